//! Points of a curve, as its continuation needs them.

use crate::curve::newton::{Constraint, Newton, NewtonSettings};
use crate::curve::problem::{Failure, Problem, norm};

/// A converged point of the curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePoint {
    /// Scaled state.
    pub y: Vec<f64>,
    /// Unit tangent in the direction of travel.
    pub tangent: Vec<f64>,
    /// Newton iterations.
    pub iterations: usize,
    /// Factorisations they needed.
    pub factorisations: usize,
    /// Largest scaled residual.
    pub residual: f64,
    /// Sign of the bordered Jacobian's determinant times a measure of its distance from a singular one
    /// ([`Problem::orientation`]); a change of the sign between points marks a bifurcation.
    pub orientation: f64,
    /// Arc length of the step that led here.
    pub step: f64,
}

impl CurvePoint {
    /// Travels the other way.
    pub(crate) fn turn_round(&mut self) {
        self.tangent.iter_mut().for_each(|t| *t = -*t);
        self.orientation = -self.orientation;
    }

    /// Whether it is one of a state of this length, with finite numbers.
    pub(super) fn is_of(&self, length: usize) -> bool {
        let is_whole = |values: &[f64]| values.len() == length && values.iter().all(|value| value.is_finite());
        is_whole(&self.y) && is_whole(&self.tangent)
    }
}

/// Corrects `y` on the plane through it normal to `row`.
pub(super) fn land<P: Problem>(
    problem: &mut P,
    newton: &mut Newton,
    mut y: Vec<f64>,
    row: &[f64],
    settings: &NewtonSettings,
) -> Result<CurvePoint, Failure> {
    let origin = y.clone();
    let settings = NewtonSettings { max_iterations: 20, ..*settings };
    let constraint = Constraint::Hyperplane { row, origin: &origin };
    let convergence = newton.solve(problem, &mut y, constraint, &settings)?;
    // The last matrix may be that of a distant start: once more at the point itself, for its tangent.
    newton.solve(problem, &mut y, constraint, &settings)?;
    Ok(CurvePoint {
        orientation: problem.orientation(),
        y,
        tangent: unit(problem.metric(), newton.direction.clone()),
        iterations: convergence.iterations,
        factorisations: convergence.factorisations,
        residual: convergence.residual,
        step: 0.0,
    })
}

/// Unit direction of the curve by the Jacobian at a state next to it, the way in which `row` grows; none if there is none.
pub(crate) fn direction_at<P: Problem>(problem: &mut P, mut y: Vec<f64>, row: &[f64]) -> Option<Vec<f64>> {
    problem.linearise(&mut y).is_finite().then_some(())?;
    problem.factor(row).ok()?;
    let (mut step, mut direction) = (vec![0.0; y.len()], vec![0.0; y.len()]);
    problem.solve(0.0, &mut step, &mut direction);
    let direction = unit(problem.metric(), direction);
    direction.iter().all(|t| t.is_finite()).then_some(direction)
}

/// A direction of unit length.
pub(crate) fn unit(metric: &[f64], mut direction: Vec<f64>) -> Vec<f64> {
    let length = norm(metric, &direction);
    direction.iter_mut().for_each(|d| *d /= length);
    direction
}
