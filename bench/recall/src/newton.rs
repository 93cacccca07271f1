//! Newton's method, onto a plane and by steps of least norm.

use crate::balance::{Balance, Bordered, Evaluation};
use crate::quadrature::{dot, norm};

/// Most steps onto a plane; a branch is followed in steps that need half as many.
const STEPS: usize = 8;

/// Converges y onto the plane through `origin` with a normal; the number of steps, and the tangent there.
pub fn onto_plane(balance: &Balance, y: &mut [f64], normal: &[f64], origin: &[f64]) -> Option<(usize, Vec<f64>)> {
    let size = balance.size();
    for step in 0..STEPS {
        let at = balance.evaluate(y);
        let bordered = Bordered::new(&at.jacobian, normal);
        let off: f64 = normal.iter().zip(y.iter().zip(origin)).map(|(n, (y, o))| n * (y - o)).sum();
        if step > 0 && balance.is_converged(y, &at.residual) {
            return Some((step, bordered.tangent(size)?));
        }
        let change = bordered.solve(Some(&at.residual), -off, size)?;
        y.iter_mut().zip(&change).for_each(|(y, change)| *y += change);
        if y[size] <= 0.0 || norm(&change) > 1e3 {
            return None;
        }
    }
    None
}

/// Leads y to some response by steps of least norm, each at most half of the motion; `enough` is the residual, of the
/// forcing, to stop at, and the tangent there is returned.
pub fn nearest(balance: &Balance, y: &mut [f64], steps: usize, enough: f64) -> Option<Vec<f64>> {
    let is_enough =
        |y: &[f64], residual: &[f64]| norm(residual) <= enough * balance.forcing || balance.is_converged(y, residual);
    least_norm(&|y| balance.evaluate(y), &is_enough, y, steps)
}

/// Leads y to some solution by steps of least norm; the last unknown is the frequency.
pub fn least_norm(
    evaluate: &dyn Fn(&[f64]) -> Evaluation,
    is_enough: &dyn Fn(&[f64], &[f64]) -> bool,
    y: &mut [f64],
    steps: usize,
) -> Option<Vec<f64>> {
    let size = y.len() - 1;
    let mut row = vec![0.0; size + 1];
    row[size] = 1.0;
    for _ in 0..steps {
        let at = evaluate(y);
        let bordered = Bordered::new(&at.jacobian, &row);
        row = bordered.tangent(size)?;
        if is_enough(y, &at.residual) {
            return Some(row);
        }
        // Any solution of the linearised equations, less its part along the tangent, is the one of least norm.
        let mut change = bordered.solve(Some(&at.residual), 0.0, size)?;
        let along = dot(&change, &row);
        change.iter_mut().zip(&row).for_each(|(change, tangent)| *change -= along * tangent);
        let (length, motion) = (norm(&change), norm(&y[..size]));
        let share = (0.5 * motion / length).min(0.3 * y[size] / change[size].abs()).min(1.0);
        y.iter_mut().zip(&change).for_each(|(y, change)| *y += share * change);
    }
    None
}
