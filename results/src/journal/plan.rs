//! What a sweep consists of, as it is known once the backbones are.

use protocol::backbone::BackboneMessage;
use protocol::ids::TaskId;
use protocol::to_everyone::Amplitude;
use serde::{Deserialize, Serialize};
use solver::response::forced::SearchRange;
use solver::response::modes::{LeftOut, ModesFollowed};
use solver::response::task::Task;
use solver::response::windows::Window;

/// What a sweep consists of: known when the backbones are.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPlan {
    /// Backbone of the primary mode.
    pub backbone: BackboneMessage,
    /// Backbones of further modes.
    pub further: Vec<BackboneMessage>,
    /// Modes without a backbone, from 0, and why.
    pub left_out: Vec<(usize, LeftOut)>,
    /// Within which frequencies and amplitudes branches are followed.
    pub reach: SearchRange,
    /// What follows for orders of motions beyond the first one.
    pub orders: Vec<OrderPlan>,
    /// The work of every level.
    pub levels: Vec<LevelPlan>,
    /// Tasks that were added over all levels, to follow curves over the forcing or to verify branches; none when a sweep begins.
    pub added: Vec<AddedTask>,
}

/// What motions of a further order are looked for with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OrderPlan {
    /// Order m.
    pub order: usize,
    /// Backbones with the force on harmonic m, that of the primary mode first if it starts.
    pub backbones: Vec<BackboneMessage>,
    /// Modes without a backbone, from 0, and why.
    pub left_out: Vec<(usize, LeftOut)>,
    /// Within which frequencies and amplitudes branches are followed.
    pub reach: SearchRange,
}

impl OrderPlan {
    /// Which modes have a backbone, and which not.
    pub fn modes(&self) -> ModesFollowed {
        let followed = self.backbones.iter().map(|backbone| backbone.mode).collect();
        ModesFollowed { followed, left_out: self.left_out.clone() }
    }
}

/// A task that follows from what others found.
#[derive(Debug, Clone, PartialEq)]
pub struct AddedTask {
    /// Task.
    pub id: TaskId,
    /// The level that it is of, or that its curve starts from: its forcing amplitude as typed.
    pub amplitude: String,
    /// What is to be done.
    pub task: Task,
}

impl SweepPlan {
    /// Within which frequencies and amplitudes branches of an order are followed; `None`: of the first.
    pub fn reach_of(&self, order: Option<usize>) -> SearchRange {
        let further = self.orders.iter().find(|further| Some(further.order) == order);
        further.map_or(self.reach, |further| further.reach)
    }

    /// Which modes have a backbone, and which not.
    pub fn modes(&self) -> ModesFollowed {
        let followed = std::iter::once(&self.backbone).chain(&self.further).map(|backbone| backbone.mode);
        ModesFollowed { followed: followed.collect(), left_out: self.left_out.clone() }
    }
}

/// The work of one forcing level.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelPlan {
    /// Forcing amplitude.
    pub amplitude: Amplitude,
    /// Windows.
    pub windows: Vec<Window>,
    /// Tasks, in order.
    pub tasks: Vec<Task>,
}

/// Levels that are added to a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Extension {
    /// Keys and values that the command line changed in the study, as those of a run that began with all levels.
    pub overrides: Vec<(String, String)>,
    /// The study with all levels, TOML.
    pub study: String,
    /// The levels that are added.
    pub amplitudes: Vec<Amplitude>,
    /// What follows from the backbones; nothing as long as they are not known.
    pub plan: Option<MorePlan>,
}

/// What follows from the backbones for levels that are added.
#[derive(Debug, Clone, PartialEq)]
pub struct MorePlan {
    /// Within which frequencies and amplitudes branches are followed from now on.
    pub reach: SearchRange,
    /// The same of further orders of motions.
    pub orders: Vec<OrderPlan>,
    /// The work of the levels that are added.
    pub levels: Vec<LevelPlan>,
}
