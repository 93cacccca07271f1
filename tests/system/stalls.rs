//! Stalls of the coordinator, of its disk and of the router between: nothing that a healthy worker does is thrown away.

use crate::{BRIEF, DAMPER, ENDLESS, FINE, LEVELS, SHORT};
use protocol::credentials::Credentials;
use protocol::keys::NAMESPACE;
use rustix::process::Signal;
use std::time::Duration;
use tests::{PATIENCE, System, block_on, own_endpoint};

/// Longer than a lease, the grace of a worker that vanished and the time after which partners give a connection up.
const LONG_STALL: Duration = Duration::from_secs(12);

/// How often attempts were ended for want of a sign of life, taken up again ones included.
fn expired(system: &System) -> i64 {
    system.number("SELECT count(*) FROM attempts WHERE \"end\" = 'expired'")
        + system.number("SELECT coalesce(sum(lapses), 0) FROM attempts")
}

/// Waits until the branch of a worker under way has more points than now.
fn wait_for_progress(system: &System) {
    let points = |status: &protocol::to_everyone::Status| {
        status.workers.iter().filter_map(|worker| worker.progress).map(|progress| progress.points).max().unwrap_or(0)
    };
    let before = points(&system.wait_until("a worker at work", |status| points(status) > 1));
    system.wait_until("more points", |status| points(status) > before);
}

/// A paused container, a suspended machine, a disk that hangs.
#[test]
fn a_coordinator_frozen_for_longer_than_a_lease() {
    let mut system = System::sweep(DAMPER, &[ENDLESS, SHORT].concat());
    let workers = [system.worker(), system.worker()];
    let attempts = workers.each_ref().map(|worker| system.attempt_of(worker));
    wait_for_progress(&system);
    for _ in 0..2 {
        system.coordinator.signal(Signal::STOP);
        std::thread::sleep(LONG_STALL);
        system.coordinator.signal(Signal::CONT);
        wait_for_progress(&system);
    }
    // Past the time that everybody has to be heard of again.
    std::thread::sleep(LONG_STALL);
    wait_for_progress(&system);
    assert_eq!(expired(&system), 0, "{}", system.coordinator.output());
    for (worker, attempt) in workers.iter().zip(attempts) {
        let now = system.attempt_of(worker);
        assert!(now.number == 1 && (now == attempt || now.task != attempt.task), "{attempt:?} became {now:?}");
    }
}

/// Another program writes, or only begins to, for longer than SQLite waits.
#[test]
fn a_store_that_another_program_has_locked() {
    let mut system = System::sweep(DAMPER, &[LEVELS, FINE, BRIEF].concat());
    let other = rusqlite::Connection::open(system.directory().join("run.sqlite")).unwrap();
    other.busy_timeout(PATIENCE).unwrap();
    let _worker = system.worker();
    system.eventually("a result", |system| !system.done().is_empty());
    other.execute_batch("BEGIN IMMEDIATE").unwrap();
    let (stored, said) = (system.done(), "locked by another program");
    system.eventually("a message", |system| system.coordinator.output().contains(said));
    std::thread::sleep(LONG_STALL);
    assert!(system.coordinator.is_running(), "{}", system.coordinator.output());
    assert_eq!(system.done(), stored, "stored in spite of the lock");
    other.execute_batch("COMMIT").unwrap();
    system.expect_complete();
    assert!(system.coordinator.output().contains("was let go after"), "{}", system.coordinator.output());
    assert_eq!(system.attempts("coalesce(ending, '') NOT IN ('done', 'confirmed')"), 0, "something was computed twice");
}

/// A router between is restarted: everybody vanishes at once, and nobody is to blame.
#[test]
fn a_router_that_is_restarted() {
    let endpoint = own_endpoint();
    block_on(async {
        let router = protocol::session::listen(&endpoint, &Credentials::default(), NAMESPACE).await.unwrap();
        let mut system = System::sweep(DAMPER, &[ENDLESS, &["--lease", "15", "--connect", &endpoint]].concat());
        let workers = [system.worker_at(&endpoint), system.worker_at(&endpoint)];
        let attempts = workers.each_ref().map(|worker| system.attempt_of(worker));
        let progress = |system: System| async {
            tokio::task::spawn_blocking(move || {
                std::thread::spawn(move || {
                    wait_for_progress(&system);
                    system
                })
                .join()
                .unwrap()
            })
            .await
            .unwrap()
        };
        system = progress(system).await;
        router.close().await.unwrap();
        tokio::time::sleep(LONG_STALL).await;
        let _router = protocol::session::listen(&endpoint, &Credentials::default(), NAMESPACE).await.unwrap();
        system = progress(system).await;
        tokio::time::sleep(2 * LONG_STALL).await;
        system = progress(system).await;
        assert_eq!(expired(&system), 0, "{}", system.coordinator.output());
        for (worker, attempt) in workers.iter().zip(attempts) {
            let now = system.attempt_of(worker);
            assert!(now.number == 1 && (now == attempt || now.task != attempt.task), "{attempt:?} became {now:?}");
        }
    });
}
