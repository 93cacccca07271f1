//! Newton's method on a [`Problem`] that nothing closes: each step is the shortest one, so that it leads to some solution not
//! far away, whichever it is.

use crate::curve::newton::{Constraint, Newton, NewtonSettings};
use crate::curve::problem::{Failure, Problem, inner, norm, weighted};

/// Longest step, relative to the motion and to each parameter. Longer ones leave what the start is near to.
const LONGEST: f64 = 0.5;

/// Scaled residual of a solution that is known roughly, from where Newton's method converges.
pub const ROUGH: f64 = 1e-6;

/// Moves `y` to a solution in at most so many steps of least norm, and from there by Newton's method in the plane normal to the
/// curve through it.
///
/// # Errors
/// Those of [`nearest`], and if Newton's method fails.
pub fn converge<P: Problem>(
    problem: &mut P,
    y: &mut [f64],
    iterations: usize,
    newton: &NewtonSettings,
) -> Result<(), Failure> {
    let tangent = nearest(problem, y, ROUGH, iterations)?;
    let (origin, row) = (y.to_vec(), weighted(problem.metric(), &tangent));
    Newton::default().solve(problem, y, Constraint::Hyperplane { row: &row, origin: &origin }, newton)?;
    Ok(())
}

/// Moves `y` to a solution in at most so many steps of least norm, and returns the direction of the curve through it (not
/// normalised).
///
/// # Errors
/// If the scaled residual is not below `tolerance` by then, or the way there meets a singular Jacobian.
pub fn nearest<P: Problem>(
    problem: &mut P,
    y: &mut [f64],
    tolerance: f64,
    iterations: usize,
) -> Result<Vec<f64>, Failure> {
    let mut row = problem.parameter_row();
    iterate(problem, y, tolerance, iterations, |problem, _, step, tangent| {
        problem.factor(&row).map_err(|_| Failure::Singular)?;
        problem.solve(0.0, step, tangent);
        let metric = problem.metric();
        let length = norm(metric, tangent);
        let along = inner(metric, step, tangent) / (length * length);
        step.iter_mut().zip(tangent.iter()).for_each(|(step, tangent)| *step -= along * tangent);
        // The last direction keeps the bordered matrix away from singular ones.
        row = weighted(metric, tangent);
        row.iter_mut().for_each(|weight| *weight /= length);
        Ok(())
    })
}

/// Moves `y` to a solution in at most so many Newton steps, each across the motion that it is taken from, so that the motion
/// neither fades nor grows: of problems that rest solves as well.
///
/// # Errors
/// If the scaled residual is not below `tolerance` by then, or the way there meets a singular Jacobian.
pub fn of_size<P: Problem>(problem: &mut P, y: &mut [f64], tolerance: f64, iterations: usize) -> Result<(), Failure> {
    let motion = problem.len() - problem.parameters();
    let across = |problem: &mut P, y: &[f64], step: &mut [f64], tangent: &mut [f64]| {
        let mut row = weighted(problem.metric(), y);
        row[motion..].fill(0.0);
        problem.factor(&row).map_err(|_| Failure::Singular)?;
        problem.solve(0.0, step, tangent);
        Ok(())
    };
    iterate(problem, y, tolerance, iterations, across).map(drop)
}

/// Takes steps until the residual is below `tolerance`; the tangent at the last one. `next` fills step and tangent at a state that
/// was linearised.
fn iterate<P: Problem>(
    problem: &mut P,
    y: &mut [f64],
    tolerance: f64,
    iterations: usize,
    mut next: impl FnMut(&mut P, &[f64], &mut [f64], &mut [f64]) -> Result<(), Failure>,
) -> Result<Vec<f64>, Failure> {
    let (mut step, mut tangent) = (vec![0.0; problem.len()], vec![0.0; problem.len()]);
    let mut residual = problem.linearise(y);
    for iteration in 0..=iterations {
        if !residual.is_finite() {
            return Err(Failure::Diverged);
        }
        if iteration > 0 && residual < tolerance {
            return Ok(tangent);
        }
        next(problem, y, &mut step, &mut tangent)?;
        advance(problem, y, &step);
        residual = problem.linearise(y);
    }
    Err(Failure::NotConverged { iterations, residual })
}

/// Takes a step, or of one that leads too far a part.
fn advance<P: Problem>(problem: &P, y: &mut [f64], step: &[f64]) {
    let motion = problem.motion_metric();
    let parameters = problem.len() - problem.parameters();
    let mut longest = norm(motion, y) / norm(motion, step);
    for (y, step) in y[parameters..].iter().zip(&step[parameters..]) {
        longest = longest.min(y.abs() / step.abs());
    }
    let share = if longest.is_finite() { (LONGEST * longest).min(1.0) } else { 1.0 };
    y.iter_mut().zip(step).for_each(|(y, step)| *y += share * step);
}
