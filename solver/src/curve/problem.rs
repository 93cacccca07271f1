//! What continuation solves: an underdetermined system R(y) = 0 in scaled unknowns, closed by one border row.

use crate::linalg::LinalgError;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Largest relative distance of a state from an image of it that is the same: what Newton's method has left over would grow next to
/// branch points.
pub const SAME_IMAGE: f64 = 1e-6;

/// A system of equations with one unknown more than equations.
///
/// `y` is the full scaled state: the unknowns proper and what depends on them explicitly (contact nodes that do not
/// touch, modal amplitudes), so that its length never changes while the system that is factorised does.
#[expect(clippy::len_without_is_empty, reason = "a system without unknowns does not exist")]
pub trait Problem {
    /// Length of the state.
    fn len(&self) -> usize;

    /// Number of free parameters: the last entries of the state.
    fn parameters(&self) -> usize;

    /// Diagonal of the metric in which arc length, steps and distances are measured.
    fn metric(&self) -> &[f64];

    /// Completes the dependent entries of `y`, evaluates residual and Jacobian there, and returns the largest scaled
    /// residual.
    fn linearise(&mut self, y: &mut [f64]) -> f64;

    /// Factorises the Jacobian of the last [`Problem::linearise`], bordered by `row` (a linear form on the state).
    ///
    /// # Errors
    /// If the matrix is singular.
    fn factor(&mut self, row: &[f64]) -> Result<(), LinalgError>;

    /// Rounding error to expect of the residual at the state last linearised: whatever is smaller is as good as zero.
    fn rounding(&self) -> f64;

    /// Whether the factorisation at hand still fits the state last linearised: the same unknowns. Its steps then are those
    /// of a simplified Newton method.
    fn is_factorisation_current(&self) -> bool;

    /// Of the matrix last factorised: the sign of its determinant, which does not change along a smooth branch, times a measure of how far
    /// it is from a singular one, which goes to zero where the sign changes.
    fn orientation(&mut self) -> f64;

    /// With the matrix last factorised: Newton correction J δ = −R, row·δ = −`mismatch`, and direction of the solution
    /// curve J t = 0, row·t = 1.
    fn solve(&mut self, mismatch: f64, step: &mut [f64], tangent: &mut [f64]);

    /// With the matrix last factorised: weights w of the equations and of the border row (last) with
    /// Σ_i w_i ∂R_i + w_last row = `form` on every movement of the state that keeps dependent entries dependent. The solution of
    /// the transposed system: what folds, sensitivities and error estimates are made of. `form` has weights on motions that the
    /// metric measures, and on parameters. Only while [`Problem::is_factorisation_current`].
    fn solve_transposed(&mut self, form: &[f64]) -> Vec<f64>;

    /// What solving at one state leaves behind that bears on the next one, a starting value say; empty if nothing does.
    fn memory(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Takes up a [`Problem::memory`].
    fn recall(&mut self, _memory: &[f64]) {}

    /// Longest step (arc length) along the unit tangent of a point that cannot pass over something narrow, a lightly damped
    /// resonance say. Infinite if nothing is known of such.
    fn longest_step(&mut self, _y: &[f64], _tangent: &[f64]) -> f64 {
        f64::INFINITY
    }

    /// Whether one state may follow another on a curve: solutions that differ too much to be neighbours may not, even if
    /// both are small and close in arc length.
    fn are_neighbours(&self, _from: &[f64], _to: &[f64]) -> bool {
        true
    }

    /// Whether a step between two solutions has led over a resonance, from one of its flanks to the other.
    fn hops(&self, _from: &[f64], _to: &[f64]) -> bool {
        false
    }

    /// Whether a walk may go on beyond a sharp corner by the sign of the determinant alone. Not where the Jacobian has no limit at a
    /// corner, as on curves of extrema, whose corners are told and passed by whoever drives the walk.
    fn turns_corners(&self) -> bool {
        true
    }

    /// Number of states that are the same solution: itself and what symmetries of the problem make of it.
    fn images(&self) -> usize {
        1
    }

    /// Image `index` of a state or direction, from 0 (itself) on.
    fn image(&self, y: &[f64], _index: usize) -> Vec<f64> {
        y.to_vec()
    }

    /// The images of a state that differ from each other, itself the first.
    fn distinct_images(&self, y: &[f64]) -> Vec<Vec<f64>> {
        let mut list: Vec<Vec<f64>> = Vec::new();
        for index in 0..self.images() {
            let image = self.image(y, index);
            let metric = self.motion_metric();
            let is_same = |other: &Vec<f64>| {
                let difference: Vec<f64> = image.iter().zip(other).map(|(a, b)| a - b).collect();
                norm(metric, &difference) <= SAME_IMAGE * norm(metric, y)
            };
            if !list.iter().any(is_same) {
                list.push(image);
            }
        }
        list
    }

    /// How far a state is from being its own image by each exchange of equal parts of the structure, relative to its size: along curves
    /// that end where it becomes its own image.
    fn asymmetries(&self, _y: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// The part of the metric that measures motions, without the parameters.
    fn motion_metric(&self) -> &[f64] {
        &self.metric()[..self.len() - self.parameters()]
    }

    /// Linear form that takes the first parameter out of the state.
    fn parameter_row(&self) -> Vec<f64> {
        let mut row = vec![0.0; self.len()];
        row[self.len() - self.parameters()] = 1.0;
        row
    }
}

/// Why a point could not be computed.
#[derive(Debug, Clone, Copy, PartialEq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Failure {
    /// Newton's method used up its iterations.
    #[error("no convergence in {iterations} iterations (scaled residual {residual:.1e})")]
    NotConverged {
        /// Iterations done.
        iterations: usize,
        /// Largest scaled residual left.
        residual: f64,
    },
    /// The residual or the state is not finite.
    #[error("the iteration diverged")]
    Diverged,
    /// The bordered Jacobian is singular.
    #[error("the Jacobian is singular")]
    Singular,
}

/// Scalar product in the metric.
pub fn inner(metric: &[f64], a: &[f64], b: &[f64]) -> f64 {
    metric.iter().zip(a).zip(b).map(|((w, x), y)| w * x * y).sum()
}

/// Length in the metric.
pub fn norm(metric: &[f64], a: &[f64]) -> f64 {
    inner(metric, a, a).sqrt()
}

/// Linear form of the scalar product with `direction`.
pub fn weighted(metric: &[f64], direction: &[f64]) -> Vec<f64> {
    metric.iter().zip(direction).map(|(w, d)| w * d).collect()
}
