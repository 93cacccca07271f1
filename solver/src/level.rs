//! One forcing level: main branch, isolas, and the account of every window.

use crate::backbone::Backbone;
use crate::branch::{Branch, BranchPoint};
use crate::forced::Forced;
use crate::model::Model;
use crate::problem::Failure;
use crate::seeds::{Landing, LandingFailure, Phase, land, land_by_amplitude};
use crate::settings::{Settings, SettingsError};
use crate::state::State;
use crate::walk::Observer;
use crate::windows::{Window, windows};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Names a branch of a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BranchId {
    /// The main branch.
    Main,
    /// Isola number i, from 0.
    Isola(usize),
}

impl std::fmt::Display for BranchId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            BranchId::Main => write!(f, "main"),
            BranchId::Isola(index) => write!(f, "isola {}", index + 1),
        }
    }
}

/// What became of a seed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SeedOutcome {
    /// It lies on this branch.
    Found(BranchId),
    /// It did not lead to a forced response.
    NotLanded(LandingFailure),
    /// It landed, but no branch could be started there.
    NotTraced(Failure),
    /// It lies outside the bounds within which branches are followed.
    OutOfBounds,
}

impl std::fmt::Display for SeedOutcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            SeedOutcome::Found(id) => write!(f, "{id}"),
            SeedOutcome::NotLanded(failure) => write!(f, "{failure}"),
            SeedOutcome::NotTraced(failure) => write!(f, "landed, but no branch starts there: {failure}"),
            SeedOutcome::OutOfBounds => write!(f, "outside the frequency or amplitude bounds"),
        }
    }
}

/// A seed of a window and what became of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SeedAccount {
    /// Backbone index of the minimum of A* it stands for.
    pub minimum: usize,
    /// Which of the two phases.
    pub phase: Phase,
    /// What became of it.
    pub outcome: SeedOutcome,
}

/// The account of a window.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WindowAccount {
    /// The window.
    pub window: Window,
    /// Two seeds, one for each phase, for every minimum of A* in the window.
    pub seeds: Vec<SeedAccount>,
}

impl WindowAccount {
    /// The branches found from the window, without repetition; empty: predicted, not found.
    pub fn branches(&self) -> Vec<BranchId> {
        let mut list: Vec<BranchId> = Vec::new();
        for seed in &self.seeds {
            if let SeedOutcome::Found(id) = seed.outcome
                && !list.contains(&id)
            {
                list.push(id);
            }
        }
        list
    }
}

/// Why a level has no result at all.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LevelError {
    /// A setting is out of its range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The forcing amplitude is not a positive number.
    #[error("forcing amplitude {0}: use a finite number above zero")]
    Amplitude(f64),
    /// Whoever observes asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// The main branch has no first point.
    #[error(
        "the main branch does not start at A = {amplitude}, {omega:.6} rad/s: {failure}; choose another frequency.min"
    )]
    Start {
        /// Forcing amplitude.
        amplitude: f64,
        /// Lower frequency bound, rad/s.
        omega: f64,
        /// Why.
        failure: Failure,
    },
}

type LandFn = fn(&mut Forced<'_>, &Backbone, &Window, Phase, f64) -> Result<Landing, Failure>;

/// All forced responses found at one forcing amplitude.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// Forcing amplitude A.
    pub amplitude: f64,
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
    /// If a setting or the amplitude is out of range, the main branch cannot be started, or `observer` breaks; everything
    /// else is part of the result.
    pub fn compute(
        model: &Model,
        settings: &Settings,
        backbone: &Backbone,
        amplitude: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Self, LevelError> {
        settings.validate(model)?;
        if !(amplitude > 0.0 && amplitude.is_finite()) {
            return Err(LevelError::Amplitude(amplitude));
        }
        let mut forced = Forced::new(model, settings, backbone, amplitude);
        let (omega, high) = forced.frequency_bounds();
        if omega >= high {
            let remedy = format!("the lower frequency bound is {omega}: use a higher one");
            return Err(SettingsError { key: "frequency.max", value: high.to_string(), remedy }.into());
        }
        let main = forced.main_branch(observer).map_err(|failure| LevelError::Start { amplitude, omega, failure })?;
        let mut level = Self { amplitude, main, isolas: Vec::new(), windows: Vec::new() };
        for window in windows(backbone, amplitude) {
            if level.branches().any(|(_, branch)| branch.is_cancelled()) {
                return Err(LevelError::Cancelled);
            }
            let account = level.follow_window(&mut forced, backbone, window, observer);
            level.windows.push(account);
        }
        if level.branches().any(|(_, branch)| branch.is_cancelled()) {
            return Err(LevelError::Cancelled);
        }
        Ok(level)
    }

    /// All seeds of a window at fixed frequency; if none leads to a branch, by steps in the forcing amplitude.
    fn follow_window(
        &mut self,
        forced: &mut Forced<'_>,
        backbone: &Backbone,
        window: Window,
        observer: &mut Observer<'_>,
    ) -> WindowAccount {
        let amplitude = self.amplitude;
        let wells = window.wells(backbone);
        let mut try_all = |land: LandFn| {
            let mut seeds = Vec::new();
            for well in &wells {
                for phase in [Phase::First, Phase::Second] {
                    let outcome = match land(forced, backbone, well, phase, amplitude) {
                        Ok(landing) => self.follow(forced, &landing, observer),
                        Err(failure) => SeedOutcome::NotLanded(LandingFailure::NotConverged(failure)),
                    };
                    seeds.push(SeedAccount { minimum: well.best, phase, outcome });
                }
            }
            WindowAccount { window, seeds }
        };
        let account = try_all(land);
        if account.branches().is_empty() { try_all(land_by_amplitude) } else { account }
    }

    /// Traces the branch through a landed state, unless it is known.
    fn follow(&mut self, forced: &mut Forced<'_>, landing: &Landing, observer: &mut Observer<'_>) -> SeedOutcome {
        let state = &landing.state;
        match self.identify(forced, state) {
            Some(id) if landing.is_near() => return SeedOutcome::Found(id),
            Some(_) => return SeedOutcome::NotLanded(LandingFailure::Far(landing.distance)),
            None => {}
        }
        if !forced.contains(state) {
            return SeedOutcome::OutOfBounds;
        }
        let branch = match forced.branch_through(state, observer) {
            Ok(branch) => branch,
            Err(failure) => return SeedOutcome::NotTraced(failure),
        };
        // A known branch that ended too early is met from its other side.
        if !branch.is_closed() && !branch.is_cancelled() {
            let ends = [branch.points.first(), branch.points.last()];
            if let Some(id) = ends.into_iter().flatten().find_map(|end| self.identify(forced, &end.state)) {
                return SeedOutcome::Found(id);
            }
        }
        self.isolas.push(branch);
        SeedOutcome::Found(BranchId::Isola(self.isolas.len() - 1))
    }

    /// The branch that a converged state lies on, if it is known.
    fn identify(&self, forced: &mut Forced<'_>, state: &State) -> Option<BranchId> {
        self.branches().find(|(_, branch)| forced.lies_on(state, branch)).map(|(id, _)| id)
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
