//! Forced-response branches: points, special points, outcome.

use crate::curve::continuation::CurvePoint;
pub use crate::curve::outcome::{Outcome, Stop};
use crate::curve::walk::{self, Evaluated};
use crate::formulation::Formulation;
use crate::formulation::harmonics::{rms, width};
use crate::formulation::state::State;
use crate::structure::laws::{Law, LawKind};
use serde::{Deserialize, Serialize};

/// Amplitude and root mean square of a monitored dof, in m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Monitored {
    /// Maximum of |x| over the period, between samples too.
    pub amplitude: f64,
    /// Root mean square over the period.
    pub rms: f64,
}

/// What tells whether a point can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    /// Largest scaled residual.
    pub residual: f64,
    /// Share of the two highest harmonics in the norm of the modal amplitudes.
    pub high_harmonics: f64,
    /// Newton iterations.
    pub iterations: usize,
}

/// A periodic solution on a branch or on the backbone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BranchPoint {
    /// Harmonics, ω, ζ and A.
    pub state: State,
    /// Monitored dofs, in the model's order.
    pub monitors: Vec<Monitored>,
    /// Share of the period in contact, per contact element.
    pub contact: Vec<f64>,
    /// Certificate.
    pub certificate: Certificate,
}

/// A point of a walk: as the continuation needs it and as people do.
pub type Visited = walk::Visited<BranchPoint>;

/// Told of every point that continuation steps to (not of the first one); breaking cancels it.
pub type Observer<'o> = walk::Observer<'o, BranchPoint>;

impl<'m, F: Formulation<'m>> Evaluated<F> for BranchPoint {
    fn evaluate(problem: &mut F, point: &CurvePoint) -> Self {
        let state = problem.decode(&point.y).expect("it converged, so it can be evaluated");
        let model = problem.model();
        let nc = width(state.harmonics);
        let monitors = model
            .monitors()
            .iter()
            .map(|&dof| {
                let series = state.displacement(model, dof);
                Monitored { amplitude: problem.aft().max_abs(&series), rms: rms(&series) }
            })
            .collect();
        let mut contact = Vec::new();
        let mut first = 0;
        for element in model.elements() {
            if matches!(element.law, LawKind::Contact(_)) {
                contact.push(problem.aft().coverage(&state.arguments[first * nc..(first + 1) * nc], 0.0).fraction());
            }
            first += element.law.arguments();
        }
        let energy =
            |from: usize| -> f64 { state.modal.chunks(nc).flat_map(|series| &series[from..]).map(|c| c * c).sum() };
        let high = if state.harmonics >= 2 { energy(nc - 4) / energy(0) } else { 1.0 };
        let certificate = Certificate {
            residual: point.residual,
            high_harmonics: if high.is_finite() { high.sqrt() } else { 0.0 },
            iterations: point.iterations,
        };
        Self { state, monitors, contact, certificate }
    }

    fn omega(&self) -> f64 {
        self.state.omega
    }

    fn amplitude(&self) -> f64 {
        self.monitors[0].amplitude
    }
}

impl BranchPoint {
    /// Amplitude of the first monitored dof, in m.
    pub fn amplitude(&self) -> f64 {
        self.monitors[0].amplitude
    }

    /// Frequency ω, rad/s.
    pub fn omega(&self) -> f64 {
        self.state.omega
    }
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
}

impl Branch {
    /// Whether the branch is a closed curve.
    pub fn is_closed(&self) -> bool {
        self.outcome == Outcome::Closed
    }

    /// Whether whoever observed it asked to stop.
    pub fn is_cancelled(&self) -> bool {
        matches!(self.outcome, Outcome::Open(first, last) if [first, last].contains(&Stop::Cancelled))
    }

    /// Lowest and highest frequency, rad/s.
    pub fn frequency_range(&self) -> (f64, f64) {
        self.points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
            (low.min(point.omega()), high.max(point.omega()))
        })
    }

    /// Point of largest amplitude of the first monitored dof.
    pub fn peak(&self) -> &BranchPoint {
        let best = self.points.iter().max_by(|a, b| a.amplitude().total_cmp(&b.amplitude()));
        best.expect("a branch has at least its start")
    }

    /// Special points of one kind.
    pub fn special(&self, kind: SpecialKind) -> impl Iterator<Item = &BranchPoint> {
        self.special.iter().filter(move |s| s.kind == kind).map(|s| &self.points[s.index])
    }
}
