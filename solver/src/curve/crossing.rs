//! Where a curve crosses another one the determinant of its Jacobian changes its sign, and goes to zero on the way. Where a step has hopped
//! to another part of the curve the sign may have changed as well, but on the way there it jumps, however near the two parts are.

use crate::curve::newton::{Newton, NewtonSettings};
use crate::curve::point::{CurvePoint, land};
use crate::curve::problem::{Problem, inner, weighted};

/// Smallest cosine between the tangents on either side.
const STRAIGHT: f64 = 0.9;

/// By how much more than evenly the distance from a singular Jacobian may change over the last piece of the way.
const EVEN: f64 = 10.0;

/// Behind a point from which a step may lead over a crossing the distance from a singular Jacobian is this share of what it was one step
/// before that point, at most.
const LED: f64 = 0.2;

/// Whether a step that changes the sign may be led over a crossing: on both sides the Jacobian is much nearer to a singular one than it was
/// before.
pub fn is_led_to(before: &CurvePoint, [last, first]: [&CurvePoint; 2]) -> bool {
    [last, first].iter().all(|point| point.orientation.abs() < LED * before.orientation.abs())
}

/// The arc length from the first of two points, along its tangent, to the crossing that lies between them, to `near`, if there is one.
pub fn between<P: Problem>(
    problem: &mut P,
    newton: &mut Newton,
    settings: &NewtonSettings,
    [from, to]: [&CurvePoint; 2],
    near: f64,
) -> Option<f64> {
    let metric = problem.metric();
    let row = weighted(metric, &from.tangent);
    let way: Vec<f64> = to.y.iter().zip(&from.y).map(|(to, from)| to - from).collect();
    let length = inner(metric, &way, &from.tangent);
    if length < 2.0 * near || inner(metric, &from.tangent, &to.tangent) < STRAIGHT {
        return None;
    }
    let (mut low, mut before) = (0.0, from.orientation.abs());
    let (mut high, mut behind) = (length, to.orientation.abs());
    while high - low > near {
        let arc = f64::midpoint(low, high);
        let y = from.y.iter().zip(&from.tangent).map(|(y, t)| y + arc * t).collect();
        let point = land(problem, newton, y, &row, settings).ok()?;
        if !problem.are_neighbours(&from.y, &point.y) || problem.hops(&from.y, &point.y) {
            return None;
        }
        let size = point.orientation.abs();
        if point.orientation * from.orientation > 0.0 {
            (low, before) = (arc, size)
        } else {
            (high, behind) = (arc, size)
        }
    }
    let even = (from.orientation.abs() + to.orientation.abs()) * (high - low) / length;
    (before + behind < EVEN * even).then_some(high)
}
