//! Sharp corners of a curve: where a law changes its slope (a slider begins to slide at a maximum of its motion, say) the curve
//! turns at once, and if it turns by more than a right angle no plane across its tangent has a point beyond.
//!
//! The curve goes on with the same orientation: along it the determinant of the Jacobian bordered by the tangent keeps its sign, at
//! corners as elsewhere (Allgower & Georg, *Numerical Continuation Methods*, Springer 1990, chapter 12). The Jacobian just
//! beyond the corner and that sign tell which way.

use crate::curve::continuation::CurvePoint;
use crate::curve::newton::{Newton, NewtonSettings};
use crate::curve::point::{direction_at, land};
use crate::curve::problem::{Problem, inner, norm, weighted};

/// How far ahead the Jacobian beyond the corner is looked for, in shortest steps.
const AHEAD: [f64; 3] = [16.0, 128.0, 1024.0];

/// First step beyond the corner, in distances at which the Jacobian was looked for.
const STEP: f64 = 16.0;

/// Smallest cosine between the directions before and beyond the corner: one that turns by more comes back along itself, as a walk
/// does at a branch point at which the determinant changes its sign; there the angle is that by which the curve turns on the way to
/// where the Jacobian is looked for.
const BACK: f64 = -0.999;

/// Smallest cosine between the direction that the Jacobian tells and the tangent at the point found.
const ALONG: f64 = 0.99;

/// The first point of a curve beyond a corner next to `current`, at which a walk has stalled, whose steps are between these.
pub fn beyond<P: Problem>(
    problem: &mut P,
    newton: &mut Newton,
    settings: &NewtonSettings,
    current: &CurvePoint,
    (shortest, longest): (f64, f64),
) -> Option<CurvePoint> {
    if !problem.turns_corners() {
        return None;
    }
    AHEAD.iter().map(|ahead| ahead * shortest).filter(|ahead| STEP * ahead <= longest).find_map(|ahead| {
        let direction = direction(problem, current, ahead)?;
        let step = STEP * ahead;
        let row = weighted(problem.metric(), &direction);
        let y = current.y.iter().zip(&direction).map(|(y, t)| y + step * t).collect();
        let mut point = land(problem, newton, y, &row, settings).ok()?;
        let metric = problem.metric();
        let cosine = inner(metric, &point.tangent, &direction);
        let moved: Vec<f64> = point.y.iter().zip(&current.y).map(|(a, b)| a - b).collect();
        // The way back along the tangent passes as near as the corner is.
        let along = inner(metric, &moved, &point.tangent);
        let miss: Vec<f64> = moved.iter().zip(&point.tangent).map(|(m, t)| m - along * t).collect();
        let is_next = cosine > ALONG
            && point.orientation.signum() == current.orientation.signum()
            && norm(metric, &miss) < 2.0 * ahead + (1.0 - ALONG) * step
            && problem.are_neighbours(&current.y, &point.y)
            && !problem.hops(&current.y, &point.y);
        point.step = step;
        is_next.then_some(point)
    })
}

/// The direction of the curve beyond a corner at most `ahead` of a point; none where the curve turns by less than a right angle, or
/// comes back along itself.
fn direction<P: Problem>(problem: &mut P, current: &CurvePoint, ahead: f64) -> Option<Vec<f64>> {
    let y = current.y.iter().zip(&current.tangent).map(|(y, t)| y + ahead * t).collect();
    let row = weighted(problem.metric(), &current.tangent);
    let forward = direction_at(problem, y, &row)?;
    // Forward is where the row grows: the determinant with it has the sign of that with the row.
    if problem.orientation().signum() == current.orientation.signum() {
        return None;
    }
    let direction: Vec<f64> = forward.iter().map(|t| -t).collect();
    (inner(problem.metric(), &direction, &current.tangent) > BACK).then_some(direction)
}

#[cfg(test)]
mod tests {
    use crate::curve::bent::Bent;
    use crate::curve::continuation::{Continuation, ContinuationSettings};

    /// The last of three hundred points from so far below, and whether the walk has stalled.
    fn walked(slopes: [f64; 2], below: f64) -> (Vec<f64>, bool) {
        let mut bent = Bent::new(slopes);
        let (first, settings) = (vec![slopes[0] * below, -below], ContinuationSettings::default());
        let mut walk = Continuation::start(&mut bent, first, &[0.0, 1.0], settings).unwrap();
        let last = walk.by_ref().take(300).last().unwrap();
        (last.y, walk.stalled().is_some())
    }

    #[test]
    fn a_walk_goes_on_beyond_a_sharp_corner() {
        for slopes in [[-1.0, -2.0], [-1.0, 0.5], [-1.0, 1.5], [-1.0, 5.0], [-10.0, 1.0], [-10.0, 10.0]] {
            let (last, has_stalled) = walked(slopes, 1.0);
            assert!(!has_stalled && last[1] > 1.0, "{slopes:?}: {last:?}");
            assert!((last[0] + slopes[1] * last[1]).abs() < 1e-12, "{slopes:?}: {last:?}");
        }
    }

    /// The angle between what comes in and what goes out is one degree.
    #[test]
    fn a_walk_does_not_come_back_along_itself() {
        let (last, has_stalled) = walked([-100.0, 100.0], 0.01);
        assert!(has_stalled && last[1] < 0.0, "{last:?}");
    }
}
