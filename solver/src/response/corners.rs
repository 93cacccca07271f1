//! Corners of fold and peak curves where a contact begins or ends (grazing), and how they are passed.
//!
//! With h the height of an extremum of a contact's argument over its threshold, the condition of the curve is
//! g = g₀(y) + κ √h⁺ and the balance has the term ∝ h^{3/2} whose derivative that is (see `formulation::pressure::touch`).
//! State, null vectors and g are continuous at h = 0; the curve's tangent is not: on the side h < 0 it comes in like any other,
//! on the side h > 0 it leaves along the surface h = 0, with h ∝ (arc length)². Steps along a tangent cannot pass this. Where
//! the height is prescribed √h is a constant, and Newton's method converges on either side as if there were no corner.

use crate::curve::continuation::{Continuation, CurvePoint};
use crate::curve::problem::{Problem, inner, norm, weighted};
use crate::curve::walk::{self, Bounds, Evaluated};
use crate::formulation::pressure::{PressureForm, Touch};
use crate::formulation::state::State;
use crate::linalg::dot;
use crate::response::branch::{BranchPoint, Observer, Stop, TracedPoint};
use crate::response::critical::Corner;

/// Extrema closer to the threshold than this share of the argument's range may be what stops a curve.
const CLOSE: f64 = 1e-3;

/// Most of them that are tried.
const CANDIDATES: usize = 4;

/// Heights at which the curve is taken up on the side with the arc, the first that works: the lower, the less is jumped over.
const ARC: [f64; 4] = [1e-8, 1e-9, 1e-7, 1e-6];

/// Depths at which it is taken up on the side without.
const SMOOTH: [f64; 4] = [1e-6, 1e-5, 1e-4, 1e-7];

/// Depth of the corner itself: as good as none.
const CORNER: f64 = 1e-11;

/// Steps of Newton's method at a prescribed height.
const ITERATIONS: usize = 15;

/// Largest residual of a point that is found.
const SOLVED: f64 = 1e-11;

/// Largest arc length from where the curve stalled, which it does at the shortest step, to the corner.
const BACK: f64 = 1e-4;

/// Largest arc length from the corner to where the curve is taken up.
const REACH: f64 = 5e-3;

/// At a quarter of the height the corner is half as far or a quarter as far: no farther than this share.
const SHORTENED: f64 = 0.75;

/// Smallest cosine between the null vectors where the curve stalled and where it is taken up.
const ALIKE: f64 = 0.9;

/// Most points before the one where the curve stalled that tell from which side it came.
const MEMORY: usize = 50;

/// Most corners that a curve is taken past, one way.
const MOST: usize = 100;

/// Most corners looked for within a step, as a power of two.
const DEPTH: usize = 3;

/// Extrema farther from the threshold than this share of the argument's range do not reach it within a step.
const FAR: f64 = 0.2;

/// Asked of every point whether the walk ends there.
type Ending<'e, 'm> = walk::Ending<'e, PressureForm<'m>, BranchPoint>;

/// Corners passed: each point, and the number of the element whose contact begins or ends there.
#[derive(Debug, Default)]
pub(super) struct Corners(Vec<(State, usize)>);

impl Corners {
    /// Adds a point that is a corner by an element.
    pub fn add(&mut self, point: &BranchPoint, element: usize) {
        self.0.push((point.state.clone(), element));
    }

    /// The element that a point is a corner by, if it is one.
    pub fn at(&self, point: &BranchPoint) -> Option<usize> {
        self.0.iter().find(|(state, _)| *state == point.state).map(|(_, element)| *element)
    }

    /// Those among the points of a curve.
    pub fn among(&self, points: &[BranchPoint]) -> Vec<Corner> {
        let corner = |(index, point)| self.at(point).map(|element| Corner { index, element });
        points.iter().enumerate().filter_map(corner).collect()
    }
}

/// Walks until a bound, a closed loop or a failure, from the continuation's current point (included), past corners.
pub(super) fn walk_past<'m>(
    continuation: &mut Continuation<'_, PressureForm<'m>>,
    bounds: &Bounds,
    observer: &mut Observer<'_>,
    ending: &mut Ending<'_, 'm>,
    corners: &mut Corners,
) -> (Vec<TracedPoint>, Stop) {
    let (mut visited, mut stop) = walk::walk(continuation, bounds, observer, ending);
    for _ in 0..MOST {
        let Stop::Stalled(_) = stop else { break };
        let Some(Passage { element, corner, beyond }) = pass(continuation, &visited) else { break };
        let [corner, beyond] = [corner, beyond].map(|curve| {
            let point = BranchPoint::evaluate(continuation.problem(), &curve);
            TracedPoint { curve, point }
        });
        corners.add(&corner.point, element);
        let step = beyond.curve.step.max(100.0 * continuation.settings().min_step);
        continuation.resume(beyond.curve.clone(), step);
        let is_cancelled = [&corner, &beyond].into_iter().any(|visited| observer(&visited.point).is_break());
        let end = ending(continuation.problem(), &beyond);
        visited.extend([corner, beyond]);
        let count = visited.len();
        stop = match end {
            _ if is_cancelled => Stop::Cancelled,
            Some(end) => end,
            None => walk::walk_on(continuation, &mut visited, bounds, observer, ending),
        };
        if visited.len() == count {
            break;
        }
    }
    (visited, stop)
}

/// The points of a curve with the corners among them that ordinary steps have led past, each with a point next to it on
/// either side.
pub(super) fn with_corners(
    continuation: &mut Continuation<'_, PressureForm<'_>>,
    visited: Vec<TracedPoint>,
    is_closed: bool,
    corners: &mut Corners,
) -> Vec<TracedPoint> {
    let count = visited.len();
    let steps = if is_closed { count } else { count.saturating_sub(1) };
    let mut list = Vec::with_capacity(count);
    for (i, point) in visited.iter().enumerate() {
        list.push(point.clone());
        let next = &visited[(i + 1) % count];
        if i < steps && corners.at(&point.point).is_none() && corners.at(&next.point).is_none() {
            split(continuation, [&point.curve, &next.curve], DEPTH, corners, &mut list);
        }
    }
    list
}

/// Adds the corners of a step to a list of points.
fn split(
    continuation: &mut Continuation<'_, PressureForm<'_>>,
    [a, b]: [&CurvePoint; 2],
    depth: usize,
    corners: &mut Corners,
    list: &mut Vec<TracedPoint>,
) {
    if depth == 0 {
        return;
    }
    let [from, to] = [a, b].map(|point| continuation.problem().touches_of(&point.y));
    let number = switches(&to);
    let changed = switches(&from).into_iter().zip(number).position(|(before, after)| before != after);
    let Some(element) = changed else { return };
    let near = |touch: &&Touch| touch.element == element && touch.distance() < FAR;
    let candidates: Vec<Touch> =
        from.iter().filter(near).take(CANDIDATES).chain(to.iter().filter(near).take(CANDIDATES)).copied().collect();
    let found = candidates
        .into_iter()
        .find_map(|touch| Between { continuation: &mut *continuation, ends: [a, b], touch }.corner());
    let Some([before, corner, after]) = found else { return };
    split(continuation, [a, &before], depth - 1, corners, list);
    for curve in [&before, &corner, &after] {
        let point = BranchPoint::evaluate(continuation.problem(), curve);
        list.push(TracedPoint { curve: curve.clone(), point });
    }
    corners.add(&list[list.len() - 2].point, element);
    split(continuation, [&after, b], depth - 1, corners, list);
}

/// How often the argument of each element passes its threshold in a period.
fn switches(touches: &[Touch]) -> Vec<usize> {
    let mut counts = Vec::new();
    let last = touches.iter().map(|touch| touch.element).max().unwrap_or_default();
    for element in 0..=last {
        let mut own: Vec<&Touch> = touches.iter().filter(|touch| touch.element == element).collect();
        own.sort_by(|a, b| a.instant.total_cmp(&b.instant));
        let next = own.iter().cycle().skip(1);
        counts.push(own.iter().zip(next).filter(|(a, b)| a.is_above() != b.is_above()).count());
    }
    counts
}

/// The way past a corner.
struct Passage {
    /// Number of the element whose contact begins or ends.
    element: usize,
    /// The corner.
    corner: CurvePoint,
    /// Where the curve is taken up beyond it.
    beyond: CurvePoint,
}

/// The way past the corner at which a curve has stalled; none if there is no corner, or the way is not certain.
fn pass(continuation: &mut Continuation<'_, PressureForm<'_>>, visited: &[TracedPoint]) -> Option<Passage> {
    let problem = continuation.problem();
    problem.linearise(&mut visited.last()?.curve.y.clone());
    let touches = problem.touches();
    let close = touches.into_iter().take_while(|touch| touch.distance() < CLOSE).take(CANDIDATES);
    close.into_iter().find_map(|touch| {
        let mut passage = CornerPassage::new(continuation, visited, touch)?;
        let heights = if passage.is_smooth { ARC } else { SMOOTH };
        heights.into_iter().find_map(|height| passage.past(height))
    })
}

/// A corner about to be passed.
struct CornerPassage<'w, 'c, 'm> {
    height: Height<'w, 'c, 'm>,
    /// Where the curve stalled.
    last: &'w CurvePoint,
    /// Whether the curve comes from the side without the arc.
    is_smooth: bool,
}

/// A step along a curve with a corner between its ends.
struct Between<'w, 'c, 'm> {
    continuation: &'w mut Continuation<'c, PressureForm<'m>>,
    ends: [&'w CurvePoint; 2],
    touch: Touch,
}

impl Between<'_, '_, '_> {
    /// The corner, and a point on either side of it.
    fn corner(self) -> Option<[CurvePoint; 3]> {
        let [a, b] = self.ends;
        let problem = self.continuation.problem();
        let mut height = |point: &CurvePoint| {
            problem.touches_of(&point.y);
            problem.again(&self.touch).map(|touch| touch.height)
        };
        let (from, to) = (height(a), height(b));
        let share = match (from, to) {
            (Some(from), Some(to)) if from * to < 0.0 => from / (from - to),
            (Some(_), Some(_)) => return None,
            (Some(_), None) => 0.0,
            _ => 1.0,
        };
        // What is not there any more at the other end has passed the threshold before.
        let comes_smooth = from.map_or_else(|| to.is_some_and(|to| to > 0.0), |from| from < 0.0);
        let chord = difference(&b.y, &a.y);
        let length = norm(problem.metric(), &chord);
        let mut height = Height { continuation: self.continuation, touch: self.touch, reach: length };
        let corner = height.at(&walk::interpolate(&a.y, &b.y, share), -CORNER)?;
        let arc = ARC.into_iter().find_map(|depth| height.at(&corner, depth))?;
        let smooth = SMOOTH.into_iter().find_map(|depth| height.at(&corner, -depth))?;
        let [before, after] = if comes_smooth { [smooth, arc] } else { [arc, smooth] };
        let metric = height.continuation.problem().metric();
        let offset = |y: &[f64]| difference(y, &a.y);
        let is_between = [&before, &corner, &after].into_iter().all(|y| {
            let share = inner(metric, &offset(y), &chord) / (length * length);
            (0.0..=1.0).contains(&share) && norm(metric, &offset(y)) <= length
        });
        if !is_between {
            return None;
        }
        let rows = [(&before, &corner), (&corner, &after)].map(|(a, b)| weighted(metric, &difference(b, a)));
        let before = height.continuation.correct_on(before, &rows[0]).ok()?;
        let after = height.continuation.correct_on(after, &rows[1]).ok()?;
        let corner = CurvePoint { y: corner, tangent: after.tangent.clone(), ..a.clone() };
        Some([before, corner, after])
    }
}

impl<'w, 'c, 'm> CornerPassage<'w, 'c, 'm> {
    fn new(
        continuation: &'w mut Continuation<'c, PressureForm<'m>>,
        visited: &'w [TracedPoint],
        touch: Touch,
    ) -> Option<Self> {
        let problem = continuation.problem();
        // On which side the last point itself lies rounding may decide.
        let side = visited.iter().rev().take(MEMORY).find_map(|visited| {
            problem.linearise(&mut visited.curve.y.clone());
            problem.again(&touch).map(|touch| touch.height).filter(|height| height.abs() > 10.0 * CORNER)
        });
        let height = Height { continuation, touch, reach: REACH };
        Some(Self { height, last: &visited.last()?.curve, is_smooth: side? < 0.0 })
    }

    /// Past the corner to a height on its other side.
    fn past(&mut self, height: f64) -> Option<Passage> {
        let (corner, beyond, nearer) = if self.is_smooth {
            let corner = self.height.at(&self.last.y, -CORNER)?;
            let beyond = self.height.at(&corner, height)?;
            let nearer = self.height.at(&beyond, 0.25 * height)?;
            (corner, beyond, nearer)
        } else {
            let beyond = self.height.at(&self.last.y, -height)?;
            let nearer = self.height.at(&beyond, -0.25 * height)?;
            (self.height.at(&nearer, -CORNER)?, beyond, nearer)
        };
        let settings = *self.height.continuation.settings();
        let problem = self.height.continuation.problem();
        let metric = problem.metric();
        let way = difference(&corner, &self.last.y);
        let [back, ahead, less] =
            [&way, &difference(&beyond, &corner), &difference(&nearer, &corner)].map(|v| norm(metric, v));
        let is_ahead = inner(metric, &way, &self.last.tangent) > -10.0 * settings.min_step;
        // What tends to the corner with the height is the curve that goes on there.
        if !is_ahead || back > BACK || ahead > REACH || less.is_nan() || less > SHORTENED * ahead {
            return None;
        }
        let [from, to] = [&self.last.y, &beyond].map(|y| null_vector(problem, y));
        if inner(problem.metric(), &from, &to).abs() < ALIKE {
            return None;
        }
        let row = weighted(problem.metric(), &difference(&beyond, &corner));
        let beyond = CurvePoint { step: ahead, ..self.height.continuation.correct_on(beyond, &row).ok()? };
        let corner = CurvePoint { y: corner, tangent: beyond.tangent.clone(), step: back, ..self.last.clone() };
        Some(Passage { element: self.height.touch.element, corner, beyond })
    }
}

/// Points of a curve at prescribed heights of an extremum.
struct Height<'w, 'c, 'm> {
    continuation: &'w mut Continuation<'c, PressureForm<'m>>,
    touch: Touch,
    /// Farthest that a start may be moved, arc length.
    reach: f64,
}

impl Height<'_, '_, '_> {
    /// The point of the curve near `y` at which the extremum has this height.
    fn at(&mut self, y: &[f64], height: f64) -> Option<Vec<f64>> {
        let mut y = y.to_vec();
        let (mut step, mut tangent) = (vec![0.0; y.len()], vec![0.0; y.len()]);
        for _ in 0..ITERATIONS {
            // Steps at another height than the one asked for are those of another √h.
            let residual = self.raise(&mut y, height)?;
            let problem = self.continuation.problem();
            if residual < SOLVED || residual < problem.rounding() {
                return Some(y);
            }
            let touch = problem.again(&self.touch)?;
            problem.factor(&problem.height_form(&touch)).ok()?;
            problem.solve(touch.height - height, &mut step, &mut tangent);
            y.iter_mut().zip(&step).for_each(|(y, s)| *y += s);
        }
        None
    }

    /// Moves `y` along the null vector of the condition, by which the balance changes in second order only, until the
    /// extremum has a height. Returns the residual there.
    fn raise(&mut self, y: &mut [f64], height: f64) -> Option<f64> {
        let problem = self.continuation.problem();
        for _ in 0..ITERATIONS {
            let residual = problem.linearise(y);
            let touch = problem.again(&self.touch).filter(|_| residual.is_finite())?;
            let missing = height - touch.height;
            if missing.abs() < 1e-2 * height.abs() {
                return Some(residual);
            }
            let null = problem.null_vector()?;
            let shift = missing / dot(&problem.height_form(&touch), null);
            let length = shift.abs() * norm(problem.metric(), null);
            if length.is_nan() || length > self.reach {
                return None;
            }
            y.iter_mut().zip(null).for_each(|(y, v)| *y += shift * v);
        }
        None
    }
}

/// Unit null vector of the condition's matrix.
fn null_vector(problem: &mut PressureForm<'_>, y: &[f64]) -> Vec<f64> {
    problem.linearise(&mut y.to_vec());
    let null = problem.null_vector().unwrap_or_default();
    let length = norm(problem.metric(), null);
    null.iter().map(|v| v / length).collect()
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
