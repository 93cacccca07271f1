//! Dense linear algebra: the only file that names faer types.
//!
//! Matrices are row-major; factorisations work in place in buffers that their owners keep.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::{Mat, MatMut, MatRef, Par, Side, Spec};
use rustfft::num_complex::Complex64;
use std::ops::{Index, IndexMut};
use thiserror::Error;

/// Why a factorisation or an eigenvalue problem could not be computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum LinalgError {
    /// A pivot of the factorisation is zero or not finite.
    #[error("the matrix is singular or not finite (pivot {pivot} of {size})")]
    Singular {
        /// Index of the first bad pivot.
        pivot: usize,
        /// Order of the matrix.
        size: usize,
    },
    /// The Cholesky factorisation met a pivot that is not positive.
    #[error("the matrix is not positive definite (leading minor {0})")]
    NotPositiveDefinite(usize),
    /// An eigenvalue iteration did not converge.
    #[error("the eigenvalue iteration did not converge")]
    NoConvergence,
}

/// Dense real matrix, row-major.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    rows: usize,
    cols: usize,
    data: Vec<f64>,
}

impl Matrix {
    /// Zero matrix of `rows` × `cols`.
    pub fn zeros(rows: usize, cols: usize) -> Self {
        Self { rows, cols, data: vec![0.0; rows * cols] }
    }

    /// Matrix with entries `f(i, j)`.
    pub fn from_fn(rows: usize, cols: usize, mut f: impl FnMut(usize, usize) -> f64) -> Self {
        let mut data = Vec::with_capacity(rows * cols);
        for i in 0..rows {
            data.extend((0..cols).map(|j| f(i, j)));
        }
        Self { rows, cols, data }
    }

    /// Diagonal matrix.
    pub fn diagonal(values: &[f64]) -> Self {
        Self::from_fn(values.len(), values.len(), |i, j| if i == j { values[i] } else { 0.0 })
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Row `i`.
    pub fn row(&self, i: usize) -> &[f64] {
        &self.data[i * self.cols..(i + 1) * self.cols]
    }

    /// Row `i`, mutable.
    pub fn row_mut(&mut self, i: usize) -> &mut [f64] {
        &mut self.data[i * self.cols..(i + 1) * self.cols]
    }

    /// Column `j`, copied.
    pub fn column(&self, j: usize) -> Vec<f64> {
        (0..self.rows).map(|i| self[(i, j)]).collect()
    }

    /// All entries, row after row.
    pub fn entries(&self) -> &[f64] {
        &self.data
    }

    /// Transposed copy.
    pub fn transpose(&self) -> Self {
        Self::from_fn(self.cols, self.rows, |i, j| self[(j, i)])
    }

    /// Product with a vector of `cols` entries.
    pub fn mul_vec(&self, x: &[f64]) -> Vec<f64> {
        (0..self.rows).map(|i| dot(self.row(i), x)).collect()
    }

    /// Matrix product.
    pub fn matmul(&self, other: &Matrix) -> Matrix {
        let product = self.view() * other.view();
        Matrix::from_fn(self.rows, other.cols, |i, j| product[(i, j)])
    }

    fn view(&self) -> MatRef<'_, f64> {
        MatRef::from_row_major_slice(&self.data, self.rows, self.cols)
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;
    fn index(&self, (i, j): (usize, usize)) -> &f64 {
        &self.data[i * self.cols + j]
    }
}

impl IndexMut<(usize, usize)> for Matrix {
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut f64 {
        &mut self.data[i * self.cols + j]
    }
}

/// Runs a computation compiled for the widest vector instructions of this processor. Only what is inlined into `f` gains.
#[inline(always)]
pub fn vectorised<R>(f: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(f)
}

/// Scalar product, summed in eight interleaved parts: the order of summation, and so the result, is the same on every
/// processor.
#[inline(always)]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut parts = [0.0; 8];
    let (chunks_a, chunks_b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = chunks_a.remainder().iter().zip(chunks_b.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in chunks_a.zip(chunks_b) {
        for i in 0..8 {
            parts[i] += x[i] * y[i];
        }
    }
    ((parts[0] + parts[4]) + (parts[1] + parts[5])) + ((parts[2] + parts[6]) + (parts[3] + parts[7])) + rest
}

/// y ← y + a·x.
#[inline(always)]
pub fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}

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
    #[cfg(test)]
    pub(crate) fn entries(&self) -> &[f64] {
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

/// Eigenvalues of a square matrix, in no particular order.
///
/// # Errors
/// If an entry is not finite, or the iteration does not converge.
pub fn eigenvalues(matrix: &Matrix) -> Result<Vec<Complex64>, LinalgError> {
    if !matrix.data.iter().all(|entry| entry.is_finite()) {
        return Err(LinalgError::NoConvergence);
    }
    matrix.view().eigenvalues().map_err(|_| LinalgError::NoConvergence)
}

/// Eigenvalues (ascending) and M-orthonormal eigenvectors (columns) of K φ = λ M φ, K and M symmetric, M positive
/// definite.
///
/// Cholesky of M and a symmetric eigenvalue problem, then one step of iterative refinement: without it the lowest
/// eigenvalue is only good to machine precision times λ_max/λ_min, which a lightly damped resonance amplifies.
///
/// # Errors
/// If M is not positive definite, or the iteration does not converge.
pub fn symmetric_eigen(k: &Matrix, m: &Matrix) -> Result<(Vec<f64>, Matrix), LinalgError> {
    use faer::linalg::cholesky::llt::factor::LltError;
    use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
    let n = k.rows();
    let llt = m.view().llt(Side::Lower).map_err(|error| match error {
        LltError::NonPositivePivot { index } => LinalgError::NotPositiveDefinite(index + 1),
    })?;
    let lower = llt.L();
    let mut reduced: Mat<f64> = k.view().to_owned();
    solve_lower_triangular_in_place(lower, reduced.as_mut(), Par::Seq);
    let mut reduced = reduced.transpose().to_owned();
    solve_lower_triangular_in_place(lower, reduced.as_mut(), Par::Seq);
    let reduced = Mat::from_fn(n, n, |i, j| 0.5 * (reduced[(i, j)] + reduced[(j, i)]));
    let eigen = reduced.self_adjoint_eigen(Side::Lower).map_err(|_| LinalgError::NoConvergence)?;
    let mut vectors = eigen.U().to_owned();
    solve_upper_triangular_in_place(lower.transpose(), vectors.as_mut(), Par::Seq);
    Ok(refine(k, m, &Matrix::from_fn(n, n, |i, j| vectors[(i, j)])))
}

/// Eigenvalues closer than this, relative to the largest one, are rounding: rigid-body modes.
const EIGENVALUE_ROUNDING: f64 = 1e-12;

/// One first-order perturbation step on an eigenbasis that is already nearly right.
fn refine(k: &Matrix, m: &Matrix, vectors: &Matrix) -> (Vec<f64>, Matrix) {
    let n = k.rows();
    let transposed = vectors.transpose();
    let kh = transposed.matmul(&k.matmul(vectors));
    let mh = transposed.matmul(&m.matmul(vectors));
    let values: Vec<f64> = (0..n).map(|j| kh[(j, j)] / mh[(j, j)]).collect();
    let rounding = EIGENVALUE_ROUNDING * values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let correction = Matrix::from_fn(n, n, |i, j| {
        if i == j {
            return 1.0 / mh[(j, j)].sqrt();
        }
        let (off_k, off_m) = (0.5 * (kh[(i, j)] + kh[(j, i)]), 0.5 * (mh[(i, j)] + mh[(j, i)]));
        let separation = values[j] - values[i];
        // A (nearly) double eigenvalue has no preferred basis: only orthonormality is restored.
        if separation.abs() < (1e-9 * values[j].abs().max(values[i].abs())).max(rounding) {
            -0.5 * off_m
        } else {
            (off_k - values[j] * off_m) / separation
        }
    });
    let refined = vectors.matmul(&correction);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let sorted = Matrix::from_fn(n, n, |i, j| refined[(i, order[j])]);
    (order.iter().map(|&j| values[j]).collect(), sorted)
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn eigenpairs_satisfy_their_equations() {
        let k = Matrix::from_fn(4, 4, |i, j| match i.abs_diff(j) {
            0 => 2.0e6 * (1 + i * i * i) as f64,
            1 => -1.0e5,
            _ => 0.0,
        });
        let m = Matrix::from_fn(4, 4, |i, j| if i == j { 2.0 } else { 0.3 });
        let (values, vectors) = symmetric_eigen(&k, &m).unwrap();
        for j in 0..4 {
            let phi = vectors.column(j);
            let (kphi, mphi) = (k.mul_vec(&phi), m.mul_vec(&phi));
            for i in 0..4 {
                assert!((kphi[i] - values[j] * mphi[i]).abs() < 1e-13 * values[3]);
            }
            assert!((dot(&phi, &mphi) - 1.0).abs() < 1e-14);
        }
        assert!(values.is_sorted());
    }

    #[test]
    fn rigid_body_modes_are_orthonormal() {
        // Three free chains of three masses each.
        let chain = |i: usize, j: usize| match (i / 3 == j / 3, i.abs_diff(j)) {
            (true, 0) => 1e6 * if i % 3 == 1 { 2.0 } else { 1.0 },
            (true, 1) => -1e6,
            _ => 0.0,
        };
        let k = Matrix::from_fn(9, 9, chain);
        let m = Matrix::from_fn(9, 9, |i, j| if i == j { 1.0 + 0.1 * i as f64 } else { 0.01 });
        let (values, vectors) = symmetric_eigen(&k, &m).unwrap();
        assert!(values.is_sorted());
        assert!(values[2].abs() < 1e-12 * values[8] && values[3] > 0.1 * values[8]);
        let product = vectors.transpose().matmul(&m.matmul(&vectors));
        for i in 0..9 {
            for j in 0..9 {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((product[(i, j)] - expected).abs() < 1e-13, "({i}, {j}): {}", product[(i, j)]);
            }
        }
    }

    #[test]
    fn an_indefinite_mass_is_refused() {
        let m = Matrix::diagonal(&[1.0, -1.0]);
        let error = symmetric_eigen(&Matrix::diagonal(&[1.0, 1.0]), &m).unwrap_err();
        assert_eq!(error, LinalgError::NotPositiveDefinite(2));
    }
}
