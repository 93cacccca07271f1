//! Seeds: backbone motions shifted in time so that the forcing feeds in what is dissipated; landing on forced responses.

use crate::amplitude::through_motion;
use crate::backbone::Backbone;
use crate::forced::Forced;
use crate::melnikov::forcing_projection;
use crate::pressure::PressureForm;
use crate::problem::Failure;
use crate::state::State;
use crate::windows::Window;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The two time shifts per backbone point at which the forcing does the right work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// ψ = asin((R_lin + R_nl)/W).
    First,
    /// ψ = π − asin((R_lin + R_nl)/W).
    Second,
}

/// A predicted forced response.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Seed {
    /// Predicted motion at its frequency, with its forcing amplitude.
    pub state: State,
    /// Index of the backbone point it comes from.
    pub backbone_index: usize,
    /// Which of the two phases.
    pub phase: Phase,
}

/// Seed of a backbone point at forcing amplitude `amplitude`.
pub fn seed(problem: &PressureForm<'_>, backbone: &Backbone, index: usize, phase: Phase, amplitude: f64) -> Seed {
    let point = &backbone.points[index];
    let m = problem.model().forcing.harmonic as f64;
    let balance = (point.energies.balance() / amplitude).clamp(-1.0, 1.0).asin();
    let psi = match phase {
        Phase::First => balance,
        Phase::Second => std::f64::consts::PI - balance,
    };
    let shift = -(psi + forcing_projection(problem, &point.point.state).arg()) / m;
    let mut state = point.point.state.shifted(shift);
    (state.amplitude, state.decay) = (amplitude, 0.0);
    Seed { state, backbone_index: index, phase }
}

/// Landing no farther than this from its seed (relative distance) is a landing on what was predicted.
const NEAR: f64 = 0.3;

/// Why a seed did not lead to a forced response.
#[derive(Debug, Clone, Copy, PartialEq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LandingFailure {
    /// No point of the window converged.
    #[error("no seed of the window converged: {0}")]
    NotConverged(Failure),
    /// Every point that converged did so far from its prediction, this relative distance at best.
    #[error("every seed that converged ended far from its prediction (relative distance {0:.2} or more)")]
    Far(f64),
}

/// Lands on a forced response of a window at fixed frequency, from its most promising backbone points in turn.
pub fn land(
    forced: &mut Forced<'_>,
    backbone: &Backbone,
    window: &Window,
    phase: Phase,
    amplitude: f64,
) -> Result<State, LandingFailure> {
    attempt(&candidates(backbone, window, amplitude), |index| {
        let seed = seed(&forced.problem, backbone, index, phase, amplitude);
        let landed = forced.converge(&seed.state)?;
        let distance = forced.distance(&landed, &seed.state);
        Ok((landed, distance))
    })
}

/// Lands by fold-safe steps in the forcing amplitude, from where the energy balance just closes: slower than [`land`],
/// for windows where that finds nothing.
pub fn land_by_amplitude(
    forced: &mut Forced<'_>,
    backbone: &Backbone,
    window: &Window,
    phase: Phase,
    amplitude: f64,
) -> Result<State, LandingFailure> {
    let candidates = candidates(backbone, window, amplitude);
    // The best candidates are enough: a walk in A passes through the motions of the others.
    attempt(&candidates[..candidates.len().min(3)], |index| {
        let threshold = backbone.points[index].threshold.min(amplitude);
        let seed = seed(&forced.problem, backbone, index, phase, threshold);
        let mut best: Result<(State, f64), Failure> = Err(Failure::OutOfReach);
        for state in through_motion(forced.problem.model(), forced.settings(), amplitude, &seed.state)? {
            let landed = forced.converge(&state)?;
            let distance = forced.distance(&landed, &seed.state);
            if best.as_ref().is_ok_and(|best| best.1 <= distance) {
                continue;
            }
            best = Ok((landed, distance));
        }
        best
    })
}

/// Tries backbone points in turn; `land` gives a converged state and its distance from the seed.
fn attempt(
    candidates: &[usize],
    mut land: impl FnMut(usize) -> Result<(State, f64), Failure>,
) -> Result<State, LandingFailure> {
    let mut nearest = f64::INFINITY;
    let mut failure = Failure::Diverged;
    for &index in candidates {
        match land(index) {
            Ok((state, distance)) if distance <= NEAR => return Ok(state),
            Ok((_, distance)) => nearest = nearest.min(distance),
            Err(error) => failure = error,
        }
    }
    Err(if nearest.is_finite() { LandingFailure::Far(nearest) } else { LandingFailure::NotConverged(failure) })
}

/// Backbone points to try. Near the edges of a window, where A* is close to A, the forced response crosses the backbone
/// and the prediction is nearly exact; far inside, where the forcing exceeds what is dissipated many times, it is poor.
fn candidates(backbone: &Backbone, window: &Window, amplitude: f64) -> Vec<usize> {
    let nearest = |indices: std::ops::RangeInclusive<usize>, ratio: f64| {
        let distance = |i: usize| (backbone.points[i].threshold / amplitude - ratio).abs();
        indices.min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or(window.best)
    };
    let (left, right) = (window.first..=window.best, window.best..=window.last);
    let inner = nearest(right.clone(), 0.5);
    let edges = [nearest(right, 0.9), nearest(left, 0.9)];
    let span = (window.last - window.first) as f64;
    let between = [0.5, 0.25, 0.75].map(|share| window.first + (share * span).round() as usize);
    let mut list = Vec::new();
    for index in [inner].into_iter().chain(edges).chain([window.best]).chain(between) {
        if !list.contains(&index) {
            list.push(index);
        }
    }
    list
}
