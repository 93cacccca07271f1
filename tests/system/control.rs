//! Orders of people: cancel, interrupt, resume; and what a run opens on the network.

use crate::stand_in::StandIn;
use crate::{BRIEF, DAMPER, ENDLESS, FINE, LONG, THIRD_OF_LONG};
use rustix::process::Signal;
use std::time::Instant;
use tests::{System, block_on, complaint, isola};

fn is_alive(id: &u32) -> bool {
    std::path::Path::new(&format!("/proc/{id}")).exists()
}

/// Cancelling reaches a running branch before a third of its lease; the run can go on afterwards.
#[test]
fn cancel() {
    let mut system = System::sweep(DAMPER, &[ENDLESS, LONG].concat());
    let mut worker = system.worker();
    let attempt = system.attempt_of(&worker);
    system.wait_for_a_branch();
    let told = Instant::now();
    let cancelled = isola(&["cancel", &system.directory_text()]);
    assert!(cancelled.status.success(), "{}", complaint(&cancelled));
    assert!(worker.wait().success(), "{}", worker.output());
    assert!(told.elapsed() < THIRD_OF_LONG, "{:?}", told.elapsed());
    assert_eq!(system.coordinator.wait().code(), Some(3));
    assert_eq!(system.end_of(&attempt), "released");
    let status = isola(&["status", &system.directory_text()]);
    assert!(String::from_utf8_lossy(&status.stdout).contains("cancelled"));
    system.resume(&["--workers", "0"]);
    let worker = system.worker();
    assert_eq!(system.attempt_of(&worker).task, attempt.task);
}

/// Ctrl-C: workers are gone, nothing is half-written, `resume` finishes what is left.
#[test]
fn interrupt_and_resume() {
    let levels = ["--amplitudes", "0.006,0.007,0.009", "--workers", "2"];
    let mut system = System::sweep_with(DAMPER, &[&levels, FINE, BRIEF, LONG].concat());
    block_on(async {
        // Of three levels two workers have two: as long as the third one is held, the run goes on.
        let holder = StandIn::of(&system).await;
        holder.grant().await;
        system
            .eventually("two workers and a result", |system| system.children().len() == 2 && !system.done().is_empty());
    });
    let children = system.children();
    system.coordinator.signal(Signal::INT);
    assert_eq!(system.coordinator.wait().code(), Some(130), "{}", system.coordinator.output());
    assert!(system.coordinator.output().contains("isola resume"));
    assert!(!children.iter().any(is_alive), "workers are left behind");
    let before = system.done();
    assert!(!before.is_empty());
    system.resume(&["--workers", "2"]);
    system.expect_complete();
    assert_eq!(system.done()[..before.len()], before[..]);
}

/// Workers of a sweep that is killed go with it, long before they would lose patience with their coordinator.
#[test]
fn local_workers_do_not_outlive_their_coordinator() {
    let mut system = System::sweep_with(DAMPER, &[ENDLESS, &["--workers", "2"]].concat());
    system.wait_for_a_branch();
    let children = system.children();
    assert_eq!(children.len(), 2);
    system.coordinator.signal(Signal::KILL);
    system.coordinator.wait();
    system.eventually("the end of the workers", |_| !children.iter().any(is_alive));
}

/// Only loopback, and only the coordinator listens.
#[test]
fn what_a_run_opens() {
    let system = System::sweep_with(DAMPER, &[ENDLESS, &["--workers", "2"]].concat());
    system.wait_for_a_branch();
    let port = system.address().rsplit(':').next().unwrap().to_string();
    assert_eq!(tests::listening(system.coordinator.id()), [format!("127.0.0.1:{port}")]);
    for worker in system.children() {
        assert!(tests::listening(worker).is_empty());
    }
}
