//! Whether a step is one along the curve: it stays near the tangent, hops to no other part, and changes the sign of the determinant only
//! where another curve crosses.

use super::{Continuation, Rejection};
use crate::curve::crossing;
use crate::curve::newton::ACCURACY;
use crate::curve::point::{CurvePoint, land};
use crate::curve::problem::{Failure, Problem, inner, norm, weighted};
use crate::curve::sides::Side;

/// Smallest cosine between a step longer than the largest one of the settings and the mean of the tangents at its ends, which on
/// a smooth curve is next to 1. A step that has hopped across the gap between two curves that nearly meet, where both turn sharply,
/// is not along it; nor is one whose tangents belong to points nearby, which is then taken shorter without need.
const STRAIGHT: f64 = 0.996;

/// Smallest cosine between the tangents at both ends of a step, somewhat less than an arc has whose chord just stays near the tangent. Beside
/// a crossing the plane that a step ends on holds all of the other curve, nearly, and Newton's method may end there.
const TURNED: f64 = 0.5;

/// Where a step leads this much nearer to a singular Jacobian, the sign of its determinant may be that of the other side of a crossing.
const NEAR_CROSSING: f64 = 0.2;

/// Steps of so many shortest ones may change the sign of the determinant.
const CROSSING: f64 = 64.0;

/// How far before a crossing the walk stops to pass it, as a share of the way there: near enough to know that it is led to it, and so far
/// that the Jacobian still tells the direction.
const BEFORE: f64 = 0.02;

/// Length of the step over a crossing, in distances at which the walk has stopped before it: half as long, it still passes.
const PASSING: f64 = 3.0;

/// Share of a step by which the way back from its end may miss where it began; what Newton's method leaves of the motions at both ends is no
/// miss, as long as it is not more than the larger share.
const MISS: [f64; 2] = [1e-3, 0.1];

impl<P: Problem> Continuation<'_, P> {
    /// A candidate next point with the present step, or why not.
    pub(super) fn attempt(&mut self) -> Result<CurvePoint, Rejection> {
        let from = self.current.clone();
        let previous = self.previous.take();
        let result = self.correct(&from, previous.as_ref().map(|previous| &previous.y[..]), self.step);
        self.previous = previous;
        let mut point = result.map_err(Rejection::Newton)?;
        // It is that of the last matrix factorised, which belongs to a point nearby: on the other side of a crossing, perhaps. Along
        // extrema a determinant that falls tells of corners instead.
        let is_near_crossing =
            self.problem.turns_corners() && point.orientation.abs() < NEAR_CROSSING * from.orientation.abs();
        if is_near_crossing {
            match self.orientation_at(&point) {
                Ok(orientation) => point.orientation = orientation,
                // At the edge of a corner Newton's method may meet a point by chance, from which nothing leads on.
                Err(failure) if self.step > CROSSING * self.shortest() => return Err(Rejection::Newton(failure)),
                Err(_) => {}
            }
        }
        let (ahead, off) = self.angles([&from, &point], is_near_crossing);
        let turns = point.orientation.signum() != from.orientation.signum();
        if !self.problem.are_neighbours(&from.y, &point.y)
            || self.problem.hops(&from.y, &point.y)
            || self.changes_side(&from, &point)
        {
            return Err(Rejection::Distance);
        }
        // Corners (a law that changes its slope) and crossings stay what they are however short the step. So does the way back:
        // where two curves nearly meet, it leads across as well, but only as long as the step is longer than the gap.
        if off.is_some() || turns {
            let is_shortest = self.step <= CROSSING * self.shortest();
            let crossing = if off.is_some() || is_shortest { None } else { self.crossing(&from, &point) };
            let is_led = |before: &CurvePoint| crossing::is_led_to(before, [&from, &point]);
            let is_next = is_shortest || (crossing.is_some() && self.previous.as_ref().is_some_and(is_led));
            if !(is_next && ahead > 0.0 && self.leads_back(&point, &from)) {
                if let Some(point) = crossing.and_then(|arc| self.before_crossing(&from, arc)) {
                    return Ok(point);
                }
                return Err(off.map_or(Rejection::Orientation, Rejection::Angle));
            }
        }
        Ok(point)
    }

    /// Whether a step seems to lead past a motion that is its own image and does not meet it.
    fn changes_side(&mut self, from: &CurvePoint, to: &CurvePoint) -> bool {
        match Side::of(self.problem, &from.y, &to.y) {
            Side::Same => false,
            Side::Neither(index) | Side::Opposite(index) => !self.meets_own_image(from, to, index),
            Side::Unknown => true,
        }
    }

    /// Cosine between a step and the tangent that it was taken along, and the one that says that it is none along the curve, if one does.
    fn angles(&self, [from, to]: [&CurvePoint; 2], is_near_crossing: bool) -> (f64, Option<f64>) {
        let metric = self.problem.metric();
        let moved: Vec<f64> = to.y.iter().zip(&from.y).map(|(a, b)| a - b).collect();
        let ahead = inner(metric, &moved, &from.tangent) / norm(metric, &moved);
        let mean: Vec<f64> = to.tangent.iter().zip(&from.tangent).map(|(a, b)| a + b).collect();
        let straightness = inner(metric, &moved, &mean) / (norm(metric, &moved) * norm(metric, &mean));
        let turned = inner(metric, &to.tangent, &from.tangent);
        // A step that does not move has no angle.
        let is_off = ahead.is_nan() || ahead < self.settings.min_cosine;
        let off = match (self.step > self.settings.max_step && straightness < STRAIGHT, is_off) {
            (true, _) => Some(straightness),
            (false, true) => Some(ahead),
            (false, false) => Some(turned).filter(|turned| is_near_crossing && *turned < TURNED),
        };
        (ahead, off)
    }

    /// The determinant at a point itself.
    fn orientation_at(&mut self, point: &CurvePoint) -> Result<f64, Failure> {
        let row = weighted(self.problem.metric(), &point.tangent);
        let mut own = land(self.problem, &mut self.newton, point.y.clone(), &row, &self.settings.newton)?;
        if inner(self.problem.metric(), &own.tangent, &point.tangent) < 0.0 {
            own.turn_round();
        }
        Ok(own.orientation)
    }

    /// Arc length to the crossing that a step has led over, if it has.
    fn crossing(&mut self, from: &CurvePoint, to: &CurvePoint) -> Option<f64> {
        let near = 0.1 * CROSSING * self.shortest();
        crossing::between(self.problem, &mut self.newton, &self.settings.newton, [from, to], near)
    }

    /// A point before the crossing at an arc length. The next step is just long enough to pass it.
    fn before_crossing(&mut self, from: &CurvePoint, arc: f64) -> Option<CurvePoint> {
        let distance = BEFORE * arc;
        let point = self.correct(from, None, arc - distance).ok();
        let point = point.filter(|point| point.orientation * from.orientation > 0.0)?;
        self.step = PASSING * distance;
        Some(point)
    }

    /// Whether the way back from a point along its own tangent leads to the one it was reached from, as it does where
    /// curves cross. After a hop to another part of the curve it leads past it.
    fn leads_back(&mut self, point: &CurvePoint, from: &CurvePoint) -> bool {
        let metric = self.problem.metric();
        let row = weighted(metric, &point.tangent);
        let back: Vec<f64> = point.y.iter().zip(&from.y).map(|(p, f)| p - f).collect();
        let distance = norm(metric, &back);
        let arc = inner(metric, &back, &point.tangent);
        let y = point.y.iter().zip(&point.tangent).map(|(y, t)| y - arc * t).collect();
        let Ok(mut landed) = land(self.problem, &mut self.newton, y, &row, &self.settings.newton) else { return false };
        self.symmetry.keep(self.problem, &mut landed.y, &mut landed.tangent);
        let miss: Vec<f64> = landed.y.iter().zip(&from.y).map(|(a, b)| a - b).collect();
        let left = 2.0 * ACCURACY * norm(self.problem.motion_metric(), &from.y);
        norm(self.problem.metric(), &miss) < left.clamp(MISS[0] * distance, MISS[1] * distance)
    }
}
