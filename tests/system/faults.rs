//! Workers, coordinators and networks that fail: nothing is lost, nothing is stored twice.

use crate::stand_in::StandIn;
use crate::{BRIEF, DAMPER, ENDLESS, FINE, LEVELS, LONG, SHORT, THIRD_OF_LONG};
use protocol::to_everyone::Stage;
use protocol::to_worker::{Acknowledgement, SubmitReply};
use rustix::process::Signal;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use tests::{System, block_on, complaint, isola, own_endpoint};

/// At least once, acknowledged late.
#[test]
fn a_worker_killed_in_the_middle_of_a_branch() {
    let mut system = System::sweep(DAMPER, &[LEVELS, FINE, BRIEF, SHORT].concat());
    let _killed = system.expired_worker(|worker| worker.signal(Signal::KILL));
    let _second = system.worker();
    system.expect_complete();
}

/// Stored once: whoever is frozen past its lease comes back too late, and notices.
#[test]
fn a_worker_frozen_past_its_lease() {
    let mut system = System::sweep(DAMPER, &[LEVELS, FINE, BRIEF, SHORT, &["--stay"]].concat());
    let mut frozen = system.expired_worker(|_| {});
    let _second = system.worker();
    system.wait_until_finished();
    frozen.signal(Signal::CONT);
    assert!(frozen.wait().success(), "{}", frozen.output());
    let said = frozen.output();
    // Frozen before its grant arrived, it has nothing to come back with.
    let noticed = ["given up", "there was a result already", "all work is done tasks=0"];
    assert!(noticed.iter().any(|words| said.contains(words)), "{said}");
    system.coordinator.signal(Signal::INT);
    system.expect_complete();
}

/// A second result of a task is compared with the first one, and not stored.
#[test]
fn a_result_that_comes_twice() {
    let mut system = System::sweep(DAMPER, &[&["--amplitudes", "0.007", "--stay"], BRIEF, SHORT].concat());
    block_on(async {
        let tardy = StandIn::of(&system).await;
        let grant = tardy.grant().await;
        let result = tardy.compute(&grant).await;
        // Its lease expires, somebody else carries the task out.
        let _worker = system.worker();
        system.reaches("the end", |status| status.stage == Stage::Finished).await;
        assert_eq!(tardy.submit(&result).await, SubmitReply::Duplicate { agrees: true });
        assert_eq!(tardy.submit(&result).await, SubmitReply::Duplicate { agrees: true });
    });
    system.coordinator.signal(Signal::INT);
    system.expect_complete();
}

/// A coordinator's restart loses nothing and recomputes nothing finished; a branch under way goes on.
#[test]
fn the_coordinator_killed_and_started_again() {
    let listen = own_endpoint();
    let serve = ["--listen", &listen, "--lease", "60"];
    let mut system = System::sweep(DAMPER, &[LEVELS, FINE, BRIEF, &serve].concat());
    let _worker = system.worker();
    system.freeze_coordinator(
        "SELECT EXISTS (SELECT * FROM results) AND EXISTS (SELECT * FROM tasks WHERE state = 'leased')",
    );
    system.coordinator.signal(Signal::KILL);
    system.coordinator.wait();
    let before = system.done();
    system.resume(&[&["--workers", "0"], &serve[..]].concat());
    system.expect_complete();
    assert_eq!(system.done()[..before.len()], before[..]);
    assert_eq!(system.attempts("ending = 'expired'"), 0, "the branch under way was not adopted");
    assert_eq!(system.attempts_in_vain(), Vec::<String>::new(), "something was computed in vain");
}

/// Verification goes on where a killed coordinator left it, and says what it would have said without.
#[test]
fn the_coordinator_killed_while_branches_are_verified() {
    let all = ["--search", "none", "--verify", "all"];
    let mut undisturbed = System::sweep_with(DAMPER, &[LEVELS, &all, &["--workers", "2"]].concat());
    undisturbed.expect_complete();
    let (listen, lease) = (own_endpoint(), ["--lease", "60"]);
    let serve = ["--listen", &listen, "--lease", "60", "--workers", "0"];
    let mut system = System::sweep_with(DAMPER, &[LEVELS, &all[..], &serve].concat());
    let _worker = system.worker();
    system.freeze_coordinator(
        "SELECT EXISTS (SELECT * FROM verifications) \
         AND EXISTS (SELECT * FROM tasks WHERE kind = 'verify' AND state IN ('waiting', 'leased'))",
    );
    system.coordinator.signal(Signal::KILL);
    system.coordinator.wait();
    let before = system.done();
    system.resume(&[&["--workers", "0", "--listen", &listen], &lease[..]].concat());
    system.expect_complete();
    assert_eq!(system.done()[..before.len()], before[..]);
    assert_eq!(system.attempts_in_vain(), Vec::<String>::new(), "something was computed in vain");
    let bifurcations = |system: &System| std::fs::read_to_string(system.directory().join("bifurcations.csv")).unwrap();
    assert!(bifurcations(&system).lines().count() > 3, "{}", bifurcations(&system));
    assert_eq!(bifurcations(&system), bifurcations(&undisturbed));
}

/// Verified afterwards, a run gains what it would have had, and keeps the rest.
#[test]
fn a_finished_run_that_is_verified_afterwards() {
    let mut system = System::sweep_with(DAMPER, &[LEVELS, BRIEF, &["--workers", "1"]].concat());
    system.expect_complete();
    let before = system.done();
    assert_eq!(system.number("SELECT count(*) FROM verifications"), 0);
    let output = isola(&["verify", &system.directory_text(), "--workers", "1"]);
    assert!(output.status.success(), "{}", complaint(&output));
    assert_eq!(system.done()[..before.len()], before[..]);
    let missing =
        "SELECT count(*) FROM branches WHERE id NOT IN (SELECT branch FROM verifications WHERE stretch = 'whole')";
    assert_eq!(system.number(missing), 0);
    // Once more there is nothing to do.
    let (done, output) = (system.done(), isola(&["verify", &system.directory_text(), "--workers", "1"]));
    assert!(output.status.success(), "{}", complaint(&output));
    assert_eq!(system.done(), done);
}

/// Pushed afterwards, a run says how hard a push throws its structure onto its isolas, though its coordinator was killed meanwhile.
#[test]
fn a_finished_run_that_is_pushed_afterwards() {
    let mut system = System::sweep_with(DAMPER, &[LEVELS, BRIEF, &["--workers", "1"]].concat());
    system.expect_complete();
    let output = isola(&["disturb", &system.directory_text(), "--modes", "1", "--workers", "2"]);
    assert!(output.status.success(), "{}", complaint(&output));
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.contains("Smallest push"), "{said}");
    // What is stable of its isolas was computed first: all of it is said once, at the end.
    assert_eq!(said.matches("results: ").count(), 1, "{said}");
    assert_eq!(complaint(&output).lines().filter(|line| line.starts_with("run ")).count(), 1, "{}", complaint(&output));
    let isolas = system.number("SELECT count(*) FROM branches WHERE kind = 'isola'");
    assert!(isolas > 0);
    assert_eq!(system.number("SELECT count(*) FROM pushes WHERE below < impulse AND confirmed"), isolas);
    let pushes = std::fs::read_to_string(system.directory().join("pushes.csv")).unwrap();
    assert_eq!(pushes.lines().count() as i64, isolas + 1, "{pushes}");
    // Once more there is nothing to do.
    let (done, output) = (system.done(), isola(&["disturb", &system.directory_text(), "--modes", "1"]));
    assert!(output.status.success(), "{}", complaint(&output));
    assert_eq!(system.done(), done);
}

/// Elastic: who joins late gets work.
#[test]
fn a_worker_that_joins_late() {
    let mut system = System::sweep(DAMPER, &[LEVELS, FINE, BRIEF, LONG].concat());
    block_on(async {
        let holder = StandIn::of(&system).await;
        let held = holder.grant().await;
        let first = system.worker();
        system.eventually("a result", |system| system.workers_with_results() == 1);
        // So that it does not do all that is left by itself.
        first.signal(Signal::STOP);
        assert_eq!(holder.release(&held).await, Acknowledgement::Ok);
        let _second = system.worker();
        system.eventually("a result of the second worker", |system| system.workers_with_results() == 2);
        first.signal(Signal::CONT);
        system.expect_complete();
    });
}

/// Drain: a worker told to end gives back what it has at once, and somebody else is given it.
#[test]
fn a_worker_told_to_end() {
    let mut system = System::sweep(DAMPER, &[ENDLESS, LONG].concat());
    let mut first = system.worker();
    let attempt = system.attempt_of(&first);
    system.wait_for_a_branch();
    let told = Instant::now();
    first.signal(Signal::TERM);
    assert!(first.wait().success(), "{}", first.output());
    assert!(told.elapsed() < THIRD_OF_LONG);
    assert_eq!(system.end_of(&attempt), "released");
    let second = system.worker();
    assert_eq!(system.attempt_of(&second).task, attempt.task);
}

/// A partition: the network between a worker and the coordinator stops for longer than a lease.
#[test]
fn a_network_that_stops() {
    let mut system = System::sweep(DAMPER, &[LEVELS, FINE, BRIEF, SHORT, &["--stay"]].concat());
    let proxy = Proxy::to(&system.address());
    let cut_off = system.worker_at(&proxy.address);
    loop {
        let attempt = system.attempt_of(&cut_off);
        proxy.frozen.store(true, Ordering::Relaxed);
        match system.end_of(&attempt).as_str() {
            "expired" => break,
            // Its result was on its way: then once more.
            end => assert_eq!(end, "done"),
        }
        proxy.frozen.store(false, Ordering::Relaxed);
    }
    let second = system.worker();
    system.attempt_of(&second);
    proxy.frozen.store(false, Ordering::Relaxed);
    system.wait_until_finished();
    system.coordinator.signal(Signal::INT);
    system.expect_complete();
}

/// A poison task ends on the dead list with its reasons; the rest finishes.
#[test]
fn a_task_that_always_fails() {
    let mut system = System::sweep(DAMPER, &[LEVELS, BRIEF, LONG].concat());
    block_on(async {
        let poisoned = StandIn::of(&system).await;
        for _ in 0..3 {
            let grant = poisoned.grant_of("0.009-0").await;
            assert_eq!(poisoned.fail(&grant, "out of memory").await, Acknowledgement::Ok);
        }
    });
    let _worker = system.worker();
    let status = system.coordinator.wait();
    assert_eq!(status.code(), Some(3), "{}", system.coordinator.output());
    assert_eq!(system.attempts("ending = 'failed' AND reason LIKE '%out of memory%'"), 3);
    assert_eq!(system.number("SELECT count(*) FROM tasks WHERE state = 'dead'"), 1);
    assert!(system.number("SELECT count(*) FROM tasks WHERE state = 'done'") > 3);
    // It can be tried again.
    let directory = system.directory_text();
    let retried = tests::isola(&["retry-dead", &directory]);
    assert!(retried.status.success(), "{}", tests::complaint(&retried));
    system.resume(&["--workers", "1"]);
    system.expect_complete();
}

/// A TCP relay that can stop without closing anything.
struct Proxy {
    address: String,
    frozen: Arc<AtomicBool>,
}

impl Proxy {
    fn to(address: &str) -> Self {
        let target = address.trim_start_matches("tcp/").to_string();
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = format!("tcp/{}", listener.local_addr().unwrap());
        let frozen = Arc::new(AtomicBool::new(false));
        let stopped = frozen.clone();
        std::thread::spawn(move || {
            for client in listener.incoming().flatten() {
                let Ok(server) = TcpStream::connect(&target) else { continue };
                let ways = [(client.try_clone().unwrap(), server.try_clone().unwrap()), (server, client)];
                for (from, to) in ways {
                    let stopped = stopped.clone();
                    std::thread::spawn(move || relay(from, to, &stopped));
                }
            }
        });
        Self { address, frozen }
    }
}

fn relay(mut from: TcpStream, mut to: TcpStream, frozen: &AtomicBool) {
    let mut buffer = [0; 1 << 16];
    while let Ok(count) = from.read(&mut buffer) {
        while frozen.load(Ordering::Relaxed) {
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        if count == 0 || to.write_all(&buffer[..count]).is_err() {
            break;
        }
    }
    let _ = to.shutdown(Shutdown::Both);
}
