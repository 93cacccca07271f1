//! Long branches are not lost with the worker that follows them.

use crate::{DAMPER, LASTING, LONG, SHORT};
use rustix::process::Signal;
use tests::{System, results};

/// The task of the main branch.
const MAIN: &str = "0.009-0";

/// Waits for the main branch: every number of it as stored.
fn branch(system: &System) -> Vec<String> {
    let stored = format!("SELECT count(*) FROM branches WHERE task = '{MAIN}'");
    system.eventually("the main branch", |system| system.number(&stored) == 1);
    results::numbers_of(&system.directory(), MAIN)
}

/// Waits until more than so many steps of its branch are kept, or the branch is stored: whether that is not so.
fn is_under_way_after(system: &System, steps: i64) -> bool {
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
    let mut system = System::sweep(DAMPER, &[LASTING, SHORT].concat());
    let first = system.worker();
    assert!(is_under_way_after(&system, 0), "the branch does not last");
    first.signal(Signal::KILL);
    system.coordinator.signal(Signal::KILL);
    system.coordinator.wait();
    system.resume(&["--workers", "0", "--lease", "5"]);
    let second = system.worker();
    let handed_on = format!("SELECT coalesce(max(checkpoint), 0) FROM attempts WHERE task = '{MAIN}'");
    system.eventually("a successor", |system| system.number(&handed_on) > 0);
    let once = system.number(&handed_on);
    let mut successors = vec![second];
    if is_under_way_after(&system, once) {
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
