//! What comes of a request for work and of a result.

use protocol::ids::{Attempt, TaskId};
use protocol::to_everyone::Amplitude;
use protocol::to_worker::{Known, KnownCurve};
use solver::response::task::{SeedOutcome, Task};
use std::time::Duration;

/// Answer to a request for work.
#[derive(Debug, Clone, PartialEq)]
pub enum Leased {
    /// This task.
    Grant(Granted),
    /// Nothing now.
    Wait,
    /// Nothing any more.
    Drained,
    /// The run was cancelled.
    Stop,
    /// Nothing any more for this worker, since its results were refused: why.
    Unwelcome(Vec<String>),
}

/// A task handed out.
#[derive(Debug, Clone, PartialEq)]
pub struct Granted {
    /// Task.
    pub task: TaskId,
    /// Which attempt at it.
    pub attempt: Attempt,
    /// Forcing amplitude.
    pub amplitude: Amplitude,
    /// What is to be done.
    pub work: Task,
    /// Of a seed: the task that landed it.
    pub landing: Option<TaskId>,
    /// Branches of the level found before; of a fold, the branch that it is of.
    pub known: Vec<Known>,
    /// Curves found before: those that a fold may lie on, or the one that crosses the level.
    pub curves: Vec<KnownCurve>,
    /// Steps kept of earlier attempts.
    pub checkpoint: usize,
}

/// What a result has to be of, as far as the ledger knows.
#[derive(Debug, Clone, PartialEq)]
pub enum Offered {
    /// A result of this.
    Expected {
        /// Forcing amplitude.
        amplitude: f64,
        /// Order of the motions, if it is not the first one.
        order: Option<usize>,
        /// What was to be done.
        work: Task,
        /// Of a verification: the task that found the branch.
        branch: Option<TaskId>,
    },
    /// Nobody was given this task under this number.
    NeverGranted,
    /// No such task in this run.
    Unknown,
}

/// Answer to a result.
#[derive(Debug, Clone, PartialEq)]
pub enum Submitted {
    /// First result of its task.
    Accepted(Accepted),
    /// There is one already.
    Duplicate,
    /// There is one already, and this was to be a second one.
    Repeated {
        /// Whether it came to the same.
        agrees: bool,
        /// When it was handed out.
        granted_at: Duration,
    },
    /// The task was given up and its level went on: its branch may have been found by another one.
    Late,
    /// Not what such a task brings.
    Foreign,
    /// Nobody was given this task under this number.
    NeverGranted,
    /// No such task in this run.
    Unknown,
}

/// A result to be stored.
#[derive(Debug, Clone, PartialEq)]
pub struct Accepted {
    /// What became of the task, with a new branch named.
    pub outcome: SeedOutcome,
    /// Number of the announcement.
    pub sequence: u64,
    /// Forcing amplitude.
    pub amplitude: Amplitude,
    /// What was to be done.
    pub work: Task,
}
