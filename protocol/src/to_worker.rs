//! What the coordinator answers to workers.

use crate::PROGRAM;
use crate::codec::{encode_part, messages, sha256};
use crate::curve::Seeds;
use crate::ids::{Attempt, TaskId};
use crate::steps::Steps;
use serde::{Deserialize, Serialize};
use solver::response::forced::SearchRange;
use solver::response::task::{BranchId, Task};

/// Answer to a request for work.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[expect(clippy::large_enum_variant, reason = "one of them exists at a time")]
pub enum LeaseReply {
    /// Work.
    Grant(Grant),
    /// Everything is handed out, or not ready yet: ask again.
    Wait {
        /// After so many ms.
        retry_ms: u64,
    },
    /// All work is done.
    Drained,
    /// No work for this worker, ever.
    Stop {
        /// Why.
        reason: String,
    },
}

/// A task handed out for a time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Grant {
    /// Task.
    pub task: TaskId,
    /// Which attempt at it.
    pub attempt: Attempt,
    /// Without a sign of life for so many ms the task is handed out again.
    pub ttl_ms: u64,
    /// Forcing amplitude A.
    pub amplitude: f64,
    /// Order of the motions, if it is not the study's first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<usize>,
    /// Within which frequencies and amplitudes branches are followed.
    pub reach: SearchRange,
    /// What is to be done.
    pub work: Task,
    /// Seeds to start from, as published on `seed/<task>`.
    pub seeds: Seeds,
    /// Of a seed: the task whose stored result has what it landed on.
    pub landing: Option<TaskId>,
    /// Branches of this level found before: the stored results to fetch from `result/<task>`. Of a fold: the branch that it
    /// is of.
    pub known: Vec<Known>,
    /// Curves found before, in stored results as well: those that a fold or response may lie on, or the one that crosses the level.
    pub curves: Vec<KnownCurve>,
    /// Steps that earlier attempts took, on `checkpoint/<task>`; 0 if there are none.
    pub checkpoint: usize,
}

impl Grant {
    /// SHA-256 of everything that the steps of the task depend on beside the run's model and settings.
    pub fn fingerprint(&self) -> String {
        let Self { amplitude, order, reach, work, seeds, landing, known, curves, .. } = self;
        sha256(&encode_part(&(PROGRAM, amplitude, order, reach, work, seeds, landing, known, curves)))
    }
}

/// Steps that earlier attempts at a task took, on `checkpoint/<task>?first=<number>`: in the order in which they came, from a part that
/// begins with this number on, as many as one answer holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// The task.
    pub task: TaskId,
    /// The steps.
    pub parts: Vec<Steps>,
}

/// Answer to new steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CheckpointReply {
    /// They are kept.
    Kept,
    /// No room for them now: to be sent again later.
    Busy,
    /// They do not follow those that are kept, or there would be too many: to send more of them will not help.
    Enough,
    /// The task is done or somebody else's.
    Lost,
}

/// A branch found before.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Known {
    /// Its name in the level.
    pub branch: BranchId,
    /// The task that found it.
    pub task: TaskId,
}

/// A curve over the forcing amplitude found before.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct KnownCurve {
    /// Its number, from 0.
    pub number: usize,
    /// The task that found it.
    pub task: TaskId,
}

/// Answer to a sign of life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RenewReply {
    /// Go on.
    Ok,
    /// The task is done or somebody else's: stop computing it.
    Lost,
    /// The run was cancelled or stops: stop computing and give the task back.
    Cancel,
}

/// Answer to a result, given once it is on disk.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SubmitReply {
    /// Stored.
    Accepted,
    /// Stored, and the thread's next task: only if it was asked for.
    Next(Box<Grant>),
    /// Another result of this task was stored before.
    Duplicate {
        /// Whether range and peak agree to 1e-6.
        agrees: bool,
    },
    /// No room for it now: to be sent again.
    Busy {
        /// After so many ms.
        retry_ms: u64,
    },
    /// Not stored, and sending it again will not help.
    Rejected {
        /// Why.
        why: String,
    },
}

/// Answer to a failure or a release.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Acknowledgement {
    /// Noted.
    Ok,
    /// It was not this worker's any more.
    Lost,
}

messages! {
    LeaseReply => "lease_reply",
    RenewReply => "renew_reply",
    SubmitReply => "submit_reply",
    Acknowledgement => "acknowledgement",
    Checkpoint => "checkpoint",
    CheckpointReply => "checkpoint_reply",
}
