//! What the engine decides.

use super::checked_result::Expected;
use crate::ledger::{Granted, Load};
use protocol::control::ControlReply;
use protocol::ids::{TaskId, WorkerId};
use protocol::to_everyone::{Done, Manifest, Status};
use protocol::to_worker::{Acknowledgement, CheckpointReply, RenewReply, SubmitReply};
use results::journal::Change;
use std::time::Duration;

/// What follows from an event.
#[derive(Debug, Default, PartialEq)]
pub struct Decision {
    /// What has to be on disk before the answer is given and the news are told.
    pub changes: Vec<Change>,
    /// The answer to whoever asked; without one they ask again.
    pub answer: Option<Answer>,
    /// What everybody should hear of.
    pub news: Vec<News>,
}

/// An answer to whoever caused an event.
#[derive(Debug, PartialEq)]
pub enum Answer {
    /// This task, with seeds that whoever hands on the answer makes.
    Grant(Granted),
    /// No task now; after so long there may be one.
    Wait(Duration),
    /// No task any more.
    Drained,
    /// No task for this worker, ever, and why.
    Stop(String),
    /// To a sign of life.
    Renew(RenewReply),
    /// To the question what a result has to be of.
    Offer(Offer),
    /// To steps of a task under way.
    Checkpoint(CheckpointReply),
    /// To a result.
    Submit(SubmitReply),
    /// To a result that is accepted: the next task, as that of a request for one.
    Next(Granted),
    /// To a failure or a release.
    Acknowledge(Acknowledgement),
    /// To an order.
    Control(ControlReply),
}

/// What becomes of a result before it is looked at.
#[derive(Debug, Clone, PartialEq)]
pub enum Offer {
    /// It is to be checked, as one of this.
    Check(Expected),
    /// It is refused: why.
    Refuse(String),
}

/// Something to tell everybody.
#[derive(Debug, PartialEq)]
pub enum News {
    /// The run has changed.
    Manifest(Box<Manifest>),
    /// A result that was stored, encoded: for whoever asks for it, not for the bus.
    Result(TaskId, Vec<u8>),
    /// A result was stored.
    Done(Done),
    /// A result was taken back.
    Withdrawn(TaskId),
    /// How the run is doing.
    Status(Status),
    /// How busy everybody is: not for the bus.
    Load(Box<Load>),
    /// Workers should ask how things are.
    Hint,
    /// There is work for a computing thread of this worker.
    Wake(WorkerId),
}

impl Decision {
    /// An answer that follows from changes.
    pub(super) fn new(answer: Answer, changes: Vec<Change>) -> Self {
        Self { changes, answer: Some(answer), news: Vec::new() }
    }
}

impl Answer {
    /// Whether it tells of nothing that has to be on disk.
    pub(super) fn is_immediate(&self) -> bool {
        matches!(self, Self::Renew(_) | Self::Offer(_))
    }
}
