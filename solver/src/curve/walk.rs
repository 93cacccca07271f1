//! Walking a curve to its end: bounds, closure, reversal.

use crate::curve::continuation::{Continuation, ContinuationSettings, CurvePoint, Rejection};
use crate::curve::outcome::{Outcome, Stop};
use crate::curve::problem::{Failure, Problem, inner, norm};
use std::ops::ControlFlow;

/// What is evaluated of every point of a curve of `P`, once, when it is reached.
pub trait Evaluated<P>: Clone {
    /// Evaluates a converged point.
    fn evaluate(problem: &mut P, point: &CurvePoint) -> Self;

    /// Frequency ω, rad/s.
    fn omega(&self) -> f64;

    /// Amplitude that bounds apply to, m.
    fn amplitude(&self) -> f64;
}

/// Told of every point a walk steps to (not of its first point); breaking cancels the walk.
pub type Observer<'o, T> = dyn FnMut(&T) -> ControlFlow<()> + 'o;

/// Where a walk ends.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    /// Frequencies, rad/s.
    pub frequency: (f64, f64),
    /// Largest amplitude, m.
    pub amplitude: f64,
    /// Largest number of points.
    pub points: usize,
    /// Relative distance at which the curve has closed; `None`: closing is not looked for.
    pub closure: Option<f64>,
}

/// A point of a walk: as the continuation needs it and as people do.
#[derive(Debug, Clone)]
pub struct Visited<T> {
    /// Scaled state and tangent.
    pub curve: CurvePoint,
    /// Evaluated point.
    pub point: T,
}

/// Walks until a bound, a closed loop or a failure, from the continuation's current point (included).
pub fn walk<P: Problem, T: Evaluated<P>>(
    continuation: &mut Continuation<'_, P>,
    bounds: &Bounds,
    observer: &mut Observer<'_, T>,
) -> (Vec<Visited<T>>, Stop) {
    let first = continuation.current().clone();
    let point = T::evaluate(continuation.problem(), &first);
    let outside = |point: &T| {
        let (low, high) = bounds.frequency;
        // A walk may start at a bound.
        point.omega() < low * (1.0 - 1e-9) || point.omega() > high * (1.0 + 1e-9)
    };
    let too_large = |point: &T| point.amplitude() > bounds.amplitude;
    let start = if outside(&point) {
        Some(Stop::FrequencyBound)
    } else if too_large(&point) {
        Some(Stop::AmplitudeBound)
    } else {
        None
    };
    let mut visited = vec![Visited { curve: first, point }];
    if let Some(stop) = start {
        return (visited, stop);
    }
    loop {
        if visited.len() >= bounds.points {
            return (visited, Stop::PointBudget);
        }
        let Some(curve) = continuation.next() else {
            let rejection = continuation.stalled().expect("a walk only ends by a refused step");
            return (visited, Stop::Stalled(rejection));
        };
        let point = T::evaluate(continuation.problem(), &curve);
        let cancelled = observer(&point).is_break();
        let (outside, too_large) = (outside(&point), too_large(&point));
        visited.push(Visited { curve, point });
        let problem = continuation.problem();
        let (metric, motion) = (problem.metric(), problem.motion_metric());
        if cancelled {
            return (visited, Stop::Cancelled);
        }
        if bounds.closure.is_some_and(|tolerance| has_closed(metric, motion, &visited, tolerance)) {
            visited.pop();
            return (visited, Stop::Closed);
        }
        if has_reversed::<P, T>(metric, motion, &visited) {
            return (visited, Stop::Reversed);
        }
        if outside {
            end_at_bound(continuation, &mut visited, bounds.frequency);
            return (visited, Stop::FrequencyBound);
        }
        if too_large {
            return (visited, Stop::AmplitudeBound);
        }
    }
}

/// A curve walked to both of its ends.
pub struct Walked<T> {
    /// Points in the order of the arc.
    pub visited: Vec<Visited<T>>,
    /// Index of the point where the walk started.
    pub start: usize,
    /// How the curve begins and ends.
    pub outcome: Outcome,
    /// Steps refused.
    pub rejections: usize,
}

/// Walks from a point near the curve the way of `direction` and, if the curve does not close, the other way as well.
///
/// # Errors
/// If the first point does not converge. What stops the walk later is part of the result.
pub fn walk_both<P: Problem, T: Evaluated<P>>(
    problem: &mut P,
    y: Vec<f64>,
    direction: &[f64],
    settings: &ContinuationSettings,
    bounds: &Bounds,
    observer: &mut Observer<'_, T>,
) -> Result<Walked<T>, Failure> {
    let mut continuation = Continuation::start(problem, y, direction, *settings)?;
    let (visited, stop) = walk(&mut continuation, bounds, observer);
    let mut rejections = continuation.rejections();
    if stop == Stop::Closed || stop == Stop::Cancelled {
        let outcome = if stop == Stop::Closed { Outcome::Closed } else { Outcome::Open(stop, stop) };
        return Ok(Walked { visited, start: 0, outcome, rejections });
    }
    let first = visited[0].curve.clone();
    let back: Vec<f64> = first.tangent.iter().map(|t| -t).collect();
    let mut continuation = match Continuation::start(problem, first.y, &back, *settings) {
        Ok(continuation) => continuation,
        Err(failure) => {
            let outcome = Outcome::Open(Stop::Stalled(Rejection::Newton(failure)), stop);
            return Ok(Walked { visited, start: 0, outcome, rejections });
        }
    };
    let (backwards, other_stop) = walk(&mut continuation, bounds, observer);
    rejections += continuation.rejections();
    if other_stop == Stop::Closed {
        return Ok(Walked { visited: backwards, start: 0, outcome: Outcome::Closed, rejections });
    }
    let start = backwards.len() - 1;
    Ok(Walked { visited: join(backwards, visited), start, outcome: Outcome::Open(other_stop, stop), rejections })
}

/// One list in the direction of `forwards`; both start at the same point.
fn join<T>(backwards: Vec<Visited<T>>, mut forwards: Vec<Visited<T>>) -> Vec<Visited<T>> {
    let steps: Vec<f64> = backwards.iter().map(|v| v.curve.step).collect();
    let mut joined = Vec::with_capacity(backwards.len() + forwards.len());
    for (i, mut visited) in backwards.into_iter().enumerate().skip(1).rev() {
        visited.curve.tangent.iter_mut().for_each(|t| *t = -*t);
        visited.curve.step = steps.get(i + 1).copied().unwrap_or(0.0);
        joined.push(visited);
    }
    forwards[0].curve.step = steps.get(1).copied().unwrap_or(0.0);
    joined.extend(forwards);
    joined
}

/// Replaces a last point beyond a frequency bound by the point at the bound, so that a branch's range does not depend on
/// its steps.
fn end_at_bound<P: Problem, T: Evaluated<P>>(
    continuation: &mut Continuation<'_, P>,
    visited: &mut [Visited<T>],
    (low, high): (f64, f64),
) {
    let [.., before, last] = visited else { return };
    let (from, to) = (before.point.omega(), last.point.omega());
    let bound = if to > high { high } else { low };
    if (from - bound) * (to - bound) >= 0.0 {
        return;
    }
    let share = (bound - from) / (to - from);
    let y = interpolate(&before.curve.y, &last.curve.y, share);
    let frequency = continuation.problem().parameter_row();
    if let Ok(mut curve) = continuation.correct_on(y, &frequency) {
        curve.step = share * last.curve.step;
        let point = T::evaluate(continuation.problem(), &curve);
        *last = Visited { curve, point };
    }
}

/// Whether the last step crosses the plane through the first point normal to its tangent, in the same direction and
/// close to it. The paper [9, 10] cuts with ω = ω_first instead, which fails when the first point is a fold.
fn has_closed<T>(metric: &[f64], motion: &[f64], visited: &[Visited<T>], tolerance: f64) -> bool {
    let [.., before, last] = visited else { return false };
    if visited.len() < 5 {
        return false;
    }
    let first = &visited[0].curve;
    let height = |y: &[f64]| -> f64 {
        metric.iter().zip(y.iter().zip(&first.y)).zip(&first.tangent).map(|((w, (y, f)), t)| w * (y - f) * t).sum()
    };
    let (from, to) = (height(&before.curve.y), height(&last.curve.y));
    if !(from < 0.0 && to >= 0.0) || inner(metric, &first.tangent, &last.curve.tangent) < 0.0 {
        return false;
    }
    let share = -from / (to - from);
    relative_distance(motion, &interpolate(&before.curve.y, &last.curve.y, share), &first.y) <= tolerance
}

/// Whether the last point lies on an earlier part of the curve, walked the other way.
fn has_reversed<P, T: Evaluated<P>>(metric: &[f64], motion: &[f64], visited: &[Visited<T>]) -> bool {
    let Some((last, earlier)) = visited.split_last() else { return false };
    let omega = last.point.omega();
    let keep_clear = earlier.len().saturating_sub(3);
    earlier[..keep_clear].windows(2).any(|pair| {
        let (a, b) = (pair[0].point.omega(), pair[1].point.omega());
        if (a - omega) * (b - omega) > 0.0 || a == b {
            return false;
        }
        let between = interpolate(&pair[0].curve.y, &pair[1].curve.y, (omega - a) / (b - a));
        relative_distance(motion, &between, &last.curve.y) < 1e-4
            && inner(metric, &pair[0].curve.tangent, &last.curve.tangent) < -0.9
    })
}

/// (1 − share) a + share b.
pub fn interpolate(a: &[f64], b: &[f64], share: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect()
}

/// ‖a − b‖ / ‖b‖ in the metric, over as many entries as the metric is given for.
pub fn relative_distance(metric: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    norm(metric, &difference) / norm(metric, b)
}
