//! Special points of a branch: folds and peak, located along the arc, and branch points, where its steps came upon them.

use crate::curve::continuation::{Continuation, ContinuationSettings};
use crate::curve::extrema::{Maximum, Measure, further_peaks, insert_maxima, locate_maximum, turning_points};
use crate::curve::problem::{Problem, norm};
use crate::curve::walk::{Evaluated, TracedCurve};
use crate::response::branch::{BranchPoint, Outcome, SpecialKind, SpecialPoint, TracedPoint};
use crate::response::branch_points::{Passed, branch_points};

/// The points of a branch that was walked, with its folds and its peak among them.
pub(super) fn with_special_points<P: Problem>(
    problem: &mut P,
    settings: ContinuationSettings,
    walked: TracedCurve<BranchPoint>,
) -> (Vec<BranchPoint>, Vec<SpecialPoint>)
where
    BranchPoint: Evaluated<P>,
{
    let TracedCurve { visited, start, outcome, .. } = walked;
    let closed = outcome == Outcome::Closed;
    let mut maxima = vec![Maximum { anchor: start, located: None }];
    let mut kinds = vec![Some(SpecialKind::Start)];
    // Of a fold whether the frequency is largest (1) or smallest (−1) there.
    let mut signs = vec![None];
    let first = visited[start].curve.clone();
    if let Ok(mut continuation) = Continuation::start(problem, first.y.clone(), &first.tangent, settings) {
        for (anchor, sign) in frequency_folds(&visited, closed) {
            let measure = move |_: &mut P, v: &TracedPoint| sign * v.point.omega();
            maxima.push(refine(&mut continuation, &visited, anchor, closed, &measure));
            kinds.resize(maxima.len(), Some(SpecialKind::Fold));
            signs.push(Some(sign));
        }
        let measure = move |_: &mut P, v: &TracedPoint| v.point.amplitude();
        for anchor in highest_steps(&visited, closed) {
            maxima.push(refine(&mut continuation, &visited, anchor, closed, &measure));
            kinds.resize(maxima.len(), Some(SpecialKind::Peak));
        }
        // What else stands out: peaks at other resonances, and those of the other monitored dofs.
        for (monitor, anchor) in other_peaks(&visited, closed) {
            let measure = move |_: &mut P, v: &TracedPoint| v.point.amplitudes()[monitor];
            maxima.push(refine(&mut continuation, &visited, anchor, closed, &measure));
            kinds.push(None);
        }
        for Passed { place, is_branch_point } in branch_points(&mut continuation, &visited, closed) {
            maxima.push(place);
            kinds.push(is_branch_point.then_some(SpecialKind::BranchPoint));
        }
    }
    let (visited, indices) = insert_maxima(visited, maxima);
    let omegas: Vec<f64> = visited.iter().map(|visited| visited.point.omega()).collect();
    signs.resize(kinds.len(), None);
    let placed = kinds.into_iter().zip(signs).zip(indices);
    let at = |sign: Option<f64>, index| sign.map_or(index, |sign| turn(&omegas, (index, sign), closed));
    let mut special: Vec<SpecialPoint> =
        placed.filter_map(|((kind, sign), index)| Some(SpecialPoint { kind: kind?, index: at(sign, index) })).collect();
    // A fold may turn out higher than the point refined from the highest step.
    let highest = |a: &usize, b: &usize| visited[*a].point.amplitude().total_cmp(&visited[*b].point.amplitude());
    if let Some(index) = (0..visited.len()).max_by(highest) {
        special.retain(|s| s.kind != SpecialKind::Peak);
        special.push(SpecialPoint { kind: SpecialKind::Peak, index });
    }
    special.sort_by_key(|s| s.index);
    (visited.into_iter().map(|v| v.point).collect(), special)
}

/// How many points from where it was located a fold may be.
const BESIDE: usize = 3;

/// Where the frequency turns next to a fold: a point of another kind that was located beside it may lie farther out.
fn turn(omegas: &[f64], (mut index, sign): (usize, f64), closed: bool) -> usize {
    let count = omegas.len();
    for _ in 0..BESIDE {
        let before = if index > 0 || closed { Some((index + count - 1) % count) } else { None };
        let after = if index + 1 < count || closed { Some((index + 1) % count) } else { None };
        let outermost =
            [before, after].into_iter().flatten().max_by(|&a, &b| (sign * omegas[a]).total_cmp(&(sign * omegas[b])));
        match outermost {
            Some(next) if sign * omegas[next] > sign * omegas[index] => index = next,
            _ => break,
        }
    }
    index
}

/// A local maximum among the points this close to the highest may be the peak once both are located.
const RIVAL: f64 = 0.95;

/// Points that are local maxima of the amplitude, and high enough to lie next to the peak.
fn highest_steps(visited: &[TracedPoint], closed: bool) -> Vec<usize> {
    let (n, amplitude) = (visited.len(), |i: usize| visited[i].point.amplitude());
    let highest = (0..n).map(amplitude).fold(0.0, f64::max);
    let is_maximum = |&i: &usize| {
        let before = if i > 0 || closed { amplitude((i + n - 1) % n) } else { f64::NEG_INFINITY };
        let after = if i + 1 < n || closed { amplitude((i + 1) % n) } else { f64::NEG_INFINITY };
        amplitude(i) >= RIVAL * highest && amplitude(i) >= before && amplitude(i) > after
    };
    (0..n).filter(is_maximum).collect()
}

/// Numbers of monitored dofs and of points next to which their amplitudes peak, apart from the [`highest_steps`]: of the first dof at every
/// resonance of an open branch, of the others the largest.
fn other_peaks(visited: &[TracedPoint], closed: bool) -> Vec<(usize, usize)> {
    let of = |monitor: usize| visited.iter().map(move |v| v.point.amplitudes()[monitor]);
    let first: Vec<f64> = if closed { Vec::new() } else { of(0).collect() };
    let highest = first.iter().copied().fold(0.0, f64::max);
    let resonances = further_peaks(&first).into_iter().filter(|&i| first[i] < RIVAL * highest).map(|i| (0, i));
    let monitors = visited.first().map_or(0, |v| v.point.amplitudes().len());
    let others = (1..monitors).filter_map(|monitor| {
        let (i, _) = of(monitor).enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((monitor, i))
    });
    resonances.chain(others).collect()
}

/// Relative height below which a turn in frequency may be one that sampled contact makes.
const SHALLOW: f64 = 1e-5;

/// Turning points in frequency, (index, +1 for a maximum or −1 for a minimum); those that the sampled contact makes by
/// changing one sample at a time are too shallow to count.
fn frequency_folds(visited: &[TracedPoint], closed: bool) -> Vec<(usize, f64)> {
    let omegas: Vec<f64> = visited.iter().map(|v| v.point.omega()).collect();
    let scale = omegas.iter().fold(0.0f64, |m, w| m.max(w.abs()));
    let n = omegas.len();
    if closed {
        // Rotated to start at the lowest frequency, so that the ends of the list are no folds of their own.
        let lowest = (0..n).min_by(|&a, &b| omegas[a].total_cmp(&omegas[b])).unwrap_or(0);
        let rotated: Vec<f64> = (0..=n).map(|i| omegas[(lowest + i) % n]).collect();
        // However narrow it is, a closed curve turns at both ends.
        let range = rotated.iter().fold(0.0f64, |m, w| m.max(w - rotated[0]));
        let mut folds = turning_points(&rotated, (SHALLOW * scale).min(0.1 * range));
        folds.pop();
        return folds.into_iter().map(|(i, max)| ((lowest + i) % n, if max { 1.0 } else { -1.0 })).collect();
    }
    turning_points(&omegas, SHALLOW * scale)
        .into_iter()
        .filter(|&(i, _)| i > 0 && i + 1 < n)
        .map(|(i, max)| (i, if max { 1.0 } else { -1.0 }))
        .collect()
}

fn refine<P: Problem>(
    continuation: &mut Continuation<'_, P>,
    visited: &[TracedPoint],
    anchor: usize,
    closed: bool,
    measure: &Measure<'_, P, BranchPoint>,
) -> Maximum<BranchPoint>
where
    BranchPoint: Evaluated<P>,
{
    let n = visited.len();
    if n < 3 || (!closed && (anchor == 0 || anchor + 1 == n)) {
        return Maximum { anchor, located: None };
    }
    let (before, after) = ((anchor + n - 1) % n, (anchor + 1) % n);
    let arc = |a: usize, b: usize, problem: &P| {
        let difference: Vec<f64> = visited[a].curve.y.iter().zip(&visited[b].curve.y).map(|(a, b)| a - b).collect();
        norm(problem.metric(), &difference)
    };
    let problem = continuation.problem();
    let arcs = (arc(before, anchor, problem), arc(anchor, after, problem));
    let values = [before, anchor, after].map(|i| measure(problem, &visited[i]));
    locate_maximum(continuation, visited, anchor, arcs, values, measure)
}
