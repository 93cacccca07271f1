//! Factors of the small matrices of touching nodes.

use crate::linalg::{LinalgError, Lu, axpy};

/// Largest order for which elimination row by row, without the preparations of a blocked factorisation, is the faster one.
const SMALL: usize = 16;

/// LU factorisation with partial pivoting of a row-major matrix, in buffers that are kept: by plain elimination if it is small.
pub struct Factors {
    size: usize,
    /// L without its diagonal of ones, and U, row-major.
    entries: Vec<f64>,
    /// The row that each row was exchanged with.
    exchanges: Vec<usize>,
    large: Lu,
    /// Right-hand sides one after the other, as [`Lu`] wants them.
    columns: Vec<f64>,
}

impl Factors {
    /// Room for matrices up to an order.
    pub fn new(most: usize) -> Self {
        let entries = Vec::with_capacity(most.min(SMALL).pow(2));
        Self { size: 0, entries, exchanges: Vec::new(), large: Lu::default(), columns: Vec::new() }
    }

    /// A row-major `size` × `size` matrix to be filled before [`factor`](Self::factor).
    #[inline(always)]
    pub fn reset(&mut self, size: usize) -> &mut [f64] {
        self.size = size;
        if size > SMALL {
            return self.large.reset(size);
        }
        self.entries.resize(size * size, 0.0);
        &mut self.entries
    }

    /// Factorises what [`reset`](Self::reset) handed out.
    ///
    /// # Errors
    /// If a pivot is zero or not finite.
    #[inline(always)]
    pub fn factor(&mut self) -> Result<(), LinalgError> {
        let n = self.size;
        if n > SMALL {
            return self.large.factor();
        }
        self.exchanges.clear();
        for k in 0..n {
            let size = |i: usize| self.entries[i * n + k].abs();
            let largest = (k + 1..n).fold(k, |largest, i| if size(i) > size(largest) { i } else { largest });
            self.exchanges.push(largest);
            exchange(&mut self.entries, n, k, largest);
            let (above, below) = self.entries.split_at_mut((k + 1) * n);
            let row = &above[k * n..];
            let pivot = row[k];
            if pivot == 0.0 || !pivot.is_finite() {
                return Err(LinalgError::Singular { pivot: k, size: n });
            }
            for other in below.chunks_exact_mut(n) {
                let share = other[k] / pivot;
                other[k] = share;
                axpy(-share, &row[k + 1..], &mut other[k + 1..]);
            }
        }
        Ok(())
    }

    /// Solves A X = B in place: `b` has one row of `columns` numbers for each row of A.
    #[inline(always)]
    pub fn solve(&mut self, b: &mut [f64], columns: usize) {
        let n = self.size;
        if n > SMALL {
            self.columns.clear();
            self.columns.extend((0..columns).flat_map(|j| b.iter().skip(j).step_by(columns)));
            self.large.solve(&mut self.columns);
            b.iter_mut().enumerate().for_each(|(at, b)| *b = self.columns[at % columns * n + at / columns]);
            return;
        }
        self.exchanges.iter().enumerate().for_each(|(k, &other)| exchange(b, columns, k, other));
        for i in 0..n {
            let (done, rest) = b.split_at_mut(i * columns);
            for (share, row) in self.entries[i * n..].iter().zip(done.chunks_exact(columns)) {
                axpy(-share, row, &mut rest[..columns]);
            }
        }
        for i in (0..n).rev() {
            let (rest, done) = b.split_at_mut((i + 1) * columns);
            let row = &mut rest[i * columns..];
            for (entry, known) in self.entries[i * n + i + 1..].iter().zip(done.chunks_exact(columns)) {
                axpy(-entry, known, row);
            }
            row.iter_mut().for_each(|x| *x /= self.entries[i * n + i]);
        }
    }
}

/// Exchanges two rows of a matrix.
#[inline(always)]
fn exchange(matrix: &mut [f64], columns: usize, a: usize, b: usize) {
    if a != b {
        let (first, last) = matrix.split_at_mut(a.max(b) * columns);
        first[a.min(b) * columns..][..columns].swap_with_slice(&mut last[..columns]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Matrix;

    #[test]
    fn small_and_large_matrices_are_solved_to_their_definition() {
        for n in [1, 2, 3, 5, SMALL, SMALL + 1, 27] {
            // Without pivoting the first pivot would be zero.
            let entry = |i: usize, j: usize| {
                if i + j == 0 && n > 1 { 0.0 } else { ((7 * i + 3 * j * j + i * j) % 11) as f64 - 4.5 }
            };
            let a = Matrix::from_fn(n, n, |i, j| entry(i, j) + if i == (j + 1) % n { 9.0 } else { 0.0 });
            let x = Matrix::from_fn(n, 3, |i, j| (i + 1) as f64 - 2.5 * j as f64);
            let mut b = a.matmul(&x).entries().to_vec();
            let mut factors = Factors::new(n);
            factors.reset(n).copy_from_slice(a.entries());
            factors.factor().unwrap();
            factors.solve(&mut b, 3);
            b.iter().zip(x.entries()).for_each(|(b, x)| assert!((b - x).abs() < 1e-10, "{n}: {b} for {x}"));
        }
    }

    #[test]
    fn singular_matrices_are_refused() {
        let mut factors = Factors::new(2);
        factors.reset(2).copy_from_slice(&[1.0, 2.0, 2.0, 4.0]);
        assert_eq!(factors.factor(), Err(LinalgError::Singular { pivot: 1, size: 2 }));
        factors.reset(1)[0] = f64::NAN;
        assert!(factors.factor().is_err());
    }
}
