//! Workers, coordinators and networks that fail: nothing is lost, nothing is stored twice.

use crate::{DAMPER, SLOW};
use protocol::from_worker::{FailRequest, Lease, LeaseRequest, ReleaseRequest, SubmitRequest};
use protocol::ids::WorkerId;
use protocol::keys::Keys;
use protocol::session::request;
use protocol::to_everyone::Stage;
use protocol::to_worker::{Acknowledgement, Grant, LeaseReply, SubmitReply};
use rustix::process::Signal;
use std::cell::Cell;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use tests::{PATIENCE, System, block_on, eventually};

/// At least once, acknowledged late.
#[test]
fn a_worker_killed_in_the_middle_of_a_branch() {
    let mut system = System::sweep(DAMPER, SLOW);
    let first = system.worker();
    system.wait_for_a_branch();
    first.signal(Signal::KILL);
    let _second = system.worker();
    system.expect_complete();
    assert!(system.attempts("ending = 'expired'") >= 1);
}

/// Stored once.
#[test]
fn a_worker_frozen_past_its_lease() {
    let mut system = System::sweep(DAMPER, &[SLOW, &["--stay"]].concat());
    let mut frozen = system.worker();
    system.wait_for_a_branch();
    frozen.signal(Signal::STOP);
    let _second = system.worker();
    system.wait_until_finished();
    frozen.signal(Signal::CONT);
    assert!(frozen.wait().success(), "{}", frozen.output());
    system.coordinator.signal(Signal::INT);
    system.expect_complete();
    assert!(system.attempts("ending = 'expired'") >= 1);
}

/// A second result of a task is compared with the first one, and not stored.
#[test]
fn a_result_that_comes_twice() {
    let mut system = System::sweep(DAMPER, &["--amplitudes", "0.007", "--stay"]);
    block_on(async {
        let (session, keys, manifest) = system.viewer().await;
        let tardy = Tardy::new(session, keys, &manifest).await;
        let grant = tardy.grant().await;
        let result = tardy.compute(&grant);
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
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let listen = format!("tcp/127.0.0.1:{port}");
    let serve = ["--listen", &listen];
    let mut system = System::sweep(DAMPER, &[SLOW, &serve].concat());
    let _worker = system.worker();
    system.wait_until("a result", |status| status.tasks.done > 0);
    system.wait_for_a_branch();
    system.coordinator.signal(Signal::KILL);
    system.coordinator.wait();
    let before = system.done();
    system.resume(&[&["--workers", "0", "--lease", "5"], &serve[..]].concat());
    system.expect_complete();
    assert_eq!(system.done()[..before.len()], before[..]);
    assert_eq!(system.attempts("ending = 'expired'"), 0, "the branch under way was not adopted");
    assert_eq!(system.attempts("1") - system.attempts("ending = 'done'"), 0, "something was computed twice");
}

/// Elastic: who joins late gets work.
#[test]
fn a_worker_that_joins_late() {
    let mut system = System::sweep(DAMPER, SLOW);
    let _first = system.worker();
    system.wait_for_a_branch();
    let _second = system.worker();
    system.expect_complete();
    assert_eq!(system.workers_with_results(), 2);
}

/// Drain: a worker told to end gives back what it has at once.
#[test]
fn a_worker_told_to_end() {
    let mut system = System::sweep(DAMPER, SLOW);
    let mut first = system.worker();
    system.wait_for_a_branch();
    let told = Instant::now();
    first.signal(Signal::TERM);
    assert!(first.wait().success(), "{}", first.output());
    assert!(told.elapsed() < Duration::from_secs(2));
    assert_eq!(system.attempts("ending = 'released'"), 1);
    let _second = system.worker();
    system.expect_complete();
}

/// A partition: the network between a worker and the coordinator stops for longer than a lease.
#[test]
fn a_network_that_stops() {
    let mut system = System::sweep(DAMPER, &[SLOW, &["--stay"]].concat());
    let proxy = Proxy::to(&system.address());
    let _cut_off = system.worker_at(&proxy.address);
    system.wait_for_a_branch();
    // Between two tasks there is no lease that could expire: then once more.
    let expires = |proxy: &Proxy| {
        system.wait_until("a task under way", |status| status.tasks.running > 0);
        proxy.frozen.store(true, Ordering::Relaxed);
        let is_leased = || system.number("SELECT count(*) FROM tasks WHERE state = 'leased'") > 0;
        let has_expired = || system.attempts("ending = 'expired'") >= 1;
        std::thread::sleep(Duration::from_millis(300));
        let expires = is_leased() && eventually(PATIENCE, has_expired) || has_expired();
        proxy.frozen.store(expires, Ordering::Relaxed);
        expires
    };
    assert!((0..5).any(|_| expires(&proxy)));
    let _second = system.worker();
    std::thread::sleep(Duration::from_millis(500));
    proxy.frozen.store(false, Ordering::Relaxed);
    system.wait_until_finished();
    system.coordinator.signal(Signal::INT);
    system.expect_complete();
}

/// A poison task ends on the dead list with its reasons; the rest finishes.
#[test]
fn a_task_that_always_fails() {
    let mut system = System::sweep(DAMPER, &["--amplitudes", "0.007,0.009"]);
    block_on(async {
        let (session, keys, manifest) = system.viewer().await;
        let poisoned = Tardy::new(session, keys, &manifest).await;
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

/// A worker that does what a test says.
struct Tardy {
    session: zenoh::Session,
    keys: Keys,
    settings: solver::settings::Settings,
    model: solver::model::Model,
    worker: WorkerId,
    /// Another one after every release: a thread is first offered the level that it worked on last.
    slot: Cell<u32>,
}

impl Tardy {
    async fn new(session: zenoh::Session, keys: Keys, manifest: &protocol::to_everyone::Manifest) -> Self {
        let model: protocol::model::ModelMessage =
            protocol::session::fetch(&session, &keys.model(), PATIENCE).await.unwrap();
        let (settings, worker) = (manifest.settings, WorkerId::new("tardy").unwrap());
        Self { session, keys, settings, model: model.model().unwrap(), worker, slot: Cell::new(0) }
    }

    async fn lease(&self) -> LeaseReply {
        let (protocol, program) = (protocol::VERSION, protocol::PROGRAM.to_string());
        let question = LeaseRequest { protocol, program, worker: self.worker.clone(), slot: self.slot.get() };
        request(&self.session, &self.keys.lease(), &question, PATIENCE).await.unwrap()
    }

    async fn grant(&self) -> Grant {
        loop {
            match self.lease().await {
                LeaseReply::Grant(grant) => return grant,
                LeaseReply::Wait { retry_ms } => tokio::time::sleep(Duration::from_millis(retry_ms)).await,
                other => panic!("{other:?}"),
            }
        }
    }

    /// Gives everything back until one task comes.
    async fn grant_of(&self, task: &str) -> Grant {
        loop {
            let grant = self.grant().await;
            if grant.task.as_str() == task {
                return grant;
            }
            let question = ReleaseRequest { lease: self.held(&grant) };
            let _: Acknowledgement = request(&self.session, &self.keys.release(), &question, PATIENCE).await.unwrap();
            self.slot.set(self.slot.get() + 1);
            tokio::time::sleep(Duration::from_millis(50)).await;
        }
    }

    fn held(&self, grant: &Grant) -> Lease {
        Lease { task: grant.task.clone(), attempt: grant.attempt, worker: self.worker.clone(), slot: self.slot.get() }
    }

    fn compute(&self, grant: &Grant) -> SubmitRequest {
        assert!(grant.known.is_empty(), "the first task of a level knows of no branch");
        let mut forced = solver::forced::Forced::new(&self.model, &self.settings, grant.reach, grant.amplitude);
        let observer = &mut |_: &_| std::ops::ControlFlow::Continue(());
        let finding = solver::task::carry_out(&mut forced, &grant.work, &[], &[], observer).unwrap();
        let (lease, program) = (self.held(grant), protocol::PROGRAM.to_string());
        SubmitRequest { lease, program, seconds: 0.1, finding: (&finding).into() }
    }

    async fn submit(&self, result: &SubmitRequest) -> SubmitReply {
        request(&self.session, &self.keys.submit(&result.lease.task), result, PATIENCE).await.unwrap()
    }

    async fn fail(&self, grant: &Grant, reason: &str) -> Acknowledgement {
        let question = FailRequest { lease: self.held(grant), reason: reason.into() };
        request(&self.session, &self.keys.fail(), &question, PATIENCE).await.unwrap()
    }
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
            std::thread::sleep(Duration::from_millis(10));
        }
        if count == 0 || to.write_all(&buffer[..count]).is_err() {
            break;
        }
    }
    let _ = to.shutdown(Shutdown::Both);
}
