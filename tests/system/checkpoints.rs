//! Long branches are not lost with the worker that follows them.

use crate::{DAMPER, LASTING, LONG, SHORT};
use rustix::process::Signal;
use tests::{Process, System, results};

/// The task of the main branch.
const MAIN: &str = "0.009-0";

/// Waits for the main branch: every number of it as stored.
fn branch(system: &System) -> Vec<String> {
    let stored = format!("SELECT count(*) FROM branches WHERE task = '{MAIN}'");
    system.eventually("the main branch", |system| system.number(&stored) == 1);
    results::numbers_of(&system.directory(), MAIN)
}

/// Kills a worker when at least so many steps of its branch are kept; `done` to the system before somebody else goes on.
fn taken_over(steps: i64, done: impl FnOnce(&mut System)) -> (System, Process) {
    let mut system = System::sweep(DAMPER, &[LASTING, SHORT].concat());
    let first = system.worker();
    let kept = format!("SELECT coalesce(sum(steps), 0) >= {steps} FROM checkpoints WHERE task = '{MAIN}'");
    system.eventually("a checkpoint", |system| system.number(&kept) == 1);
    first.signal(Signal::KILL);
    done(&mut system);
    let second = system.worker();
    (system, second)
}

/// What is kept is taken as it is, the rest computed, and the branch is the one that nothing disturbs.
fn assert_taken_over(system: &System, second: &Process, steps: i64, undisturbed: &[String]) {
    assert!(branch(system) == undisturbed, "another branch");
    let handed_on = format!("SELECT max(checkpoint) FROM attempts WHERE task = '{MAIN}'");
    assert!(system.number(&handed_on) >= steps, "{} steps", system.number(&handed_on));
    assert!(second.output().contains("goes on from a checkpoint"), "{}", second.output());
    assert_eq!(system.number(&format!("SELECT count(*) FROM checkpoints WHERE task = '{MAIN}'")), 0);
    assert_eq!(system.number(&format!("SELECT count(*) FROM results WHERE task = '{MAIN}'")), 1);
}

/// Also if the coordinator is killed with the worker.
#[test]
fn a_successor_goes_on_and_comes_to_the_same_bytes() {
    let mut whole = System::sweep(DAMPER, &[LASTING, LONG].concat());
    let worker = whole.worker();
    let undisturbed = branch(&whole);
    let points = whole.number(&format!("SELECT points FROM branches WHERE task = '{MAIN}'"));
    drop((worker, whole));
    let half = points / 2;
    let (system, second) = taken_over(half, |_| {});
    assert_taken_over(&system, &second, half, &undisturbed);
    drop(system);
    let (system, second) = taken_over(points / 4, |system| {
        system.coordinator.signal(Signal::KILL);
        system.coordinator.wait();
        system.resume(&["--workers", "0", "--lease", "5"]);
    });
    assert_taken_over(&system, &second, points / 4, &undisturbed);
}
