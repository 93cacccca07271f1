//! The simplest curve with a corner, for tests.

use super::problem::Problem;
use crate::linalg::LinalgError;

/// x = −`slopes[0]`·y below, x = −`slopes[1]`·y above.
pub struct Bent {
    slopes: [f64; 2],
    residual: f64,
    jacobian: [f64; 2],
    matrix: [[f64; 2]; 2],
}

impl Bent {
    pub fn new(slopes: [f64; 2]) -> Self {
        Self { slopes, residual: 0.0, jacobian: [0.0; 2], matrix: [[0.0; 2]; 2] }
    }

    fn determinant(&self) -> f64 {
        let [[a, b], [c, d]] = self.matrix;
        a * d - b * c
    }
}

impl Problem for Bent {
    fn len(&self) -> usize {
        2
    }

    fn parameters(&self) -> usize {
        1
    }

    fn metric(&self) -> &[f64] {
        &[1.0, 1.0]
    }

    fn linearise(&mut self, y: &mut [f64]) -> f64 {
        self.jacobian = [1.0, self.slopes[usize::from(y[1] >= 0.0)]];
        self.residual = y[0] + self.jacobian[1] * y[1];
        self.residual.abs()
    }

    fn factor(&mut self, row: &[f64]) -> Result<(), LinalgError> {
        self.matrix = [self.jacobian, [row[0], row[1]]];
        if self.determinant() == 0.0 { Err(LinalgError::Singular { pivot: 1, size: 2 }) } else { Ok(()) }
    }

    fn rounding(&self) -> f64 {
        1e-15
    }

    fn is_factorisation_current(&self) -> bool {
        true
    }

    fn orientation(&mut self) -> f64 {
        self.determinant().signum()
    }

    fn solve(&mut self, mismatch: f64, step: &mut [f64], tangent: &mut [f64]) {
        let ([[a, b], [c, d]], determinant) = (self.matrix, self.determinant());
        let solution =
            |first: f64, second: f64| [(d * first - b * second) / determinant, (a * second - c * first) / determinant];
        step.copy_from_slice(&solution(-self.residual, -mismatch));
        tangent.copy_from_slice(&solution(0.0, 1.0));
    }

    fn solve_transposed(&mut self, _form: &[f64]) -> Vec<f64> {
        unreachable!("walks do not ask for it")
    }
}
