//! Something to compute.

use protocol::codec::{encode, sha256};
use protocol::curve::Seeds;
use protocol::ids::{Attempt, RunId, TaskId};
use protocol::model::ModelMessage;
use protocol::to_everyone::{Amplitude, Manifest, Stage};
use protocol::to_worker::{Grant, Known};
use solver::files;
use solver::formulation::modal::Modal;
use solver::response::backbone::Backbone;
use solver::response::branch::Side;
use solver::response::forced::SearchRange;
use solver::response::task::Task;
use solver::settings::Settings;
use solver::structure::Model;
use std::path::Path;
use std::time::Duration;

/// A lease with a sign of life every 200 ms.
const LEASE_MS: u64 = 600;

/// A lease without a sign of life within a test, unless there is a hint.
pub const LONG_LEASE: Duration = Duration::from_secs(900);

/// The damper that has an isola between A = 0.0048 and 0.0114.
pub struct Study {
    pub model: Model,
    pub settings: Settings,
    pub backbone: Backbone,
}

impl Study {
    pub fn new(harmonics: usize) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/nonlinear_damper");
        let model = files::load(&folder).unwrap();
        let mut settings = Settings::default();
        settings.harmonics.count = harmonics;
        settings.harmonics.samples = 64;
        let backbone = Backbone::compute(&model, &settings).unwrap();
        Self { model, settings, backbone }
    }

    /// With steps so short that no branch ends within a test.
    pub fn endless() -> Self {
        let mut study = Self::new(1);
        let continuation = &mut study.settings.continuation;
        (continuation.initial_step, continuation.min_step, continuation.max_step) = (1e-7, 1e-9, 1e-6);
        study.settings.branch.max_points = usize::MAX;
        study
    }

    pub fn reach(&self) -> SearchRange {
        SearchRange::new(&self.settings, &self.backbone).unwrap()
    }

    pub fn model_message(&self) -> Vec<u8> {
        encode(&ModelMessage::from(&self.model))
    }

    pub fn manifest(&self) -> Manifest {
        Manifest {
            protocol: protocol::VERSION,
            program: protocol::PROGRAM.into(),
            run: RunId::new("one").unwrap(),
            name: "damper".into(),
            model_sha256: sha256(&self.model_message()),
            settings: self.settings,
            reach: Some(self.reach()),
            modes: None,
            amplitudes: vec![Amplitude { text: "0.008".into(), value: 0.008 }],
            monitors: vec!["x1".into()],
            stage: Stage::Sweep,
            lease_ms: LEASE_MS,
            max_result_bytes: 100_000_000,
            units: None,
        }
    }

    /// Task number `index` of the level A = 0.008.
    pub fn grant(&self, index: usize, work: Task, known: Vec<Known>) -> Grant {
        let amplitude = 0.008;
        let seeds = work.seeds(&Modal::new(&self.model), &self.backbone, amplitude);
        Grant {
            task: TaskId::of_level("0.008", index).unwrap(),
            attempt: Attempt(1),
            ttl_ms: LEASE_MS,
            amplitude,
            order: None,
            reach: self.reach(),
            work,
            seeds: Seeds::new(&seeds),
            known,
            landing: matches!(work, Task::Seed(_)).then(|| TaskId::of_level("0.008", index - 1).unwrap()),
            curves: Vec::new(),
            checkpoint: 0,
        }
    }

    /// The main branch.
    pub fn main(&self) -> Grant {
        self.grant(0, Task::Main(Side::Below), Vec::new())
    }

    /// The main branch, with a lease that needs no sign of life within a test.
    pub fn long_main(&self) -> Grant {
        Grant { ttl_ms: LONG_LEASE.as_millis() as u64, ..self.main() }
    }
}
