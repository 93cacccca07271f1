//! What the engine is asked and what it tells.

use crate::ledger::{LevelPlan, StoredTask};
use protocol::control::{ControlReply, ControlRequest};
use protocol::from_worker::{FailRequest, LeaseRequest, Progress, ReleaseRequest, RenewRequest, SubmitRequest};
use protocol::ids::{TaskId, WorkerId};
use protocol::to_everyone::{Done, Manifest, SeedMessage, Status};
use protocol::to_worker::{Acknowledgement, LeaseReply, RenewReply, SubmitReply};
use solver::backbone::Backbone;
use solver::forced::Reach;

/// Sends an answer on its way.
pub type Responder<R> = Box<dyn FnOnce(R) + Send>;

/// Something to decide.
pub enum Job {
    /// A worker asks for work.
    Lease(LeaseRequest, Responder<LeaseReply>),
    /// A worker is alive.
    Renew(RenewRequest, Responder<RenewReply>),
    /// A result.
    Submit(Box<SubmitRequest>, Responder<SubmitReply>),
    /// A task that cannot be carried out.
    Fail(FailRequest, Responder<Acknowledgement>),
    /// A task given back.
    Release(ReleaseRequest, Responder<Acknowledgement>),
    /// Somebody wants something.
    Control(ControlRequest, Responder<ControlReply>),
    /// A worker vanished from the bus.
    WorkerGone(WorkerId),
    /// Where the branch of a task is.
    Progress(TaskId, Progress),
    /// Where the backbone is.
    Backbone(Progress),
    /// Backbone and windows are there: the sweep begins.
    Ready(Box<Ready>),
    /// Hand out nothing any more: the process ends.
    Stop,
}

/// What the sweep needs beside the model.
pub struct Ready {
    /// Backbone.
    pub backbone: Backbone,
    /// Within which frequencies and amplitudes branches are followed.
    pub reach: Reach,
    /// Tasks of every level.
    pub plans: Vec<LevelPlan>,
    /// What has become of them already.
    pub tasks: Vec<StoredTask>,
    /// Whether the store does not have them yet.
    pub fresh: bool,
}

/// Something to tell everybody.
pub enum News {
    /// The run has changed.
    Manifest(Manifest),
    /// A task was handed out.
    Seed(SeedMessage),
    /// A result was stored.
    Done(Done),
    /// How the run is doing.
    Status(Status),
    /// Workers should ask how things are.
    Hint,
}
