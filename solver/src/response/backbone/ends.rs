//! Ends of curves of free motions: exactly where a bound of amplitude or forcing is reached, so that what follows from how far they go, as
//! frequencies that nobody gave, does not depend on steps.

use super::way::Way;
use crate::curve::continuation::{Continuation, CurvePoint};
use crate::curve::walk::{Evaluated, TracedCurve};
use crate::formulation::Formulation;
use crate::response::branch::{BranchPoint, Outcome, Stop, TracedPoint};

/// Halvings of the last step: it is known to 1e-9 of that.
const HALVINGS: usize = 30;

impl Way<'_> {
    /// Moves the ends of a curve back to where the bound is that they lie beyond.
    pub(super) fn end_at_bounds<'m, F: Formulation<'m>>(
        &self,
        continuation: &mut Continuation<'_, F>,
        curve: &mut TracedCurve<BranchPoint>,
    ) {
        let Outcome::Open(first, last) = curve.outcome else { return };
        if let [.., before, end] = &mut curve.visited[..]
            && let Some((point, step)) = self.bound_between(continuation, last, (&before.curve, end), end.curve.step)
        {
            *end = point;
            end.curve.step = step;
        }
        if let [end, next, ..] = &mut curve.visited[..]
            && let Some((point, step)) = self.bound_between(continuation, first, (&next.curve, end), -next.curve.step)
        {
            *end = point;
            (end.curve.step, next.curve.step) = (0.0, -step);
        }
    }

    /// The point where the curve reaches a bound, and the step there from a point inside, on the way to an end that a whole step leads to.
    fn bound_between<'m, F: Formulation<'m>>(
        &self,
        continuation: &mut Continuation<'_, F>,
        stop: Stop,
        (from, end): (&CurvePoint, &TracedPoint),
        step: f64,
    ) -> Option<(TracedPoint, f64)> {
        let is_beyond = |problem: &mut F, at: &TracedPoint| match stop {
            Stop::AmplitudeBound => at.point.amplitude() > self.bounds.amplitude,
            Stop::ForcingBound => self.is_beyond(problem, at),
            _ => false,
        };
        if !is_beyond(continuation.problem(), end) {
            return None;
        }
        let (mut inside, mut outside, mut found) = (0.0, step, None);
        for _ in 0..HALVINGS {
            let step = f64::midpoint(inside, outside);
            let curve = continuation.probe(from, step).ok()?;
            let point = BranchPoint::evaluate(continuation.problem(), &curve);
            let at = TracedPoint { curve, point };
            if is_beyond(continuation.problem(), &at) {
                (outside, found) = (step, Some(at));
            } else {
                inside = step;
            }
        }
        found.map(|point| (point, outside))
    }
}
