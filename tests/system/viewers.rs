//! Viewers: late, after the end, frozen.

use crate::stand_in::StandIn;
use crate::{BRIEF, DAMPER, FINE, LEVELS, LONG};
use protocol::codec::{encode, sha256};
use protocol::follow::{Follower, Update};
use protocol::ids::TaskId;
use protocol::keys::Keys;
use protocol::session::fetch;
use protocol::to_everyone::{Stage, Status, StoredResult};
use protocol::to_worker::Acknowledgement;
use rustix::process::Signal;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use tests::{PATIENCE, Process, System, block_on, program};

/// Collects every result of a run that may be going on: announced before, or from now on.
struct Viewer {
    follower: Follower,
    results: BTreeMap<TaskId, StoredResult>,
}

impl Viewer {
    async fn of(system: &System) -> Self {
        let (session, keys, _) = system.viewer().await;
        let follower = Follower::start(&session, &keys, PATIENCE).await.unwrap();
        Self { follower, results: BTreeMap::new() }
    }

    /// Until there are so many, or the run has ended.
    async fn collect(&mut self, count: usize) {
        while self.results.len() < count {
            let Some(update) = self.follower.next().await.unwrap() else { return };
            let Update::Done(done) = update else { continue };
            let result = self.follower.result(&done).await.unwrap();
            let bytes = encode(&result);
            assert_eq!((bytes.len() as u64, sha256(&bytes)), (done.size, done.sha256));
            assert!(self.results.insert(done.task, result).is_none(), "announced twice");
        }
    }
}

/// One joins half way, one after the end: both hold every branch.
#[test]
fn late_viewers_see_all() {
    let mut system = System::sweep(DAMPER, &[LEVELS, FINE, BRIEF, LONG, &["--stay"]].concat());
    let (half_way, after) = block_on(async {
        let holder = StandIn::of(&system).await;
        let held = holder.grant().await;
        let _worker = system.worker();
        system.reaches("a part of it", |status| status.tasks.done >= 2).await;
        let mut half_way = Viewer::of(&system).await;
        half_way.collect(2).await;
        assert_eq!(holder.release(&held).await, Acknowledgement::Ok);
        half_way.collect(usize::MAX).await;
        let mut after = Viewer::of(&system).await;
        after.collect(usize::MAX).await;
        (half_way.results, after.results)
    });
    assert_eq!(half_way, after);
    let branches = after.values().filter(|result| result.branch.is_some()).count();
    assert_eq!(branches as i64, system.number("SELECT count(*) FROM branches"));
    assert_eq!(after.len() as i64, system.number("SELECT count(*) FROM tasks WHERE state = 'done'"));
    system.coordinator.signal(Signal::INT);
    system.expect_complete();
}

/// Whoever waits for a frozen viewer waits until Zenoh gives it up, 5 s after it was last heard.
const FOR_THE_FROZEN: Duration = Duration::from_secs(2);

/// A small request: how the run is doing.
async fn timed_status(session: &zenoh::Session, keys: &Keys) -> (Status, Duration) {
    let asked = Instant::now();
    let status = fetch(session, &keys.status(), PATIENCE).await.unwrap();
    (status, asked.elapsed())
}

/// A frozen viewer hurts nobody: the run ends, and small requests take no longer than those to another run, of which
/// nobody wants anything, at the same time on the same machine.
#[test]
fn a_frozen_viewer() {
    let quiet = System::sweep(DAMPER, &[LEVELS, BRIEF].concat());
    let rotor = ["--workers", "1", "--stay", "--amplitudes", "20:100:20"];
    let mut system = System::sweep_with("models/rotor67/study.toml", &[&rotor, BRIEF].concat());
    system.wait_until("a result", |status| status.tasks.done > 0);
    let log = system.folder().join("viewer.log");
    let secret = system.secret_file().display().to_string();
    let frozen = Process::start(&program("isola-test-viewer"), &[&system.address(), &secret], &log);
    system.eventually("a result that was read", |_| frozen.output().contains("result"));
    frozen.signal(Signal::STOP);
    let mut times = block_on(async {
        let (session, keys, _) = system.viewer().await;
        let (other, other_keys, _) = quiet.viewer().await;
        let mut times = Vec::new();
        loop {
            let (status, time) = timed_status(&session, &keys).await;
            times.push([time, timed_status(&other, &other_keys).await.1]);
            if status.stage == Stage::Finished && times.len() >= 200 {
                return times;
            }
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    });
    let [middle, slowest] = [times.len() / 2, times.len() - 1].map(|rank| {
        [0, 1].map(|of| {
            times.sort_by_key(|time| time[of]);
            times[rank][of]
        })
    });
    assert!(middle[0] < Duration::from_millis(100) + 10 * middle[1], "{middle:?}");
    assert!(slowest[0] < FOR_THE_FROZEN + slowest[1], "{slowest:?}");
    system.coordinator.signal(Signal::INT);
    system.expect_complete();
}
