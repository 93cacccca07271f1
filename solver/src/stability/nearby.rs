//! Marched orbits of branches at a frequency, and how far motions are from them.

use super::marching::{Marching, MarchingError};
use super::multipliers::Verdict;
use super::polish::{Around, PolishSettings, Polished, polish};
use super::shooting::Orbit;
use crate::formulation::state::State;
use crate::response::branch::Branch;
use crate::structure::Model;

/// The solutions of the balance at which a branch passes a frequency, between its points, each at exactly that one.
pub fn passages(branch: &Branch, omega: f64) -> Vec<State> {
    let count = branch.points.len();
    let last = if branch.is_closed() { count } else { count.saturating_sub(1) };
    let at = |i: usize| &branch.points[i % count].state;
    let passes = |&i: &usize| (at(i).omega < omega) != (at(i + 1).omega < omega);
    let between = |i: usize| {
        let (a, b) = (at(i), at(i + 1));
        State { omega, ..a.interpolate(b, (omega - a.omega) / (b.omega - a.omega)) }
    };
    (0..last).filter(passes).map(between).collect()
}

/// The marched orbits of a branch at a frequency, each with its verdict; without those that marching does not come to.
pub fn orbits(model: &Model, branch: &Branch, omega: f64) -> Vec<(Verdict, Polished)> {
    let settings = PolishSettings::default();
    let polished = |state: &State| {
        let found = polish(model, &settings, state, Around::default());
        found.polished.map(|polished| (found.verdict, polished))
    };
    passages(branch, omega).iter().filter_map(polished).collect()
}

/// Distance of states of the marcher at the same phase: root of the sum of squares of the modal displacements and of the
/// velocities over ω, kg^½·m.
pub fn apart(model: &Model, omega: f64, a: &[f64], b: &[f64]) -> f64 {
    let n = model.size();
    let of = |range: std::ops::Range<usize>, scale: f64| -> f64 {
        a[range.clone()].iter().zip(&b[range]).map(|(a, b)| ((a - b) * scale).powi(2)).sum()
    };
    (of(0..n, 1.0) + of(n..2 * n, 1.0 / omega)).sqrt()
}

/// The states of an orbit at the phases at which the forcing begins a period: one, unless the response has a multiple of the
/// period of the forcing and may be delayed by parts of its own.
///
/// # Errors
/// If the orbit cannot be marched.
pub fn images(model: &Model, orbit: &Orbit) -> Result<Vec<Vec<f64>>, MarchingError> {
    let parts = model.forcing().harmonic;
    let mut marching = orbit.marching(model)?;
    let mut images = vec![orbit.state.clone()];
    for part in 1..parts {
        walk_to(&mut marching, part * orbit.steps / parts)?;
        images.push(marching.state());
    }
    Ok(images)
}

/// Goes on to a step.
///
/// # Errors
/// If the motion cannot be marched.
pub fn walk_to(marching: &mut Marching<'_>, step: usize) -> Result<(), MarchingError> {
    while marching.index() < step {
        marching.step()?;
    }
    Ok(())
}

/// The least distance of a state from images of an orbit.
pub fn distance(model: &Model, omega: f64, state: &[f64], images: &[Vec<f64>]) -> f64 {
    images.iter().map(|image| apart(model, omega, state, image)).fold(f64::INFINITY, f64::min)
}
