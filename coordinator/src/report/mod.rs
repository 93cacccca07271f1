//! What the figures of a run show, read from the store at any stage: one [`Report`], drawn by the page and by `plot`.

mod account;
mod backbone;
mod column;
mod curve;
mod gather;
mod level;
mod motion;
#[cfg(test)]
mod tests;
mod verdict;
mod ways;
pub mod words;

pub use account::{Account, TaskRow, WorkerCost};
pub use backbone::{BackboneCurve, ModeShare, Peak};
pub use column::Column;
pub use curve::{Curve, largest};
pub use gather::{Selection, monitors};
pub use level::{Level, Window};
pub use motion::{Motion, Motions, Node};
pub use verdict::Sentence;
pub use ways::{Resonance, Ways};

use crate::survey::{Lacks, Survey};
use serde::Serialize;

/// A run as its figures show it. Its JSON is what the page is given: rad/s, m, N, J, s.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Which run.
    pub run: RunFacts,
    /// Where it is dangerous, from which forcing on, what ordinary continuation would have missed.
    pub verdict: [Sentence; 3],
    /// Monitored dofs; the first one counts.
    pub monitors: Vec<Monitor>,
    /// Lowest and highest frequency of the sweep, rad/s; known when the backbone is.
    pub omega: Option<(f64, f64)>,
    /// Levels by forcing amplitude.
    pub levels: Vec<Level>,
    /// Branches, level by level, main before isolas.
    pub branches: Vec<Curve>,
    /// The backbone, once it is known.
    pub backbone: Option<BackboneCurve>,
    /// Frequency and amplitude of the largest response, three ways.
    pub ways: Ways,
    /// Motions at chosen points, if there is a branch.
    pub motions: Option<Motions>,
    /// How it came about.
    pub account: Account,
    /// What it was made of, with all levels that are shown.
    #[serde(skip)]
    pub survey: Survey,
    /// What is missing.
    #[serde(skip)]
    pub lacks: Lacks,
}

/// Which run, and what is not there.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RunFacts {
    /// Run.
    pub id: String,
    /// Name of the study.
    pub name: String,
    /// Name of the model.
    pub model: String,
    /// Where the study was read from.
    pub study_file: String,
    /// When the run was created, RFC 3339.
    pub created: String,
    /// Version of the program.
    pub program: String,
    /// `backbone`, `sweep`, `finished` or `cancelled`; `None` if it cannot be read.
    pub stage: Option<protocol::to_everyone::Stage>,
    /// When this was read, RFC 3339.
    pub made: String,
    /// What is not there, not yet, or damaged: a sentence each.
    pub missing: Vec<String>,
}

/// A monitored dof.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Monitor {
    /// Name.
    pub name: String,
    /// Its clearance to the casing, m, if it is normal to it.
    pub gap: Option<f64>,
}
