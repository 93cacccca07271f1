//! A run followed on a real bus, from a coordinator that loses announcements, repeats them, and is started again.

use crate::samples;
use protocol::codec::{encode, encoding, sha256};
use protocol::credentials::Credentials;
use protocol::follow::{FollowError, Follower, Update};
use protocol::ids::TaskId;
use protocol::keys::{Keys, NAMESPACE, last_chunk};
use protocol::session::{RequestError, answer, connect, listen, refuse};
use protocol::to_everyone::{Done, Stage, Status, StoredResult};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use zenoh::Session;
use zenoh::bytes::Encoding;
use zenoh::query::Query;

/// A coordinator that is not heard for so long is gone.
const PATIENCE: Duration = Duration::from_secs(300);

/// What a coordinator has stored.
#[derive(Default)]
struct Store {
    done: Vec<Done>,
    stage: Option<Stage>,
}

/// A coordinator that announces what it is told to.
struct Coordinator {
    session: Session,
    keys: Keys,
    store: Arc<Mutex<Store>>,
}

fn own_endpoint(port: u16) -> String {
    let [_, a, b, c] = std::process::id().to_be_bytes();
    format!("tcp/127.{}.{b}.{c}:{port}", 64 + a % 64)
}

fn done(sequence: u64) -> Done {
    Done { sequence, task: TaskId::of_level("2.5", sequence as usize).unwrap(), ..samples::done() }
}

impl Coordinator {
    async fn start(endpoint: &str, store: Arc<Mutex<Store>>) -> Self {
        let session = listen(endpoint, &Credentials::default(), NAMESPACE).await.unwrap();
        let keys = Keys::new("isola", &samples::manifest().run);
        let coordinator = Self { session, keys, store };
        for key in [coordinator.keys.status(), coordinator.keys.all_done(), coordinator.keys.results()] {
            let (keys, store) = (coordinator.keys.clone(), coordinator.store.clone());
            let lend = move |query: Query| lend(&query, &keys, &store.lock().unwrap());
            coordinator.session.declare_queryable(key).complete(true).callback(lend).background().await.unwrap();
        }
        coordinator
    }

    fn store(&self, sequence: u64) {
        self.store.lock().unwrap().done.push(done(sequence));
    }

    async fn announce(&self, sequence: u64) {
        let done = done(sequence);
        let put = self.session.put(self.keys.done(&done.task), encode(&done));
        put.encoding(Encoding::from(encoding::<Done>())).await.unwrap();
    }

    fn enter(&self, stage: Stage) {
        self.store.lock().unwrap().stage = Some(stage);
    }
}

fn lend(query: &Query, keys: &Keys, store: &Store) {
    let key = query.key_expr().as_str();
    match store.stage {
        None => refuse(query, "the run is just starting"),
        Some(stage) if key == keys.status() => {
            let sequence = store.done.len() as u64;
            answer(query, key, &Status { stage, sequence, ..samples::status() });
        }
        Some(_) if key == keys.all_done() => {
            store.done.iter().for_each(|done| answer(query, &keys.done(&done.task), done))
        }
        Some(_) => {
            // The second one is not what was announced.
            let is_altered = last_chunk(key) == done(2).task.as_str();
            let seconds = samples::result().seconds + if is_altered { 1.0 } else { 0.0 };
            answer(query, key, &StoredResult { seconds, ..samples::result() });
        }
    }
}

/// A coordinator that has not begun, and somebody who follows it.
async fn pair(port: u16) -> (Coordinator, Follower) {
    let endpoint = own_endpoint(port);
    let coordinator = Coordinator::start(&endpoint, Arc::default()).await;
    let session = connect(&endpoint, &Credentials::default()).await.unwrap();
    let follower = Follower::start(&session, &coordinator.keys, PATIENCE).await.unwrap();
    (coordinator, follower)
}

/// Numbers of the next announcements, so many or all.
async fn heard(follower: &mut Follower, count: usize) -> Vec<u64> {
    let mut heard = Vec::new();
    while heard.len() < count {
        match follower.next().await.unwrap() {
            Some(Update::Done(done)) => heard.push(done.sequence),
            Some(Update::Status(_)) => {}
            None => break,
        }
    }
    heard
}

#[tokio::test(flavor = "multi_thread")]
async fn what_is_lost_is_asked_for() {
    let (coordinator, mut follower) = pair(21_000).await;
    coordinator.enter(Stage::Sweep);
    (1..=3).for_each(|sequence| coordinator.store(sequence));
    assert_eq!(heard(&mut follower, 3).await, [1, 2, 3], "announced before");
    // The fourth one is dropped, the fifth one comes twice.
    (4..=5).for_each(|sequence| coordinator.store(sequence));
    coordinator.announce(5).await;
    coordinator.announce(5).await;
    let mut both = heard(&mut follower, 2).await;
    both.sort_unstable();
    assert_eq!(both, [4, 5]);
    // Nothing is announced any more, not even the end.
    coordinator.store(6);
    coordinator.enter(Stage::Finished);
    assert_eq!(heard(&mut follower, usize::MAX).await, [6]);
    assert_eq!((follower.next().await.unwrap(), follower.missing()), (None, 0));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_coordinator_that_is_just_starting() {
    let (coordinator, mut follower) = pair(21_001).await;
    let following = tokio::spawn(async move { heard(&mut follower, usize::MAX).await });
    coordinator.store(1);
    tokio::time::sleep(Duration::from_millis(500)).await;
    coordinator.enter(Stage::Cancelled);
    assert_eq!(following.await.unwrap(), [1]);
}

/// Announcements keep their numbers, and come once.
#[tokio::test(flavor = "multi_thread")]
async fn a_coordinator_that_is_started_again() {
    let (first, mut follower) = pair(21_002).await;
    first.enter(Stage::Sweep);
    (1..=2).for_each(|sequence| first.store(sequence));
    assert_eq!(heard(&mut follower, 2).await, [1, 2]);
    first.session.close().await.unwrap();
    let following = tokio::spawn(async move { heard(&mut follower, usize::MAX).await });
    tokio::time::sleep(Duration::from_millis(500)).await;
    let second = Coordinator::start(&own_endpoint(21_002), first.store.clone()).await;
    second.store(3);
    second.enter(Stage::Finished);
    assert_eq!(following.await.unwrap(), [3]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_coordinator_that_is_gone() {
    let endpoint = own_endpoint(21_003);
    let coordinator = Coordinator::start(&endpoint, Arc::default()).await;
    coordinator.enter(Stage::Sweep);
    coordinator.store(1);
    let session = connect(&endpoint, &Credentials::default()).await.unwrap();
    let mut follower = Follower::start(&session, &coordinator.keys, Duration::from_secs(1)).await.unwrap();
    assert_eq!(heard(&mut follower, 1).await, [1]);
    coordinator.session.close().await.unwrap();
    while let Some(update) = follower.next().await.transpose() {
        match update {
            Ok(update) => assert!(matches!(update, Update::Status(_))),
            Err(error) => {
                assert_eq!(error.to_string(), "the coordinator has not answered for 1 s");
                return;
            }
        }
    }
    panic!("the run is not over");
}

#[tokio::test(flavor = "multi_thread")]
async fn results() {
    let (coordinator, follower) = pair(21_004).await;
    assert!(matches!(
        follower.result(&done(1)).await,
        Err(FollowError::Request(RequestError::Refused(why))) if why == "the run is just starting"
    ));
    coordinator.enter(Stage::Sweep);
    assert_eq!(follower.result(&done(1)).await.unwrap(), samples::result());
    assert_eq!(done(1).sha256, sha256(&encode(&samples::result())));
    assert!(matches!(follower.result(&done(2)).await, Err(FollowError::Altered(task)) if task == done(2).task));
    let status: Status = follower.fetch(&coordinator.keys.status()).await.unwrap();
    assert_eq!(status.stage, Stage::Sweep);
}
