//! What workers ask: queries with a payload, each answered by the coordinator (see [`crate::to_worker`]).

use crate::branch::TaskResultMessage;
use crate::codec::{CodecError, decode_part, messages};
use crate::ids::{Attempt, TaskId, WorkerId};
use crate::orbits::OrbitsMessage;
use crate::steps::Steps;
use serde::{Deserialize, Serialize};

/// Slots of a computing thread, which take turns: while the result of one is on its way, another one computes.
pub const LANES: u32 = 4;

/// The computing thread of a slot.
pub fn thread_of(slot: u32) -> u32 {
    slot / LANES
}

/// Asks for work, on `rpc/lease`. Asking again with the same worker and slot gives the same grant again.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeaseRequest {
    /// Version of the messages.
    pub protocol: u32,
    /// Version of the program.
    pub program: String,
    /// Who asks.
    pub worker: WorkerId,
    /// Which of its slots, from 0: [`LANES`] for each computing thread.
    pub slot: u32,
}

/// A task under way, named by who computes it.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Lease {
    /// Task.
    pub task: TaskId,
    /// Which attempt at it.
    pub attempt: Attempt,
    /// Who.
    pub worker: WorkerId,
    /// Which of its slots.
    pub slot: u32,
}

/// Sign of life, on `rpc/renew`, three times a lease.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RenewRequest {
    /// Which task.
    pub lease: Lease,
    /// Where the branch is; `None` while a seed lands.
    pub progress: Option<Progress>,
}

/// Where a branch under way is. Also put on `progress/<task>`, at most twice a second.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Points so far.
    pub points: usize,
    /// ω, rad/s.
    pub omega: f64,
    /// Amplitude of the first monitored dof, m.
    pub amplitude: f64,
}

/// Result, on `rpc/submit/<task>`. Sent again until it is answered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SubmitRequest {
    /// Which task.
    pub lease: Lease,
    /// Version of the program that computed it.
    pub program: String,
    /// Computing time, s.
    pub seconds: f64,
    /// Whether the thread takes its next task with the acknowledgement.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub next: bool,
    /// Of a verification the orbits that it was told of, if there are any: for whoever checks it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orbits: Option<OrbitsMessage>,
    /// What was found; not converging is a finding.
    pub finding: TaskResultMessage,
}

impl SubmitRequest {
    /// Whose result is in `bytes` that came with `encoding`, without reading the rest.
    ///
    /// # Errors
    /// If they are no result.
    pub fn lease_in(bytes: &[u8], encoding: &str) -> Result<Lease, CodecError> {
        #[derive(Deserialize)]
        struct Head {
            lease: Lease,
        }
        decode_part::<Self, Head>(bytes, encoding).map(|head| head.lease)
    }
}

/// New steps of a task under way, on `rpc/checkpoint/<task>`: whoever is handed the task after this worker goes on from them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CheckpointRequest {
    /// Which task.
    pub lease: Lease,
    /// The steps.
    pub steps: Steps,
}

/// A task that could not be carried out (a panic, memory, an unusable model), on `rpc/fail`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FailRequest {
    /// Which task.
    pub lease: Lease,
    /// Why.
    pub reason: String,
}

/// A task given back unfinished, on `rpc/release`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReleaseRequest {
    /// Which task.
    pub lease: Lease,
}

messages! {
    LeaseRequest => "lease_request",
    RenewRequest => "renew_request",
    Progress => "progress",
    SubmitRequest => "submit_request",
    CheckpointRequest => "checkpoint_request",
    FailRequest => "fail_request",
    ReleaseRequest => "release_request",
}
