//! One forcing level: main branch, isolas, and the account of every window.

use crate::response::backbone::Backbone;
use crate::response::branch::{Branch, BranchPoint, Observer};
use crate::response::forced::{Forced, Reach};
use crate::response::forcing::Unreached;
pub use crate::response::task::{Account, BranchId, SeedAccount, SeedOutcome, WindowAccount};
use crate::response::task::{Finding, Task, carry_out, plan};
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
    /// Main branch.
    pub main: Branch,
    /// Branches apart from the main one, in the order of the windows that led to them: closed, or open with the reasons
    /// (a bound that cuts them off, say).
    pub isolas: Vec<Branch>,
    /// Every window with its outcome.
    pub windows: Vec<WindowAccount>,
}

impl Level {
    /// Computes a whole level from the backbone.
    ///
    /// # Errors
    /// If a setting or the amplitude is out of range, or the main branch cannot be started; everything else is part of the
    /// result.
    pub fn compute(model: &Model, settings: &Settings, backbone: &Backbone, forcing: f64) -> Result<Self, LevelError> {
        Self::compute_with(model, settings, backbone, forcing, &mut |_| ControlFlow::Continue(()))
    }

    /// The same, telling `observer` of every point.
    ///
    /// # Errors
    /// Those of [`Level::compute`], and if `observer` breaks.
    pub fn compute_with(
        model: &Model,
        settings: &Settings,
        backbone: &Backbone,
        forcing: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Self, LevelError> {
        settings.validate(model)?;
        if !(forcing > 0.0 && forcing.is_finite()) {
            return Err(LevelError::Forcing(forcing));
        }
        let mut forced = Forced::new(model, settings, Reach::new(settings, backbone)?, forcing);
        let (windows, tasks) = plan(backbone, forcing);
        let mut account = Account::new(windows);
        let mut found: Vec<(BranchId, Branch)> = Vec::new();
        for task in tasks {
            if !account.needs(&task) {
                continue;
            }
            let seeds = task.seeds(forced.modal(), backbone, forcing);
            let known: Vec<(BranchId, &Branch)> = found.iter().map(|(id, branch)| (*id, branch)).collect();
            match carry_out(&mut forced, &task, &seeds, &known, observer).ok_or(LevelError::Cancelled)? {
                Finding::Branch(branch) => {
                    if let SeedOutcome::Found(id) = account.record(&task, None) {
                        found.push((id, branch));
                    }
                }
                Finding::Nothing(SeedOutcome::NotTraced(failure)) if task == Task::Main => {
                    let (omega, _) = forced.reach().frequency;
                    return Err(LevelError::Start { forcing, omega, failure });
                }
                Finding::Nothing(outcome) => {
                    account.record(&task, Some(outcome));
                }
            }
        }
        let mut branches = found.into_iter().map(|(_, branch)| branch);
        let main = branches.next().expect("the first task is the main branch, and failing ends the level");
        Ok(Self { forcing, main, isolas: branches.collect(), windows: account.windows })
    }

    /// All branches with their names.
    pub fn branches(&self) -> impl Iterator<Item = (BranchId, &Branch)> {
        let isolas = self.isolas.iter().enumerate().map(|(i, branch)| (BranchId::Isola(i), branch));
        std::iter::once((BranchId::Main, &self.main)).chain(isolas)
    }

    /// Point of largest amplitude over all branches.
    pub fn peak(&self) -> &BranchPoint {
        self.branches()
            .map(|(_, branch)| branch.peak())
            .max_by(|a, b| a.amplitude().total_cmp(&b.amplitude()))
            .expect("there is a main branch")
    }
}
