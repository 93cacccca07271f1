//! Backbone: damped nonlinear normal mode of one mode, with its energies and modal contributions (paper [20–26]).

use crate::branch::{BranchPoint, Stop};
use crate::continuation::Continuation;
use crate::harmonics::width;
use crate::linear;
use crate::melnikov::{Criterion, Energies};
use crate::model::Model;
use crate::pressure::{PressureForm, Unknown};
use crate::problem::{Failure, Problem};
use crate::scales::Scales;
use crate::settings::{BackboneEquation, Settings};
use crate::state::State;
use crate::walk::{Bounds, Observer, Visited, insert_maxima, locate_maximum, walk};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A point of the backbone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BackbonePoint {
    /// Motion, amplitudes, contact, certificate.
    pub point: BranchPoint,
    /// Energy balance.
    pub energies: Energies,
    /// Threshold amplitude A*: forced responses are predicted here for A > A*.
    pub threshold: f64,
    /// Share of each mode: max |γ_j(t)| over a period, γ_j = Φ_jᵀ M x, divided by their sum (paper [35, 36]).
    pub contributions: Vec<f64>,
    /// Scaled arc length from the first point.
    pub arc: f64,
}

/// A damped nonlinear normal mode.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Backbone {
    /// Mode it starts from, from 0.
    pub mode: usize,
    /// Points along the arc.
    pub points: Vec<BackbonePoint>,
    /// Why it ended.
    pub stop: Stop,
    /// Steps refused and repeated shorter.
    pub rejections: usize,
}

/// Why there is no backbone at all.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BackboneError {
    /// Not even the first point, close to the linear mode, converged.
    #[error("the backbone of mode {mode} does not start at its linear mode ({omega:.6} rad/s): {failure}")]
    Start {
        /// Mode, from 1.
        mode: usize,
        /// Its eigenfrequency, rad/s.
        omega: f64,
        /// Why.
        failure: Failure,
    },
}

impl Backbone {
    /// Computes the backbone of `settings.backbone.mode`, telling `observer` of every point.
    pub fn compute(model: &Model, settings: &Settings, observer: &mut Observer<'_>) -> Result<Self, BackboneError> {
        let mode = settings.tracked();
        let scales = Scales::new(model, mode);
        let mut problem = PressureForm::new(
            model,
            settings.harmonics,
            mode,
            match settings.backbone.equation {
                BackboneEquation::DampedMode => Unknown::Mode { damped: true },
                BackboneEquation::ConservativeMode => Unknown::Mode { damped: false },
                BackboneEquation::PhaseResonance => Unknown::PhaseResonance,
            },
            scales,
        );
        let omega = model.modes.frequencies[mode];
        let start = match settings.backbone.equation {
            BackboneEquation::PhaseResonance => linear::forced_response(&problem, 1.0, omega)
                .map(|state| linear::below_first_touch(&problem, state))
                .map_err(|_| BackboneError::Start { mode: mode + 1, omega, failure: Failure::Singular })?,
            _ => linear::mode_motion(&problem, mode),
        };
        let y = problem.encode(&start);
        let direction = problem.growth(&y);
        let mut continuation = Continuation::start(&mut problem, y, &direction, settings.continuation)
            .map_err(|failure| BackboneError::Start { mode: mode + 1, omega, failure })?;
        let limits = &settings.backbone;
        let bounds = Bounds {
            frequency: (limits.min_frequency.unwrap_or(0.25 * omega), limits.max_frequency.unwrap_or(4.0 * omega)),
            amplitude: limits.max_amplitude.unwrap_or(8.0 * scales.length),
            points: limits.max_points,
            closure: None,
        };
        let (visited, stop) = walk(&mut continuation, &bounds, observer);
        let visited = with_threshold_extrema(&mut continuation, visited, limits.criterion);
        let rejections = continuation.rejections();
        let mut arc = 0.0;
        let points = visited
            .into_iter()
            .map(|visited| {
                arc += visited.curve.step;
                evaluate(continuation.problem(), visited, arc, limits.criterion)
            })
            .collect();
        Ok(Self { mode, points, stop, rejections })
    }

    /// Lowest and highest frequency, rad/s.
    pub fn frequency_range(&self) -> (f64, f64) {
        self.points
            .iter()
            .map(|p| p.point.omega())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), omega| (low.min(omega), high.max(omega)))
    }

    /// Largest amplitude of the first monitored dof, m.
    pub fn max_amplitude(&self) -> f64 {
        self.points.iter().map(|p| p.point.amplitude()).fold(0.0, f64::max)
    }
}

/// Inserts the minima and maxima of the threshold curve, located along the arc.
fn with_threshold_extrema(
    continuation: &mut Continuation<'_, PressureForm<'_>>,
    visited: Vec<Visited>,
    criterion: Criterion,
) -> Vec<Visited> {
    let log_threshold = |problem: &mut PressureForm<'_>, v: &Visited| {
        energies_at(problem, &v.curve.y, &v.point.state).threshold(criterion).ln()
    };
    let values: Vec<f64> = visited.iter().map(|v| log_threshold(continuation.problem(), v)).collect();
    let mut maxima = Vec::new();
    for i in 1..visited.len().saturating_sub(1) {
        let (before, here, after) = (values[i - 1], values[i], values[i + 1]);
        let sign = match (here < before && here <= after, here > before && here >= after) {
            (true, _) => -1.0,
            (_, true) => 1.0,
            _ => continue,
        };
        let arcs = (visited[i].curve.step, visited[i + 1].curve.step);
        let values = [before, here, after].map(|v| sign * v);
        let measure = move |problem: &mut PressureForm<'_>, v: &Visited| sign * log_threshold(problem, v);
        maxima.push(locate_maximum(continuation, &visited, i, arcs, values, &measure));
    }
    insert_maxima(visited, maxima).0
}

/// Energies at a converged scaled state.
fn energies_at(problem: &mut PressureForm<'_>, y: &[f64], state: &State) -> Energies {
    problem.linearise(&mut y.to_vec());
    Energies::evaluate(problem, state)
}

fn evaluate(problem: &mut PressureForm<'_>, visited: Visited, arc: f64, criterion: Criterion) -> BackbonePoint {
    let energies = energies_at(problem, &visited.curve.y, &visited.point.state);
    let nc = width(visited.point.state.harmonics);
    let maxima: Vec<f64> = visited.point.state.modal.chunks(nc).map(|series| problem.aft().max_abs(series)).collect();
    let sum: f64 = maxima.iter().sum();
    let contributions = maxima.iter().map(|m| m / sum).collect();
    BackbonePoint { point: visited.point, threshold: energies.threshold(criterion), energies, contributions, arc }
}
