//! Dense linear algebra and Fourier transforms: the only files that name types of faer and rustfft. Matrices and vectors
//! here, factorisations, eigenvalues and transforms beside.
//!
//! A crate of its own, since the compiler needs longer for what these libraries leave to it than for many files of the
//! solver. Matrices are row-major; factorisations work in place in buffers that their owners keep.

mod eigen;
mod fourier;
mod lu;

pub use eigen::{eigen, eigenvalues, symmetric_eigen};
pub use fourier::Fourier;
pub use lu::{Lu, solve_complex};

use faer::{Accum, MatMut, MatRef, Par};
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
    #[inline]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[inline]
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Row `i`.
    #[inline]
    pub fn row(&self, i: usize) -> &[f64] {
        &self.data[i * self.cols..(i + 1) * self.cols]
    }

    /// Row `i`, mutable.
    #[inline]
    pub fn row_mut(&mut self, i: usize) -> &mut [f64] {
        &mut self.data[i * self.cols..(i + 1) * self.cols]
    }

    /// Column `j`, copied.
    pub fn column(&self, j: usize) -> Vec<f64> {
        (0..self.rows).map(|i| self[(i, j)]).collect()
    }

    /// All entries, row after row.
    #[inline]
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

/// `out` = A B of row-major matrices, `inner` the number of columns of A and of rows of B.
pub fn multiply(a: &[f64], b: &[f64], inner: usize, out: &mut [f64]) {
    let (rows, cols) = (a.len() / inner, b.len() / inner);
    faer::linalg::matmul::matmul(
        MatMut::from_row_major_slice_mut(out, rows, cols),
        Accum::Replace,
        MatRef::from_row_major_slice(a, rows, inner),
        MatRef::from_row_major_slice(b, inner, cols),
        1.0,
        Par::Seq,
    );
}

/// `out` = A Bᵀ of row-major matrices, `inner` the number of columns of both.
pub fn multiply_transposed(a: &[f64], b: &[f64], inner: usize, out: &mut [f64]) {
    let (rows, cols) = (a.len() / inner, b.len() / inner);
    faer::linalg::matmul::matmul(
        MatMut::from_row_major_slice_mut(out, rows, cols),
        Accum::Replace,
        MatRef::from_row_major_slice(a, rows, inner),
        MatRef::from_row_major_slice(b, cols, inner).transpose(),
        1.0,
        Par::Seq,
    );
}

/// Rows as they are written in code.
impl<const ROWS: usize, const COLS: usize> From<[[f64; COLS]; ROWS]> for Matrix {
    fn from(rows: [[f64; COLS]; ROWS]) -> Self {
        Self::from_fn(ROWS, COLS, |i, j| rows[i][j])
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;

    #[inline]
    fn index(&self, (i, j): (usize, usize)) -> &f64 {
        &self.data[i * self.cols + j]
    }
}

impl IndexMut<(usize, usize)> for Matrix {
    #[inline]
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut f64 {
        &mut self.data[i * self.cols + j]
    }
}

/// Runs a computation compiled for the widest vector instructions of this processor. Only what is inlined into `f` gains, and `f`
/// itself only if it says so: `vectorised(#[inline(always)] || …)`.
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
