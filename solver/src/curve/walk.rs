//! Walking a curve to its end: bounds, closure, reversal.

use crate::curve::continuation::{Continuation, ContinuationSettings, CurvePoint, Rejection};
use crate::curve::frequencies::Frequencies;
use crate::curve::identity::{Identity, is_beside};
use crate::curve::outcome::{Outcome, Stop};
use crate::curve::problem::{Failure, Problem, SAME_IMAGE, inner, norm};
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

/// Asked of every point a walk steps to: whether it ends there, for a reason of its own.
pub type Ending<'e, P, T> = dyn FnMut(&mut P, &TracedPoint<T>) -> Option<Stop> + 'e;

/// Where a walk ends.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    /// Frequencies, rad/s.
    pub frequency: (f64, f64),
    /// Largest amplitude, m.
    pub amplitude: f64,
    /// Largest number of points.
    pub points: usize,
    /// Whether the curve may come back to its first point.
    pub closes: bool,
}

impl Bounds {
    /// The bound that a point of this frequency and amplitude lies beyond.
    fn passed(&self, omega: f64, amplitude: f64) -> Option<Stop> {
        let (low, high) = self.frequency;
        // A walk may start at a bound.
        if omega < low * (1.0 - 1e-9) || omega > high * (1.0 + 1e-9) {
            return Some(Stop::FrequencyBound);
        }
        (amplitude > self.amplitude).then_some(Stop::AmplitudeBound)
    }
}

/// A point of a walk: as the continuation needs it and as people do.
#[derive(Debug, Clone)]
pub struct TracedPoint<T> {
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
    ending: &mut Ending<'_, P, T>,
) -> (Vec<TracedPoint<T>>, Stop) {
    let first = continuation.current().clone();
    let point = T::evaluate(continuation.problem(), &first);
    let stop = bounds.passed(point.omega(), point.amplitude());
    let mut visited = vec![TracedPoint { curve: first, point }];
    let stop = stop.unwrap_or_else(|| walk_on(continuation, &mut visited, bounds, observer, ending));
    (visited, stop)
}

/// Walks on from the last point of `visited`, the continuation's current one.
pub fn walk_on<P: Problem, T: Evaluated<P>>(
    continuation: &mut Continuation<'_, P>,
    visited: &mut Vec<TracedPoint<T>>,
    bounds: &Bounds,
    observer: &mut Observer<'_, T>,
    ending: &mut Ending<'_, P, T>,
) -> Stop {
    let mut identity = Identity::default();
    let mut omegas: Frequencies = visited.iter().map(|visited| visited.point.omega()).collect();
    loop {
        if visited.len() >= bounds.points {
            return Stop::PointBudget;
        }
        let Some(curve) = continuation.next() else {
            let rejection = continuation.stalled().expect("a walk only ends by a refused step");
            return Stop::Stalled(rejection);
        };
        let point = T::evaluate(continuation.problem(), &curve);
        let cancelled = observer(&point).is_break();
        let passed = bounds.passed(point.omega(), point.amplitude());
        omegas.push(point.omega());
        visited.push(TracedPoint { curve, point });
        if cancelled {
            return Stop::Cancelled;
        }
        // A walk that went on before did not come upon itself here.
        let went_on = continuation.goes_on();
        let rounds = if bounds.closes && !went_on { rounds(&mut identity, continuation, visited) } else { None };
        if let Some(rounds) = rounds {
            visited.pop();
            if !turns_round(continuation.problem(), visited, rounds) {
                return Stop::Reversed;
            }
            if rounds == 1 {
                resolve_end(continuation, visited);
            }
            return Stop::Closed;
        }
        let revisit = if went_on { None } else { revisit(&mut identity, continuation, visited, &omegas) };
        match revisit {
            Some(Revisit::Backwards) => return Stop::Reversed,
            Some(Revisit::Forwards(earlier)) if bounds.closes => {
                visited.pop();
                if !turns_round(continuation.problem(), &visited[earlier + 1..], 1) {
                    return Stop::Reversed;
                }
                visited.drain(..=earlier);
                return Stop::Closed;
            }
            _ => {}
        }
        if passed == Some(Stop::FrequencyBound) {
            end_at_bound(continuation, visited, bounds.frequency);
        }
        if let Some(stop) = passed {
            return stop;
        }
        if let Some(stop) = visited.last().and_then(|last| ending(continuation.problem(), last)) {
            return stop;
        }
    }
}

/// A curve walked to both of its ends.
pub struct TracedCurve<T> {
    /// Points in the order of the arc.
    pub visited: Vec<TracedPoint<T>>,
    /// Index of the point where the walk started.
    pub start: usize,
    /// How the curve begins and ends.
    pub outcome: Outcome,
    /// Steps refused.
    pub rejections: usize,
}

/// Walks from a point near the curve the way of `direction` and, if the curve does not close, the other way as well; `ending`
/// is asked both ways.
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
    ending: &mut Ending<'_, P, T>,
) -> Result<TracedCurve<T>, Failure> {
    let mut one_way = |continuation: &mut Continuation<'_, P>| walk(continuation, bounds, observer, ending);
    both_ways(problem, y, direction, settings, &mut one_way)
}

/// One way of a curve from a continuation's current point (included): its points and where it ends.
pub type OneWay<'w, P, T> = dyn FnMut(&mut Continuation<'_, P>) -> (Vec<TracedPoint<T>>, Stop) + 'w;

/// The same as [`walk_both`], each of the two ways walked by `one_way`.
///
/// # Errors
/// If the first point does not converge.
pub fn both_ways<P: Problem, T: Evaluated<P>>(
    problem: &mut P,
    y: Vec<f64>,
    direction: &[f64],
    settings: &ContinuationSettings,
    one_way: &mut OneWay<'_, P, T>,
) -> Result<TracedCurve<T>, Failure> {
    let mut continuation = Continuation::start(problem, y, direction, *settings)?;
    let (visited, stop) = one_way(&mut continuation);
    let mut rejections = continuation.rejections();
    if stop == Stop::Closed || stop == Stop::Cancelled {
        let outcome = if stop == Stop::Closed { Outcome::Closed } else { Outcome::Open(stop, stop) };
        return Ok(TracedCurve { visited, start: 0, outcome, rejections });
    }
    let first = visited[0].curve.clone();
    let back: Vec<f64> = first.tangent.iter().map(|t| -t).collect();
    let mut continuation = match Continuation::start(problem, first.y, &back, *settings) {
        Ok(continuation) => continuation,
        Err(failure) => {
            let outcome = Outcome::Open(Stop::Stalled(Rejection::Newton(failure)), stop);
            return Ok(TracedCurve { visited, start: 0, outcome, rejections });
        }
    };
    let (backwards, other_stop) = one_way(&mut continuation);
    rejections += continuation.rejections();
    if other_stop == Stop::Closed {
        let leaves = matches!(stop, Stop::FrequencyBound | Stop::AmplitudeBound | Stop::ForcingBound | Stop::Branching);
        if !leaves {
            return Ok(TracedCurve { visited: backwards, start: 0, outcome: Outcome::Closed, rejections });
        }
        // What leaves through a bound, or branches off, is no loop: the way back was left for one.
        return Ok(TracedCurve { visited, start: 0, outcome: Outcome::Open(Stop::Reversed, stop), rejections });
    }
    let start = backwards.len() - 1;
    Ok(TracedCurve { visited: join(backwards, visited), start, outcome: Outcome::Open(other_stop, stop), rejections })
}

/// One list in the direction of `forwards`; both start at the same point.
fn join<T>(backwards: Vec<TracedPoint<T>>, mut forwards: Vec<TracedPoint<T>>) -> Vec<TracedPoint<T>> {
    let steps: Vec<f64> = backwards.iter().map(|v| v.curve.step).collect();
    let mut joined = Vec::with_capacity(backwards.len() + forwards.len());
    for (i, mut visited) in backwards.into_iter().enumerate().skip(1).rev() {
        visited.curve.turn_round();
        visited.curve.step = steps.get(i + 1).copied().unwrap_or(0.0);
        joined.push(visited);
    }
    forwards[0].curve.step = steps.get(1).copied().unwrap_or(0.0);
    joined.extend(forwards);
    joined
}

/// Replaces a last point beyond a frequency bound by the point at the bound, so that a branch's range does not depend on
/// its steps.
pub fn end_at_bound<P: Problem, T: Evaluated<P>>(
    continuation: &mut Continuation<'_, P>,
    visited: &mut [TracedPoint<T>],
    bounds: (f64, f64),
) {
    let [.., before, last] = visited else { return };
    if let Some((mut at_bound, share)) = point_at_bound(continuation, before, last, bounds) {
        at_bound.curve.step = share * last.curve.step;
        *last = at_bound;
    }
}

/// Replaces a first point beyond a frequency bound by the point at the bound.
pub fn begin_at_bound<P: Problem, T: Evaluated<P>>(
    continuation: &mut Continuation<'_, P>,
    visited: &mut [TracedPoint<T>],
    bounds: (f64, f64),
) {
    let [first, next, ..] = visited else { return };
    if let Some((at_bound, share)) = point_at_bound(continuation, next, first, bounds) {
        next.curve.step *= share;
        *first = at_bound;
    }
    first.curve.step = 0.0;
}

/// The point at the frequency bound that lies between an inner point and its neighbour beyond it, and its share of the way.
fn point_at_bound<P: Problem, T: Evaluated<P>>(
    continuation: &mut Continuation<'_, P>,
    inner_point: &TracedPoint<T>,
    beyond: &TracedPoint<T>,
    (low, high): (f64, f64),
) -> Option<(TracedPoint<T>, f64)> {
    let (from, to) = (inner_point.point.omega(), beyond.point.omega());
    let bound = if to > high { high } else { low };
    if (from - bound) * (to - bound) >= 0.0 {
        return None;
    }
    let share = (bound - from) / (to - from);
    let y = interpolate(&inner_point.curve.y, &beyond.curve.y, share);
    let frequency = continuation.problem().parameter_row();
    let mut curve = continuation.correct_on(y, &frequency).ok()?;
    let problem = continuation.problem();
    if !problem.are_neighbours(&inner_point.curve.y, &curve.y) {
        return None;
    }
    if inner(problem.metric(), &curve.tangent, &beyond.curve.tangent) < 0.0 {
        curve.turn_round();
    }
    let point = T::evaluate(problem, &curve);
    Some((TracedPoint { curve, point }, share))
}

/// Whether the last step passes the first point or an image of it, in the direction in which the walk left it: how many such
/// rounds lead back to the first point itself. The paper [9, 10] compares an interpolated point at the first one's frequency,
/// which takes a near sheet for the same and fails at folds.
fn rounds<P: Problem, T>(
    identity: &mut Identity,
    continuation: &mut Continuation<'_, P>,
    visited: &[TracedPoint<T>],
) -> Option<usize> {
    let [first, _, .., before, last] = visited else { return None };
    let newton = continuation.settings().newton;
    let problem = continuation.problem();
    let index = (0..problem.images()).find(|&index| {
        let (y, tangent) = (problem.image(&first.curve.y, index), problem.image(&first.curve.tangent, index));
        inner(problem.metric(), &tangent, &last.curve.tangent) > 0.0
            && identity.passes(problem, &newton, [&before.curve.y, &last.curve.y], &y)
    })?;
    let metric = problem.motion_metric();
    let mut image = problem.image(&first.curve.y, index);
    let mut rounds = 1;
    while rounds < problem.images() && relative_distance(metric, &image, &first.curve.y) > SAME_IMAGE {
        image = problem.image(&image, index);
        rounds += 1;
    }
    Some(rounds)
}

/// Most points that are added where a curve closes.
const HALVINGS: usize = 8;

/// Adds points to a curve that has closed until the piece that leads back to its first point arrives the way in which it began:
/// the step that passed the first point may have led over a bend next to it.
fn resolve_end<P: Problem, T: Evaluated<P>>(continuation: &mut Continuation<'_, P>, visited: &mut Vec<TracedPoint<T>>) {
    let least = continuation.settings().min_cosine;
    for _ in 0..HALVINGS {
        let [first, .., last] = &visited[..] else { return };
        let (metric, end) = (continuation.problem().metric(), last.curve.clone());
        let piece: Vec<f64> = first.curve.y.iter().zip(&end.y).map(|(first, end)| first - end).collect();
        let length = norm(metric, &piece);
        let is_straight = inner(metric, &piece, &first.curve.tangent) >= least * length;
        let Some(Ok(curve)) = (!is_straight).then(|| continuation.probe(&end, 0.5 * length)) else { return };
        let point = T::evaluate(continuation.problem(), &curve);
        visited.push(TracedPoint { curve, point });
    }
}

/// Of the whole turn of a closed curve, the share that the tangents at its points show at least.
const SHOWN: f64 = 0.8;

/// Whether a curve that leads back to its first point after so many rounds turns like one: a closed curve turns by 2π or more
/// (W. Fenchel, Math. Ann. 101, 238–252, 1929). What comes back without has jumped, next to a branch point say.
fn turns_round<P: Problem, T>(problem: &P, visited: &[TracedPoint<T>], rounds: usize) -> bool {
    let angle = |pair: &[TracedPoint<T>]| {
        let [a, b] = [0, 1].map(|i| &pair[i].curve.tangent[..]);
        let metric = problem.metric();
        (inner(metric, a, b) / (norm(metric, a) * norm(metric, b))).clamp(-1.0, 1.0).acos()
    };
    let turned: f64 = visited.windows(2).map(angle).sum();
    // The last piece, back to the first point, is as long as any.
    let count = visited.len() as f64;
    turned * (1.0 + 1.0 / count) * rounds as f64 >= SHOWN * std::f64::consts::TAU
}

/// How a walk comes upon its own points.
enum Revisit {
    /// Walking the other way.
    Backwards,
    /// Walking the same way, after the point of this index: it has gone round without passing its first point, which can
    /// only be if that did not lie on the loop.
    Forwards(usize),
}

/// Whether the last point lies on an earlier part of the curve; `omegas`: the frequencies of the points.
fn revisit<P: Problem, T: Evaluated<P>>(
    identity: &mut Identity,
    continuation: &mut Continuation<'_, P>,
    visited: &[TracedPoint<T>],
    omegas: &Frequencies,
) -> Option<Revisit> {
    let (last, earlier) = visited.split_last()?;
    let newton = continuation.settings().newton;
    let problem = continuation.problem();
    let omega = last.point.omega();
    let keep_clear = earlier.len().saturating_sub(3);
    for index in omegas.around(omega, keep_clear) {
        let [a, b] = [&earlier[index].curve, &earlier[index + 1].curve];
        let cosine = inner(problem.metric(), &a.tangent, &last.curve.tangent);
        if cosine.abs() > 0.9
            && is_beside(problem.metric(), &a.y, &b.y, &last.curve.y)
            && identity.passes(problem, &newton, [&a.y, &b.y], &last.curve.y)
        {
            if cosine < 0.0 {
                return Some(Revisit::Backwards);
            }
            // Next to a branch point steps become so short that many of them are beside the end of one that was taken before.
            let since: f64 = visited[index + 2..].iter().map(|visited| visited.curve.step).sum();
            let chord: Vec<f64> = b.y.iter().zip(&a.y).map(|(b, a)| b - a).collect();
            if since > norm(problem.metric(), &chord) {
                return Some(Revisit::Forwards(index));
            }
        }
    }
    None
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
