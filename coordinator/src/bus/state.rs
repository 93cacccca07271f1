//! What anyone may ask of a run that goes on, as it is now.

use crate::ledger::Load;
use protocol::backbone::BackboneMessage;
use protocol::codec::encode;
use protocol::curve::Seeds;
use protocol::ids::TaskId;
use protocol::to_everyone::{Amplitude, LevelWindows, Manifest, SeedMessage, Status, WindowsMessage};
use results::journal::{LevelPlan, SweepPlan};
use solver::formulation::modal::Modal;
use solver::response::backbone::Backbone;
use solver::response::task::Task;
use std::sync::Arc;
use std::time::Instant;

/// A run as it is now. Whoever carries it out changes it, whoever answers reads it.
pub struct RunState {
    /// Latest manifest.
    pub manifest: Manifest,
    /// Latest status.
    pub status: Option<Status>,
    /// How busy everybody is, once there is a sweep.
    pub load: Option<Load>,
    /// When the status was last told.
    pub told: Instant,
    /// The sweep, once its backbone is known.
    pub sweep: Option<Arc<PublishedSweep>>,
}

impl RunState {
    /// Of a run that begins or goes on.
    pub fn new(manifest: Manifest) -> Self {
        Self { manifest, status: None, load: None, told: Instant::now(), sweep: None }
    }
}

/// What is known when a sweep begins.
pub struct PublishedSweep {
    /// Backbones, reach and tasks of every level.
    pub plan: Arc<SweepPlan>,
    /// The `backbone` messages with their modes, from 0, that of the primary one first.
    pub backbone_bytes: Vec<(usize, Vec<u8>)>,
    /// The `windows` message.
    pub windows_bytes: Vec<u8>,
    /// By order of the motions, the first one without a number: the forcing in modal coordinates, and the backbones.
    orders: Vec<(Option<usize>, Modal, Vec<Backbone>)>,
}

impl PublishedSweep {
    /// From what was computed.
    pub fn new(orders: Vec<(Option<usize>, Modal, Vec<Backbone>)>, plan: Arc<SweepPlan>) -> Self {
        let level =
            |plan: &LevelPlan| LevelWindows { amplitude: plan.amplitude.clone(), windows: plan.windows.clone() };
        let windows = WindowsMessage { levels: plan.levels.iter().map(level).collect() };
        let encoded = |message: &BackboneMessage| (message.mode, encode(message));
        let backbone_bytes = std::iter::once(&plan.backbone).chain(&plan.further).map(encoded).collect();
        Self { backbone_bytes, windows_bytes: encode(&windows), plan, orders }
    }

    /// The seeds of a task of a level: they follow from it and the backbones.
    pub fn seeds(&self, work: &Task, level: &Amplitude) -> Seeds {
        let order = self.orders.iter().find(|(order, ..)| *order == level.order());
        Seeds::new(&order.map_or_else(Vec::new, |(_, modal, backbones)| work.seeds(modal, backbones, level.value)))
    }

    /// The `seed` message of a task; `None` if there is no such task.
    pub fn seed(&self, task: &TaskId) -> Option<SeedMessage> {
        let level = self.plan.levels.iter().find(|level| task.is_of_level(&level.amplitude.text))?;
        let amplitude = level.amplitude.clone();
        let is_asked = |i: &usize| TaskId::of_level(&amplitude.text, *i).is_ok_and(|id| id == *task);
        let work = level.tasks[(0..level.tasks.len()).find(is_asked)?];
        let seeds = self.seeds(&work, &amplitude);
        Some(SeedMessage { task: task.clone(), amplitude, work, seeds })
    }
}
