//! How the figures came about: numerics, tasks, workers.

use crate::overview::{Level, Omissions};
use crate::resolved_study::settings;
use crate::store::{Reader, TaskRow, WorkerCost};
use serde::Serialize;

/// The account of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct CostAccount {
    /// Dotted keys of the study with their values, as TOML.
    pub settings: Vec<(String, String)>,
    /// Who computed how much.
    pub workers: Vec<WorkerCost>,
    /// Every task.
    pub tasks: Vec<TaskRow>,
    /// The study with every setting spelled out, TOML.
    pub study: String,
    /// Points of the backbone.
    pub backbone_points: usize,
}

impl CostAccount {
    /// Of a run whose resolved study is known.
    pub fn read(reader: &Reader, study: &str, levels: &[Level], omissions: &mut Omissions) -> Self {
        let places = levels.iter().enumerate().map(|(place, level)| (level.amplitude.as_str(), place)).collect();
        Self {
            settings: settings(study),
            workers: omissions.read("The account of the workers is", reader.workers()).unwrap_or_default(),
            tasks: omissions.read("The account of the tasks is", reader.task_rows(&places)).unwrap_or_default(),
            study: study.into(),
            backbone_points: omissions
                .read("The number of points of the backbone is", reader.backbone_points())
                .unwrap_or(0),
        }
    }
}
