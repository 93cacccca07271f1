//! Viewers: late, after the end, frozen.

use crate::{DAMPER, SLOW};
use protocol::codec::{decode, encode, sha256};
use protocol::ids::TaskId;
use protocol::session::{fetch, fetch_all};
use protocol::to_everyone::{Done, Status, StoredResult};
use rustix::process::Signal;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use tests::{PATIENCE, Process, System, block_on, program};

/// Collects every result of a run that may be going on: announced before, or from now on.
async fn collect(system: &System) -> BTreeMap<TaskId, StoredResult> {
    let (session, keys, _) = system.viewer().await;
    let announced = session.declare_subscriber(keys.all_done()).await.unwrap();
    let mut results = BTreeMap::new();
    let mut pending: Vec<Done> = fetch_all(&session, &keys.all_done(), PATIENCE).await.unwrap();
    let deadline = Instant::now() + PATIENCE;
    loop {
        for done in pending.drain(..) {
            if results.contains_key(&done.task) {
                continue;
            }
            let result: StoredResult = fetch(&session, &keys.result(&done.task), PATIENCE).await.unwrap();
            let bytes = encode(&result);
            assert_eq!((bytes.len() as u64, sha256(&bytes)), (done.size, done.sha256));
            results.insert(done.task, result);
        }
        let status: Status = fetch(&session, &keys.status(), PATIENCE).await.unwrap();
        if status.stage == protocol::to_everyone::Stage::Finished && results.len() as u64 == status.sequence {
            return results;
        }
        assert!(Instant::now() < deadline, "{} of {} results", results.len(), status.sequence);
        if let Ok(Ok(sample)) = tokio::time::timeout(Duration::from_millis(200), announced.recv_async()).await {
            pending.push(decode(&sample.payload().to_bytes(), &sample.encoding().to_string()).unwrap());
        }
    }
}

/// One joins half way, one after the end: both hold every branch.
#[test]
fn late_viewers_see_all() {
    let mut system = System::sweep(DAMPER, &[SLOW, &["--stay"]].concat());
    let _worker = system.worker();
    system.wait_until("half of it", |status| status.tasks.done >= 2);
    let (half_way, after) = block_on(async {
        let half_way = collect(&system).await;
        (half_way, collect(&system).await)
    });
    assert_eq!(half_way, after);
    let branches = after.values().filter(|result| result.branch.is_some()).count();
    assert_eq!(branches as i64, system.number("SELECT count(*) FROM branches"));
    assert_eq!(after.len() as i64, system.number("SELECT count(*) FROM tasks WHERE state = 'done'"));
    system.coordinator.signal(Signal::INT);
    system.expect_complete();
}

/// A frozen viewer hurts nobody: small requests stay under 100 ms, and the run ends.
#[test]
fn a_frozen_viewer() {
    let mut system =
        System::sweep_with("models/rotor67/study.toml", &["--workers", "1", "--stay", "--amplitudes", "20,60"]);
    system.wait_until("a result", |status| status.tasks.done > 0);
    let log = system.folder().join("viewer.log");
    let frozen = Process::start(&program("isola-test-viewer"), &[&system.address()], &log);
    assert!(tests::eventually(PATIENCE, || frozen.output().contains("result")), "{}", frozen.output());
    frozen.signal(Signal::STOP);
    let slowest = block_on(async {
        let (session, keys, _) = system.viewer().await;
        let mut slowest = Duration::ZERO;
        loop {
            let asked = Instant::now();
            let status: Status = fetch(&session, &keys.status(), PATIENCE).await.unwrap();
            slowest = slowest.max(asked.elapsed());
            if status.stage == protocol::to_everyone::Stage::Finished {
                return slowest;
            }
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    });
    assert!(slowest < Duration::from_millis(100), "{slowest:?}");
    system.coordinator.signal(Signal::INT);
    system.expect_complete();
}
