//! Continuation in the forcing amplitude at fixed frequency: the linear start of a main branch that already touches, and
//! the fold-safe way from a backbone motion to a forced response.

use crate::curve::continuation::{Continuation, ContinuationSettings};
use crate::curve::problem::Failure;
use crate::curve::walk::interpolate;
use crate::formulation::Formulation;
use crate::formulation::linear::{below_first_touch, forced_response};
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::response::interrupt::Interrupt;
use crate::settings::Settings;
use crate::structure::Model;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Largest step of a walk in A, whose points are not kept.
const LARGEST_STEP: f64 = 0.3;

/// Points of a walk in A before giving up.
const BUDGET: usize = 200;

/// Of the amplitude wanted, how far beyond it a walk in A goes before giving up: those that came back went no farther.
const FARTHEST: f64 = 10.0;

/// Why no forced response was reached.
#[derive(Debug, Clone, Copy, PartialEq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unreached {
    /// A continuation in the forcing amplitude never came to the amplitude wanted.
    #[error("the forcing amplitude is not reached by continuation in the amplitude")]
    OutOfReach,
    /// A point on the way could not be computed.
    #[error(transparent)]
    #[serde(untagged)]
    Failure(#[from] Failure),
}

/// State close to the forced response at amplitude `forcing` and frequency `omega`, continued in A from the linear
/// response to a small forcing.
///
/// # Errors
/// If a point on the way does not converge, or the curve never comes to the amplitude.
pub(super) fn from_rest<'m, F: Formulation<'m>>(
    model: &'m Model,
    settings: &Settings,
    forcing: f64,
    omega: f64,
    interrupt: &Interrupt,
) -> Result<State, Unreached> {
    let mut problem: F = system(model, settings, forcing, omega);
    let linear = forced_response(&problem, forcing, omega).map_err(|_| Failure::Singular)?;
    let mut start = below_first_touch(&problem, linear);
    if start.forcing > forcing {
        // What is asked for is smaller still.
        let share = forcing / start.forcing;
        start.modal.iter_mut().for_each(|q| *q *= share);
        start.forcing = forcing;
        start.arguments = problem.modal().open_arguments(&start.modal);
    }
    let upwards = problem.parameter_row();
    follow_to(&mut problem, settings, &start, &upwards, forcing, interrupt)
}

/// States near forcing amplitude `forcing` on the curve in A through a predicted motion: the curve is entered at the
/// motion's own size, with A free, and followed both ways over its fold in A.
///
/// # Errors
/// If neither way leads there.
pub(super) fn through_motion<'m, F: Formulation<'m>>(
    model: &'m Model,
    settings: &Settings,
    forcing: f64,
    motion: &State,
    interrupt: &Interrupt,
) -> Result<Vec<State>, Unreached> {
    let mut problem: F = system(model, settings, forcing, motion.omega);
    let y = problem.encode(motion);
    let growth = problem.growth(&y);
    let shrink: Vec<f64> = growth.iter().map(|g| -g).collect();
    let mut found = Vec::new();
    let mut failure = Unreached::from(Failure::Diverged);
    for direction in [growth, shrink] {
        match follow_to(&mut problem, settings, motion, &direction, forcing, interrupt) {
            Ok(state) => found.push(state),
            Err(error) => failure = error,
        }
    }
    if found.is_empty() { Err(failure) } else { Ok(found) }
}

/// The system with A free, A measured in units of the amplitude wanted.
fn system<'m, F: Formulation<'m>>(model: &'m Model, settings: &Settings, forcing: f64, omega: f64) -> F {
    let scales = Scales { forcing, ..Scales::new(model, settings.tracked(model)) };
    F::build(model, settings.harmonics, settings.tracked(model), Unknown::Forcing { omega }, scales)
        .expect("a formulation that knows forced responses knows them at fixed frequency too")
}

/// State where the curve first crosses a forcing amplitude, interpolated: the curve through `start` the way of `direction`.
fn follow_to<'m, F: Formulation<'m>>(
    problem: &mut F,
    settings: &Settings,
    start: &State,
    direction: &[f64],
    forcing: f64,
    interrupt: &Interrupt,
) -> Result<State, Unreached> {
    let y = problem.encode(start);
    let steps = ContinuationSettings { max_step: LARGEST_STEP, ..settings.continuation };
    let mut continuation = Continuation::start(problem, y, direction, steps)?;
    let mut before = continuation.current().clone();
    let state_at = |problem: &mut F, y: &[f64]| problem.decode(y).map_err(|_| Failure::Singular);
    let mut before_forcing = state_at(continuation.problem(), &before.y)?.forcing;
    for _ in 0..BUDGET {
        if interrupt.is_set() {
            break;
        }
        let Some(point) = continuation.next() else { break };
        let reached = state_at(continuation.problem(), &point.y)?.forcing;
        if (before_forcing - forcing) * (reached - forcing) <= 0.0 {
            let share = (forcing - before_forcing) / (reached - before_forcing);
            let between = interpolate(&before.y, &point.y, share);
            return Ok(state_at(continuation.problem(), &between)?);
        }
        // Beyond rest the way is the one behind it again, with the forcing turned round.
        if reached < 0.0 || reached > FARTHEST * forcing {
            break;
        }
        (before, before_forcing) = (point, reached);
    }
    Err(Unreached::OutOfReach)
}
