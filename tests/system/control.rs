//! Orders of people: cancel, interrupt, resume; and what a run opens on the network.

use crate::{DAMPER, SLOW};
use rustix::process::Signal;
use std::time::{Duration, Instant};
use tests::{System, complaint, isola};

/// Cancelling reaches a running branch before a third of its lease.
#[test]
fn cancel() {
    let mut system = System::sweep_with(DAMPER, &[SLOW, &["--workers", "0", "--lease", "15"]].concat());
    let mut worker = system.worker();
    system.wait_until("a task under way", |status| status.tasks.running > 0);
    let told = Instant::now();
    let cancelled = isola(&["cancel", &system.directory_text()]);
    assert!(cancelled.status.success(), "{}", complaint(&cancelled));
    assert!(worker.wait().success(), "{}", worker.output());
    assert!(told.elapsed() < Duration::from_secs(5), "{:?}", told.elapsed());
    assert_eq!(system.coordinator.wait().code(), Some(3));
    assert_eq!(system.attempts("ending = 'released'"), 1);
    let status = isola(&["status", &system.directory_text()]);
    assert!(String::from_utf8_lossy(&status.stdout).contains("cancelled"));
    system.resume(&["--workers", "2"]);
    system.expect_complete();
}

/// Ctrl-C: workers are gone, nothing is half-written, `resume` finishes what is left.
#[test]
fn interrupt_and_resume() {
    let mut system = System::sweep_with(DAMPER, &[SLOW, &["--workers", "2"]].concat());
    system.wait_until("a result", |status| status.tasks.done > 0);
    system.wait_for_a_branch();
    let children = system.children();
    assert_eq!(children.len(), 2);
    system.coordinator.signal(Signal::INT);
    assert_eq!(system.coordinator.wait().code(), Some(130), "{}", system.coordinator.output());
    assert!(system.coordinator.output().contains("isola resume"));
    let alive = |id: &u32| std::path::Path::new(&format!("/proc/{id}")).exists();
    assert!(!children.iter().any(alive), "workers are left behind");
    let before = system.done();
    assert!(!before.is_empty());
    system.resume(&["--workers", "2"]);
    system.expect_complete();
    assert_eq!(system.done()[..before.len()], before[..]);
}

/// Workers of a sweep that is killed go with it.
#[test]
fn local_workers_do_not_outlive_their_coordinator() {
    let mut system = System::sweep_with(DAMPER, &[SLOW, &["--workers", "2"]].concat());
    system.wait_for_a_branch();
    let children = system.children();
    system.coordinator.signal(Signal::KILL);
    system.coordinator.wait();
    let alive = |id: &u32| std::path::Path::new(&format!("/proc/{id}")).exists();
    assert!(tests::eventually(Duration::from_secs(5), || !children.iter().any(alive)));
    system.resume(&["--workers", "2"]);
    system.expect_complete();
}

/// Only loopback, and only the coordinator listens.
#[test]
fn what_a_run_opens() {
    let system = System::sweep_with(DAMPER, &[SLOW, &["--workers", "2"]].concat());
    system.wait_for_a_branch();
    let port = system.address().rsplit(':').next().unwrap().to_string();
    assert_eq!(tests::listening(system.coordinator.id()), [format!("127.0.0.1:{port}")]);
    for worker in system.children() {
        assert!(tests::listening(worker).is_empty());
    }
}
