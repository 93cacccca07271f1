//! What the engine is told and asked.

use super::checked_result::CheckedResult;
use protocol::control::ControlRequest;
use protocol::from_worker::{FailRequest, Lease, LeaseRequest, Progress, ReleaseRequest, RenewRequest};
use protocol::ids::{TaskId, WorkerId};
use results::journal::{CheckpointPart, Kept, StoredTask, SweepPlan};
use results::store::Extent;
use std::collections::HashMap;
use std::sync::Arc;

/// Something to decide.
#[derive(Debug)]
pub enum Event {
    /// A worker asks for work.
    Lease(LeaseRequest),
    /// A worker is alive.
    Renew(RenewRequest),
    /// Steps of a task under way, and whose.
    Checkpoint(Lease, CheckpointPart),
    /// A result under this lease has come, and is not looked at yet.
    Offer(Lease),
    /// A result that cannot be true: why.
    Refused(Lease, String),
    /// A result.
    Submit(Box<CheckedResult>),
    /// A task that cannot be carried out.
    Fail(FailRequest),
    /// A task given back.
    Release(ReleaseRequest),
    /// Somebody wants something.
    Control(ControlRequest),
    /// A worker vanished from the bus.
    WorkerGone(WorkerId),
    /// Where the branch of a task is.
    Progress(TaskId, Progress),
    /// Where the backbone is.
    Backbone(Progress),
    /// Backbone and windows are there: the sweep begins.
    Begin(Box<Beginning>),
    /// This process did not run for a while, or had no connection: nobody is to blame for not having been heard of.
    Stalled,
    /// Time has passed.
    Tick,
    /// Hand out nothing any more: the process ends.
    Stop,
}

/// What a sweep begins with.
#[derive(Debug)]
pub struct Beginning {
    /// Backbone, reach and tasks of every level.
    pub plan: Arc<SweepPlan>,
    /// What the store has of the sweep; `None`: nothing, the plan neither.
    pub stored: Option<Stored>,
}

/// A sweep that was interrupted.
#[derive(Debug, Default)]
pub struct Stored {
    /// What has become of the tasks: those done in the order of their announcements, then the others.
    pub tasks: Vec<StoredTask>,
    /// The branches found, in numbers, by task.
    pub extents: HashMap<TaskId, Extent>,
    /// What is kept of tasks under way.
    pub kept: HashMap<TaskId, Kept>,
}
