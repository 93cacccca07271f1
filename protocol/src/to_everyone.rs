//! What anyone may ask for or listen to: manifest, windows, seeds, announcements, results, status.

use crate::branch::{BranchMessage, TaskResultMessage};
use crate::codec::messages;
use crate::critical::CriticalMessage;
use crate::curve::Seeds;
use crate::from_worker::Progress;
use crate::ids::{Attempt, RunId, TaskId, WorkerId};
use crate::landings::LandingsMessage;
use crate::level;
use serde::{Deserialize, Serialize};
use solver::response::forced::SearchRange;
use solver::response::modes::ModesFollowed;
use solver::response::task::{BranchId, SeedOutcome, Task};
use solver::response::windows::Window;
use solver::settings::Settings;
use solver::stability::disturbance::Disturbance;
use solver::stability::settling::Settling;
use solver::stability::verification::Verification;

/// A forcing amplitude.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Amplitude {
    /// As typed: names files and tasks. Of motions of a further order it says that too: [`crate::level`].
    pub text: String,
    /// A.
    pub value: f64,
}

impl Amplitude {
    /// The same amplitude, for motions of a further order.
    pub fn of_order(&self, order: usize) -> Self {
        Self { text: level::of_order(&self.text, order), value: self.value }
    }

    /// The order of the motions, if it is not the study's first.
    pub fn order(&self) -> Option<usize> {
        level::order(&self.text)
    }
}

/// What a run is, on `run`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of the messages.
    pub protocol: u32,
    /// Version of the program.
    pub program: String,
    /// Run.
    pub run: RunId,
    /// Name of the study.
    pub name: String,
    /// SHA-256 of the `model` message.
    pub model_sha256: String,
    /// Numerics.
    pub settings: Settings,
    /// Within which frequencies and amplitudes branches are followed; known when the backbone is.
    pub reach: Option<SearchRange>,
    /// Which modes have a backbone, the primary one first, and why others have none; known when the backbones are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modes: Option<ModesFollowed>,
    /// Forcing levels.
    pub amplitudes: Vec<Amplitude>,
    /// Names of the monitored dofs; the first one is plotted.
    pub monitors: Vec<String>,
    /// Where the run is.
    pub stage: Stage,
    /// Time without a sign of life after which a task is handed out again, ms.
    pub lease_ms: u64,
    /// Largest result accepted, bytes.
    pub max_result_bytes: usize,
    /// Units in which the run is shown, as in the study, if any are chosen there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<String>,
}

impl Manifest {
    /// Most bytes of steps that are kept of a task. Beside a state a step has its tangent: it takes twice as many as a point of a
    /// result.
    pub fn max_checkpoint_bytes(&self) -> usize {
        self.max_result_bytes.saturating_mul(2)
    }
}

/// Where a run is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Computing the backbone.
    Backbone,
    /// Handing out tasks.
    Sweep,
    /// Every task is done, superfluous or dead.
    Finished,
    /// Cancelled.
    Cancelled,
}

impl Stage {
    /// Whether nothing more will come.
    pub fn is_over(self) -> bool {
        matches!(self, Self::Finished | Self::Cancelled)
    }

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Backbone => "computing the backbone",
            Stage::Sweep => "running",
            Stage::Finished => "finished",
            Stage::Cancelled => "cancelled",
        }
    }
}

/// The windows of a level, on `windows`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LevelWindows {
    /// Forcing amplitude.
    pub amplitude: Amplitude,
    /// Windows, backbone by backbone and in the order of each.
    pub windows: Vec<Window>,
}

/// The windows of all levels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WindowsMessage {
    /// One entry a level.
    pub levels: Vec<LevelWindows>,
}

/// The seeds of a task, on `seed/<task>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SeedMessage {
    /// Task.
    pub task: TaskId,
    /// Forcing amplitude.
    pub amplitude: Amplitude,
    /// What is to be done.
    pub work: Task,
    /// Where from.
    pub seeds: Seeds,
}

/// Announces a stored result, on `done/<task>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Done {
    /// Counts the announcements of a run, from 1: whoever misses a number asks for `done/*`.
    pub sequence: u64,
    /// Task.
    pub task: TaskId,
    /// Forcing amplitude.
    pub amplitude: Amplitude,
    /// What became of it.
    pub outcome: SeedOutcome,
    /// The new branch, if it found one.
    pub branch: Option<BranchId>,
    /// Size of the stored result, bytes.
    pub size: u64,
    /// SHA-256 of the stored result.
    pub sha256: String,
}

/// A stored result, on `result/<task>`. The branch comes first: see [`crate::digest`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoredResult {
    /// The new branch.
    pub branch: Option<BranchMessage>,
    /// The new curve over the forcing amplitude.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<CriticalMessage>,
    /// What seeds landed on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub landings: Option<LandingsMessage>,
    /// What marching says of a branch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verification: Option<Verification>,
    /// Where pushes end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disturbance: Option<Disturbance>,
    /// What an unstable motion turns into.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settling: Option<Settling>,
    /// Task.
    pub task: TaskId,
    /// Attempt that was accepted.
    pub attempt: Attempt,
    /// Forcing amplitude.
    pub amplitude: Amplitude,
    /// What was to be done.
    pub work: Task,
    /// What became of it.
    pub outcome: SeedOutcome,
    /// Name of the branch, if it found a new one.
    pub name: Option<BranchId>,
    /// Who computed it.
    pub worker: WorkerId,
    /// With which version of the program.
    pub program: String,
    /// Computing time, s.
    pub seconds: f64,
}

impl StoredResult {
    /// Whether it has nothing but a branch, or not even that.
    pub fn is_plain(&self) -> bool {
        let is_marched = self.verification.is_some() || self.disturbance.is_some() || self.settling.is_some();
        self.curve.is_none() && self.landings.is_none() && !is_marched
    }

    /// The same with what was found.
    pub fn with(self, found: TaskResultMessage) -> Self {
        match found {
            TaskResultMessage::Landings(found) => Self { landings: Some(found), ..self },
            TaskResultMessage::Branch(found) => Self { branch: Some(found), ..self },
            TaskResultMessage::Curve(found) => Self { curve: Some(found), ..self },
            TaskResultMessage::Verification(found) => Self { verification: Some(found), ..self },
            TaskResultMessage::Disturbance(found) => Self { disturbance: Some(found), ..self },
            TaskResultMessage::Settling(found) => Self { settling: Some(found), ..self },
            TaskResultMessage::Nothing(_) => self,
        }
    }
}

/// How a run is doing, on `status` every second.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// Run.
    pub run: RunId,
    /// Name of the study.
    pub name: String,
    /// Where it is.
    pub stage: Stage,
    /// Points of the backbone so far.
    pub backbone: Option<Progress>,
    /// Tasks.
    pub tasks: Counts,
    /// Number of levels.
    pub levels: usize,
    /// Levels whose tasks are all done.
    pub levels_done: usize,
    /// Levels under way.
    pub active: Vec<LevelStatus>,
    /// Workers present.
    pub workers: Vec<WorkerStatus>,
    /// Tasks that do not get on, though their workers give signs of life.
    #[serde(default)]
    pub stalled: Vec<StalledTask>,
    /// Number of announcements so far.
    pub sequence: u64,
    /// Time since the coordinator started, s.
    pub elapsed: f64,
    /// Time to the end, estimated, s.
    pub eta: Option<f64>,
}

/// Tasks by state.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Stored.
    pub done: usize,
    /// Not needed: other seeds of their windows led to branches, or what they would begin from was not found.
    pub skipped: usize,
    /// Under way.
    pub running: usize,
    /// Still to come (some may turn out not to be needed).
    pub waiting: usize,
    /// Given up after too many attempts.
    pub dead: usize,
    /// Branches found.
    pub branches: usize,
}

/// A level under way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LevelStatus {
    /// Forcing amplitude, as typed.
    pub amplitude: String,
    /// Tasks done or not needed.
    pub done: usize,
    /// Tasks in all.
    pub total: usize,
    /// Branches found.
    pub branches: usize,
    /// Where the branch under way is.
    pub progress: Option<Progress>,
}

/// A task under way of which nothing new has come for long.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StalledTask {
    /// Which.
    pub task: TaskId,
    /// Who has it.
    pub worker: WorkerId,
    /// For how long, s.
    pub seconds: f64,
}

/// A worker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorkerStatus {
    /// Who.
    pub worker: WorkerId,
    /// Tasks under way, one per computing thread.
    pub tasks: Vec<TaskId>,
    /// Tasks done.
    pub done: usize,
    /// Where its (first) branch is.
    pub progress: Option<Progress>,
}

messages! {
    Manifest => "manifest",
    WindowsMessage => "windows",
    SeedMessage => "seed",
    Done => "done",
    StoredResult => "result",
    Status => "status",
}
