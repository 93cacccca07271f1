//! What the engine of a run puts on disk and gets back: the plan of a sweep, tasks, their states, and every change of them.

mod plan;
mod repeats;

pub use plan::{AddedTask, Extension, LevelPlan, MorePlan, OrderPlan, SweepPlan};
pub use repeats::{Evidence, Said};

use protocol::digest::Digest;
use protocol::ids::{Attempt, TaskId, WorkerId};
use protocol::to_everyone::{Stage, StoredResult};
use solver::response::task::{Brought, SeedOutcome, Task};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

/// Kinds of tasks, as [`kind`] names them.
pub const KINDS: [&str; 13] = [
    "main", "land", "seed", "fold", "crossing", "start", "begin", "scout", "verify", "disturb", "march", "carry",
    "switch",
];

/// What kind of task this is, in one word.
pub fn kind(task: &Task) -> &'static str {
    KINDS[place_of_kind(task)]
}

/// Where its kind stands in [`KINDS`].
pub fn place_of_kind(task: &Task) -> usize {
    match task {
        Task::Main(_) => 0,
        Task::Land(_) => 1,
        Task::Seed(_) => 2,
        Task::Fold(_) => 3,
        Task::Crossing(_) => 4,
        Task::Start(_) => 5,
        Task::Begin(_) => 6,
        Task::Scout(_) => 7,
        Task::Verify(_) => 8,
        Task::Disturb(_) => 9,
        Task::March(_) => 10,
        Task::Carry(_) => 11,
        Task::Switch(_) => 12,
    }
}

/// A computing thread of a worker.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Holder {
    /// Worker.
    pub worker: WorkerId,
    /// Thread, from 0.
    pub slot: u32,
}

/// State of a task.
#[derive(Debug, Clone, PartialEq)]
pub enum TaskState {
    /// To be handed out in its turn.
    Waiting,
    /// Handed out.
    Leased {
        /// To whom.
        holder: Holder,
        /// Until when, since an origin of the ledger's choice; not stored.
        deadline: Duration,
    },
    /// Result stored.
    Done(SeedOutcome),
    /// Not needed.
    Skipped,
    /// Given up.
    Dead,
}

/// A task as the store has it.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredTask {
    /// Task.
    pub id: TaskId,
    /// State; the deadline of a lease does not count.
    pub state: TaskState,
    /// What its result brought, if that is a new branch or a new curve.
    pub brought: Option<Brought>,
    /// To whom it was handed out so far: one an attempt, in their order.
    pub holders: Vec<Holder>,
    /// What has gone wrong with it, since it was last taken from the dead list.
    pub troubles: Troubles,
    /// How far what was said of it is to be believed.
    pub evidence: Evidence,
}

/// What has gone wrong with a task. A worker that is not heard of is the network's fault, a result that is refused the worker's,
/// and everything else the task's.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Troubles {
    /// Why attempts ended without a result, in words.
    pub reasons: Vec<String>,
    /// Attempts that failed.
    pub failures: u32,
    /// Workers whose results were refused.
    pub refused: BTreeSet<WorkerId>,
    /// Attempts without a sign of life in time.
    pub lapses: u32,
}

impl Troubles {
    /// Takes down how an attempt of a worker ended.
    pub fn note(&mut self, worker: &WorkerId, end: &AttemptEnd) {
        match end {
            AttemptEnd::Released | AttemptEnd::Superseded => return,
            AttemptEnd::Confirmed | AttemptEnd::Disputed(_) | AttemptEnd::Refuted(_) => return,
            AttemptEnd::Failed(_) => self.failures += 1,
            AttemptEnd::Refused(_) => drop(self.refused.insert(worker.clone())),
            AttemptEnd::Expired => self.lapses += 1,
        }
        let reason = end.reason().map_or_else(|| format!("{worker}: no sign of life"), str::to_string);
        self.reasons.push(reason);
    }

    /// The last attempt, of which there was no sign of life, goes on.
    pub fn forget_lapse(&mut self) {
        if self.lapses > 0 {
            self.lapses -= 1;
            self.reasons.pop();
        }
    }
}

/// A change that has to be on disk before whoever caused it is answered.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// The run is here now.
    Stage(Stage),
    /// There is a backbone, and what follows from it.
    Planned(Arc<SweepPlan>),
    /// What was found asks for more.
    Added(Vec<AddedTask>),
    /// Handed out.
    Granted {
        /// Task.
        task: TaskId,
        /// Which attempt at it.
        attempt: Attempt,
        /// To whom.
        holder: Holder,
    },
    /// A task that is done was handed out once more, to compare its result.
    Repeated {
        /// Task.
        task: TaskId,
        /// Which attempt at it.
        attempt: Attempt,
        /// To whom.
        holder: Holder,
    },
    /// An attempt ended without a result, or what became of one that has a result was judged again.
    Ended {
        /// Task.
        task: TaskId,
        /// Which attempt at it.
        attempt: Attempt,
        /// How.
        end: AttemptEnd,
    },
    /// What an attempt says of a task that others disagree on.
    Said {
        /// Task.
        task: TaskId,
        /// Which attempt at it.
        attempt: Attempt,
        /// What it says.
        said: Said,
    },
    /// What is stored of a task was refuted, or follows from that: it is to be done as if it never had been.
    Withdrawn {
        /// Task.
        task: TaskId,
    },
    /// An attempt of which there was no sign of life goes on.
    Adopted {
        /// Task.
        task: TaskId,
        /// Which attempt at it.
        attempt: Attempt,
    },
    /// An attempt begins with steps of those before it.
    HandedOn {
        /// Task.
        task: TaskId,
        /// Which attempt at it.
        attempt: Attempt,
        /// Steps.
        steps: usize,
    },
    /// A task under way has taken further steps.
    Checkpoint(CheckpointPart),
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
    /// The result of a task that is done.
    Result(AcceptedResult),
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

impl Change {
    /// The task whose steps are of no use from now on: it is settled, or they may be why its attempt has failed.
    pub fn ends_checkpoint(&self) -> Option<&TaskId> {
        match self {
            Self::Done { task, .. } | Self::Skipped { task } | Self::Dead { task } => Some(task),
            Self::Ended { task, end: AttemptEnd::Failed(_) | AttemptEnd::Refused(_), .. } => Some(task),
            _ => None,
        }
    }
}

/// Steps of a task under way, for whoever is handed it after this attempt.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CheckpointPart {
    /// Task.
    pub task: TaskId,
    /// Which attempt at it.
    pub attempt: Attempt,
    /// Number of the first step, from 0: with that, what was kept before is dropped.
    pub first: usize,
    /// Number of steps.
    pub steps: usize,
    /// The steps, as they are stored.
    pub payload: Vec<u8>,
}

/// What is kept of a task under way, in numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kept {
    /// Steps.
    pub steps: usize,
    /// Bytes.
    pub bytes: usize,
    /// The attempt that sent the last of them.
    pub attempt: Attempt,
}

/// A result as it is stored and announced.
#[derive(Debug, Clone, PartialEq)]
pub struct AcceptedResult {
    /// The result.
    pub result: Box<StoredResult>,
    /// Number of its announcement.
    pub sequence: u64,
    /// Size and SHA-256 of its encoding.
    pub digest: Digest,
}

/// How an attempt ended without a result, or with one that is not stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AttemptEnd {
    /// No sign of life in time.
    Expired,
    /// The worker says that it cannot.
    Failed(String),
    /// The worker's result cannot be true.
    Refused(String),
    /// The worker gave it back.
    Released,
    /// Somebody else's result came first.
    Superseded,
    /// It repeated a task that was done, and came to the same.
    Confirmed,
    /// It repeated a task that was done, and came to something else.
    Disputed(String),
    /// Its result is not what two others come to.
    Refuted(String),
}

impl AttemptEnd {
    /// One word for the store.
    pub fn name(&self) -> &'static str {
        match self {
            AttemptEnd::Expired => "expired",
            AttemptEnd::Failed(_) => "failed",
            AttemptEnd::Refused(_) => "refused",
            AttemptEnd::Released => "released",
            AttemptEnd::Superseded => "superseded",
            AttemptEnd::Confirmed => "confirmed",
            AttemptEnd::Disputed(_) => "disputed",
            AttemptEnd::Refuted(_) => "refuted",
        }
    }

    /// Why, if there is a reason to tell.
    pub fn reason(&self) -> Option<&str> {
        match self {
            AttemptEnd::Failed(reason)
            | AttemptEnd::Refused(reason)
            | AttemptEnd::Disputed(reason)
            | AttemptEnd::Refuted(reason) => Some(reason),
            _ => None,
        }
    }

    /// The end of this name; `None` if an attempt with that has a result.
    pub fn named(name: &str, reason: Option<String>) -> Option<Self> {
        match name {
            "expired" => Some(Self::Expired),
            "failed" => Some(Self::Failed(reason.unwrap_or_default())),
            "refused" => Some(Self::Refused(reason.unwrap_or_default())),
            "released" => Some(Self::Released),
            "superseded" => Some(Self::Superseded),
            "confirmed" => Some(Self::Confirmed),
            "disputed" => Some(Self::Disputed(reason.unwrap_or_default())),
            "refuted" => Some(Self::Refuted(reason.unwrap_or_default())),
            _ => None,
        }
    }
}
