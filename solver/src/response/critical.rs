//! What is known of curves over the forcing amplitude, of folds, peaks or responses at fixed frequency: their points, the extrema
//! of A along them, how they end, and why there may be none.

use crate::curve::problem::Failure;
use crate::formulation::FormulationError;
pub use crate::formulation::unknown::Quantity;
use crate::response::branch::{BranchPoint, Outcome, Stop};
use crate::settings::SettingsError;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Within which forcing amplitudes and frequencies a curve is followed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Extent {
    /// Lowest and highest forcing amplitude A.
    pub forcing: (f64, f64),
    /// Lowest and highest frequency, rad/s.
    pub frequency: (f64, f64),
    /// Largest number of points in each direction.
    pub points: usize,
}

/// What an extremum of A along a fold or peak curve is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CriticalKind {
    /// An isola is born: below this A it is not there.
    Birth,
    /// An isola shrinks to a point: above this A it is not there.
    Death,
    /// Two branches, or two parts of one, meet.
    Merge,
    /// Two folds (or a maximum and a minimum) of one branch meet and vanish: no branch is born or merges.
    Cusp,
    /// Not told: next to a corner of the curve (a contact begins or ends), or the corrector failed next to it.
    Unknown,
}

impl CriticalKind {
    /// Its name in files and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Birth => "birth",
            Self::Death => "death",
            Self::Merge => "merge",
            Self::Cusp => "cusp",
            Self::Unknown => "unknown",
        }
    }
}

/// An extremum of A along a fold or peak curve, located to rounding unless its kind is unknown.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CriticalEvent {
    /// What it is.
    pub kind: CriticalKind,
    /// Index into [`CriticalCurve::points`].
    pub index: usize,
    /// Of a birth, death or merge on a curve of folds: A and ω, rad/s, with twice the harmonics. Nothing if it was not found near there.
    #[serde(default)]
    pub doubled: Option<(f64, f64)>,
}

/// A corner of a fold or peak curve: there a contact begins or ends (grazing). The curve is continuous, its tangent is not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Corner {
    /// Index into [`CriticalCurve::points`]: the corner itself.
    pub index: usize,
    /// The element whose contact begins or ends there, by its number in the model.
    pub element: usize,
}

/// A curve of folds or peaks, or of responses at fixed frequency.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CriticalCurve {
    /// What has an extremum at its points, along the branch at each point's own A; nothing at fixed frequency.
    pub quantity: Option<Quantity>,
    /// Points in the order of the arc, extrema of A among them; a closed curve does not repeat its first point. Where the
    /// curve leaves the range of forcing amplitudes, its last point lies at the bound.
    pub points: Vec<BranchPoint>,
    /// Extrema of A, in the order of the arc; none of a curve at fixed frequency, where branches turn in A and nothing is born.
    pub events: Vec<CriticalEvent>,
    /// Its corners, in the order of the arc: those at which it stalled and beyond which it was taken up again, and those that a
    /// step had led past. An extremum of A at a corner is a cusp: two folds meet there and vanish.
    #[serde(default)]
    pub corners: Vec<Corner>,
    /// How it begins and ends.
    pub outcome: Outcome,
    /// For both ends, if the curve stalled there: the element, by its number in the model, that is about to act or to cease
    /// (grazing). There first derivatives vary like a square root or jump, and no way past it was found.
    pub grazing: [Option<usize>; 2],
    /// Steps refused and repeated shorter.
    pub rejections: usize,
}

impl CriticalCurve {
    /// What its points are, in a word: `fold`, `peak` or `response`.
    pub fn of(&self) -> &'static str {
        name(self.quantity)
    }

    /// Its events of one kind.
    pub fn events(&self, kind: CriticalKind) -> impl Iterator<Item = &BranchPoint> {
        self.events.iter().filter(move |event| event.kind == kind).map(|event| &self.points[event.index])
    }

    /// Forcing amplitudes of its points, of a closed curve the first one again.
    pub fn forcing(&self) -> impl Iterator<Item = f64> {
        let last = if self.is_closed() { self.points.first() } else { None };
        self.points.iter().chain(last).map(|point| point.state.forcing)
    }

    /// Lowest and highest forcing amplitude.
    pub fn forcing_range(&self) -> (f64, f64) {
        self.points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
            (low.min(point.state.forcing), high.max(point.state.forcing))
        })
    }

    /// Whether whoever observed it asked to stop.
    pub fn is_cancelled(&self) -> bool {
        matches!(self.outcome, Outcome::Open(first, last) if first == Stop::Cancelled || last == Stop::Cancelled)
    }

    /// Whether it is a closed curve.
    pub fn is_closed(&self) -> bool {
        self.outcome == Outcome::Closed
    }

    /// Neighbouring points, of a closed curve the last and the first as well.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (&BranchPoint, &BranchPoint)> {
        let last = if self.is_closed() { self.points.first() } else { None };
        self.points.iter().zip(self.points.iter().skip(1).chain(last))
    }
}

/// What the points of a curve are, in a word.
pub const fn name(quantity: Option<Quantity>) -> &'static str {
    match quantity {
        Some(quantity) => quantity.extremum(),
        None => "response",
    }
}

/// Why there is no curve at all.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CriticalError {
    /// A setting is out of its range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// A law has no second derivatives.
    #[error(transparent)]
    Formulation(#[from] FormulationError),
    /// No point of the curve was found near the start.
    #[error("no {} near {omega:.6} rad/s at A = {forcing}: {failure}", name(*quantity))]
    Start {
        /// What was to have an extremum.
        quantity: Option<Quantity>,
        /// Frequency of the start, rad/s.
        omega: f64,
        /// Its forcing amplitude.
        forcing: f64,
        /// Why.
        failure: Failure,
    },
    /// What was found near the start is a different response.
    #[error("no {} near {omega:.6} rad/s at A = {forcing}: the nearest is another response", name(*quantity))]
    Elsewhere {
        /// What was to have an extremum.
        quantity: Option<Quantity>,
        /// Frequency of the start, rad/s.
        omega: f64,
        /// Its forcing amplitude.
        forcing: f64,
    },
}

/// Where a curve whose points have these forcing amplitudes (see [`CriticalCurve::forcing`]) crosses `forcing`: the points
/// before.
pub fn crossed(amplitudes: &[f64], forcing: f64) -> impl Iterator<Item = usize> {
    let crosses = move |pair: &[f64]| (pair[0] > forcing) != (pair[1] > forcing);
    amplitudes.windows(2).enumerate().filter(move |(_, pair)| crosses(pair)).map(|(segment, _)| segment)
}
