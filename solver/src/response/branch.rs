//! Forced-response branches: points, special points, outcome.

use crate::curve::continuation::CurvePoint;
pub use crate::curve::outcome::{Outcome, Stop};
use crate::curve::walk::{self, Evaluated};
use crate::formulation::Formulation;
use crate::formulation::state::State;
pub use crate::response::certificate::{Certificate, Standing};
use crate::response::columns::{self, Row};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Points that are as near as this, relative to themselves, have no distance that means anything.
const ROUNDED: f64 = 1e-6;

/// Share of the largest amplitude of a branch from which on that of another point is comparable to it.
const COMPARABLE: f64 = 0.5;

/// A periodic solution on a branch or on the backbone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BranchPoint {
    /// Harmonics, ω, ζ and A.
    pub state: State,
    /// What else is known of it: [`columns::of_points`].
    pub values: Row,
}

/// A point of a walk: as the continuation needs it and as people do.
pub type TracedPoint = walk::TracedPoint<BranchPoint>;

/// Told of every point that continuation steps to (not of the first one); breaking cancels it.
pub type Observer<'o> = walk::Observer<'o, BranchPoint>;

impl<'m, F: Formulation<'m>> Evaluated<F> for BranchPoint {
    fn evaluate(problem: &mut F, point: &CurvePoint) -> Self {
        let state = problem.decode(&point.y).expect("it converged, so it can be evaluated");
        let values = Row::of_point(problem.model(), problem.aft(), point, &state);
        Self { state, values }
    }

    fn omega(&self) -> f64 {
        self.state.omega
    }

    fn amplitude(&self) -> f64 {
        self.values.first(columns::AMPLITUDE)
    }
}

impl BranchPoint {
    /// Amplitude of the first monitored dof: maximum of |x| over the period, between samples too, m.
    pub fn amplitude(&self) -> f64 {
        self.values.first(columns::AMPLITUDE)
    }

    /// Amplitudes of the monitored dofs, in the model's order, m.
    pub fn amplitudes(&self) -> &[f64] {
        self.values.all(columns::AMPLITUDE)
    }

    /// Share of the period in contact, per contact element.
    pub fn contact(&self) -> &[f64] {
        self.values.all(columns::CONTACT)
    }

    /// Largest scaled residual.
    pub fn residual(&self) -> f64 {
        self.values.first(columns::RESIDUAL)
    }

    /// Frequency ω, rad/s.
    pub fn omega(&self) -> f64 {
        self.state.omega
    }
}

/// What kind of branch it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BranchKind {
    /// Ordinary continuation reaches it: from the linear range below or above.
    Main,
    /// A closed curve.
    Isola,
    /// Detached, and leaves through the widest frequency bounds at both ends: a permanently pressed response, say.
    Open,
    /// Leaves through bounds that were given: whether it is detached is not known.
    Cut,
    /// Branches off other responses, of higher symmetry or shorter period: one of asymmetric motions, or a period-doubled one, say.
    Branched,
    /// Stalled, turned back along itself, used up its points or was cancelled: it goes on where it ends.
    Unfinished,
}

impl BranchKind {
    /// All kinds, in the order in which they are listed.
    pub const ALL: [Self; 6] = [Self::Main, Self::Isola, Self::Open, Self::Cut, Self::Branched, Self::Unfinished];

    /// The kind of a branch that was not reached from the linear range; `is_cut` tells whether it ends at a bound that was given.
    pub fn of_detached(outcome: &Outcome, is_cut: bool) -> Self {
        let is_bound = |stop: &Stop| matches!(stop, Stop::FrequencyBound | Stop::AmplitudeBound);
        match outcome {
            Outcome::Closed => Self::Isola,
            Outcome::Open(..) if outcome.is_branched() && !outcome.is_unfinished() => Self::Branched,
            Outcome::Open(first, last) if !(is_bound(first) && is_bound(last)) => Self::Unfinished,
            Outcome::Open(..) if is_cut => Self::Cut,
            Outcome::Open(Stop::FrequencyBound, Stop::FrequencyBound) => Self::Open,
            Outcome::Open(..) => Self::Unfinished,
        }
    }

    /// Its name in files and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Main => "main",
            Self::Isola => "isola",
            Self::Open => "open",
            Self::Cut => "cut",
            Self::Branched => "branched",
            Self::Unfinished => "unfinished",
        }
    }

    /// The kind of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

impl std::fmt::Display for BranchKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// At which end of the frequency range a main branch is entered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// At the lower bound, upwards.
    Below,
    /// At the upper bound, downwards.
    Above,
}

/// What a special point is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SpecialKind {
    /// Where the branch was entered: in the linear regime or at a landed seed.
    Start,
    /// Largest amplitude of the first monitored dof.
    Peak,
    /// Turning point in frequency.
    Fold,
    /// Where another branch crosses: between this point and the next the determinant of the Jacobian bordered by the tangent
    /// changes its sign.
    BranchPoint,
}

/// A special point: its kind and its index among the branch's points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct SpecialPoint {
    /// Kind.
    pub kind: SpecialKind,
    /// Index into [`Branch::points`].
    pub index: usize,
}

/// A forced-response branch at one forcing amplitude.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Branch {
    /// What kind of branch it is.
    pub kind: BranchKind,
    /// Forcing amplitude A.
    pub forcing: f64,
    /// Points in the order of the arc; a closed branch does not repeat its first point.
    pub points: Vec<BranchPoint>,
    /// Special points, in the order of the arc; folds and peak are located along the arc to 1e-6 relative (unless the
    /// corrector fails between the points there).
    pub special: Vec<SpecialPoint>,
    /// How it ends.
    pub outcome: Outcome,
    /// Steps that were refused and repeated shorter.
    pub rejections: usize,
    /// What is known of the harmonics that were left out.
    pub certificate: Certificate,
}

impl Branch {
    /// Whether the branch is a closed curve.
    pub fn is_closed(&self) -> bool {
        self.outcome == Outcome::Closed
    }

    /// Whether it ends where it branches off others.
    pub fn is_branched(&self) -> bool {
        self.outcome.is_branched()
    }

    /// The same, known to cross another one: neither detached nor a piece of a main branch.
    pub(super) fn branching_off(self) -> Self {
        let is_piece = self.kind == BranchKind::Main && self.is_joined();
        let is_detached = is_piece || matches!(self.kind, BranchKind::Isola | BranchKind::Open | BranchKind::Cut);
        let kind = if is_detached { BranchKind::Branched } else { self.kind };
        Self { kind, ..self }
    }

    /// Whether it ends at a branch that was known before it.
    pub fn is_joined(&self) -> bool {
        matches!(self.outcome, Outcome::Open(first, last) if [first, last].contains(&Stop::Joined))
    }

    /// Whether continuation failed at an end, or turned back along the curve there.
    pub(super) fn breaks_off(&self) -> bool {
        let fails = |stop: Stop| matches!(stop, Stop::Stalled(_) | Stop::Reversed);
        matches!(self.outcome, Outcome::Open(first, last) if fails(first) || fails(last))
    }

    /// Whether whoever observed it asked to stop.
    pub fn is_cancelled(&self) -> bool {
        matches!(self.outcome, Outcome::Open(first, last) if [first, last].contains(&Stop::Cancelled))
    }

    /// The values of the column of this name at every point; `None` if there is no such column, or a point is without.
    pub fn column(&self, name: &str) -> Option<Vec<&[f64]>> {
        let place = columns::of_points().position(|column| column.name == name)?;
        self.points.iter().map(|point| point.values.get(place)).collect()
    }

    /// Lowest and highest frequency, rad/s.
    pub fn frequency_range(&self) -> (f64, f64) {
        self.points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
            (low.min(point.omega()), high.max(point.omega()))
        })
    }

    /// Point of largest amplitude of the first monitored dof.
    pub fn peak(&self) -> &BranchPoint {
        &self.points[self.peak_index()]
    }

    /// Whether its amplitude is that of a maximum, or only as far as the branch is known.
    pub fn peak_standing(&self) -> Standing {
        if self.rises_through_a_bound() {
            return Standing::AtLeast;
        }
        let end = self.end_at_peak().unwrap_or_else(|| self.peak_index());
        Standing::of_peak(&self.outcome, end, self.points.len())
    }

    /// Whether it leaves through a bound of the frequency growing, with an amplitude that is comparable to its largest one: not far beyond
    /// it may be larger.
    fn rises_through_a_bound(&self) -> bool {
        let (Outcome::Open(first, last), [begin, next, .., before, end]) = (self.outcome, &self.points[..]) else {
            return false;
        };
        let comparable = COMPARABLE * self.peak().amplitude();
        [(first, begin, next), (last, end, before)].into_iter().any(|(stop, end, inner)| {
            stop == Stop::FrequencyBound
                && end.amplitude() > comparable
                && end.amplitude() > inner.amplitude() * (1.0 + ROUNDED)
        })
    }

    /// The end of an open branch whose point its peak is, but for rounding: the last step to a bound may be of no length.
    pub(super) fn end_at_peak(&self) -> Option<usize> {
        let peak = self.peak();
        let is_near = |a: f64, b: f64| (a - b).abs() <= ROUNDED * b.abs();
        let ends = [0, self.points.len().checked_sub(1)?];
        ends.into_iter().filter(|_| !self.is_closed()).find(|&end| {
            let point = &self.points[end];
            is_near(point.amplitude(), peak.amplitude()) && is_near(point.omega(), peak.omega())
        })
    }

    /// Keeps these points only; the peak is the highest of them.
    pub(super) fn keep(&mut self, kept: Range<usize>) {
        self.points.truncate(kept.end);
        self.points.drain(..kept.start);
        self.special.retain(|special| special.kind != SpecialKind::Peak && kept.contains(&special.index));
        self.special.iter_mut().for_each(|special| special.index -= kept.start);
        let index = self.peak_index();
        self.special.push(SpecialPoint { kind: SpecialKind::Peak, index });
        self.special.sort_by_key(|special| special.index);
    }

    /// Number of that point.
    pub fn peak_index(&self) -> usize {
        let amplitude = |i: usize| self.points[i].amplitude();
        let best = (0..self.points.len()).max_by(|&a, &b| amplitude(a).total_cmp(&amplitude(b)));
        best.expect("a branch has at least its start")
    }

    /// Numbers of the points at which it turns in frequency, in the order of the arc.
    pub fn folds(&self) -> impl Iterator<Item = usize> {
        self.special.iter().filter(|special| special.kind == SpecialKind::Fold).map(|special| special.index)
    }

    /// Special points of one kind.
    pub fn special(&self, kind: SpecialKind) -> impl Iterator<Item = &BranchPoint> {
        self.special.iter().filter(move |s| s.kind == kind).map(|s| &self.points[s.index])
    }
}
