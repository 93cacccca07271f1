//! The work of a run in pieces: each task lands a seed, continues one branch of a forcing level, or one curve over all levels.

mod message;

use crate::curve::problem::Failure;
use crate::formulation::modal::Modal;
use crate::response::backbone::Backbone;
use crate::response::branch::{Branch, BranchKind, Side, SpecialKind};
use crate::response::critical::{CriticalCurve, CriticalError};
use crate::response::forcing::Unreached;
pub use crate::response::marched::{DisturbPlace, MarchPlace, VerifyPlace};
pub use crate::response::name::BranchId;
pub use crate::response::origin::{BranchEnd, CarryPlace, CrossingPlace, FoldPlace, Origin, SwitchPlace};
use crate::response::scout::ScoutPlace;
use crate::response::seeds::{Landing, LandingFailure, LandingMethod, Phase, Seed, candidates};
use crate::response::starts::StartPlace;
use crate::response::windows::{Window, windows};
use crate::settings::FrequencySettings;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use thiserror::Error;

/// Where a task starts from: a well of a window, with phase and method of landing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SeedPlace {
    /// Number of the window within its level, from 0.
    pub window: usize,
    /// The well: the part of the window around one minimum of A*.
    pub well: Window,
    /// Which of the two phases.
    pub phase: Phase,
    /// How it is landed.
    #[serde(rename = "way")]
    pub method: LandingMethod,
}

/// One piece of work: continues one branch at one forcing amplitude, or one curve over the forcing amplitudes, or lands where
/// one may begin, or verifies one. Messages say `"main"` for the main branch from below, `{"main": "above"}` for the one from above,
/// `{"land": …}`, `{"seed": …}`, `{"fold": …}`, `{"crossing": …}`, `{"start": …}`, `{"begin": …}`, `{"scout": …}`,
/// `{"verify": …}`, `{"disturb": …}`, `{"march": …}`, `{"carry": …}` and `{"switch": …}`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Task {
    /// The main branch, from one of the frequency bounds.
    Main(Side),
    /// The forced responses that a seed of a window lands on. It does not depend on what else is known.
    Land(SeedPlace),
    /// The branch through what a seed of a window landed on, unless it is known.
    Seed(SeedPlace),
    /// The curve that a fold follows over the forcing amplitude, unless it is known.
    Fold(FoldPlace),
    /// The branch through where a curve crosses the level, unless it is known.
    Crossing(CrossingPlace),
    /// The forced responses that a batch of random starts leads to. They do not depend on what else is known.
    Start(StartPlace),
    /// The first branch through what a batch of random starts led to that is not known.
    Begin(StartPlace),
    /// The folds of the branches that random starts lead to at a forcing amplitude beyond the study's. They do not depend on what
    /// else is known.
    Scout(ScoutPlace),
    /// The stability of a branch, by time marching: [`crate::stability::verification::verify`].
    Verify(VerifyPlace),
    /// How hard a push throws the structure onto a branch, by time marching: [`crate::stability::disturbance::disturb`].
    Disturb(DisturbPlace),
    /// What an unstable motion turns into, by time marching: [`crate::stability::settling::settle`].
    March(MarchPlace),
    /// The curve that a response of an open branch follows over the forcing amplitude at fixed frequency, unless it is known.
    Carry(CarryPlace),
    /// The branch that crosses a known one at a branch point of that, unless it is known.
    Switch(SwitchPlace),
}

impl Task {
    /// Seeds to start from, the most promising first, or to compare known branches with; none where it starts from something
    /// else, or without the backbone of the window's mode.
    pub fn seeds(&self, modal: &Modal, backbones: &(impl AsRef<[Backbone]> + ?Sized), forcing: f64) -> Vec<Seed> {
        let (place, method) = match self {
            Task::Land(place) => (place, place.method),
            // All places of the well that are landed from, at the forcing of the level.
            Task::Seed(place) if place.method == LandingMethod::SteppedForcing => (place, LandingMethod::FullForcing),
            _ => return Vec::new(),
        };
        let backbone = backbones.as_ref().iter().find(|backbone| backbone.mode == place.well.mode);
        backbone
            .map_or_else(Vec::new, |backbone| candidates(modal, backbone, &place.well, place.phase, method, forcing))
    }

    /// The tasks of a batch of starts, and of the first branch through what it led to.
    pub fn from_starts(place: StartPlace) -> [Self; 2] {
        [Self::Start(place), Self::Begin(place)]
    }

    /// Whether it marches in time, and takes no balance.
    pub fn is_marched(&self) -> bool {
        matches!(self, Task::Verify(_) | Task::Disturb(_) | Task::March(_))
    }

    /// Whether it has to know what those before it found: such tasks are carried out one after the other.
    pub fn is_ordered(&self) -> bool {
        !matches!(self, Task::Land(_) | Task::Start(_) | Task::Scout(_)) && !self.is_marched()
    }

    /// Where the curve starts that it follows over all levels, if it follows one.
    pub fn origin(&self) -> Option<Origin> {
        match *self {
            Task::Fold(place) => Some(Origin::Fold(place)),
            Task::Carry(place) => Some(Origin::Carry(place)),
            _ => None,
        }
    }

    /// Forcing amplitude of what it lands on or traces, of a task of the level at `level`.
    pub fn forcing(&self, level: f64) -> f64 {
        match self {
            Task::Scout(scout) | Task::Fold(FoldPlace::Scout { scout, .. }) => scout.forcing(level),
            _ => level,
        }
    }
}

impl From<Origin> for Task {
    fn from(origin: Origin) -> Self {
        match origin {
            Origin::Fold(place) => Self::Fold(place),
            Origin::Carry(place) => Self::Carry(place),
        }
    }
}

/// What became of a task.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SeedOutcome {
    /// It lies on this branch.
    Found(BranchId),
    /// No seed landed near it, but this known branch passes by one, at this relative distance: what was predicted may be that, or
    /// what is not known.
    Passing(BranchId, f64),
    /// It did not lead to a forced response.
    NotLanded(LandingFailure),
    /// It landed on so many forced responses: where the branches through them begin is another task's work.
    Landed(usize),
    /// It lies on a branch of asymmetric motions that leaves one of symmetric motions at a point of it. So in runs of
    /// stores up to version 6; such branches are listed now ([`BranchKind::Branched`]).
    Attached,
    /// It landed, but no branch could be started there.
    NotTraced(Unreached),
    /// It lies outside the bounds within which branches are followed.
    OutOfBounds,
    /// A scout met no fold.
    NoFold,
    /// It lies on the curve of this number, from 0.
    OnCurve(usize),
    /// No curve starts there.
    NotFollowed(Unfollowed),
    /// So many of its points were verified.
    Verified(usize),
    /// So many pushes of a scan were marched.
    Disturbed(usize),
    /// So many periods of an unstable motion were marched.
    Marched(usize),
}

/// Why no curve over the forcing amplitude starts at a point.
#[derive(Debug, Clone, Copy, PartialEq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unfollowed {
    /// A law has no second derivatives.
    #[error("a law has no second derivatives; contact has them with harmonics.quadrature = \"arcs\"")]
    Unsupported,
    /// The nearest point of such a curve is one of another response.
    #[error("the nearest one is one of another response")]
    Elsewhere,
    /// It could not be located.
    #[error(transparent)]
    #[serde(untagged)]
    Failure(#[from] Failure),
}

impl From<CriticalError> for Unfollowed {
    fn from(error: CriticalError) -> Self {
        match error {
            CriticalError::Settings(_) | CriticalError::Formulation(_) => Self::Unsupported,
            CriticalError::Elsewhere { .. } => Self::Elsewhere,
            CriticalError::Start { failure, .. } => Self::Failure(failure),
        }
    }
}

impl SeedOutcome {
    /// The branch that is there: it was landed on, or passes by.
    pub fn branch(&self) -> Option<BranchId> {
        match *self {
            Self::Found(id) | Self::Passing(id, _) => Some(id),
            _ => None,
        }
    }
}

impl std::fmt::Display for SeedOutcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            SeedOutcome::Found(id) => write!(f, "{id}"),
            SeedOutcome::Passing(id, distance) => write!(f, "{id} passes by (relative distance {distance:.2})"),
            SeedOutcome::NotLanded(failure) => write!(f, "{failure}"),
            SeedOutcome::Landed(1) => write!(f, "1 forced response"),
            SeedOutcome::Landed(count) => write!(f, "{count} forced responses"),
            SeedOutcome::NotTraced(failure) => write!(f, "landed, but no branch starts there: {failure}"),
            SeedOutcome::Attached => write!(f, "on asymmetric motions that branch off symmetric ones"),
            SeedOutcome::OutOfBounds => write!(f, "outside the frequency or amplitude bounds"),
            SeedOutcome::NoFold => write!(f, "no fold was met"),
            SeedOutcome::OnCurve(number) => write!(f, "curve {}", number + 1),
            SeedOutcome::Verified(1) => write!(f, "1 point verified"),
            SeedOutcome::Verified(count) => write!(f, "{count} points verified"),
            SeedOutcome::Disturbed(count) => write!(f, "{count} pushes marched"),
            SeedOutcome::Marched(count) => write!(f, "{count} periods marched"),
            SeedOutcome::NotFollowed(failure) => write!(f, "no curve starts there: {failure}"),
        }
    }
}

/// The result of a task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TaskResult {
    /// The forced responses that seeds landed on, in the order of the seeds; of a scout the folds.
    Landings(Vec<Landing>),
    /// A branch that was not known.
    Branch(Branch),
    /// A curve over the forcing amplitude that was not known.
    Curve(CriticalCurve),
    /// No new branch, and why.
    Nothing(SeedOutcome),
}

impl TaskResult {
    /// The same without the branch itself.
    pub fn brought(&self) -> Brought {
        match self {
            TaskResult::Landings(landings) => Brought::Landings(landings.len()),
            TaskResult::Branch(branch) => {
                let count = |kind| branch.special(kind).count();
                let (folds, branch_points) = (count(SpecialKind::Fold), count(SpecialKind::BranchPoint));
                Brought::Branch { kind: branch.kind, folds, branch_points }
            }
            TaskResult::Curve(curve) => Brought::Curve(curve.forcing().collect()),
            TaskResult::Nothing(outcome) => Brought::Nothing(*outcome),
        }
    }
}

/// What a task brought, without the curve itself.
#[derive(Debug, Clone, PartialEq)]
pub enum Brought {
    /// Forced responses, so many.
    Landings(usize),
    /// A branch that was not known.
    Branch {
        /// Its kind.
        kind: BranchKind,
        /// Number of its folds.
        folds: usize,
        /// Number of its branch points.
        branch_points: usize,
    },
    /// A curve that was not known: the forcing amplitudes of its points.
    Curve(Arc<[f64]>),
    /// What marching says of so many points of a branch, and the points of it whose unstable motions are worth following, with the
    /// frequencies of these.
    Verification(usize, Arc<[(usize, f64)]>),
    /// Where so many pushes of a scan end.
    Disturbance(usize),
    /// What an unstable motion turns into, after so many periods.
    Settling(usize),
    /// Nothing new, and why.
    Nothing(SeedOutcome),
}

impl Brought {
    /// A branch of this kind without folds or branch points.
    pub fn branch(kind: BranchKind) -> Self {
        Self::Branch { kind, folds: 0, branch_points: 0 }
    }
}

/// The windows of a level, backbone by backbone, each of a mode of its own, and its tasks in the order in which they are
/// carried out: the main branch from below and from above; then, window by window, both phases of every well with the
/// full forcing, and the same by steps in the forcing, each landed first; last, so many batches of random starts. Windows
/// beyond the bounds that the settings give are none of the study.
pub fn plan(
    backbones: &(impl AsRef<[Backbone]> + ?Sized),
    forcing: f64,
    bounds: &FrequencySettings,
    batches: usize,
) -> (Vec<Window>, Vec<Task>) {
    let is_within = |window: &Window| {
        bounds.min.is_none_or(|min| window.omega.1 >= min) && bounds.max.is_none_or(|max| window.omega.0 <= max)
    };
    let mut list = Vec::new();
    let mut tasks = vec![Task::Main(Side::Below), Task::Main(Side::Above)];
    for backbone in backbones.as_ref() {
        for window in windows(backbone, forcing).into_iter().filter(is_within) {
            let (number, wells) = (list.len(), window.wells(backbone));
            list.push(window);
            for method in [LandingMethod::FullForcing, LandingMethod::SteppedForcing] {
                for well in &wells {
                    let place = |phase| SeedPlace { window: number, well: *well, phase, method };
                    let places = [Phase::First, Phase::Second].map(place);
                    tasks.extend(places.into_iter().flat_map(|place| [Task::Land(place), Task::Seed(place)]));
                }
            }
        }
    }
    let starts = (0..batches).map(StartPlace::random);
    tasks.extend(starts.flat_map(Task::from_starts));
    (list, tasks)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seed() -> SeedPlace {
        let well = Window { mode: 0, first: 3, last: 9, best: 5, threshold: 0.5, omega: (1.0, 2.0) };
        SeedPlace { window: 0, well, phase: Phase::Second, method: LandingMethod::FullForcing }
    }

    #[test]
    fn tasks_of_before_read_and_are_written_as_before() {
        for (task, form) in [
            (Task::Main(Side::Below), r#""main""#.to_string()),
            (Task::Main(Side::Above), r#"{"main":"above"}"#.to_string()),
            (Task::Seed(seed()), format!(r#"{{"seed":{}}}"#, serde_json::to_string(&seed()).unwrap())),
        ] {
            assert_eq!(serde_json::to_string(&task).unwrap(), form);
            assert_eq!(serde_json::from_str::<Task>(&form).unwrap(), task);
        }
        for form in [r#""seed""#, "{}", r#"{"main":"above","seed":1}"#, r#"{"main":"left"}"#, r#"{"walk":1}"#] {
            assert!(serde_json::from_str::<Task>(form).is_err(), "{form}");
        }
    }
}
