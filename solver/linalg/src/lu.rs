//! LU factorisations: of real matrices in buffers that are kept, of complex ones once.

use super::LinalgError;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::{MatMut, MatRef, Par, Spec};
use num_complex::Complex64;

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}

/// Solutions with a matrix or its transpose by which its smallest singular value is told.
const INVERSE_ITERATIONS: usize = 4;

/// The golden ratio.
const GOLDEN: f64 = 1.618_033_988_749_895;

/// LU factorisation with partial pivoting of a row-major matrix, in a buffer that is kept between factorisations.
pub struct Lu {
    size: usize,
    factors: Vec<f64>,
    permutation: Vec<usize>,
    inverse: Vec<usize>,
    scratch: MemBuffer,
    scratch_size: usize,
    /// Right-hand sides that there is scratch for.
    scratch_columns: usize,
}

impl Default for Lu {
    fn default() -> Self {
        Self {
            size: 0,
            factors: Vec::new(),
            permutation: Vec::new(),
            inverse: Vec::new(),
            scratch: MemBuffer::new(faer::dyn_stack::StackReq::EMPTY),
            scratch_size: 0,
            scratch_columns: 2,
        }
    }
}

impl Lu {
    /// A zeroed row-major `size` × `size` matrix to be filled before [`Lu::factor`].
    pub fn reset(&mut self, size: usize) -> &mut [f64] {
        self.size = size;
        self.factors.clear();
        self.factors.resize(size * size, 0.0);
        &mut self.factors
    }

    /// The matrix as filled since [`Lu::reset`], until it is factorised.
    pub fn entries(&self) -> &[f64] {
        &self.factors
    }

    /// Factorises the matrix that [`Lu::reset`] handed out.
    ///
    /// # Errors
    /// If a pivot is zero or not finite.
    pub fn factor(&mut self) -> Result<(), LinalgError> {
        let n = self.size;
        self.permutation.resize(n, 0);
        self.inverse.resize(n, 0);
        if self.scratch_size < n {
            self.scratch_size = n;
            self.reserve();
        }
        // Read column by column, the row-major buffer is the transposed matrix.
        factor::lu_in_place(
            MatMut::from_column_major_slice_mut(&mut self.factors, n, n),
            &mut self.permutation,
            &mut self.inverse,
            Par::Seq,
            MemStack::new(&mut self.scratch),
            Spec::default(),
        );
        match (0..n).find(|&i| {
            let pivot = self.factors[i * n + i];
            pivot == 0.0 || !pivot.is_finite()
        }) {
            Some(pivot) => Err(LinalgError::Singular { pivot, size: n }),
            None => Ok(()),
        }
    }

    /// Scratch for the largest order and the most right-hand sides so far.
    fn reserve(&mut self) {
        let (n, columns) = (self.scratch_size, self.scratch_columns);
        let request = factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Spec::default())
            .or(solve::solve_transpose_in_place_scratch::<usize, f64>(n, columns, Par::Seq))
            .or(solve::solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq));
        self.scratch = MemBuffer::new(request);
    }

    /// Sign of the determinant: +1 or −1.
    pub fn determinant_sign(&self) -> f64 {
        let n = self.size;
        let negative = (0..n).filter(|&i| self.factors[i * n + i] < 0.0).count();
        let mut seen = vec![false; n];
        let mut cycles = 0;
        for start in 0..n {
            let mut i = start;
            cycles += usize::from(!seen[start]);
            while !std::mem::replace(&mut seen[i], true) {
                i = self.permutation[i];
            }
        }
        if (negative + n - cycles).is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    /// How far A is from a singular matrix: its smallest singular value by inverse iteration, or a little more.
    pub fn distance_from_singular(&mut self) -> f64 {
        // The fractions of multiples of the golden ratio repeat nothing.
        let mut vector: Vec<f64> = (1..=self.size).map(|i| (i as f64 * GOLDEN).fract() - 0.5).collect();
        let mut distance = f64::INFINITY;
        for iteration in 0..INVERSE_ITERATIONS {
            let length = norm(&vector);
            vector.iter_mut().for_each(|entry| *entry /= length);
            if iteration % 2 == 0 {
                self.solve_transposed(&mut vector)
            } else {
                self.solve(&mut vector)
            }
            distance = 1.0 / norm(&vector);
        }
        distance
    }

    /// Solves A x = b in place, for one right-hand side or several one after the other.
    pub fn solve(&mut self, b: &mut [f64]) {
        let n = self.size;
        let columns = b.len() / n;
        if columns > self.scratch_columns {
            self.scratch_columns = columns;
            self.reserve();
        }
        let factors = MatRef::from_column_major_slice(&self.factors, n, n);
        solve::solve_transpose_in_place(
            factors,
            factors,
            faer::perm::PermRef::new_checked(&self.permutation, &self.inverse, n),
            MatMut::from_column_major_slice_mut(b, n, columns),
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
    }

    /// Solves Aᵀ x = b in place.
    pub fn solve_transposed(&mut self, b: &mut [f64]) {
        let n = self.size;
        let factors = MatRef::from_column_major_slice(&self.factors, n, n);
        solve::solve_in_place(
            factors,
            factors,
            faer::perm::PermRef::new_checked(&self.permutation, &self.inverse, n),
            MatMut::from_column_major_slice_mut(b, n, 1),
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
    }
}

/// Solves A X = B for a complex row-major A of order `size` and `columns` right-hand sides (row-major, in place).
///
/// # Errors
/// If A is singular.
pub fn solve_complex(a: &[Complex64], b: &mut [Complex64], size: usize, columns: usize) -> Result<(), LinalgError> {
    use faer::linalg::solvers::Solve;
    let lu = MatRef::from_row_major_slice(a, size, size).partial_piv_lu();
    let pivots = lu.U().diagonal().column_vector();
    if let Some(pivot) = (0..size).find(|&i| pivots[i].norm() == 0.0 || !pivots[i].norm().is_finite()) {
        return Err(LinalgError::Singular { pivot, size });
    }
    lu.solve_in_place(MatMut::from_row_major_slice_mut(b, size, columns));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dot;

    #[test]
    fn lu_solves_row_major_systems() {
        let a = [4.0, 1.0, 0.5, -1.0, 3.0, 2.0, 0.25, 0.0, 5.0];
        let x = [1.0, -2.0, 3.0];
        let mut b: Vec<f64> = (0..3).map(|i| dot(&a[3 * i..3 * i + 3], &x)).collect();
        let mut lu = Lu::default();
        lu.reset(3).copy_from_slice(&a);
        lu.factor().unwrap();
        lu.solve(&mut b);
        for (b, x) in b.iter().zip(x) {
            assert!((b - x).abs() < 1e-14);
        }
    }

    #[test]
    fn the_distance_from_a_singular_matrix_is_proportional_to_what_is_missing() {
        let mut lu = Lu::default();
        let mut distance = |missing: f64| {
            lu.reset(3).copy_from_slice(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0 + missing]);
            lu.factor().unwrap();
            lu.distance_from_singular()
        };
        let (far, near) = (distance(1e-4), distance(-1e-6));
        assert!((far / near / 100.0 - 1.0).abs() < 1e-3, "{far:e}, {near:e}");
    }

    #[test]
    fn determinant_signs() {
        let mut lu = Lu::default();
        let cases: [(&[f64], f64); 4] = [
            (&[0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0], 1.0),
            (&[0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0], -1.0),
            (&[2.0, 1.0, 0.0, 1.0, -3.0, 0.5, 0.2, 0.1, 1.0], -1.0),
            (&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0], -1.0),
        ];
        for (matrix, sign) in cases {
            lu.reset(3).copy_from_slice(matrix);
            lu.factor().unwrap();
            assert_eq!(lu.determinant_sign(), sign);
        }
    }

    #[test]
    fn a_singular_matrix_is_refused() {
        let mut lu = Lu::default();
        lu.reset(2).copy_from_slice(&[1.0, 2.0, 2.0, 4.0]);
        assert!(matches!(lu.factor(), Err(LinalgError::Singular { .. })));
    }
}
