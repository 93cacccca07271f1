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

/// A motion that is farther away than this from where it was looked for, relative to itself, is another one.
const FAR: f64 = 1.0;

/// Where a branch is straight, what of it is nearest to a motion is no farther along it than the motion is away: so many times as far is
/// looked.
const ALONG: f64 = 1.5;

/// A motion is one of another part of the branch if it is nearer to that than this share of how far it is from its own.
const HOPPED: f64 = 0.5;

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
        let from = Nearby::of(&motion, points, i, small);
        if length(from.at[i]) < FAR && !from.has_hopped(problem, &motion) {
            found.push((i, from.distance()));
        }
    }
    if 2 * found.len() < looked_at.len() {
        return Some(Change { omega: points[looked_at[0]].omega(), share: None });
    }
    let (i, share) = found.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Change { omega: points[i].omega(), share: Some(share) })
}

/// A branch as seen from a motion that was found near one of its points: in frequency and amplitude, relative to those of the motion,
/// amplitudes below a least one to that.
struct Nearby<'b> {
    points: &'b [BranchPoint],
    /// Where they are.
    at: Vec<[f64; 2]>,
    /// The point near which the motion was found.
    own: usize,
}

impl<'b> Nearby<'b> {
    fn of(motion: &BranchPoint, points: &'b [BranchPoint], own: usize, small: f64) -> Self {
        let (omega, amplitude) = (motion.omega(), motion.amplitude().max(small));
        let to = |other: &BranchPoint| {
            [(other.omega() - omega) / omega, (other.amplitude() - motion.amplitude()) / amplitude]
        };
        Self { points, at: points.iter().map(to).collect(), own }
    }

    /// How far the motion is from the branch: what moves along it has not moved.
    fn distance(&self) -> f64 {
        let [begin, end] = stretch(&self.at, self.own);
        self.at[begin..=end].windows(2).map(to_segment).fold(f64::INFINITY, f64::min)
    }

    /// Whether the motion is one of another part of the branch that passes by.
    fn has_hopped<'m, F: Formulation<'m>>(&self, problem: &F, motion: &BranchPoint) -> bool {
        let [begin, end] = stretch(&self.at, self.own);
        let own = self.distance();
        let here = longer(problem, motion);
        let apart = |i: usize| {
            let there = longer(problem, &self.points[i]);
            norm(
                problem.motion_metric(),
                &there.iter().zip(&here).map(|(there, here)| there - here).collect::<Vec<_>>(),
            )
        };
        let others = (0..self.at.len()).filter(|i| !(begin..=end).contains(i) && length(self.at[*i]) < own);
        let nearest = others.map(apart).fold(f64::INFINITY, f64::min);
        nearest < HOPPED * apart(self.own)
    }
}

/// The stretch of a curve around one of its points that holds what of it is nearest to the origin, without other parts that pass by.
fn stretch(at: &[[f64; 2]], own: usize) -> [usize; 2] {
    let reach = ALONG * length(at[own]);
    let step = |a: usize, b: usize| length([at[a][0] - at[b][0], at[a][1] - at[b][1]]);
    let (mut begin, mut end) = (own, own);
    let (mut before, mut after) = (0.0, 0.0);
    while begin > 0 && before <= reach {
        begin -= 1;
        before += step(begin, begin + 1);
    }
    while end + 1 < at.len() && after <= reach {
        end += 1;
        after += step(end - 1, end);
    }
    [begin, end]
}

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

/// Distance of the origin from a chord.
fn to_segment(ends: &[[f64; 2]]) -> f64 {
    let ([ax, ay], [bx, by]) = (ends[0], ends[1]);
    let (dx, dy) = (bx - ax, by - ay);
    let along = (-(ax * dx + ay * dy) / (dx * dx + dy * dy).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (ax + along * dx).hypot(ay + along * dy)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files;
    use crate::formulation::pressure::PressureForm;
    use crate::formulation::scales::Scales;
    use crate::formulation::unknown::Unknown;
    use crate::response::backbone::Backbone;
    use crate::response::branch::Side;
    use crate::response::forced::{Forced, SearchRange};
    use crate::settings::Settings;
    use std::ops::ControlFlow;
    use std::path::Path;

    /// The main branch of a stiffening oscillator has three motions at a frequency: one of the middle, found from the highest, is none of the
    /// strand that it was looked for on.
    #[test]
    fn a_motion_of_another_strand_is_not_compared() {
        let model = files::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/duffing")).unwrap();
        let settings = Settings::default();
        let reach = SearchRange::new(&settings, &Backbone::compute(&model, &settings).unwrap()).unwrap();
        let mut forced: Forced<'_, PressureForm<'_>> = Forced::build(&model, &settings, reach, 0.2).unwrap();
        let main = forced.main_branch(Side::Below, &mut |_| ControlFlow::Continue(())).unwrap();
        let (points, peak) = (&main.points, main.peak_index());
        let scales = Scales::new(&model, settings.tracked(&model));
        let unknown = Unknown::Frequency { forcing: 0.2 };
        let twice = settings.harmonics.doubled();
        let problem = PressureForm::build(&model, twice, settings.tracked(&model), unknown, scales).unwrap();
        let omega = 0.85 * points[peak].omega();
        let nearest = |a: &usize, b: &usize| {
            let apart = |i: usize| (points[i].omega() - omega).abs();
            apart(*a).total_cmp(&apart(*b))
        };
        let high = (0..peak).min_by(nearest).unwrap();
        let middle = (peak..points.len()).find(|&i| points[i].omega() < omega).unwrap();
        let ratio = points[high].amplitude() / points[middle].amplitude();
        assert!((1.005..1.5).contains(&ratio), "{ratio}");
        let hopped = |found: usize| Nearby::of(&points[found], points, high, 0.0).has_hopped(&problem, &points[found]);
        assert_eq!([hopped(middle), hopped(high), hopped(high + 1)], [true, false, false]);
    }

    /// The two strands of a narrow resonance, 0.6 % of the frequency apart: a motion 6 % above its own strand, right beside the other one.
    #[test]
    fn another_strand_that_passes_by_is_no_measure() {
        let strand = |omega: f64, rises: bool| {
            (0..=40).map(move |i| [omega, -0.5 + 0.025 * f64::from(if rises { i } else { 40 - i })])
        };
        // Up to 0.5 above the motion, and down again; the motion itself is the origin.
        let falling: Vec<[f64; 2]> = strand(-0.06, true).chain(strand(0.006, false)).collect();
        let own = 20;
        let near = |at: &[[f64; 2]]| {
            let [begin, end] = stretch(at, own);
            at[begin..=end].windows(2).map(to_segment).fold(f64::INFINITY, f64::min)
        };
        assert!(falling.windows(2).map(to_segment).fold(f64::INFINITY, f64::min) < 0.0061);
        assert!((near(&falling) - 0.06).abs() < 1e-12, "{}", near(&falling));
        // What moves along the curve has not moved.
        let along: Vec<[f64; 2]> = falling.iter().map(|[x, y]| [x + 0.06, y + 0.01]).collect();
        assert!(near(&along) < 1e-12);
    }
}
