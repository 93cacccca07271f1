//! A worker that does what a test says: it may keep what it holds, and with it the run open.

use protocol::from_worker::{FailRequest, Lease, LeaseRequest, ReleaseRequest, SubmitRequest};
use protocol::ids::WorkerId;
use protocol::keys::Keys;
use protocol::session::{fetch, request};
use protocol::to_worker::{Acknowledgement, Grant, LeaseReply, SubmitReply};
use std::cell::Cell;
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

    async fn lease(&self) -> LeaseReply {
        let (protocol, program) = (protocol::VERSION, protocol::PROGRAM.to_string());
        let question = LeaseRequest { protocol, program, worker: self.worker.clone(), slot: self.slot.get() };
        request(&self.session, &self.keys.lease(), &question, PATIENCE).await.unwrap()
    }

    /// The next task.
    pub async fn grant(&self) -> Grant {
        loop {
            match self.lease().await {
                LeaseReply::Grant(grant) => return grant,
                LeaseReply::Wait { retry_ms } => tokio::time::sleep(Duration::from_millis(retry_ms)).await,
                other => panic!("{other:?}"),
            }
        }
    }

    /// Gives everything back until one task comes.
    pub async fn grant_of(&self, task: &str) -> Grant {
        loop {
            let grant = self.grant().await;
            if grant.task.as_str() == task {
                return grant;
            }
            self.release(&grant).await;
            self.slot.set(self.slot.get() + 1);
        }
    }

    fn held(&self, grant: &Grant) -> Lease {
        Lease { task: grant.task.clone(), attempt: grant.attempt, worker: self.worker.clone(), slot: self.slot.get() }
    }

    /// Carries a task out.
    pub fn compute(&self, grant: &Grant) -> SubmitRequest {
        assert!(grant.known.is_empty(), "the first task of a level knows of no branch");
        let mut forced =
            solver::response::forced::Forced::new(&self.model, &self.settings, grant.reach, grant.amplitude);
        let observer = &mut |_: &_| std::ops::ControlFlow::Continue(());
        let finding = solver::response::trace::carry_out(
            &mut forced,
            &grant.work,
            &solver::response::trace::Given::default(),
            observer,
        )
        .unwrap();
        let (lease, program) = (self.held(grant), protocol::PROGRAM.to_string());
        SubmitRequest { lease, program, seconds: 0.1, finding: (&finding).into() }
    }

    pub async fn submit(&self, result: &SubmitRequest) -> SubmitReply {
        request(&self.session, &self.keys.submit(&result.lease.task), result, PATIENCE).await.unwrap()
    }

    pub async fn fail(&self, grant: &Grant, reason: &str) -> Acknowledgement {
        let question = FailRequest { lease: self.held(grant), reason: reason.into() };
        request(&self.session, &self.keys.fail(), &question, PATIENCE).await.unwrap()
    }

    pub async fn release(&self, grant: &Grant) -> Acknowledgement {
        let question = ReleaseRequest { lease: self.held(grant) };
        request(&self.session, &self.keys.release(), &question, PATIENCE).await.unwrap()
    }
}
