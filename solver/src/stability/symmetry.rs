//! Whether a marched orbit has lost a symmetry that the motion has which it was polished from: then it is one of what branches off.

use crate::curve::problem::SAME_IMAGE;
use crate::formulation::harmonics::complex;
use crate::formulation::state::State;
use crate::structure::Model;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Relative distance of an orbit from its image from which on it is another one: far above what samples leave of harmonics.
const ANOTHER: f64 = 1e-3;

/// Whether a path of modal displacements, at instants that are a `share` of the period apart (the last one perhaps less before the
/// end), has another image where the motion of the balance is its own: some periods of the forcing later, or, where the structure is odd,
/// half of one more and mirrored.
pub(super) fn is_lost(model: &Model, state: &State, path: &[f64], share: f64) -> bool {
    let (n, harmonics) = (state.modal.len() / (2 * state.harmonics + 1), state.harmonics);
    let balanced = |mode: usize, k: usize| complex(state.mode(mode), k);
    let (instants, weights) = instants(path.len() / n, share);
    let marched = |mode: usize, k: usize| -> Complex64 {
        let terms = instants
            .iter()
            .zip(&weights)
            .enumerate()
            .map(|(i, (tau, weight))| Complex64::from_polar(weight * path[i * n + mode], -(k as f64) * tau));
        terms.sum::<Complex64>() * if k == 0 { 1.0 } else { 2.0 }
    };
    let is_odd = model.is_odd();
    let m = model.forcing().harmonic;
    let mut images = (1..2 * m).filter(|halves| is_odd || halves % 2 == 0);
    images.any(|halves| {
        let factor = |k: usize| {
            let mirrored = if halves % 2 == 1 { -1.0 } else { 1.0 };
            Complex64::from_polar(mirrored, PI * (halves * k) as f64 / m as f64)
        };
        let apart = |of: &dyn Fn(usize, usize) -> Complex64| {
            let (mut apart, mut size) = (0.0, 0.0);
            for mode in 0..n {
                for k in 0..=harmonics {
                    let value = of(mode, k);
                    apart += ((factor(k) - 1.0) * value).norm_sqr();
                    size += if k > 0 { value.norm_sqr() } else { 0.0 };
                }
            }
            (apart / size).sqrt()
        };
        apart(&balanced) <= SAME_IMAGE && apart(&marched) > ANOTHER
    })
}

/// Instants of a period of 2π, and their shares of it.
fn instants(count: usize, share: f64) -> (Vec<f64>, Vec<f64>) {
    let at = |i: usize| if i < count { i as f64 * share } else { 1.0 };
    let before = |i: usize| if i == 0 { at(count - 1) - 1.0 } else { at(i - 1) };
    (0..count).map(|i| (TAU * at(i), 0.5 * (at(i + 1) - before(i)))).unzip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::laws::{PolynomialSpring, Term};

    fn model(power: u32) -> Model {
        let law = PolynomialSpring { terms: vec![Term { power: power as _, coefficient: 1.0 }] };
        Model::builder("mass").mass([[1.0]]).stiffness([[1.0]]).element("spring", law, ["x1"]).build().unwrap()
    }

    /// A path of cos τ + `second` cos 2τ at 130 instants of which the last is half as long.
    fn path(second: f64) -> (Vec<f64>, f64) {
        let share = 1.0 / 129.5;
        let at = |i: i32| TAU * f64::from(i) * share;
        ((0..130).map(|i| at(i).cos() + second * (2.0 * at(i)).cos()).collect(), share)
    }

    fn state(second: f64) -> State {
        let modal = vec![0.0, 1.0, 0.0, second, 0.0];
        State { harmonics: 2, omega: 1.0, decay: 0.0, forcing: 1.0, arguments: Vec::new(), modal }
    }

    #[test]
    fn an_orbit_with_even_harmonics_is_not_that_of_a_motion_without() {
        let lost = |power, balanced: f64, marched: f64| {
            let (path, share) = path(marched);
            is_lost(&model(power), &state(balanced), &path, share)
        };
        assert!(!lost(3, 0.0, 0.0) && !lost(3, 0.0, 3e-4));
        assert!(lost(3, 0.0, 2e-3));
        // The motion of the balance has them as well, or the structure is not symmetric.
        assert!(!lost(3, 0.02, 0.03) && !lost(2, 0.0, 0.03));
    }
}
