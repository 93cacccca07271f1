//! Extrema of the forcing amplitude along a fold or peak curve: located, classified, inserted.
//!
//! Along the curve wᵀR_A A′ = −w_q q′, (w_R, w_q) the left null vector of the condition's matrix: A is extremal where w_q = 0,
//! that is where \[R_x R_ω\] loses its rank, a birth or a merge, or where q′ = 0, a cusp.

use crate::curve::continuation::{Continuation, CurvePoint, weighted};
use crate::curve::problem::{Problem, inner};
use crate::curve::walk::Evaluated;
use crate::formulation::pressure::{Degeneracy, PressureForm};
use crate::response::branch::{BranchPoint, Visited};
use crate::response::critical::{CriticalEvent, CriticalKind};

/// Most evaluations of the slope of A.
const ITERATIONS: usize = 40;

/// Slopes of A along the unit arc below this are zero: A is within its square of the extremum.
const FLAT: f64 = 1e-10;

/// An extremum at which the slope of A stays above this is a corner of the curve.
const CORNER: f64 = 1e-6;

/// Multipliers of the quantity below this are zero, if it cannot be told from a change of sign.
const VANISHING: f64 = 1e-6;

/// Share of a step on both sides of an extremum at which its kind is told.
const BESIDE: f64 = 1e-3;

/// The points of a curve with the extrema of A among them.
pub(super) fn with_events(
    continuation: &mut Continuation<'_, PressureForm<'_>>,
    visited: Vec<Visited>,
    is_closed: bool,
) -> (Vec<Visited>, Vec<CriticalEvent>) {
    let count = visited.len();
    let steps = if is_closed { count } else { count.saturating_sub(1) };
    let mut located = Vec::new();
    for i in 0..steps {
        let (a, b) = (&visited[i], &visited[(i + 1) % count]);
        if (slope(&a.curve) > 0.0) != (slope(&b.curve) > 0.0) {
            let found = Search::new(continuation, &a.curve, &b.curve).locate();
            let is_first = (slope(&a.curve) > 0.0) == (forcing(&a.curve) > forcing(&b.curve));
            let nearest = if is_first { i } else { (i + 1) % count };
            located.push(Located { after: i, nearest, found });
        }
    }
    insert(visited, located)
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
    /// The extremum and its kind, if it could be told.
    found: Option<(CriticalKind, Visited)>,
}

/// One list of points, and the extrema by their places in it. One that was not found is the point next to it.
fn insert(visited: Vec<Visited>, located: Vec<Located>) -> (Vec<Visited>, Vec<CriticalEvent>) {
    let place = |i: usize| i + located.iter().filter(|l| l.after < i && l.found.is_some()).count();
    let events = located.iter().map(|l| match &l.found {
        Some((kind, _)) => CriticalEvent { kind: *kind, index: place(l.after) + 1 },
        None => CriticalEvent { kind: CriticalKind::Unknown, index: place(l.nearest) },
    });
    let events = events.collect();
    let mut points = Vec::with_capacity(visited.len() + located.len());
    let mut located = located.into_iter().peekable();
    for (i, v) in visited.into_iter().enumerate() {
        points.push(v);
        let found = located.next_if(|l| l.after == i).and_then(|l| l.found);
        points.extend(found.map(|(_, point)| point));
    }
    (points, events)
}

/// Search along the arc from one point to the next.
struct Search<'s, 'c, 'm> {
    continuation: &'s mut Continuation<'c, PressureForm<'m>>,
    from: &'s CurvePoint,
    row: Vec<f64>,
    length: f64,
}

impl<'s, 'c, 'm> Search<'s, 'c, 'm> {
    fn new(continuation: &'s mut Continuation<'c, PressureForm<'m>>, from: &'s CurvePoint, to: &CurvePoint) -> Self {
        let metric = continuation.problem().metric();
        let chord: Vec<f64> = to.y.iter().zip(&from.y).map(|(b, a)| b - a).collect();
        let (row, length) = (weighted(metric, &from.tangent), inner(metric, &from.tangent, &chord));
        Self { continuation, from, row, length }
    }

    /// The point at an arc length along the tangent, with the tangent of its own Jacobian.
    fn at(&mut self, arc: f64) -> Option<CurvePoint> {
        let y = self.from.y.iter().zip(&self.from.tangent).map(|(y, t)| y + arc * t).collect();
        self.continuation.correct_on(y, &self.row).ok()
    }

    /// The extremum of A and what it is.
    fn locate(mut self) -> Option<(CriticalKind, Visited)> {
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
        Some((kind, Visited { curve, point }))
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
