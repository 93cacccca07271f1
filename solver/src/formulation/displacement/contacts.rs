//! Which contact pressures a field of dof forces stands for.

use crate::formulation::FormulationError;
use crate::linalg::{Matrix, symmetric_eigen};

/// Relative size below which a direction counts as dependent on others.
const RANK_TOLERANCE: f64 = 1e-10;

/// Least-squares left inverse P of the contact normals B_N (c × contacts) that is blind to forces along B_T:
/// P B_N = I, P B_T = 0. A contact between two bodies, b = (1, −1), has P = (½, −½): with the row b instead, its
/// pressure would count twice.
pub(super) fn left_inverse(normals: &Matrix, tangents: &Matrix, names: &[&str]) -> Result<Matrix, FormulationError> {
    let (dofs, contacts) = (normals.rows(), normals.cols());
    if contacts == 0 {
        return Ok(Matrix::zeros(0, dofs));
    }
    let failed = |_| FormulationError::NoConvergence;
    let identity = |n: usize| Matrix::diagonal(&vec![1.0; n]);
    // Projector onto the complement of the tangential directions, which may depend on each other.
    let mut projector = identity(dofs);
    if tangents.cols() > 0 {
        let (values, vectors) =
            symmetric_eigen(&tangents.matmul(&tangents.transpose()), &identity(dofs)).map_err(failed)?;
        let largest = values.iter().fold(0.0f64, |m, v| m.max(*v));
        for k in (0..dofs).filter(|&k| values[k] > RANK_TOLERANCE * largest) {
            for i in 0..dofs {
                for j in 0..dofs {
                    projector[(i, j)] -= vectors[(i, k)] * vectors[(j, k)];
                }
            }
        }
    }
    let seen = projector.matmul(normals);
    let (values, vectors) = symmetric_eigen(&normals.transpose().matmul(&seen), &identity(contacts)).map_err(failed)?;
    let largest = (0..contacts).map(|j| normals.column(j).iter().map(|b| b * b).sum::<f64>()).fold(0.0, f64::max);
    let dependent: Vec<usize> = (0..contacts).filter(|&k| values[k] <= RANK_TOLERANCE * largest).collect();
    if !dependent.is_empty() {
        let involved = |i: usize| dependent.iter().any(|&k| vectors[(i, k)].abs() > 1e-6);
        let names = (0..contacts).filter(|&i| involved(i)).map(|i| names[i].to_string()).collect();
        return Err(FormulationError::Inseparable { names });
    }
    let inverse = Matrix::from_fn(contacts, contacts, |i, j| {
        (0..contacts).map(|k| vectors[(i, k)] * vectors[(j, k)] / values[k]).sum()
    });
    Ok(inverse.matmul(&seen.transpose()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns given by (dof, coefficient) pairs.
    fn columns(dofs: usize, list: &[&[(usize, f64)]]) -> Matrix {
        let mut b = Matrix::zeros(dofs, list.len());
        for (j, column) in list.iter().enumerate() {
            column.iter().for_each(|&(i, factor)| b[(i, j)] += factor);
        }
        b
    }

    #[test]
    fn pressures_come_back_and_friction_is_not_seen() {
        let normals = columns(5, &[&[(0, 1.0)], &[(1, 1.0), (2, -1.0)], &[(2, 1.0), (3, 0.5)]]);
        let tangents = columns(5, &[&[(0, 0.3), (4, 1.0)], &[(4, 2.0), (0, 0.6)]]);
        let p = left_inverse(&normals, &tangents, &["a", "b", "c"]).unwrap();
        let (unit, zero) = (p.matmul(&normals), p.matmul(&tangents));
        for i in 0..3 {
            for j in 0..3 {
                assert!((unit[(i, j)] - if i == j { 1.0 } else { 0.0 }).abs() < 1e-14);
            }
            assert!(zero.row(i).iter().all(|v| v.abs() < 1e-14));
        }
    }

    #[test]
    fn a_contact_between_two_bodies_shares_its_force() {
        let p = left_inverse(&columns(2, &[&[(0, 1.0), (1, -1.0)]]), &Matrix::zeros(2, 0), &["stop"]).unwrap();
        assert!((p[(0, 0)] - 0.5).abs() < 1e-15 && (p[(0, 1)] + 0.5).abs() < 1e-15);
    }

    #[test]
    fn contacts_that_cannot_be_told_apart_are_named() {
        let normals = columns(3, &[&[(0, 1.0)], &[(1, 1.0)], &[(0, -2.0)]]);
        let error = left_inverse(&normals, &Matrix::zeros(3, 0), &["left", "top", "right"]).unwrap_err();
        assert_eq!(error, FormulationError::Inseparable { names: vec!["left".into(), "right".into()] });
        assert!(error.to_string().contains("contacts left, right cannot be told apart"), "{error}");
    }
}
