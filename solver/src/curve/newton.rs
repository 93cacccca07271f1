//! Newton's method on a [`Problem`] closed by a constraint.
//!
//! A factorisation costs far more than a residual. It is used again (simplified Newton method) as long as the residual
//! falls so fast that a few more such steps are enough.

use crate::curve::problem::{Failure, Problem, norm};
use serde::{Deserialize, Serialize};

/// The scalar equation that closes a [`Problem`].
#[derive(Debug, Clone, Copy)]
pub enum Constraint<'a> {
    /// Hyperplane row·(y − origin) = 0: Keller's corrector with the tangent as `row`, or a fixed entry with a unit vector.
    Hyperplane {
        /// Normal of the plane, as a linear form on the state.
        row: &'a [f64],
        /// A point of the plane.
        origin: &'a [f64],
    },
    /// Sphere ‖y − centre‖² = radius² in the problem's metric (paper \[8\]).
    Sphere {
        /// The last point of the branch.
        centre: &'a [f64],
        /// Step length.
        radius: f64,
    },
}

impl Constraint<'_> {
    /// Mismatch at `y`; the gradient goes into `row`.
    fn linearise(&self, metric: &[f64], y: &[f64], row: &mut [f64]) -> f64 {
        match *self {
            Constraint::Hyperplane { row: normal, origin } => {
                row.copy_from_slice(normal);
                normal.iter().zip(y.iter().zip(origin)).map(|(r, (y, o))| r * (y - o)).sum()
            }
            Constraint::Sphere { centre, radius } => {
                let mut square = 0.0;
                for i in 0..y.len() {
                    let difference = y[i] - centre[i];
                    row[i] = metric[i] * difference / radius;
                    square += metric[i] * difference * difference;
                }
                0.5 * (square / radius - radius)
            }
        }
    }
}

/// Settings of Newton's method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NewtonSettings {
    /// Largest scaled residual of a converged point, of its largest term if that is smaller than one. Default 1e-12. Where rounding
    /// alone leaves more, what cannot be improved any more is converged.
    pub tolerance: f64,
    /// Iterations before giving up. Default 10.
    pub max_iterations: usize,
    /// Backtrack when a step does not reduce the residual (landing); plain Newton otherwise. Default false.
    pub damped: bool,
}

impl Default for NewtonSettings {
    fn default() -> Self {
        Self { tolerance: 1e-12, max_iterations: 10, damped: false }
    }
}

/// Largest error of a converged motion, relative to its size, as estimated from the last step. Near a lightly damped resonance a small
/// residual alone does not make a small error.
pub(super) const ACCURACY: f64 = 1e-7;

/// What [`Problem::rounding`] is of a residual whose largest term is one. Residuals of smaller motions have to be smaller in
/// proportion: beyond the tip of a resonance next to nothing may be left of a balance that nothing fulfils.
const ROUNDED: f64 = 64.0 * f64::EPSILON;

/// What a step leaves of the error at least, as far as can be told: after a new factorisation, and after one that was used
/// again, where what falls slowly may be hidden behind what falls fast.
const LEFT: [f64; 2] = [1e-3, 0.5];

/// A residual that an iteration leaves larger than this share of what it was has stopped falling.
const STAGNATION: f64 = 0.3;

/// Over so many damped steps the residual has to fall to half, or the iteration is given up.
const PATIENCE: usize = 8;

/// Most steps expected with one factorisation before a new one is worth its cost.
const SIMPLIFIED_STEPS: f64 = 3.0;

/// A converged iteration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Convergence {
    /// Newton steps taken.
    pub iterations: usize,
    /// Factorisations they needed.
    pub factorisations: usize,
    /// Largest scaled residual left.
    pub residual: f64,
}

/// Buffers of the iteration, kept between calls, and the direction of the curve at the last factorised iterate.
#[derive(Debug, Clone, Default)]
pub struct Newton {
    row: Vec<f64>,
    step: Vec<f64>,
    trial: Vec<f64>,
    /// Direction of the solution curve (not normalised) from the last Jacobian factorised.
    pub direction: Vec<f64>,
}

impl Newton {
    /// Solves R(y) = 0 and the constraint, starting from and ending in `y`.
    ///
    /// # Errors
    /// If it needs more iterations than allowed, diverges, or meets a singular Jacobian.
    pub fn solve<P: Problem>(
        &mut self,
        problem: &mut P,
        y: &mut [f64],
        constraint: Constraint<'_>,
        settings: &NewtonSettings,
    ) -> Result<Convergence, Failure> {
        let n = problem.len();
        for buffer in [&mut self.row, &mut self.step, &mut self.trial, &mut self.direction] {
            buffer.resize(n, 0.0);
        }
        let mut residual = problem.linearise(y);
        let mut mismatch = constraint.linearise(problem.metric(), y, &mut self.row);
        let (mut iterations, mut factorisations) = (0, 0);
        let (mut reuse, mut is_simplified, mut contraction) = (false, false, 1.0);
        let mut milestone = residual;
        loop {
            if !residual.is_finite() || !mismatch.is_finite() {
                return Err(Failure::Diverged);
            }
            // At least one step: the direction of the curve comes from its factorisation.
            if iterations > 0 && mismatch.abs() < 1e-9 {
                let metric = problem.motion_metric();
                let left = f64::max(contraction, LEFT[usize::from(is_simplified)]);
                let is_accurate = || left * norm(metric, &self.step) <= ACCURACY * norm(metric, y);
                let is_small = || residual <= settings.tolerance / ROUNDED * problem.rounding();
                let cannot_improve = || contraction > STAGNATION && residual <= problem.rounding();
                if (residual < settings.tolerance && is_accurate() && is_small()) || cannot_improve() {
                    return Ok(Convergence { iterations, factorisations, residual });
                }
            }
            let mut is_stuck = false;
            if settings.damped && iterations > 0 && iterations % PATIENCE == 0 {
                is_stuck = residual > 0.5 * milestone;
                milestone = residual;
            }
            if is_stuck || iterations == settings.max_iterations {
                return Err(Failure::NotConverged { iterations, residual });
            }
            is_simplified = reuse && problem.is_factorisation_current();
            if !is_simplified {
                problem.factor(&self.row).map_err(|_| Failure::Singular)?;
                factorisations += 1;
            }
            problem.solve(mismatch, &mut self.step, &mut self.direction);
            let before = residual;
            if settings.damped {
                (residual, mismatch) = self.backtrack(problem, y, constraint, residual);
            } else {
                y.iter_mut().zip(&self.step).for_each(|(y, s)| *y += s);
                residual = problem.linearise(y);
                mismatch = constraint.linearise(problem.metric(), y, &mut self.row);
            }
            iterations += 1;
            contraction = if before > 0.0 { residual / before } else { 0.0 };
            let steps_left = (settings.tolerance / residual).ln() / contraction.ln();
            reuse = contraction < 1.0 && steps_left <= SIMPLIFIED_STEPS;
        }
    }

    /// Halves the step until the residual decreases; takes the shortest step if it never does.
    fn backtrack<P: Problem>(
        &mut self,
        problem: &mut P,
        y: &mut [f64],
        constraint: Constraint<'_>,
        before: f64,
    ) -> (f64, f64) {
        let mut scale = 1.0;
        loop {
            for ((t, y), s) in self.trial.iter_mut().zip(y.iter()).zip(&self.step) {
                *t = y + scale * s;
            }
            let residual = problem.linearise(&mut self.trial);
            if residual < (1.0 - 0.1 * scale) * before || scale < 1e-2 {
                y.copy_from_slice(&self.trial);
                let mismatch = constraint.linearise(problem.metric(), y, &mut self.row);
                return (residual, mismatch);
            }
            scale *= 0.5;
        }
    }
}
