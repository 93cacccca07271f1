//! Branch points of a branch: where the determinant of the Jacobian bordered by the tangent changes its sign though the curve goes straight
//! on, or touches zero and keeps it (two eigenvalues at once, as structures with symmetries have them).
//!
//! A walk notices where one step changes the sign. Two changes within a step, or none at a zero, it does not notice: they are told by the
//! distance of the Jacobian from a singular one, which falls towards the step from one of its sides as if it went to zero within it.

use crate::curve::continuation::{Continuation, CurvePoint};
use crate::curve::extrema::Maximum;
use crate::curve::problem::{Problem, inner, norm, weighted};
use crate::curve::sides::Side;
use crate::curve::walk::Evaluated;
use crate::response::branch::{BranchPoint, TracedPoint};

/// Least cosine between the tangents on either side of a branch point, and between a way there and the tangent that it began with.
const STRAIGHT: f64 = 0.9;

/// At this share of the distance at the lower end a Jacobian is singular, as far as can be told.
const SINGULAR: f64 = 1e-3;

/// A singular Jacobian is looked for until this share of a step is left, or the least distance from one is more than so many times what it
/// is on the way down to zero and up again.
const NARROW: f64 = 1e-4;
const STEEP: f64 = 2.0;

/// Share of the longer part of a step at which it is looked at next (golden section).
const SECTION: f64 = 0.382;

/// Branch points are located to this arc length: nearer to them Newton's method may lead to the curve that crosses.
const LOCATED: f64 = 2e-5;

/// A point of a branch that its steps have passed over.
pub(super) struct Passed {
    /// The point.
    pub place: Maximum<BranchPoint>,
    /// Whether it is a branch point, or as good as one: where the determinant changes its sign, just before that.
    pub is_branch_point: bool,
}

/// The branch points of a walked branch, and points between such that lie within one step.
pub(super) fn branch_points<P: Problem>(
    continuation: &mut Continuation<'_, P>,
    visited: &[TracedPoint],
    closed: bool,
) -> Vec<Passed>
where
    BranchPoint: Evaluated<P>,
{
    let count = visited.len();
    let steps = if closed { count } else { count.saturating_sub(1) };
    let mut found = Vec::new();
    for from in 0..steps {
        let curve = |index: usize| &visited[index % count].curve;
        let around = (closed || (from > 0 && from + 2 < count)).then(|| [curve(from + count - 1), curve(from + 2)]);
        for (located, is_branch_point) in within(continuation, [curve(from), curve(from + 1)], around) {
            let located = located.map(|curve| {
                let point = BranchPoint::evaluate(continuation.problem(), &curve);
                (curve.step, TracedPoint { curve, point })
            });
            found.push(Passed { place: Maximum { anchor: from, located }, is_branch_point });
        }
    }
    found
}

/// Whether the determinant changes its sign on a step and the curve goes straight on. All tangents point ahead: where a curve turns back,
/// as it may at corners, they are opposite.
fn is_crossed(metric: &[f64], [from, to]: [&CurvePoint; 2]) -> bool {
    from.orientation * to.orientation < 0.0 && inner(metric, &from.tangent, &to.tangent) > STRAIGHT
}

/// Branch points within a step, whose points may have another one before and behind them, and points between such: each, if it is not the
/// first point of the step itself, and whether it is a branch point.
fn within<P: Problem>(
    continuation: &mut Continuation<'_, P>,
    [from, to]: [&CurvePoint; 2],
    around: Option<[&CurvePoint; 2]>,
) -> Vec<(Option<CurvePoint>, bool)> {
    let metric = continuation.problem().metric();
    let length = distance(metric, [from, to]);
    if is_crossed(metric, [from, to]) {
        let mut step = Step { continuation, from, length };
        return vec![(step.last_before((0.0, length), from.orientation), true)];
    }
    let zero = around.and_then(|[before, behind]| zero(metric, [before, from, to, behind]));
    let points = zero.map_or_else(Vec::new, |zero| Step { continuation, from, length }.singular(to, zero));
    points.into_iter().map(|(point, is_branch_point)| (Some(point), is_branch_point)).collect()
}

/// Distance of two points.
fn distance(metric: &[f64], [from, to]: [&CurvePoint; 2]) -> f64 {
    let chord: Vec<f64> = to.y.iter().zip(&from.y).map(|(to, from)| to - from).collect();
    norm(metric, &chord)
}

/// Where within the step between the middle ones of four points the distance from a singular Jacobian goes to zero if it goes on from one of
/// its sides as it fell up to there, as an arc length from the second one, and how steeply it falls.
fn zero(metric: &[f64], [before, from, to, behind]: [&CurvePoint; 4]) -> Option<(f64, f64)> {
    if from.orientation * to.orientation <= 0.0 {
        return None;
    }
    let [first, left, right, last] = [before, from, to, behind].map(|point| point.orientation.abs());
    let length = distance(metric, [from, to]);
    let falls = (first - left) / distance(metric, [before, from]);
    let rises = (last - right) / distance(metric, [to, behind]);
    let zeros = [(falls, left, 0.0), (rises, right, length)].into_iter().filter(|(slope, ..)| *slope > 0.0);
    let nearest = zeros.min_by(|(a, left, _), (b, right, _)| (left / a).total_cmp(&(right / b)))?;
    let (slope, value, side) = nearest;
    let arc = (side - value / slope).abs();
    (value < slope * length).then_some((arc, slope))
}

/// A step of a curve, from a point on.
struct Step<'s, 'p, P: Problem> {
    continuation: &'s mut Continuation<'p, P>,
    from: &'s CurvePoint,
    length: f64,
}

impl<P: Problem> Step<'_, '_, P> {
    /// The point at an arc length along the tangent, which is its step, with the determinant at itself.
    fn at(&mut self, arc: f64) -> Option<CurvePoint> {
        let row = weighted(self.continuation.problem().metric(), &self.from.tangent);
        let y = self.from.y.iter().zip(&self.from.tangent).map(|(y, t)| y + arc * t).collect();
        let point = CurvePoint { step: arc, ..self.continuation.correct_on(y, &row).ok()? };
        let problem = self.continuation.problem();
        // Next to a branch point the Jacobian tells no tangent.
        let is_next = STRAIGHT * distance(problem.metric(), [self.from, &point]) < arc
            && problem.are_neighbours(&self.from.y, &point.y)
            && Side::of(problem, &self.from.y, &point.y) == Side::Same;
        is_next.then_some(point)
    }

    /// Branch points on the way to the next point, looked for from an arc length on; the distance from a singular Jacobian falls there with
    /// this slope. Where the determinant keeps its sign, there is one. Where it does not there are two, and the point that tells so lies
    /// between them.
    fn singular(&mut self, to: &CurvePoint, (mut arc, mut slope): (f64, f64)) -> Vec<(CurvePoint, bool)> {
        let sign = self.from.orientation;
        let [left, right] = [self.from, to].map(|point| point.orientation.abs());
        let (mut below, mut above) = (0.0, self.length);
        let mut best = if left < right { (below, left) } else { (above, right) };
        let singular = SINGULAR * best.1;
        loop {
            if above - below < NARROW * self.length || best.1 > STEEP * slope * (above - below) {
                return Vec::new();
            }
            let Some(point) = self.at(arc) else { return Vec::new() };
            if point.orientation * sign < 0.0 {
                let first = self.last_before((0.0, arc), sign);
                let second = self.last_before((arc, self.length), -sign);
                let found = [(first, true), (Some(point), false), (second, true)];
                return found
                    .into_iter()
                    .filter_map(|(point, is_branch_point)| Some((point?, is_branch_point)))
                    .collect();
            }
            let value = point.orientation.abs();
            if value < singular {
                return vec![(point, true)];
            }
            slope = slope.max((value - best.1).abs() / (arc - best.0).abs());
            // The step narrows to where the lowest point has others on either side.
            let is_lower = value < best.1;
            let bound = if is_lower { best.0 } else { arc };
            if is_lower == (arc > best.0) {
                below = bound
            } else {
                above = bound
            }
            best = if is_lower { (arc, value) } else { best };
            let (before, behind) = (best.0 - below, above - best.0);
            arc = best.0 + if behind > before { SECTION * behind } else { -SECTION * before };
        }
    }

    /// The last point between two arc lengths at which the determinant has this sign, which it has at the first of them alone.
    fn last_before(&mut self, (mut low, mut high): (f64, f64), sign: f64) -> Option<CurvePoint> {
        let mut last = None;
        while high - low > LOCATED {
            let Some(point) = self.at(f64::midpoint(low, high)) else { break };
            if point.orientation * sign > 0.0 {
                low = point.step;
                last = Some(point);
            } else {
                high = point.step;
            }
        }
        last
    }
}
