//! What an unstable motion turns into: marched on from a point of a branch until it settles, and named for what it has become.

mod course;

use super::bifurcation::BifurcationKind;
use super::multipliers::Verdict;
use super::polish::{Around, PolishSettings, polish};
use super::shooting::{Orbit, Shooting};
use super::verification::{BifurcationPoint, Verification};
use crate::formulation::state::State;
use crate::response::branch::Branch;
use crate::response::task::{BranchId, MarchPlace};
use crate::structure::Model;
use course::{Course, Found};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// How long a motion is marched, and how it is told what it is.
#[derive(Debug, Clone, PartialEq)]
pub struct SettleSettings {
    /// Most periods that it has to become periodic.
    pub transient: usize,
    /// Periods of a motion that did not, over which it is described.
    pub record: usize,
    /// Most periods after which a motion repeats itself that are told.
    pub repeats: usize,
}

impl Default for SettleSettings {
    fn default() -> Self {
        Self { transient: 1000, record: 300, repeats: 16 }
    }
}

/// Most points of a stretch without stability that motions are followed from.
const POINTS: usize = 6;

/// More periods than any motion is marched, and more branches than any level has.
const MOST: usize = 1 << 20;

/// What a motion is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// It repeats itself after so many periods of the response.
    Periodic(usize),
    /// It does not repeat itself, and small deviations neither grow nor die out.
    QuasiPeriodic,
    /// It does not repeat itself, and small deviations grow.
    Chaotic,
}

impl std::fmt::Display for Motion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Periodic(count) => write!(f, "period {count}"),
            Self::QuasiPeriodic => f.write_str("quasi-periodic"),
            Self::Chaotic => f.write_str("chaotic"),
        }
    }
}

/// What an unstable motion of a branch turns into.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settling {
    /// Number of the point on the branch.
    pub index: usize,
    /// Frequency ω, rad/s.
    pub omega: f64,
    /// What it becomes; `None` if it could not be marched, or that is not clear.
    pub motion: Option<Motion>,
    /// The branch on whose marched orbit it ends, if it is one of those that were found.
    pub onto: Option<BranchId>,
    /// Smallest and largest of the largest |x| in a period, of each monitored dof, m; empty if it could not be marched.
    pub amplitudes: Vec<[f64; 2]>,
    /// Growth rate of small deviations per period (the largest Lyapunov exponent times the period) of a motion that does not
    /// repeat itself.
    pub growth: Option<f64>,
    /// Periods that were marched.
    pub periods: usize,
}

impl Settling {
    /// Whether it can be what a model with so many monitored dofs turns to from `place`.
    pub fn is_sound(&self, place: &MarchPlace, monitors: usize) -> bool {
        let range = |[low, high]: &[f64; 2]| 0.0 <= *low && low <= high && high.is_finite();
        let repeats = |motion| match motion {
            Motion::Periodic(count) => (1..=MOST).contains(&count),
            Motion::QuasiPeriodic | Motion::Chaotic => true,
        };
        self.index == place.index
            && self.omega == place.omega
            && (self.amplitudes.is_empty() || self.amplitudes.len() == monitors)
            && self.amplitudes.iter().all(range)
            && (self.motion.is_none() || !self.amplitudes.is_empty())
            && (self.onto.is_none() || self.motion == Some(Motion::Periodic(1)))
            && self.onto.is_none_or(|branch| branch.number < MOST)
            && self.motion.is_none_or(repeats)
            && self.periods <= MOST
            && self.growth.is_none_or(f64::is_finite)
    }
}

/// Told of every period that was marched: ω and the largest |x| of the first monitored dof; breaking cancels the rest.
pub type PeriodObserver<'o> = dyn FnMut(f64, f64) -> ControlFlow<()> + 'o;

impl Verification {
    /// Points from which unstable motions are worth following: between a bifurcation at which the branch loses its stability to
    /// motions of less symmetry, of twice the period or of another frequency, and the next fold; of a branch that is unstable wherever
    /// that is known, as where the structure vibrates by itself, any. With the frequencies of their orbits.
    pub fn unsettled(&self) -> Vec<(usize, f64)> {
        let mut found = Vec::new();
        if !self.is_sound(self.monitors()) {
            return found;
        }
        for bifurcation in &self.bifurcations {
            let leads_on = !matches!(bifurcation.kind, BifurcationKind::Fold | BifurcationKind::Grazing);
            if leads_on && bifurcation.outside.contains(&0) {
                found.extend(self.beyond(bifurcation));
            }
        }
        if self.points.iter().all(|point| !matches!(point.verdict, Verdict::Stable | Verdict::Marginal))
            && found.is_empty()
        {
            let all = (0..self.points.len()).filter(|&at| self.points[at].verdict == Verdict::Unstable);
            found.extend(self.spread(&all.collect::<Vec<_>>()));
        }
        found.sort_unstable_by_key(|&(index, _)| index);
        found.dedup_by_key(|&mut (index, _)| index);
        found
    }

    /// Points of the unstable stretch on one side of a bifurcation, evenly spread.
    fn beyond(&self, bifurcation: &BifurcationPoint) -> Vec<(usize, f64)> {
        let is_forward = bifurcation.outside[0] == 0;
        let (points, count) = (&self.points, self.points.len());
        let after = |at: usize| if at < count { Some(at) } else { (self.goes_round() && count > 0).then_some(0) };
        let before =
            |at: usize| if at > 0 { Some(at - 1) } else { (self.goes_round() && count > 0).then(|| count - 1) };
        let next = points.partition_point(|point| point.index <= bifurcation.after);
        let first = if is_forward { after(next) } else { before(next) };
        let is_fold_between = |at: usize, next: usize| {
            let (a, b) = if is_forward { (at, next) } else { (next, at) };
            let mut folds = self.bifurcations.iter().filter(|found| found.kind == BifurcationKind::Fold);
            folds.any(|fold| self.is_between(points[a].index, points[b].index, fold.after))
        };
        let is_unstable = |at: &usize| points[*at].verdict == Verdict::Unstable;
        let step = |&at: &usize| {
            let next = if is_forward { after(at + 1) } else { before(at) };
            next.filter(is_unstable).filter(|&next| Some(next) != first && !is_fold_between(at, next))
        };
        let stretch: Vec<usize> = std::iter::successors(first.filter(is_unstable), step).collect();
        self.spread(&stretch)
    }

    /// Some of these verified points, evenly spread, as those from which motions are followed.
    fn spread(&self, points: &[usize]) -> Vec<(usize, f64)> {
        let taken = points.len().min(POINTS);
        let taken = (0..taken).map(|i| &self.points[points[i * points.len() / taken]]);
        taken.filter_map(|point| Some((point.index, point.orbit.as_ref()?.omega))).collect()
    }
}

/// Marches on from the unstable orbit near a point of a branch until it settles, or is known not to; `known` are the branches of
/// the level. `None` if the observer breaks.
///
/// # Panics
/// If the branch does not have that point.
pub fn settle(
    model: &Model,
    settings: &SettleSettings,
    known: &[(BranchId, &Branch)],
    branch: &Branch,
    place: &MarchPlace,
    observer: &mut PeriodObserver<'_>,
) -> Option<Settling> {
    let nothing = |periods| Settling {
        index: place.index,
        omega: place.omega,
        motion: None,
        onto: None,
        amplitudes: Vec::new(),
        growth: None,
        periods,
    };
    let Some(mut course) = start(model, branch, place).and_then(|orbit| Course::new(model, &orbit).ok()) else {
        return Some(nothing(0));
    };
    match course.run(settings, observer) {
        Ok(None) => None,
        Ok(Some(Found { motion, range, growth })) => {
            let onto = (motion == Some(Motion::Periodic(1))).then(|| course.owner(known)).flatten();
            Some(Settling { motion, onto, amplitudes: range.0, growth, ..nothing(course.periods()) })
        }
        Err(_) => Some(nothing(course.periods())),
    }
}

/// The unstable marched orbit near a point of a branch; where it is not met again, the motion of the balance.
fn start(model: &Model, branch: &Branch, place: &MarchPlace) -> Option<Orbit> {
    let settings = PolishSettings::default();
    let state = State { omega: place.omega, ..branch.points[place.index].state.clone() };
    let found = polish(model, &settings, &state, Around::default());
    let unstable = found.polished.filter(|_| found.verdict == Verdict::Unstable).map(|polished| polished.orbit);
    unstable.or_else(|| {
        let shooting = Shooting::new(model, &settings.marching, &state).ok()?;
        (shooting.work() <= settings.work).then_some(())?;
        Some(shooting.orbit(&shooting.point_of(&state).ok()?))
    })
}
