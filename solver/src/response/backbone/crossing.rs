//! Curves that cross a backbone: where modes interact, or motions lose a symmetry, further families of free motions leave it at branch
//! points, and isolas grow about these as about the backbone itself.

use crate::curve::continuation::Continuation;
use crate::curve::extrema::Maximum;
use crate::curve::identity::Identity;
use crate::curve::point::unit;
use crate::curve::problem::norm;
use crate::curve::switch::{Crossing, SIDES};
use crate::curve::walk::{Bounds, TracedCurve, walk};
use crate::formulation::Formulation;
use crate::response::branch::{BranchPoint, Observer, Outcome, Stop, TracedPoint};
use crate::response::branch_points::{Passed, branch_points};
use crate::response::melnikov::Energies;
use crate::response::symmetry::up_to_branch_point;
use crate::settings::Settings;
use std::f64::consts::PI;

/// Most curves that are followed beside a backbone.
const MOST: usize = 8;

/// Fewest points of such a curve: what is shorter is one that is known, where it cannot be told next to a branch point.
const FEWEST: usize = 3;

/// Up to a least threshold of this many times the highest forcing amplitude branch points are of interest.
const NEAR: f64 = 10.0;

/// Up to a least threshold of this many times the highest forcing amplitude curves are followed from there.
const FAR: f64 = 100.0;

/// How curves of free motions are walked.
pub(super) struct Way<'w> {
    /// The settings.
    pub settings: &'w Settings,
    /// Where walks end.
    pub bounds: Bounds,
    /// Size of motions at rest, in the metric of motions: on the other side of it are the same ones, half a period later.
    pub rest: f64,
    /// Highest forcing amplitude that curves across are for.
    pub forcing: f64,
}

impl Way<'_> {
    /// Threshold A* of a point if the forcing did as much work as one of its size can: W/A = π m |s| |X|. On motions that cross each other
    /// one and the same force may do very different work.
    fn least_threshold<'m, F: Formulation<'m>>(&self, problem: &mut F, at: &TracedPoint) -> f64 {
        let energies = Energies::evaluate(problem, &at.curve.y, &at.point.state);
        let size = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>().sqrt();
        let (modal, m) = (problem.modal(), problem.modal().harmonic() as f64);
        let work = PI * m * size(modal.forcing()) * size(&at.point.state.modal);
        energies.dissipated(self.settings.backbone.criterion) / work
    }
}

/// A branch point of a curve.
struct Place {
    /// The point.
    point: TracedPoint,
    /// Unit tangent of the curve.
    tangent: Vec<f64>,
}

/// The curves that cross `first` at its branch points, those that cross these, and so on, each from its branch point on. Of images of each
/// other the first.
pub(super) fn curves_across<'m, F: Formulation<'m>>(
    problem: &mut F,
    way: &Way<'_>,
    first: &TracedCurve<BranchPoint>,
    observer: &mut Observer<'_>,
) -> Vec<TracedCurve<BranchPoint>> {
    let mut found: Vec<TracedCurve<BranchPoint>> = Vec::new();
    let mut places = places(problem, way, first);
    let mut looked_at = 0;
    loop {
        for (place, side) in places.iter().flat_map(|place| SIDES.map(|side| (place, side))) {
            if found.len() == MOST {
                return found;
            }
            let known: Vec<&TracedCurve<BranchPoint>> = std::iter::once(first).chain(&found).collect();
            let Some(curve) = across(problem, way, place, side, &known, observer) else { continue };
            let is_cancelled = matches!(curve.outcome, Outcome::Open(_, Stop::Cancelled));
            found.push(curve);
            if is_cancelled {
                return found;
            }
        }
        let Some(next) = found.get(looked_at) else { return found };
        places = self::places(problem, way, next);
        looked_at += 1;
    }
}

/// The branch points of a curve whose threshold is not far beyond the forcing.
fn places<'m, F: Formulation<'m>>(problem: &mut F, way: &Way<'_>, curve: &TracedCurve<BranchPoint>) -> Vec<Place> {
    let visited = &curve.visited;
    let begin = visited[curve.start].curve.clone();
    let continuation = Continuation::start(problem, begin.y, &begin.tangent, way.settings.continuation);
    let Ok(mut continuation) = continuation else { return Vec::new() };
    let passed = branch_points(&mut continuation, visited, curve.outcome == Outcome::Closed);
    let found = passed.into_iter().filter(|passed| passed.is_branch_point);
    let place = |Passed { place: Maximum { anchor, located }, .. }: Passed| {
        let [before, behind] = [anchor, anchor + 1].map(|index| &visited[index % visited.len()]);
        // The tangent at the branch point itself is one of the plane of both curves.
        let mean = before.curve.tangent.iter().zip(&behind.curve.tangent).map(|(a, b)| a + b).collect();
        let point = located.map_or_else(|| before.clone(), |(_, point)| point);
        let is_near = way.least_threshold(problem, &point) <= NEAR * way.forcing;
        is_near.then(|| Place { point, tangent: unit(problem.metric(), mean) })
    };
    found.filter_map(place).collect()
}

/// The curve that crosses another one, followed to one side, unless it is known.
fn across<'m, F: Formulation<'m>>(
    problem: &mut F,
    way: &Way<'_>,
    Place { point, tangent }: &Place,
    side: f64,
    known: &[&TracedCurve<BranchPoint>],
    observer: &mut Observer<'_>,
) -> Option<TracedCurve<BranchPoint>> {
    let settings = way.settings.continuation;
    let mut identity = Identity::default();
    let mut is_known = |problem: &mut F, y: &[f64]| {
        known.iter().any(|known| {
            let points: Vec<&[f64]> = known.visited.iter().map(|visited| &visited.curve.y[..]).collect();
            identity.position(problem, &settings.newton, &points, known.outcome == Outcome::Closed, y).is_some()
        })
    };
    let crossing = Crossing::at(problem, &point.curve.y, tangent)?;
    let y = crossing.beside(problem, &settings.newton, side, &mut |problem, y| !is_known(problem, y))?;
    let mut continuation = Continuation::start(problem, y, &crossing.way(side), settings).ok()?;
    let (mut visited, stop) = up_to_branch_point(&mut continuation, |continuation, branches_off| {
        let mut ending = |problem: &mut F, last: &TracedPoint| match () {
            () if norm(problem.motion_metric(), &last.curve.y) < way.rest => Some(Stop::Start),
            () if way.least_threshold(problem, last) > FAR * way.forcing => Some(Stop::ForcingBound),
            () if is_known(problem, &last.curve.y) => Some(Stop::Joined),
            () => branches_off(problem, last),
        };
        walk(continuation, &Bounds { closes: true, ..way.bounds }, observer, &mut ending)
    });
    let rejections = continuation.rejections();
    while visited.last().is_some_and(|last| is_known(problem, &last.curve.y)) {
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
    visited.insert(0, point.clone());
    // Where it was entered it has the symmetries of its own.
    Some(TracedCurve { visited, start: 1, outcome: Outcome::Open(Stop::Branching, stop), rejections })
}
