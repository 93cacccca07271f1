//! Long branches are not lost with the worker that follows them.

use crate::{DAMPER, LASTING, LONG};
use rustix::process::Signal;
use std::time::Duration;
use tests::{Process, System, results};

/// The task of the main branch.
const MAIN: &str = "0.009-0";

/// Shortest time between two parts that a worker sends (`PERIOD` in its `checkpoints.rs`, of which this is a copy).
const PERIOD: Duration = Duration::from_secs(2);

/// So long a worker takes steps before it is frozen.
const WORKING: Duration = Duration::from_millis(200);

/// Waits for the main branch: every number of it as stored.
fn branch(system: &System) -> Vec<String> {
    let stored = format!("SELECT count(*) FROM branches WHERE task = '{MAIN}'");
    system.eventually("the main branch", |system| system.number(&stored) == 1);
    results::numbers_of(&system.directory(), MAIN)
}

/// Waits until more than so many steps of its branch, which the worker follows, are kept, or the branch is stored: whether that is not so.
fn is_under_way_after(system: &System, worker: &Process, steps: i64) -> bool {
    // A part is due after so long by the clock: frozen meanwhile, a worker has not come to the end by then, however fast its machine.
    std::thread::sleep(WORKING);
    worker.signal(Signal::STOP);
    std::thread::sleep(PERIOD);
    worker.signal(Signal::CONT);
    let stored = format!("SELECT count(*) FROM branches WHERE task = '{MAIN}'");
    let kept = format!("SELECT coalesce(sum(steps), 0) > {steps} FROM checkpoints WHERE task = '{MAIN}'");
    system.eventually("a checkpoint", |system| system.number(&kept) == 1 || system.number(&stored) == 1);
    system.number(&stored) == 0
}

/// What is kept is taken as it is, the rest computed, and the branch is the one that nothing disturbs: also if the coordinator is
/// killed with the worker, and, where it lasts so long, the successor later.
#[test]
fn a_successor_goes_on_and_comes_to_the_same_bytes() {
    let undisturbed = std::thread::spawn(|| {
        let mut whole = System::sweep(DAMPER, &[LASTING, LONG].concat());
        let _worker = whole.worker();
        branch(&whole)
    });
    let mut system = System::sweep(DAMPER, &[LASTING, LONG].concat());
    let first = system.worker();
    system.eventually("a lease", |system| {
        system.number(&format!("SELECT count(*) FROM attempts WHERE task = '{MAIN}'")) == 1
    });
    assert!(is_under_way_after(&system, &first, 0), "the branch does not last");
    first.signal(Signal::KILL);
    system.coordinator.signal(Signal::KILL);
    system.coordinator.wait();
    system.resume(&["--workers", "0", "--lease", "5"]);
    let second = system.worker();
    let handed_on = format!("SELECT coalesce(max(checkpoint), 0) FROM attempts WHERE task = '{MAIN}'");
    system.eventually("a successor", |system| system.number(&handed_on) > 0);
    let once = system.number(&handed_on);
    let mut successors = vec![second];
    if is_under_way_after(&system, &successors[0], once) {
        successors[0].signal(Signal::KILL);
        successors.push(system.worker());
    }
    assert!(branch(&system) == undisturbed.join().unwrap(), "another branch");
    let twice = system.number(&handed_on);
    assert!(twice > once || successors.len() == 1, "{twice} steps after {once}");
    for successor in successors {
        assert!(successor.output().contains("goes on from a checkpoint"), "{}", successor.output());
    }
    assert_eq!(system.number(&format!("SELECT count(*) FROM checkpoints WHERE task = '{MAIN}'")), 0);
    assert_eq!(system.number(&format!("SELECT count(*) FROM results WHERE task = '{MAIN}'")), 1);
}
