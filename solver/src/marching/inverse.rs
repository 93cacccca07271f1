//! The matrix of a time step, A_h = I/h² + Ĉ/(2h).

use super::dot;
use crate::linalg::{LinalgError, Lu, Matrix};
use crate::structure::Damping;

/// The step of modes that damping does not couple.
pub struct Uncoupled {
    /// (1 − ĉh/2)/(1 + ĉh/2) of each mode.
    pub decays: Vec<f64>,
    /// h²/(1 + ĉh/2) of each mode, in s².
    pub compliances: Vec<f64>,
}

/// A_h⁻¹ in modal coordinates.
pub enum Inverse {
    /// Modal damping.
    Diagonal(Uncoupled),
    /// Full damping.
    Full(Matrix),
}

impl Inverse {
    /// For a time step in s. Full damping is factorised here, once.
    ///
    /// # Errors
    /// If that is singular.
    pub fn new(damping: &Damping, step: f64) -> Result<Self, LinalgError> {
        match damping.uncoupled() {
            Some(rates) => {
                let mode =
                    |c: &f64| ((1.0 - 0.5 * c * step) / (1.0 + 0.5 * c * step), step * step / (1.0 + 0.5 * c * step));
                let (decays, compliances) = rates.iter().map(mode).unzip();
                Ok(Self::Diagonal(Uncoupled { decays, compliances }))
            }
            None => {
                let matrix = damping.matrix();
                let n = matrix.rows();
                let mut lu = Lu::default();
                let a = lu.reset(n);
                for i in 0..n {
                    for j in 0..n {
                        let mass = if i == j { 1.0 / (step * step) } else { 0.0 };
                        a[i * n + j] = mass + 0.5 * matrix[(i, j)] / step;
                    }
                }
                lu.factor()?;
                let mut columns = Matrix::zeros(n, n);
                for j in 0..n {
                    columns[(j, j)] = 1.0;
                    lu.solve(columns.row_mut(j));
                }
                Ok(Self::Full(columns.transpose()))
            }
        }
    }

    /// A_h⁻¹ r.
    pub fn apply(&self, r: &[f64]) -> Vec<f64> {
        match self {
            Self::Diagonal(modes) => modes.compliances.iter().zip(r).map(|(compliance, r)| compliance * r).collect(),
            Self::Full(inverse) => inverse.mul_vec(r),
        }
    }

    /// `next` = A_h⁻¹ ((I/h² − Ĉ/(2h)) `increment` + `force`): central differences written on increments. Uses up `force`.
    #[inline(always)]
    pub fn predict(&self, increment: &[f64], force: &mut [f64], step: f64, next: &mut [f64]) {
        match self {
            Self::Diagonal(modes) => {
                let coefficients = modes.decays.iter().zip(&modes.compliances);
                let motions = increment.iter().zip(force.iter());
                for ((next, (decay, compliance)), (d, f)) in next.iter_mut().zip(coefficients).zip(motions) {
                    *next = decay * d + compliance * f;
                }
            }
            // A_h⁻¹ (I/h² − Ĉ/(2h)) = 2/h² A_h⁻¹ − I: one product does.
            Self::Full(inverse) => {
                let scale = 2.0 / (step * step);
                force.iter_mut().zip(increment).for_each(|(f, d)| *f += scale * d);
                for (i, next) in next.iter_mut().enumerate() {
                    *next = dot(inverse.row(i), force) - increment[i];
                }
            }
        }
    }
}
