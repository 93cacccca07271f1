//! A maximum of a measure on a curve near one that is known, with more harmonics.

use crate::curve::continuation::{Continuation, ContinuationSettings, CurvePoint};
use crate::curve::extrema::locate_maximum;
use crate::curve::problem::norm;
use crate::curve::walk::{Evaluated, TracedPoint};
use crate::formulation::Formulation;
use crate::response::branch::{BranchPoint, Observer};

/// Steps towards a maximum that has moved, before giving up.
const STEPS: usize = 80;

/// Points beside a maximum from which it is climbed.
const BESIDE: usize = 2;

/// A curve with fewer harmonics, and the number of its point at which a measure is largest.
pub(super) struct Top<'c> {
    /// Its points.
    pub points: &'c [BranchPoint],
    /// Whether it is closed.
    pub is_closed: bool,
    /// Which point it is.
    pub index: usize,
}

impl Top<'_> {
    /// Points a little before and after it, so that it lies between them if it has not moved; `None` at an end of an open curve.
    pub fn beside(&self) -> Option<[usize; 2]> {
        let (n, top) = (self.points.len(), self.index);
        if n < 3 || (!self.is_closed && (top == 0 || top + 1 == n)) {
            return None;
        }
        Some(match self.is_closed {
            true => [(top + n - BESIDE % n) % n, (top + BESIDE) % n],
            false => [top.saturating_sub(BESIDE), (top + BESIDE).min(n - 1)],
        })
    }
}

/// The maximum of a measure on the curve of `problem` near that of a curve with fewer harmonics, which may have `others` next to it:
/// extrema at these points; nothing at an end of an open curve. The observer is told of every step; breaking gives it up.
pub(super) fn maximum_near<'m, F: Formulation<'m>>(
    problem: &mut F,
    steps: ContinuationSettings,
    Top { points, is_closed, index: top }: Top<'_>,
    others: &[usize],
    measure: &dyn Fn(&BranchPoint) -> f64,
    observer: &mut Observer<'_>,
) -> Option<BranchPoint> {
    let [before, after] = Top { points, is_closed, index: top }.beside()?;
    let harmonics = problem.system().harmonics;
    let encode = |problem: &F, i: usize| problem.encode(&points[i].state.with_harmonics(harmonics));
    let ends = [before, after].map(|i| encode(problem, i));
    let Some(other) = others.iter().copied().filter(|&other| other != top).min_by_key(|other| other.abs_diff(top))
    else {
        return climb(problem, steps, ends, measure, observer);
    };
    if other.abs_diff(top) > BESIDE {
        return climb(problem, steps, ends, measure, observer);
    }
    // Steps as long as those of the curve would pass over both.
    let [here, other] = [top, other].map(|i| encode(problem, i));
    let aside = |end: &Vec<f64>| {
        let towards = |to: &Vec<f64>| -> Vec<f64> { to.iter().zip(&here).map(|(to, here)| to - here).collect() };
        let (way, apart) = (towards(end), norm(problem.metric(), &towards(&other)));
        let share = (0.5 * apart / norm(problem.metric(), &way)).min(1.0);
        here.iter().zip(&way).map(|(here, way)| here + share * way).collect::<Vec<f64>>()
    };
    let near = ends.each_ref().map(aside);
    climb(problem, steps, near, measure, observer).or_else(|| climb(problem, steps, ends, measure, observer))
}

/// The maximum of a measure on the curve near two states, uphill from either towards the other.
pub(super) fn climb<'m, F: Formulation<'m>>(
    problem: &mut F,
    settings: ContinuationSettings,
    [before, after]: [Vec<f64>; 2],
    measure: &dyn Fn(&BranchPoint) -> f64,
    observer: &mut Observer<'_>,
) -> Option<BranchPoint> {
    for (from, to) in [(&before, &after), (&after, &before)] {
        let direction: Vec<f64> = to.iter().zip(from).map(|(to, from)| to - from).collect();
        // The maximum lies between the two: no step may pass over it.
        let initial_step = settings.initial_step.min(0.25 * norm(problem.metric(), &direction));
        let steps = ContinuationSettings { initial_step, ..settings };
        let Ok(mut continuation) = Continuation::start(problem, from.clone(), &direction, steps) else { continue };
        let first = continuation.current().clone();
        let mut visited = vec![evaluated(&mut continuation, first)];
        for _ in 0..STEPS {
            let Some(curve) = continuation.next() else { break };
            let next = evaluated(&mut continuation, curve);
            if observer(&next.point).is_break() {
                return None;
            }
            visited.push(next);
            let [.., before, last] = visited.as_slice() else { break };
            if measure(&last.point) < measure(&before.point) {
                break;
            }
        }
        // Downhill at once: uphill is the other way.
        let n = visited.len();
        if n < 3 {
            continue;
        }
        let top = n - 2;
        let values = [top - 1, top, n - 1].map(|i| measure(&visited[i].point));
        if values[1] < values[2] {
            continue;
        }
        let arcs = (visited[top].curve.step, visited[n - 1].curve.step);
        let measure = |_: &mut F, v: &TracedPoint<BranchPoint>| measure(&v.point);
        let maximum = locate_maximum(&mut continuation, &visited, top, arcs, values, &measure);
        return Some(maximum.located.map_or_else(|| visited[top].point.clone(), |(_, located)| located.point));
    }
    None
}

fn evaluated<'m, F: Formulation<'m>>(
    continuation: &mut Continuation<'_, F>,
    curve: CurvePoint,
) -> TracedPoint<BranchPoint> {
    let point = BranchPoint::evaluate(continuation.problem(), &curve);
    TracedPoint { curve, point }
}
