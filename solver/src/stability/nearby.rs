//! Marched orbits of branches at a frequency, and how far motions are from them.

use super::multipliers::Verdict;
use super::polish::{Around, PolishSettings, Polished, polish};
use super::shooting::Orbit;
use crate::formulation::state::State;
use crate::marching::{Marching, MarchingError};
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

/// The states from which an orbit and what is the same motion start at the same phase of the forcing: itself; where the response has
/// a multiple of the period of the forcing, delayed by parts of its own; and where the structure is odd, mirrored half a period of
/// the forcing later.
///
/// # Errors
/// If the orbit cannot be marched.
pub fn images(model: &Model, orbit: &Orbit) -> Result<Vec<Vec<f64>>, MarchingError> {
    let halves = 2 * model.forcing().harmonic;
    let is_odd = model.is_odd();
    let mut marching = orbit.marching(model)?;
    let mut images = vec![orbit.state.clone()];
    for half in (1..halves).filter(|half| is_odd || half % 2 == 0) {
        let sign = if half % 2 == 1 { -1.0 } else { 1.0 };
        let mut image = state_at(&mut marching, half * orbit.steps, halves)?;
        image.iter_mut().for_each(|value| *value *= sign);
        images.push(image);
    }
    Ok(images)
}

/// The state after `numerator`/`denominator` steps, between two steps interpolated.
fn state_at(marching: &mut Marching<'_>, numerator: usize, denominator: usize) -> Result<Vec<f64>, MarchingError> {
    walk_to(marching, numerator / denominator)?;
    let before = marching.state();
    let share = (numerator % denominator) as f64 / denominator as f64;
    if share == 0.0 {
        return Ok(before);
    }
    walk_to(marching, numerator / denominator + 1)?;
    Ok(before.iter().zip(marching.state()).map(|(a, b)| a + share * (b - a)).collect())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::laws::{PolynomialSpring, Term};

    /// A mass in one of two wells: its motion in the other one is its mirror image, whatever the number of steps.
    #[test]
    fn the_mirror_image_of_a_motion_is_one() {
        let terms = vec![Term { power: 1, coefficient: -2.0 }, Term { power: 3, coefficient: 1.0 }];
        let well = Model::builder("two wells")
            .mass([[1.0]])
            .stiffness([[1.0]])
            .damping_ratio(0.05)
            .force("x1", 1.0)
            .element("spring", PolynomialSpring { terms }, ["x1"])
            .build()
            .unwrap();
        for steps in [1000, 1001] {
            let settled = |state: Vec<f64>, periods: usize| {
                let orbit = Orbit { omega: 0.9, forcing: 0.1, steps, state };
                let mut marching = orbit.marching(&well).unwrap();
                walk_to(&mut marching, periods * steps).unwrap();
                Orbit { state: marching.state(), ..orbit }
            };
            let orbit = settled(vec![1.0, 0.0], 200);
            let images = images(&well, &orbit).unwrap();
            assert_eq!(images.len(), 2);
            assert!(apart(&well, 0.9, &images[0], &images[1]) > 1.0, "{images:?}");
            for image in &images {
                let later = settled(image.clone(), 1);
                assert!(apart(&well, 0.9, image, &later.state) < 1e-4, "{steps} steps: {image:?}, {later:?}");
            }
        }
    }
}
