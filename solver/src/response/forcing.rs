//! Continuation in the forcing amplitude at fixed frequency: the linear start of a main branch that already touches, and
//! the fold-safe way from a backbone motion to a forced response.

use crate::curve::continuation::{Continuation, ContinuationSettings};
use crate::curve::problem::Failure;
use crate::formulation::linear::{below_first_touch, forced_response};
use crate::formulation::pressure::PressureForm;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::response::walk::interpolate;
use crate::settings::Settings;
use crate::structure::Model;

/// Largest step of a walk in A, whose points are not kept.
const LARGEST_STEP: f64 = 0.3;

/// Points of a walk in A before giving up.
const BUDGET: usize = 200;

/// State close to the forced response at amplitude `forcing` and frequency `omega`, continued in A from the linear
/// response to a small forcing.
pub fn from_rest(model: &Model, settings: &Settings, forcing: f64, omega: f64) -> Result<State, Failure> {
    let mut problem = system(model, settings, forcing, omega);
    let linear = forced_response(&problem, forcing, omega).map_err(|_| Failure::Singular)?;
    let start = below_first_touch(&problem, linear);
    let upwards = problem.parameter_row();
    follow_to(&mut problem, settings, &start, &upwards, forcing)
}

/// States near forcing amplitude `forcing` on the curve in A through a predicted motion: the curve is entered at the
/// motion's own size, with A free, and followed both ways over its fold in A.
pub fn through_motion(model: &Model, settings: &Settings, forcing: f64, motion: &State) -> Result<Vec<State>, Failure> {
    let mut problem = system(model, settings, forcing, motion.omega);
    let y = problem.encode(motion);
    let growth = problem.growth(&y);
    let shrink: Vec<f64> = growth.iter().map(|g| -g).collect();
    let mut found = Vec::new();
    let mut failure = Failure::Diverged;
    for direction in [growth, shrink] {
        match follow_to(&mut problem, settings, motion, &direction, forcing) {
            Ok(state) => found.push(state),
            Err(error) => failure = error,
        }
    }
    if found.is_empty() { Err(failure) } else { Ok(found) }
}

/// The system with A free, A measured in units of the amplitude wanted.
fn system<'m>(model: &'m Model, settings: &Settings, forcing: f64, omega: f64) -> PressureForm<'m> {
    let scales = Scales { forcing: forcing, ..Scales::new(model, settings.tracked()) };
    let mut problem = PressureForm::new(model, settings.harmonics, settings.tracked(), Unknown::Forcing, scales);
    problem.set_frequency(omega);
    problem
}

/// State where the curve first crosses a forcing amplitude, interpolated: the curve through `start` the way of `direction`.
fn follow_to(
    problem: &mut PressureForm<'_>,
    settings: &Settings,
    start: &State,
    direction: &[f64],
    forcing: f64,
) -> Result<State, Failure> {
    let y = problem.encode(start);
    let steps = ContinuationSettings { max_step: LARGEST_STEP, ..settings.continuation };
    let mut continuation = Continuation::start(problem, y, direction, steps)?;
    let mut before = continuation.current().clone();
    let mut before_forcing = continuation.problem().decode(&before.y).forcing;
    for _ in 0..BUDGET {
        let Some(point) = continuation.next() else { break };
        let reached = continuation.problem().decode(&point.y).forcing;
        if (before_forcing - forcing) * (reached - forcing) <= 0.0 {
            let share = (forcing - before_forcing) / (reached - before_forcing);
            let between = interpolate(&before.y, &point.y, share);
            return Ok(continuation.problem().decode(&between));
        }
        (before, before_forcing) = (point, reached);
    }
    Err(Failure::OutOfReach)
}
