//! Curves that cross a backbone: where modes interact, or motions lose a symmetry, further families of free motions leave it at branch
//! points, and isolas grow about these as about the backbone itself.

use super::ends::end_within;
use super::known::Known;
use super::resumed::beyond_tongues;
use super::way::{FAR, Rest, Way};
use crate::curve::continuation::{Continuation, CurvePoint};
use crate::curve::extrema::Maximum;
use crate::curve::point::unit;
use crate::curve::problem::norm;
use crate::curve::switch::{Crossing, SIDES};
use crate::curve::walk::{Bounds, TracedCurve, walk};
use crate::formulation::Formulation;
use crate::response::branch::{BranchPoint, Observer, Outcome, Stop, TracedPoint};
use crate::response::branch_points::{Passed, branch_points};
use crate::response::symmetry::up_to_branch_point;

/// Most curves of interest that are followed beside a backbone.
pub const MOST: usize = 8;

/// Most of all, those on which the force does next to no work among them.
const ALL: usize = 24;

/// Fewest points of such a curve: what is shorter is one that is known, where it cannot be told next to a branch point.
const FEWEST: usize = 3;

/// Up to a least threshold of this many times the highest forcing amplitude branch points are of interest.
const NEAR: f64 = 10.0;

/// Nearer to the frequency of two modes than this, relative, nothing but rounding tells a branch point: all their small motions lie on
/// curves.
const DOUBLE: f64 = 1e-5;

/// A branch point of a curve.
struct Place {
    /// The point.
    point: TracedPoint,
    /// Unit tangent of the curve.
    tangent: Vec<f64>,
}

/// Where `first` goes on beyond tongues, the curves that cross it at its branch points, those that cross these, and so on, each from its
/// branch point on. Of images of each other the first; those along which the force does enough work to be of interest. All of them together
/// have no more points than the first curve may have: where that is not enough the last one ends for want of them.
pub(super) fn curves_across<'m, F: Formulation<'m>>(
    problem: &mut F,
    way: &Way<'_>,
    first: &TracedCurve<BranchPoint>,
    observer: &mut Observer<'_>,
) -> Vec<TracedCurve<BranchPoint>> {
    let beyond = beyond_tongues(problem, way, first, observer);
    if beyond.last().is_some_and(is_cancelled) {
        return beyond;
    }
    let visited = std::iter::once(first).chain(&beyond).flat_map(|curve| &curve.visited);
    let sizes = visited.map(|visited| norm(problem.motion_metric(), &visited.curve.y));
    let largest = sizes.fold(0.0, f64::max);
    let mut found: Vec<(TracedCurve<BranchPoint>, bool)> = beyond.into_iter().map(|curve| (curve, true)).collect();
    let mut places = places(problem, way, first);
    let mut looked_at = 0;
    'all: loop {
        for (place, side) in places.iter().flat_map(|place| SIDES.map(|side| (place, side))) {
            if found.len() == ALL || found.iter().filter(|(_, matters)| *matters).count() == MOST {
                break 'all;
            }
            let points: usize = found.iter().map(|(curve, _)| curve.visited.len()).sum();
            let left = way.bounds.points.saturating_sub(points).max(FEWEST);
            let way = Way { bounds: Bounds { points: left, ..way.bounds }, ..*way };
            let across = found.iter().map(|(curve, _)| curve);
            let mut known = Known::new(first, across, way.settings.continuation.newton);
            let Some(curve) = way.across(problem, (place, side), &mut known, largest, observer) else { continue };
            // Of what ends for want of points it is not known whether it matters farther on.
            let is_spent = matches!(curve.outcome, Outcome::Open(_, Stop::PointBudget));
            let is_of_interest = |point: &TracedPoint| way.threshold(problem, point) < FAR * way.forcing;
            let matters = is_spent || curve.visited.iter().any(is_of_interest);
            let is_over = is_spent || is_cancelled(&curve);
            found.push((curve, matters));
            if is_over {
                break 'all;
            }
        }
        let Some((next, _)) = found.get(looked_at) else { break };
        places = self::places(problem, way, next);
        looked_at += 1;
    }
    found.into_iter().filter(|(_, matters)| *matters).map(|(curve, _)| curve).collect()
}

fn is_cancelled(curve: &TracedCurve<BranchPoint>) -> bool {
    matches!(curve.outcome, Outcome::Open(_, Stop::Cancelled))
}

/// The branch points of a curve whose threshold is not far beyond the forcing.
fn places<'m, F: Formulation<'m>>(problem: &mut F, way: &Way<'_>, curve: &TracedCurve<BranchPoint>) -> Vec<Place> {
    let visited = &curve.visited;
    let begin = visited[curve.start].curve.clone();
    let continuation = Continuation::start(problem, begin.y, &begin.tangent, way.settings.continuation);
    let Ok(mut continuation) = continuation else { return Vec::new() };
    let passed = branch_points(&mut continuation, visited, curve.outcome == Outcome::Closed);
    let found = passed.into_iter().filter(|passed| passed.is_branch_point);
    let (frequencies, mode) = (&problem.model().modes().frequencies, way.settings.tracked(problem.model()));
    let is_like = |omega: f64| (omega / frequencies[mode] - 1.0).abs() < DOUBLE;
    let is_double = frequencies.iter().filter(|omega| is_like(**omega)).count() > 1;
    let place = |Passed { place: Maximum { anchor, located }, .. }: Passed| {
        let [before, behind] = [anchor, anchor + 1].map(|index| &visited[index % visited.len()]);
        // The tangent at the branch point itself is one of the plane of both curves.
        let mean = before.curve.tangent.iter().zip(&behind.curve.tangent).map(|(a, b)| a + b).collect();
        let point = located.map_or_else(|| before.clone(), |(_, point)| point);
        let is_told = !(is_double && is_like(point.point.omega()));
        let is_near = is_told && way.least_threshold(problem, &point) <= NEAR * way.forcing;
        is_near.then(|| Place { point, tangent: unit(problem.metric(), mean) })
    };
    found.filter_map(place).collect()
}

impl Way<'_> {
    /// The curve that crosses another one at a place, followed to one side, unless it is known.
    fn across<'m, F: Formulation<'m>>(
        &self,
        problem: &mut F,
        (Place { point, tangent }, side): (&Place, f64),
        known: &mut Known<'_>,
        largest: f64,
        observer: &mut Observer<'_>,
    ) -> Option<TracedCurve<BranchPoint>> {
        let settings = self.settings.continuation;
        let crossing = Crossing::at(problem, &point.curve.y, tangent)?;
        let y = crossing.beside(problem, &settings.newton, side, &mut |problem, y| !known.has(problem, y))?;
        let mut continuation = Continuation::start(problem, y, &crossing.way(side), settings).ok()?;
        let (mut visited, stop) = self.walk(&mut continuation, known, largest, observer);
        let rejections = continuation.rejections();
        while visited.last().is_some_and(|last| known.has(problem, &last.curve.y)) {
            visited.pop();
        }
        if visited.len() < FEWEST {
            return None;
        }
        if stop == Stop::Closed {
            return Some(TracedCurve { visited, start: 0, outcome: Outcome::Closed, rejections });
        }
        let chord: Vec<f64> = visited[0].curve.y.iter().zip(&point.curve.y).map(|(a, b)| a - b).collect();
        visited[0].curve.step = norm(problem.metric(), &chord);
        visited.insert(0, TracedPoint { curve: CurvePoint { step: 0.0, ..point.curve.clone() }, ..point.clone() });
        // Where it was entered it has the symmetries of its own.
        Some(TracedCurve { visited, start: 1, outcome: Outcome::Open(Stop::Branching, stop), rejections })
    }

    /// Walks up to motions as large as `largest`, to what is known or is its own image, or to where no forcing of interest leads.
    fn walk<'c, 'm, F: Formulation<'m>>(
        &self,
        continuation: &mut Continuation<'c, F>,
        known: &mut Known<'_>,
        largest: f64,
        observer: &mut Observer<'_>,
    ) -> (Vec<TracedPoint>, Stop) {
        // How far the first monitored dof moves along the backbone need not say how far it does here.
        let amplitude = self.settings.backbone.max_amplitude.unwrap_or(f64::INFINITY);
        let bounds = Bounds { closes: true, amplitude, ..self.bounds };
        let (mut visited, stop) = up_to_branch_point(continuation, |continuation, branches_off| {
            let mut rest = Rest::default();
            let mut ending = |problem: &mut F, last: &TracedPoint| match () {
                () if rest.is_passed(problem, &last.curve.y) => Some(Stop::Start),
                () if norm(problem.motion_metric(), &last.curve.y) > largest => Some(Stop::AmplitudeBound),
                () if self.is_beyond(problem, last) => Some(Stop::ForcingBound),
                () if known.has(problem, &last.curve.y) => Some(Stop::Joined),
                () => branches_off(problem, last),
            };
            walk(continuation, &bounds, observer, &mut ending)
        });
        if stop == Stop::Start {
            visited.pop();
        }
        if stop == Stop::AmplitudeBound {
            let is_larger = |problem: &mut F, at: &TracedPoint| norm(problem.motion_metric(), &at.curve.y) > largest;
            end_within(continuation, &mut visited, &is_larger);
        }
        (visited, stop)
    }
}
