//! What has to be on disk before an answer is given.

use protocol::ids::{Attempt, TaskId, WorkerId};
use solver::task::SeedOutcome;

/// A change of a task.
#[derive(Debug, Clone, PartialEq)]
pub enum Record {
    /// Handed out.
    Granted {
        /// Task.
        task: TaskId,
        /// Which attempt at it.
        attempt: Attempt,
        /// To whom.
        worker: WorkerId,
        /// To which of its computing threads.
        slot: u32,
    },
    /// An attempt ended without a result.
    Ended {
        /// Task.
        task: TaskId,
        /// Which attempt at it.
        attempt: Attempt,
        /// How.
        end: AttemptEnd,
    },
    /// A result was accepted.
    Done {
        /// Task.
        task: TaskId,
        /// Which attempt at it.
        attempt: Attempt,
        /// What became of it.
        outcome: SeedOutcome,
        /// Number of the announcement.
        sequence: u64,
    },
    /// Not needed.
    Skipped {
        /// Task.
        task: TaskId,
    },
    /// Given up.
    Dead {
        /// Task.
        task: TaskId,
    },
    /// Taken from the dead list.
    Revived {
        /// Task.
        task: TaskId,
    },
}

/// How an attempt ended without a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AttemptEnd {
    /// No sign of life in time.
    Expired,
    /// The worker says that it cannot.
    Failed(String),
    /// The worker gave it back.
    Released,
    /// Somebody else's result came first.
    Superseded,
}

impl AttemptEnd {
    /// One word for the store.
    pub fn name(&self) -> &'static str {
        match self {
            AttemptEnd::Expired => "expired",
            AttemptEnd::Failed(_) => "failed",
            AttemptEnd::Released => "released",
            AttemptEnd::Superseded => "superseded",
        }
    }

    /// Why, if there is a reason to tell.
    pub fn reason(&self) -> Option<&str> {
        match self {
            AttemptEnd::Failed(reason) => Some(reason),
            _ => None,
        }
    }
}
