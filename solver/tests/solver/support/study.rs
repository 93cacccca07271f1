//! A model with its settings and backbone, and what a level of it lists. How a level stores its branches is known here only.

use solver::files;
pub use solver::response::branch::BranchKind as Kind;
use solver::response::branch::{Outcome, Stop};
use solver::response::level::{BranchId, LevelError};
use solver::{Backbone, Backbones, Branch, Level, Model, Settings};
use std::path::Path;

/// A shipped model, with some settings replaced.
pub fn shipped(name: &str, overrides: &[(&str, &str)]) -> Model {
    read("../models", name, overrides)
}

/// A model of these tests.
pub fn own(name: &str) -> Model {
    read("tests/models", name, &[])
}

fn read(folder: &str, name: &str, overrides: &[(&str, &str)]) -> Model {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).join(name);
    files::load_with(&folder, overrides).unwrap_or_else(|error| panic!("{error}"))
}

pub fn with_harmonics(count: usize) -> Settings {
    let mut settings = Settings::default();
    settings.harmonics.count = count;
    settings
}

/// A branch under its name.
pub struct Listed {
    pub kind: Kind,
    pub name: String,
    pub branch: Branch,
}

impl std::fmt::Debug for Listed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (branch, (low, high)) = (&self.branch, self.branch.frequency_range());
        let (peak, count) = (branch.peak(), branch.points.len());
        let (height, at) = (peak.amplitude(), peak.omega());
        write!(
            f,
            "{}: {low:.6} to {high:.6} rad/s, {count} points, peak {height:.6} at {at:.6}, {}",
            self.name, branch.outcome
        )
    }
}

/// A model with what is needed to compute its levels.
pub struct Study {
    pub model: Model,
    pub settings: Settings,
    pub backbones: Vec<Backbone>,
}

impl Study {
    /// With the backbone of the primary mode alone.
    pub fn new(model: Model, settings: Settings) -> Self {
        let backbone = Backbone::compute(&model, &settings).unwrap_or_else(|error| panic!("{error}"));
        Self { model, settings, backbones: vec![backbone] }
    }

    /// With the backbones of all modes that the settings choose.
    pub fn of_modes(model: Model, settings: Settings) -> Self {
        let backbones = Backbones::compute(&model, &settings).unwrap_or_else(|error| panic!("{error}"));
        Self { model, settings, backbones: backbones.list }
    }

    /// The branches at a forcing amplitude.
    pub fn try_level(&self, forcing: f64) -> Result<Vec<Listed>, LevelError> {
        let level = Level::compute(&self.model, &self.settings, &self.backbones, forcing)?;
        let list =
            |(id, branch): (BranchId, &Branch)| Listed { kind: id.kind, name: id.to_string(), branch: branch.clone() };
        Ok(level.branches().map(list).collect())
    }

    /// The branches at a forcing amplitude.
    pub fn level(&self, forcing: f64) -> Vec<Listed> {
        self.try_level(forcing).unwrap_or_else(|error| panic!("A = {forcing}: {error}"))
    }
}

/// The branches of one kind.
pub fn of_kind(level: &[Listed], kind: Kind) -> Vec<&Listed> {
    level.iter().filter(|listed| listed.kind == kind).collect()
}

/// Frequency and amplitude (of the first monitored dof) of the largest point of the main branch, in however many pieces.
pub fn main_peak(level: &[Listed]) -> (f64, f64) {
    let peaks = of_kind(level, Kind::Main).into_iter().map(|listed| listed.branch.peak());
    let peak = peaks.max_by(|a, b| a.amplitude().total_cmp(&b.amplitude())).expect("there is a main branch");
    (peak.omega(), peak.amplitude())
}

/// Why a branch ends where its curve does not, if it does: at neither a bound nor its start.
pub fn why_unfinished(branch: &Branch) -> Option<Stop> {
    let Outcome::Open(first, last) = branch.outcome else { return None };
    let is_end = |stop: &Stop| matches!(stop, Stop::Start | Stop::Rest | Stop::FrequencyBound);
    [first, last].into_iter().find(|stop| !is_end(stop))
}

/// Nothing but main branches, from frequency bound to frequency bound.
pub fn assert_main_only(level: &[Listed], what: &str) {
    let is_main = |listed: &Listed| listed.kind == Kind::Main && why_unfinished(&listed.branch).is_none();
    assert!(!level.is_empty() && level.iter().all(is_main), "{what}: {level:#?}");
}
