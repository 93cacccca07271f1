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
    /// Moves the ends of a curve back to where the bound is that they lie beyond. One that crosses another ends by its size, see
    /// [`end_within`].
    pub(super) fn end_at_bounds<'m, F: Formulation<'m>>(
        &self,
        continuation: &mut Continuation<'_, F>,
        curve: &mut TracedCurve<BranchPoint>,
    ) {
        let Outcome::Open(first, last) = curve.outcome else { return };
        let is_beyond = |stop: Stop| {
            move |problem: &mut F, at: &TracedPoint| match stop {
                Stop::AmplitudeBound => first != Stop::Branching && at.point.amplitude() > self.bounds.amplitude,
                Stop::ForcingBound => self.is_beyond(problem, at),
                _ => false,
            }
        };
        end_within(continuation, &mut curve.visited, &is_beyond(last));
        if let [end, next, ..] = &mut curve.visited[..] {
            let step = next.curve.step;
            if let Some((point, step)) = boundary(continuation, (&next.curve, end), -step, &is_beyond(first)) {
                *end = point;
                (end.curve.step, next.curve.step) = (0.0, -step);
            }
        }
    }
}

/// Moves the last point of a walk back to where it passes what it ends at, if it lies beyond.
pub(super) fn end_within<'m, F: Formulation<'m>>(
    continuation: &mut Continuation<'_, F>,
    visited: &mut [TracedPoint],
    is_beyond: &impl Fn(&mut F, &TracedPoint) -> bool,
) {
    let [.., before, end] = visited else { return };
    if let Some((point, step)) = boundary(continuation, (&before.curve, end), end.curve.step, is_beyond) {
        *end = point;
        end.curve.step = step;
    }
}

/// The point from which on all is beyond, and the step there from a point that is not, on the way to an end that a whole step leads to.
fn boundary<'m, F: Formulation<'m>>(
    continuation: &mut Continuation<'_, F>,
    (from, end): (&CurvePoint, &TracedPoint),
    step: f64,
    is_beyond: &impl Fn(&mut F, &TracedPoint) -> bool,
) -> Option<(TracedPoint, f64)> {
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
