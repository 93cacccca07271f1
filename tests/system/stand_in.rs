//! A worker that does what a test says: it may keep what it holds, and with it the run open.

use protocol::branch::TaskResultMessage;
use protocol::curve::Size;
use protocol::from_worker::{FailRequest, Lease, LeaseRequest, ReleaseRequest, RenewRequest, SubmitRequest};
use protocol::ids::{TaskId, WorkerId};
use protocol::keys::Keys;
use protocol::orbits::OrbitsMessage;
use protocol::session::{fetch, request};
use protocol::to_everyone::StoredResult;
use protocol::to_worker::{Acknowledgement, Grant, Known, LeaseReply, RenewReply, SubmitReply};
use solver::response::branch::Branch;
use solver::response::forced::Forced;
use solver::response::forcing::Unreached;
use solver::response::seeds::LandingFailure;
use solver::response::task::{BranchId, SeedOutcome, Task};
use solver::response::trace::{Given, execute};
use solver::stability::verification::verify_with_orbits;
use std::cell::Cell;
use std::ops::ControlFlow;
use std::time::Duration;
use tests::{PATIENCE, System};

/// A worker that does what a test says. Gives no sign of life by itself.
pub struct StandIn {
    session: zenoh::Session,
    keys: Keys,
    settings: solver::settings::Settings,
    model: solver::structure::Model,
    worker: WorkerId,
    /// Another one after every release: a thread is first offered the level that it worked on last.
    slot: Cell<u32>,
}

impl StandIn {
    pub async fn of(system: &System) -> Self {
        let (session, keys, manifest) = system.viewer().await;
        let model: protocol::model::ModelMessage = fetch(&session, &keys.model(), PATIENCE).await.unwrap();
        let (settings, worker) = (manifest.settings, WorkerId::new("stand-in").unwrap());
        Self { session, keys, settings, model: model.model().unwrap(), worker, slot: Cell::new(0) }
    }

    pub async fn lease(&self) -> LeaseReply {
        self.lease_for(&self.worker).await
    }

    async fn lease_for(&self, worker: &WorkerId) -> LeaseReply {
        let (protocol, program) = (protocol::VERSION, protocol::PROGRAM.to_string());
        let question = LeaseRequest { protocol, program, worker: worker.clone(), slot: self.slot.get() };
        request(&self.session, &self.keys.lease(), &question, PATIENCE).await.unwrap()
    }

    /// The next task.
    pub async fn grant(&self) -> Grant {
        self.grant_for(&self.worker).await
    }

    async fn grant_for(&self, worker: &WorkerId) -> Grant {
        loop {
            match self.lease_for(worker).await {
                LeaseReply::Grant(grant) => return grant,
                LeaseReply::Wait { retry_ms } => tokio::time::sleep(Duration::from_millis(retry_ms)).await,
                other => panic!("{other:?}"),
            }
        }
    }

    /// Gives everything back until one task comes.
    pub async fn grant_of(&self, task: &str) -> Grant {
        self.grant_of_for(task, &self.worker).await
    }

    /// The same in the name of another worker.
    pub async fn grant_of_for(&self, task: &str, worker: &WorkerId) -> Grant {
        loop {
            let grant = self.grant_for(worker).await;
            if grant.task.as_str() == task {
                return grant;
            }
            let lease = Lease { worker: worker.clone(), ..self.held(&grant) };
            self.release_lease(lease).await;
            self.move_on();
        }
    }

    /// Is another one of its threads from now on.
    pub fn move_on(&self) {
        self.slot.set(self.slot.get() + 1);
    }

    /// Which of its threads it is now.
    pub fn slot(&self) -> u32 {
        self.slot.get()
    }

    fn held(&self, grant: &Grant) -> Lease {
        Lease { task: grant.task.clone(), attempt: grant.attempt, worker: self.worker.clone(), slot: self.slot.get() }
    }

    /// A sign of life.
    pub async fn renew(&self, lease: &Lease) -> RenewReply {
        let question = RenewRequest { lease: lease.clone(), progress: None };
        request(&self.session, &self.keys.renew(), &question, PATIENCE).await.unwrap()
    }

    /// Carries a task out that is given no more than branches of its level.
    pub async fn compute(&self, grant: &Grant) -> SubmitRequest {
        let mut known = Vec::new();
        for Known { branch, task } in &grant.known {
            known.push((*branch, self.branch(task).await));
        }
        let known: Vec<(BranchId, &Branch)> = known.iter().map(|(id, branch)| (*id, branch)).collect();
        let given = Given { known: &known, ..Given::default() };
        let mut forced = Forced::new(&self.model, &self.settings, grant.reach, grant.amplitude);
        let finding = execute(&mut forced, &grant.work, &given, &mut |_| ControlFlow::Continue(())).unwrap();
        let (lease, program) = (self.held(grant), protocol::PROGRAM.to_string());
        SubmitRequest { lease, program, seconds: 0.1, next: false, orbits: None, finding: (&finding).into() }
    }

    /// A branch that is stored.
    async fn branch(&self, task: &TaskId) -> Branch {
        let found: StoredResult = fetch(&self.session, &self.keys.result(task), PATIENCE).await.unwrap();
        found.branch.unwrap().branch(&Size::of(&self.model)).unwrap()
    }

    /// Verifies a branch.
    pub async fn verify(&self, grant: &Grant) -> SubmitRequest {
        let Task::Verify(place) = grant.work else { panic!("{:?}", grant.work) };
        let branch = self.branch(&grant.known[0].task).await;
        let observer = &mut |_: &_| ControlFlow::Continue(());
        let (found, orbits) = verify_with_orbits(&self.model, &branch, place.stretch, observer).unwrap();
        let (lease, program) = (self.held(grant), protocol::PROGRAM.to_string());
        let (orbits, finding) = (OrbitsMessage::new(&orbits), TaskResultMessage::Verification(found));
        SubmitRequest { lease, program, seconds: 0.1, next: false, orbits, finding }
    }

    /// Says that nothing is there.
    pub async fn deny(&self, grant: &Grant) -> SubmitReply {
        let outcome = match grant.work {
            Task::Scout(_) => SeedOutcome::NoFold,
            _ => SeedOutcome::NotLanded(LandingFailure::NotConverged(Unreached::OutOfReach)),
        };
        let (lease, program) = (self.held(grant), protocol::PROGRAM.to_string());
        let finding = TaskResultMessage::Nothing(outcome);
        self.submit(&SubmitRequest { lease, program, seconds: 0.1, next: false, orbits: None, finding }).await
    }

    pub async fn submit(&self, result: &SubmitRequest) -> SubmitReply {
        request(&self.session, &self.keys.submit(&result.lease.task), result, PATIENCE).await.unwrap()
    }

    pub async fn fail(&self, grant: &Grant, reason: &str) -> Acknowledgement {
        let question = FailRequest { lease: self.held(grant), reason: reason.into() };
        request(&self.session, &self.keys.fail(), &question, PATIENCE).await.unwrap()
    }

    pub async fn release(&self, grant: &Grant) -> Acknowledgement {
        self.release_lease(self.held(grant)).await
    }

    async fn release_lease(&self, lease: Lease) -> Acknowledgement {
        let question = ReleaseRequest { lease };
        request(&self.session, &self.keys.release(), &question, PATIENCE).await.unwrap()
    }
}
