//! Seeds: backbone motions shifted in time so that the forcing feeds in what is dissipated; landing on forced responses.

use crate::backbone::Backbone;
use crate::forced::Forced;
use crate::melnikov::forcing_projection;
use crate::pressure::PressureForm;
use crate::problem::Failure;
use crate::state::State;
use crate::windows::Window;
use serde::{Deserialize, Serialize};

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
    /// Index of its window.
    pub window: usize,
    /// Which of the two phases.
    pub phase: Phase,
}

/// Seed of a backbone point at forcing amplitude `amplitude`.
pub fn seed(
    problem: &PressureForm<'_>,
    backbone: &Backbone,
    index: usize,
    window: usize,
    phase: Phase,
    amplitude: f64,
) -> Seed {
    let point = &backbone.points[index];
    let m = problem.model().forcing.harmonic as f64;
    let balance = (point.energies.signed_threshold() / amplitude).clamp(-1.0, 1.0).asin();
    let psi = match phase {
        Phase::First => balance,
        Phase::Second => std::f64::consts::PI - balance,
    };
    let shift = -(psi + forcing_projection(problem, &point.point.state).arg()) / m;
    let mut state = point.point.state.shifted(shift);
    (state.amplitude, state.decay) = (amplitude, 0.0);
    Seed { state, backbone_index: index, window, phase }
}

/// Landing no farther than this from its seed (relative distance) is a landing on what was predicted.
const NEAR: f64 = 0.3;

/// A forced response found from a window.
#[derive(Debug, Clone, PartialEq)]
pub enum Landing {
    /// Near a seed.
    Near(Seed, State),
    /// Converged, but far from every seed of the window.
    Far(Seed, State),
}

/// Lands on a forced response of a window: from its best point, from others, by a fold-safe step in A.
pub fn land(
    forced: &mut Forced<'_>,
    backbone: &Backbone,
    window: &Window,
    window_index: usize,
    phase: Phase,
    amplitude: f64,
) -> Result<Landing, Failure> {
    let mut failure = Failure::Diverged;
    let mut far = None;
    for index in candidates(window) {
        let seed = seed(&forced.problem, backbone, index, window_index, phase, amplitude);
        match forced.converge(&seed.state) {
            Ok(landed) if forced.distance(&landed, &seed.state) <= NEAR => return Ok(Landing::Near(seed, landed)),
            Ok(landed) => far = far.or(Some((seed, landed))),
            Err(error) => failure = error,
        }
    }
    match far {
        Some((seed, landed)) => Ok(Landing::Far(seed, landed)),
        None => Err(failure),
    }
}

/// Backbone points to try, the best one first.
fn candidates(window: &Window) -> Vec<usize> {
    let span = (window.last - window.first) as f64;
    let mut list = vec![window.best];
    for share in [0.5, 0.25, 0.75, 0.1, 0.9] {
        let index = window.first + (share * span).round() as usize;
        if !list.contains(&index) {
            list.push(index);
        }
    }
    list
}
