//! Extrema of the forcing amplitude along a fold or peak curve: located, classified, inserted.
//!
//! Along the curve wᵀR_A A′ = −w_q q′, (w_R, w_q) the left null vector of the condition's matrix: A is extremal where w_q = 0,
//! that is where \[R_x R_ω\] loses its rank, a birth or a merge, or where q′ = 0, a cusp.

use crate::curve::continuation::{Continuation, CurvePoint};
use crate::curve::problem::{Problem, inner, weighted};
use crate::curve::walk::Evaluated;
use crate::formulation::pressure::{Degeneracy, PressureForm};
use crate::linalg::dot;
use crate::response::branch::{BranchPoint, TracedPoint};
use crate::response::corners::Corners;
use crate::response::critical::{CriticalEvent, CriticalKind, Quantity};

/// Most evaluations of the slope of A.
const ITERATIONS: usize = 40;

/// Slopes of A along the unit arc below this are zero: A is within its square of the extremum.
const FLAT: f64 = 1e-10;

/// An extremum at which the slope of A stays above this is a corner of the curve.
const CORNER: f64 = 1e-6;

/// Multipliers of the quantity below this are zero, if it cannot be told from a change of sign.
const VANISHING: f64 = 1e-6;

/// Most bisections of a step that hides extrema.
const DEPTH: usize = 8;

/// First of the short steps with which an extremum next to a corner is looked for, in shortest ones, and most of them.
const SHORT: f64 = 10.0;
const STEPS: usize = 60;

/// Share of a step on both sides of an extremum at which its kind is told.
const BESIDE: f64 = 1e-3;

/// The points of a curve with the extrema of A among them.
pub(super) fn with_events(
    continuation: &mut Continuation<'_, PressureForm<'_>>,
    mut visited: Vec<TracedPoint>,
    is_closed: bool,
    corners: &Corners,
) -> (Vec<TracedPoint>, Vec<CriticalEvent>) {
    let count = visited.len();
    let steps = if is_closed { count } else { count.saturating_sub(1) };
    for i in 0..steps {
        refresh(continuation, &mut visited, [i, (i + 1) % count], corners);
    }
    let mut located = Vec::new();
    for i in 0..steps {
        let next = (i + 1) % count;
        let (a, b) = (&visited[i], &visited[next]);
        if corners.at(&b.point).is_some() && (is_closed || next + 1 < count) {
            located.extend(at_corner(continuation, &visited, next));
        } else if corners.at(&a.point).is_none() {
            located.extend(within(continuation, [&a.curve, &b.curve], [i, next], DEPTH));
        }
    }
    insert(visited, located)
}

/// Gives two neighbouring points, where A or ω goes another way between them than their tangents say, those of their own Jacobians:
/// tangents of the walk are those of matrices nearby, and A would seem to turn where it does not.
fn refresh(
    continuation: &mut Continuation<'_, PressureForm<'_>>,
    visited: &mut [TracedPoint],
    neighbours: [usize; 2],
    corners: &Corners,
) {
    let [from, to] = neighbours.map(|i| &visited[i].curve.y);
    let parameters = [from.len() - 2, from.len() - 1];
    let rises = parameters.map(|i| to[i] > from[i]);
    for i in neighbours {
        let TracedPoint { point, curve } = &mut visited[i];
        let agrees = |(parameter, rises): (usize, bool)| (curve.tangent[parameter] > 0.0) == rises;
        if corners.at(point).is_some() || parameters.into_iter().zip(rises).all(agrees) {
            continue;
        }
        let row = weighted(continuation.problem().metric(), &curve.tangent);
        if let Ok(own) = continuation.correct_on(curve.y.clone(), &row) {
            curve.tangent = own.tangent;
        }
    }
}

/// Extrema of A between two neighbouring points of a smooth piece, of these indices.
fn within(
    continuation: &mut Continuation<'_, PressureForm<'_>>,
    [a, b]: [&CurvePoint; 2],
    [i, next]: [usize; 2],
    depth: usize,
) -> Vec<Located> {
    if (slope(a) > 0.0) != (slope(b) > 0.0) {
        let is_first = (slope(a) > 0.0) == (forcing(a) > forcing(b));
        let mut found = Search::new(continuation, a, b).locate();
        // Next to a corner the curve turns within a small part of the step.
        for [from, to] in [[a.clone(), b.clone()], [turned(b), turned(a)]] {
            found = found.or_else(|| {
                let [from, to] = shorter(continuation, &from, &to)?;
                Search::new(continuation, &from, &to).locate()
            });
        }
        let (kind, point) = found.unzip();
        let kind = kind.unwrap_or(CriticalKind::Unknown);
        return vec![Located { after: i, nearest: if is_first { i } else { next }, kind, point }];
    }
    if !hides(continuation, a, b) {
        return Vec::new();
    }
    let unknown = Located { after: i, nearest: i, kind: CriticalKind::Unknown, point: None };
    let mut search = Search::new(continuation, a, b);
    let middle = if depth == 0 { None } else { search.at(0.5 * search.length) };
    let Some(middle) = middle else { return vec![unknown] };
    let mut found = within(continuation, [a, &middle], [i, next], depth - 1);
    found.extend(within(continuation, [&middle, b], [i, next], depth - 1));
    found
}

/// Neighbouring points between which A turns, by short steps from the first end of a step within which it does.
fn shorter(
    continuation: &mut Continuation<'_, PressureForm<'_>>,
    from: &CurvePoint,
    to: &CurvePoint,
) -> Option<[CurvePoint; 2]> {
    let metric = continuation.problem().metric();
    let chord: Vec<f64> = to.y.iter().zip(&from.y).map(|(b, a)| b - a).collect();
    let (row, length) = (weighted(metric, &chord), inner(metric, &chord, &chord));
    let step = SHORT * continuation.settings().min_step;
    continuation.resume(from.clone(), step);
    let mut last = from.clone();
    for _ in 0..STEPS {
        let next = continuation.next()?;
        if (slope(&next) > 0.0) != (slope(from) > 0.0) {
            return Some([last, next]);
        }
        if dot(&row, &next.y) - dot(&row, &from.y) > length {
            return None;
        }
        last = next;
    }
    None
}

/// Whether a step leads over an even number of extrema of A, a cusp and a birth or merge say: ω turns back, and the rank of
/// \[R_x R_ω\] is lost between.
fn hides(continuation: &mut Continuation<'_, PressureForm<'_>>, a: &CurvePoint, b: &CurvePoint) -> bool {
    let rate = |point: &CurvePoint| point.tangent[point.tangent.len() - 2];
    let is_of_folds = continuation.problem().quantity() == Some(Quantity::Frequency);
    is_of_folds && rate(a) * rate(b) < 0.0 && multiplier(continuation, a) * multiplier(continuation, b) < 0.0
}

/// Multiplier of the quantity at a point; its sign is that of the last one asked for, where the null vector is alike.
fn multiplier(continuation: &mut Continuation<'_, PressureForm<'_>>, point: &CurvePoint) -> f64 {
    continuation.problem().linearise(&mut point.y.clone());
    continuation.problem().degeneracy().map_or(0.0, |degeneracy| degeneracy.multiplier)
}

/// Extrema of A between the neighbours of a corner. One at the corner itself at which \[R_x R_ω\] keeps its rank is a cusp: two
/// folds meet there and vanish. What the signs on both sides do not tell is unknown.
fn at_corner(
    continuation: &mut Continuation<'_, PressureForm<'_>>,
    visited: &[TracedPoint],
    corner: usize,
) -> Vec<Located> {
    let count = visited.len();
    let before = (corner + count - 1) % count;
    let [from, at, to] = [before, corner, (corner + 1) % count].map(|i| &visited[i].curve);
    let rises = [slope(from), forcing(at) - forcing(from), forcing(to) - forcing(at), slope(to)].map(|rise| rise > 0.0);
    let (first, last) = (multiplier(continuation, from), multiplier(continuation, to));
    let keeps_rank = first * last > 0.0 && first.abs().min(last.abs()) > VANISHING;
    let located = |kind: CriticalKind| Located { after: before, nearest: corner, kind, point: None };
    let turns = (0..3).filter(|turn| rises[*turn] != rises[turn + 1]);
    let mut found: Vec<Located> = turns
        .map(|turn| located(if turn == 1 && keeps_rank { CriticalKind::Cusp } else { CriticalKind::Unknown }))
        .collect();
    // Where the rank is lost between them A has an extremum, whether the signs of its slope show it or not.
    if found.is_empty() && first * last <= 0.0 {
        found.push(located(CriticalKind::Unknown));
    }
    found
}

/// A point of the same curve walked the other way.
fn turned(point: &CurvePoint) -> CurvePoint {
    CurvePoint { tangent: point.tangent.iter().map(|t| -t).collect(), ..point.clone() }
}

/// A′ along the arc.
fn slope(point: &CurvePoint) -> f64 {
    point.tangent[point.tangent.len() - 1]
}

/// A, scaled.
fn forcing(point: &CurvePoint) -> f64 {
    point.y[point.y.len() - 1]
}

/// An extremum of A between two neighbouring points.
struct Located {
    /// Index of the first of them.
    after: usize,
    /// Index of the one with the more extreme A.
    nearest: usize,
    /// What it is.
    kind: CriticalKind,
    /// The extremum, if it was found between them.
    point: Option<TracedPoint>,
}

/// One list of points, and the extrema by their places in it. One that was not found is the point next to it.
fn insert(visited: Vec<TracedPoint>, located: Vec<Located>) -> (Vec<TracedPoint>, Vec<CriticalEvent>) {
    let place = |i: usize| i + located.iter().filter(|l| l.after < i && l.point.is_some()).count();
    let earlier = |k: usize, l: &Located| {
        located[..k].iter().filter(|other| other.after == l.after && other.point.is_some()).count()
    };
    let event = |(k, l): (usize, &Located)| {
        let index = if l.point.is_some() { place(l.after) + 1 + earlier(k, l) } else { place(l.nearest) };
        CriticalEvent { kind: l.kind, index, doubled: None }
    };
    let events = located.iter().enumerate().map(event).collect();
    let mut points = Vec::with_capacity(visited.len() + located.len());
    let mut located = located.into_iter().peekable();
    for (i, v) in visited.into_iter().enumerate() {
        points.push(v);
        while let Some(l) = located.next_if(|l| l.after == i) {
            points.extend(l.point);
        }
    }
    (points, events)
}

/// Search along the arc from one point to the next.
struct Search<'s, 'c, 'm> {
    continuation: &'s mut Continuation<'c, PressureForm<'m>>,
    from: &'s CurvePoint,
    row: Vec<f64>,
    length: f64,
    /// From the tangent at its first end to its last.
    bend: Vec<f64>,
}

impl<'s, 'c, 'm> Search<'s, 'c, 'm> {
    fn new(continuation: &'s mut Continuation<'c, PressureForm<'m>>, from: &'s CurvePoint, to: &CurvePoint) -> Self {
        let metric = continuation.problem().metric();
        let chord: Vec<f64> = to.y.iter().zip(&from.y).map(|(b, a)| b - a).collect();
        let (row, length) = (weighted(metric, &from.tangent), inner(metric, &from.tangent, &chord));
        let bend = chord.iter().zip(&from.tangent).map(|(c, t)| c - length * t).collect();
        Self { continuation, from, row, length, bend }
    }

    /// The point at an arc length along the tangent, with the tangent of its own Jacobian: next to corners only a start that
    /// is as near at one end as at the other converges.
    fn at(&mut self, arc: f64) -> Option<CurvePoint> {
        let share = (arc / self.length).powi(2);
        let straight = self.from.y.iter().zip(&self.from.tangent).map(|(y, t)| y + arc * t);
        let y = straight.zip(&self.bend).map(|(y, b)| y + share * b).collect();
        self.continuation.correct_on(y, &self.row).ok()
    }

    /// The extremum of A and what it is.
    fn locate(mut self) -> Option<(CriticalKind, TracedPoint)> {
        let mut arc = 0.0;
        // Tangents of the walk are those of matrices nearby: an extremum may lie just beyond a point.
        let (mut low, mut high) = self.bracket()?;
        let (is_minimum, mut found) = (low.1 < 0.0, None);
        for _ in 0..ITERATIONS {
            // Regula falsi, with the value of an end that stays halved (Illinois).
            arc = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let point = self.at(arc)?;
            let value = slope(&point);
            found = Some(point);
            if value.abs() < FLAT || (high.0 - low.0).abs() < 1e-12 * self.length {
                break;
            }
            if (value > 0.0) == (high.1 > 0.0) {
                high = (arc, value);
                low.1 *= 0.5;
            } else {
                low = (arc, value);
                high.1 *= 0.5;
            }
        }
        let curve = found.filter(|curve| slope(curve).abs() < CORNER)?;
        let kind = self.kind(arc, &curve, is_minimum)?;
        let point = BranchPoint::evaluate(self.continuation.problem(), &curve);
        Some((kind, TracedPoint { curve, point }))
    }

    /// Arc lengths with slopes of different signs.
    fn bracket(&mut self) -> Option<((f64, f64), (f64, f64))> {
        let length = self.length;
        [0.0, 0.1, 0.3].into_iter().find_map(|margin| {
            let mut end = |arc: f64| self.at(arc).map(|point| (arc, slope(&point)));
            let (low, high) = (end(-margin * length)?, end((1.0 + margin) * length)?);
            ((low.1 > 0.0) != (high.1 > 0.0)).then_some((low, high))
        })
    }

    /// What the extremum `curve` at `arc` is.
    fn kind(&mut self, arc: f64, curve: &CurvePoint, is_minimum: bool) -> Option<CriticalKind> {
        let beside = BESIDE * self.length;
        let mut side = |sign: f64| {
            self.at(arc + sign * beside)?;
            self.continuation.problem().degeneracy().map(|side| side.multiplier)
        };
        let sides = (side(-1.0), side(1.0));
        let mut y = curve.y.clone();
        self.continuation.problem().linearise(&mut y);
        let Degeneracy { multiplier, hessian } = self.continuation.problem().degeneracy()?;
        let vanishes = match sides {
            (Some(before), Some(after)) => before * after <= 0.0,
            _ => multiplier.abs() < VANISHING,
        };
        Some(match (vanishes, hessian > 0.0, is_minimum) {
            (false, ..) => CriticalKind::Cusp,
            (true, true, true) => CriticalKind::Birth,
            (true, true, false) => CriticalKind::Death,
            (true, false, _) => CriticalKind::Merge,
        })
    }
}
