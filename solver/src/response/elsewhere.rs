//! Where on a branch the harmonics that were left out change the motion most, and by how much: at a superharmonic resonance of a
//! harmonic beyond H, say, which is nowhere near the peak.

use crate::curve::continuation::{Continuation, ContinuationSettings};
use crate::curve::problem::norm;
use crate::curve::walk::Evaluated;
use crate::formulation::Formulation;
use crate::response::branch::{BranchPoint, Observer};
use crate::response::certificate::Change;

/// At so many points of a branch at most, evenly spaced, and where the amplitude is largest about, is evaluated what their motions leave of
/// the balance.
const LOOKED_AT: usize = 64;

/// Cubes of the number of unknowns that are spent on converging motions again: all that are looked at of small models, fewer of large
/// ones.
const SPENT: f64 = 1e9;

/// Motions smaller than this share of the largest one of the branch are measured against that share of it.
const SMALL: f64 = 1e-2;

/// A motion that is farther away than this, relative to itself, is another one.
const FAR: f64 = 1.0;

/// How far a branch moves at most with the harmonics of `problem`, of those points whose motions leave most of its balance. They are
/// converged again on the plane across the branch. `None` if no point is between two others. The observer is told of every motion;
/// breaking gives it up.
pub(super) fn largest_change<'m, F: Formulation<'m>>(
    problem: &mut F,
    steps: ContinuationSettings,
    points: &[BranchPoint],
    observer: &mut Observer<'_>,
) -> Option<Change> {
    let small = SMALL * points.iter().map(BranchPoint::amplitude).fold(0.0, f64::max);
    let count = (SPENT / (problem.len() as f64).powi(3)).ceil() as usize;
    let mut looked_at = least_balanced(problem, points);
    looked_at.truncate(count);
    let mut found: Vec<(usize, f64)> = Vec::with_capacity(looked_at.len());
    for &i in &looked_at {
        let Some(motion) = again(problem, steps, points, i) else { continue };
        if observer(&motion).is_break() {
            return None;
        }
        let share = distance(&motion, points, small);
        found.extend((share < FAR).then_some((i, share)));
    }
    if 2 * found.len() < looked_at.len() {
        return Some(Change { omega: points[looked_at[0]].omega(), share: None });
    }
    let (i, share) = found.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Change { omega: points[i].omega(), share: Some(share) })
}

/// How far a point is from a curve in frequency and amplitude, relative to its own, amplitudes below `small` to that: what moves along the
/// curve has not moved.
fn distance(point: &BranchPoint, curve: &[BranchPoint], small: f64) -> f64 {
    let (omega, amplitude) = (point.omega(), point.amplitude().max(small));
    let to =
        |other: &BranchPoint| [(other.omega() - omega) / omega, (other.amplitude() - point.amplitude()) / amplitude];
    let to_segment = |ends: &[BranchPoint]| {
        let ([ax, ay], [bx, by]) = (to(&ends[0]), to(&ends[1]));
        let (dx, dy) = (bx - ax, by - ay);
        let along = (-(ax * dx + ay * dy) / (dx * dx + dy * dy).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (ax + along * dx).hypot(ay + along * dy)
    };
    curve.windows(2).map(to_segment).fold(f64::INFINITY, f64::min)
}

/// Points between others, those first whose motions leave most of the balance in relation to their size.
fn least_balanced<'m, F: Formulation<'m>>(problem: &mut F, points: &[BranchPoint]) -> Vec<usize> {
    let step = points.len().div_ceil(LOOKED_AT).max(1);
    let amplitude = |i: usize| points[i].amplitude();
    let is_top = |i: usize| amplitude(i) > amplitude(i - 1) && amplitude(i) > amplitude(i + 1);
    let looked_at = (1..points.len().saturating_sub(1)).filter(|&i| i % step == 0 || is_top(i));
    let left_and_size = looked_at.map(|i| {
        let mut y = longer(problem, &points[i]);
        (i, problem.linearise(&mut y), norm(problem.motion_metric(), &y))
    });
    let mut found: Vec<(usize, f64, f64)> = left_and_size.collect();
    let small = SMALL * found.iter().map(|(.., size)| *size).fold(0.0, f64::max);
    found.sort_by(|a, b| (b.1 / b.2.max(small)).total_cmp(&(a.1 / a.2.max(small))));
    found.into_iter().map(|(i, ..)| i).collect()
}

/// The motion at a point between others, with the harmonics of `problem`.
fn again<'m, F: Formulation<'m>>(
    problem: &mut F,
    steps: ContinuationSettings,
    points: &[BranchPoint],
    i: usize,
) -> Option<BranchPoint> {
    let [before, at, after] = [i - 1, i, i + 1].map(|i| longer(problem, &points[i]));
    let across: Vec<f64> = after.iter().zip(&before).map(|(after, before)| after - before).collect();
    let mut continuation = Continuation::start(problem, at, &across, steps).ok()?;
    let found = continuation.current().clone();
    Some(BranchPoint::evaluate(continuation.problem(), &found))
}

/// A motion with zeros for the harmonics of `problem` that it does not have.
fn longer<'m, F: Formulation<'m>>(problem: &F, point: &BranchPoint) -> Vec<f64> {
    problem.encode(&point.state.with_harmonics(problem.harmonics()))
}
