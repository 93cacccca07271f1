//! Leases that are renewed, lost, cancelled, given twice.

use crate::fake::{Answer, Asked, Fake, drained, fine, grant, hand_out, wait};
use crate::study::Study;
use protocol::branch::FindingMessage;
use protocol::from_worker::Progress;
use protocol::ids::{Attempt, TaskId};
use protocol::to_everyone::Stage;
use protocol::to_worker::{RenewReply, SubmitReply};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use worker::Ending;
use worker::shutdown::Shutdown;

/// Time within which a branch under way hears that it is to stop.
const SOON: Duration = Duration::from_millis(1500);

/// An endless branch, and then nothing; renewals are answered by `verdict` once it is set.
async fn endless(verdict: RenewReply) -> (Fake, Arc<AtomicBool>) {
    let study = Study::endless();
    let mut grants = vec![study.main()].into_iter();
    let decided = Arc::new(AtomicBool::new(false));
    let is_decided = decided.clone();
    let answer = move |asked: &Asked| match asked {
        Asked::Lease(_) => grants.next().map_or_else(drained, grant),
        Asked::Renew(_) if is_decided.load(Ordering::Relaxed) => Answer::Renew(verdict),
        _ => fine(asked),
    };
    (Fake::start(&study, answer).await, decided)
}

#[tokio::test(flavor = "multi_thread")]
async fn a_lost_lease_stops_its_branch() {
    let (fake, decided) = endless(RenewReply::Lost).await;
    let options = fake.options(&[]);
    let worker = tokio::spawn(async move { worker::work(&options, &Shutdown::default()).await });
    // Renewed by itself, three times a lease.
    fake.seen.wait_for(Asked::is_renew, 1).await;
    decided.store(true, Ordering::Relaxed);
    let started = Instant::now();
    fake.hint().await;
    let summary = worker.await.unwrap().unwrap();
    assert!(started.elapsed() < SOON, "{:?}", started.elapsed());
    assert_eq!((summary.ending, summary.done), (Ending::Drained, 0));
    assert_eq!(fake.seen.count(Asked::is_release), 0);
    assert_eq!(fake.seen.count(Asked::is_submit), 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn cancelling_gives_the_branch_back() {
    let (fake, decided) = endless(RenewReply::Cancel).await;
    let options = fake.options(&[]);
    let worker = tokio::spawn(async move { worker::work(&options, &Shutdown::default()).await });
    fake.seen.wait_for(Asked::is_renew, 1).await;
    decided.store(true, Ordering::Relaxed);
    fake.change(|manifest| manifest.stage = Stage::Cancelled);
    let started = Instant::now();
    fake.hint().await;
    let summary = worker.await.unwrap().unwrap();
    assert!(started.elapsed() < SOON, "{:?}", started.elapsed());
    assert_eq!((summary.ending, summary.done), (Ending::Cancelled, 0));
    assert_eq!(fake.seen.count(Asked::is_release), 1);
    // Nothing is asked of a coordinator that may be gone already.
    assert_eq!(fake.seen.count(Asked::is_lease), 1);
}

/// A coordinator that stops, and may come back: the worker asks again.
#[tokio::test(flavor = "multi_thread")]
async fn a_coordinator_that_stops_is_waited_for() {
    let (fake, decided) = endless(RenewReply::Cancel).await;
    decided.store(true, Ordering::Relaxed);
    assert_eq!(fake.work(&[]).await.unwrap().ending, Ending::Drained);
    assert_eq!(fake.seen.count(Asked::is_release), 1);
    assert_eq!(fake.seen.count(Asked::is_lease), 2);
}

#[tokio::test(flavor = "multi_thread")]
async fn progress_is_shown_and_told() {
    let (fake, decided) = endless(RenewReply::Lost).await;
    let task = TaskId::of_level("0.008", 0).unwrap();
    let puts = fake.session.declare_subscriber(fake.keys.progress(&task)).await.unwrap();
    let options = fake.options(&[]);
    let worker = tokio::spawn(async move { worker::work(&options, &Shutdown::default()).await });
    let mut points = Vec::new();
    for _ in 0..3 {
        let sample = puts.recv_async().await.unwrap();
        let encoding = sample.encoding().to_string();
        let progress: Progress = protocol::codec::decode(&sample.payload().to_bytes(), &encoding).unwrap();
        points.push((Instant::now(), progress.points));
    }
    assert!(points.windows(2).all(|pair| pair[0].1 < pair[1].1), "{points:?}");
    assert!(points[2].0 - points[0].0 > Duration::from_millis(800), "more often than twice a second: {points:?}");
    decided.store(true, Ordering::Relaxed);
    fake.hint().await;
    worker.await.unwrap().unwrap();
    let log = fake.seen.log.lock().unwrap();
    let told = log.iter().any(|asked| matches!(asked, Asked::Renew(request) if request.progress.is_some()));
    assert!(told, "{log:?}");
}

/// A grant that is given again is computed again: its result may have been lost with the answer.
#[tokio::test(flavor = "multi_thread")]
async fn the_same_grant_twice() {
    let study = Study::new(1);
    let mut grants = vec![study.main(), study.main()].into_iter();
    let mut replies = [SubmitReply::Accepted, SubmitReply::Duplicate { agrees: true }].into_iter();
    let answer = move |asked: &Asked| match asked {
        Asked::Lease(_) => grants.next().map_or_else(drained, grant),
        Asked::Submit(_) => Answer::Submit(replies.next().unwrap()),
        _ => fine(asked),
    };
    let fake = Fake::start(&study, answer).await;
    assert_eq!(fake.work(&[]).await.unwrap().done, 2);
    let submitted = fake.seen.submitted();
    let [first, second] = &submitted[..] else { panic!("{} results", submitted.len()) };
    assert_eq!(first.lease, second.lease);
    assert_eq!(first.finding, second.finding);
    assert!(matches!(first.finding, FindingMessage::Branch(_)));
}

#[tokio::test(flavor = "multi_thread")]
async fn waits_for_work_and_hears_of_it() {
    let study = Study::new(1);
    let mut grants = vec![study.main()].into_iter();
    let mut waits = 5;
    let answer = move |asked: &Asked| match asked {
        Asked::Lease(_) if waits > 0 => {
            waits -= 1;
            wait()
        }
        Asked::Lease(_) => grants.next().map_or_else(drained, grant),
        _ => fine(asked),
    };
    let fake = Fake::start(&study, answer).await;
    assert_eq!(fake.work(&[]).await.unwrap().done, 1);
    assert_eq!(fake.seen.count(Asked::is_lease), 7);
}

/// Slots lease independently, and all of them end.
#[tokio::test(flavor = "multi_thread")]
async fn every_slot_has_its_own_lease() {
    let study = Study::new(1);
    let attempts = (1..=3).map(|attempt| {
        let mut grant = study.main();
        (grant.task, grant.attempt) = (TaskId::new(&format!("0.008-{attempt}")).unwrap(), Attempt(attempt));
        grant
    });
    let fake = Fake::start(&study, hand_out(attempts.collect())).await;
    assert_eq!(fake.work(&["--slots", "2"]).await.unwrap().done, 3);
    for request in fake.seen.submitted() {
        assert!(request.lease.slot < 2);
        assert_eq!(request.lease.task.as_str(), format!("0.008-{}", request.lease.attempt));
    }
}
