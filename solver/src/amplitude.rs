//! Continuation in the forcing amplitude at fixed frequency: the linear start of a main branch that already touches, and
//! the fold-safe way from a backbone motion to a forced response.

use crate::continuation::{Continuation, ContinuationSettings};
use crate::linear::{below_first_touch, forced_response};
use crate::model::Model;
use crate::pressure::PressureForm;
use crate::problem::Failure;
use crate::scales::Scales;
use crate::settings::Settings;
use crate::state::State;
use crate::unknown::Unknown;
use crate::walk::interpolate;

/// Largest step of a walk in A, whose points are not kept.
const LARGEST_STEP: f64 = 0.3;

/// Points of a walk in A before giving up.
const BUDGET: usize = 200;

/// State close to the forced response at amplitude `amplitude` and frequency `omega`, continued in A from the linear
/// response to a small forcing.
pub fn from_rest(model: &Model, settings: &Settings, amplitude: f64, omega: f64) -> Result<State, Failure> {
    let mut problem = system(model, settings, amplitude, omega);
    let linear = forced_response(&problem, amplitude, omega).map_err(|_| Failure::Singular)?;
    let start = below_first_touch(&problem, linear);
    let upwards = problem.parameter_row();
    follow_to(&mut problem, settings, &start, &upwards, amplitude)
}

/// States near forcing amplitude `amplitude` on the curve in A through a predicted motion: the curve is entered at the
/// motion's own size, with A free, and followed both ways over its fold in A.
pub fn through_motion(
    model: &Model,
    settings: &Settings,
    amplitude: f64,
    motion: &State,
) -> Result<Vec<State>, Failure> {
    let mut problem = system(model, settings, amplitude, motion.omega);
    let y = problem.encode(motion);
    let growth = problem.growth(&y);
    let shrink: Vec<f64> = growth.iter().map(|g| -g).collect();
    let mut found = Vec::new();
    let mut failure = Failure::Diverged;
    for direction in [growth, shrink] {
        match follow_to(&mut problem, settings, motion, &direction, amplitude) {
            Ok(state) => found.push(state),
            Err(error) => failure = error,
        }
    }
    if found.is_empty() { Err(failure) } else { Ok(found) }
}

/// The system with A free, A measured in units of the amplitude wanted.
fn system<'m>(model: &'m Model, settings: &Settings, amplitude: f64, omega: f64) -> PressureForm<'m> {
    let scales = Scales { forcing: amplitude, ..Scales::new(model, settings.tracked()) };
    let mut problem = PressureForm::new(model, settings.harmonics, settings.tracked(), Unknown::Amplitude, scales);
    problem.set_frequency(omega);
    problem
}

/// State where the curve first crosses a forcing amplitude, interpolated: the curve through `start` the way of `direction`.
fn follow_to(
    problem: &mut PressureForm<'_>,
    settings: &Settings,
    start: &State,
    direction: &[f64],
    amplitude: f64,
) -> Result<State, Failure> {
    let y = problem.encode(start);
    let steps = ContinuationSettings { max_step: LARGEST_STEP, ..settings.continuation };
    let mut continuation = Continuation::start(problem, y, direction, steps)?;
    let mut before = continuation.current().clone();
    let mut before_amplitude = continuation.problem().decode(&before.y).amplitude;
    for _ in 0..BUDGET {
        let Some(point) = continuation.next() else { break };
        let reached = continuation.problem().decode(&point.y).amplitude;
        if (before_amplitude - amplitude) * (reached - amplitude) <= 0.0 {
            let share = (amplitude - before_amplitude) / (reached - before_amplitude);
            let between = interpolate(&before.y, &point.y, share);
            return Ok(continuation.problem().decode(&between));
        }
        (before, before_amplitude) = (point, reached);
    }
    Err(Failure::OutOfReach)
}
