//! One forcing level: its branches, and the account of every window.

pub use crate::response::account::{Account, SeedAccount, WindowAccount};
use crate::response::backbone::Backbone;
use crate::response::branch::{Branch, BranchPoint, Observer};
use crate::response::forced::{Forced, SearchRange};
use crate::response::forcing::Unreached;
pub use crate::response::name::BranchId;
pub use crate::response::task::SeedOutcome;
use crate::response::task::{Task, TaskResult, plan};
use crate::response::trace::{Given, execute};
use crate::settings::{Settings, SettingsError};
use crate::structure::Model;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use thiserror::Error;

/// Why a level has no result at all.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LevelError {
    /// A setting is out of its range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The forcing amplitude is not a positive number.
    #[error("forcing amplitude {0}: use a finite number above zero")]
    Forcing(f64),
    /// There is no backbone to start from.
    #[error("no backbone: give that of the primary mode, at least")]
    NoBackbone,
    /// Whoever observes asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// The main branch has no first point.
    #[error(
        "the main branch does not start at A = {forcing}, {omega:.6} rad/s: {failure}; choose another frequency.min"
    )]
    Start {
        /// Forcing amplitude.
        forcing: f64,
        /// Lower frequency bound, rad/s.
        omega: f64,
        /// Why.
        failure: Unreached,
    },
}

/// All forced responses found at one forcing amplitude.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// Forcing amplitude A.
    pub forcing: f64,
    /// Branches with their names, in the order in which they were found: the main branch first, then those that windows
    /// led to.
    pub branches: Vec<(BranchId, Branch)>,
    /// Every window with its outcome.
    pub windows: Vec<WindowAccount>,
}

impl Level {
    /// Computes a whole level from one backbone or from several, each of a mode of its own, the primary mode's first.
    ///
    /// # Errors
    /// If a setting or the amplitude is out of range, or no main branch can be started from either side; everything else is
    /// part of the result.
    pub fn compute(
        model: &Model,
        settings: &Settings,
        backbones: &(impl AsRef<[Backbone]> + ?Sized),
        forcing: f64,
    ) -> Result<Self, LevelError> {
        Self::compute_with(model, settings, backbones, forcing, &mut |_| ControlFlow::Continue(()))
    }

    /// The same, telling `observer` of every point.
    ///
    /// # Errors
    /// Those of [`Level::compute`], and if `observer` breaks.
    pub fn compute_with(
        model: &Model,
        settings: &Settings,
        backbones: &(impl AsRef<[Backbone]> + ?Sized),
        forcing: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Self, LevelError> {
        settings.validate(model)?;
        if !(forcing > 0.0 && forcing.is_finite()) {
            return Err(LevelError::Forcing(forcing));
        }
        let (primary, further) = backbones.as_ref().split_first().ok_or(LevelError::NoBackbone)?;
        let reach = SearchRange::over(settings, primary, further, forcing)?.with_resonances(model, settings);
        let mut forced = Forced::new(model, settings, reach, forcing);
        let (windows, tasks) = plan(backbones, forcing, &settings.frequency, 0);
        let mut account = Account::new(windows);
        let mut branches: Vec<(BranchId, Branch)> = Vec::new();
        let (mut failed, mut landings) = (None, Vec::new());
        for task in tasks {
            if !account.needs(&task) {
                continue;
            }
            let seeds = task.seeds(forced.modal(), backbones, forcing);
            let known: Vec<(BranchId, &Branch)> = branches.iter().map(|(id, branch)| (*id, branch)).collect();
            let given = Given { seeds: &seeds, landings: &landings, known: &known, curves: &[] };
            let finding = execute(&mut forced, &task, &given, observer).ok_or(LevelError::Cancelled)?;
            let Some(outcome) = account.outcome(&finding.brought()) else { continue };
            account.record(&task, outcome);
            match (outcome, finding) {
                (_, TaskResult::Landings(landed)) => landings = landed,
                (SeedOutcome::Found(id), TaskResult::Branch(branch)) => branches.push((id, branch)),
                (SeedOutcome::NotTraced(failure), _) if matches!(task, Task::Main(_)) => {
                    failed.get_or_insert(failure);
                }
                _ => {}
            }
        }
        match failed {
            Some(failure) if !account.has_main() => {
                let (omega, _) = forced.reach().frequency;
                Err(LevelError::Start { forcing, omega, failure })
            }
            _ => Ok(Self { forcing, branches, windows: account.windows }),
        }
    }

    /// All branches with their names.
    pub fn branches(&self) -> impl Iterator<Item = (BranchId, &Branch)> {
        self.branches.iter().map(|(id, branch)| (*id, branch))
    }

    /// The branch of this name.
    pub fn branch(&self, name: BranchId) -> Option<&Branch> {
        self.branches().find(|(id, _)| *id == name).map(|(_, branch)| branch)
    }

    /// The first main branch.
    ///
    /// # Panics
    /// If the level is not a computed one, and has none.
    pub fn main(&self) -> &Branch {
        self.branch(BranchId::MAIN).expect("a level has a main branch")
    }

    /// Branches that are not main branches.
    pub fn isolas(&self) -> impl Iterator<Item = &Branch> {
        self.branches().filter(|(id, _)| !id.is_main()).map(|(_, branch)| branch)
    }

    /// Point of largest amplitude over all branches.
    pub fn peak(&self) -> &BranchPoint {
        self.branches()
            .map(|(_, branch)| branch.peak())
            .max_by(|a, b| a.amplitude().total_cmp(&b.amplitude()))
            .expect("there is a main branch")
    }
}
