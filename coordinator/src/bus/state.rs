//! What anyone may ask of a run that goes on, as it is now.

use protocol::codec::encode;
use protocol::curve::Seeds;
use protocol::ids::TaskId;
use protocol::to_everyone::{LevelWindows, Manifest, SeedMessage, Status, WindowsMessage};
use results::journal::{LevelPlan, SweepPlan};
use solver::formulation::modal::Modal;
use solver::response::backbone::Backbone;
use solver::response::task::Task;
use std::sync::Arc;

/// A run as it is now. Whoever carries it out changes it, whoever answers reads it.
pub struct RunState {
    /// Latest manifest.
    pub manifest: Manifest,
    /// Latest status.
    pub status: Option<Status>,
    /// The sweep, once its backbone is known.
    pub sweep: Option<Arc<PublishedSweep>>,
}

/// What is known when a sweep begins.
pub struct PublishedSweep {
    /// Backbone, reach and tasks of every level.
    pub plan: Arc<SweepPlan>,
    /// The `backbone` message.
    pub backbone_bytes: Vec<u8>,
    /// The `windows` message.
    pub windows_bytes: Vec<u8>,
    modal: Modal,
    backbone: Backbone,
}

impl PublishedSweep {
    /// From what was computed.
    pub fn new(modal: Modal, backbone: Backbone, plan: Arc<SweepPlan>) -> Self {
        let level =
            |plan: &LevelPlan| LevelWindows { amplitude: plan.amplitude.clone(), windows: plan.windows.clone() };
        let windows = WindowsMessage { levels: plan.levels.iter().map(level).collect() };
        let (backbone_bytes, windows_bytes) = (encode(&plan.backbone), encode(&windows));
        Self { plan, backbone_bytes, windows_bytes, modal, backbone }
    }

    /// The seeds of a task: they follow from it, the backbone and the amplitude.
    pub fn seeds(&self, work: &Task, amplitude: f64) -> Seeds {
        Seeds::new(&work.seeds(&self.modal, &self.backbone, amplitude))
    }

    /// The `seed` message of a task; `None` if there is no such task.
    pub fn seed(&self, task: &TaskId) -> Option<SeedMessage> {
        let level = self.plan.levels.iter().find(|level| task.is_of_level(&level.amplitude.text))?;
        let amplitude = level.amplitude.clone();
        let is_asked = |i: &usize| TaskId::of_level(&amplitude.text, *i).is_ok_and(|id| id == *task);
        let work = level.tasks[(0..level.tasks.len()).find(is_asked)?];
        let seeds = self.seeds(&work, amplitude.value);
        Some(SeedMessage { task: task.clone(), amplitude, work, seeds })
    }
}
