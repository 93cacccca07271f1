//! Eigenvalues of a general matrix, eigenpairs of a symmetric pencil.

use super::{LinalgError, Matrix};
use faer::{Mat, Par, Side};
use num_complex::Complex64;

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

/// Eigenvalues of a square matrix, each with its right eigenvector, in no particular order.
///
/// # Errors
/// If an entry is not finite, or the iteration does not converge.
pub fn eigen(matrix: &Matrix) -> Result<Vec<(Complex64, Vec<Complex64>)>, LinalgError> {
    if !matrix.data.iter().all(|entry| entry.is_finite()) {
        return Err(LinalgError::NoConvergence);
    }
    let found = matrix.view().eigen().map_err(|_| LinalgError::NoConvergence)?;
    let (values, vectors) = (found.S().column_vector(), found.U());
    Ok((0..matrix.rows).map(|k| (values[k], (0..matrix.rows).map(|i| vectors[(i, k)]).collect())).collect())
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
    use crate::dot;

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
