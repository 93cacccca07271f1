//! A backbone from curves that were walked: extrema of its threshold located, every point evaluated.

use super::crossing::curves_across;
use super::way::Way;
use super::{Backbone, BackbonePoint};
use crate::curve::continuation::Continuation;
use crate::curve::extrema::{Maximum, Measure, insert_maxima, locate_maximum, turning_points};
use crate::curve::walk::TracedCurve;
use crate::formulation::Formulation;
use crate::response::branch::{BranchPoint, Observer, Outcome, Stop, TracedPoint};
use crate::response::columns::{OnBackbone, Row};
use crate::response::melnikov::Energies;
use crate::settings::Criterion;

impl Backbone {
    /// A curve that was walked, and what crosses it where the force does work.
    pub(super) fn with_crossing<'m, F: Formulation<'m>>(
        problem: &mut F,
        way: &Way<'_>,
        walked: TracedCurve<BranchPoint>,
        observer: &mut Observer<'_>,
    ) -> Self {
        let across = match walked.outcome {
            Outcome::Open(_, Stop::Cancelled) => Vec::new(),
            _ => curves_across(problem, way, &walked, observer),
        };
        let mut backbone = Self {
            mode: way.settings.tracked(problem.model()),
            points: Vec::new(),
            outcome: walked.outcome,
            crossing: across.iter().map(|curve| curve.outcome).collect(),
            rejections: walked.rejections + across.iter().map(|curve| curve.rejections).sum::<usize>(),
        };
        for curve in std::iter::once(walked).chain(across) {
            backbone.add(problem, way, curve);
        }
        backbone
    }

    /// Adds a piece.
    fn add<'m, F: Formulation<'m>>(&mut self, problem: &mut F, way: &Way<'_>, mut curve: TracedCurve<BranchPoint>) {
        let (settings, start) = (way.settings, curve.start);
        let criterion = settings.backbone.criterion;
        let first = curve.visited[start].curve.clone();
        if let Ok(mut continuation) = Continuation::start(problem, first.y, &first.tangent, settings.continuation) {
            way.end_at_bounds(&mut continuation, &mut curve);
            curve.visited = with_extrema(&mut continuation, curve.visited, criterion);
        }
        let visited = curve.visited;
        let (piece, mut arc) = match self.points.last() {
            Some(last) => (last.piece() + 1, last.arc()),
            None => (0, 0.0),
        };
        self.points.extend(visited.into_iter().map(|visited| {
            arc += visited.curve.step;
            let energies = Energies::evaluate(problem, &visited.curve.y, &visited.point.state);
            let (aft, state) = (problem.aft(), &visited.point.state);
            let values = Row::of_backbone(OnBackbone { aft, state, energies, criterion, arc, piece });
            BackbonePoint { point: visited.point, values }
        }));
    }
}

/// Relative height below which a turn in frequency is none: no range depends on it.
const SHALLOW: f64 = 1e-6;

/// Inserts the minima and maxima of threshold and frequency, located along the arc: what hangs on them does not depend on steps.
fn with_extrema<'m, F: Formulation<'m>>(
    continuation: &mut Continuation<'_, F>,
    visited: Vec<TracedPoint>,
    criterion: Criterion,
) -> Vec<TracedPoint> {
    let log_threshold = |problem: &mut F, v: &TracedPoint| {
        Energies::evaluate(problem, &v.curve.y, &v.point.state).threshold(criterion).ln()
    };
    let thresholds: Vec<f64> = visited.iter().map(|v| log_threshold(continuation.problem(), v)).collect();
    let omegas: Vec<f64> = visited.iter().map(|v| v.point.omega()).collect();
    let of_threshold = turning_points(&thresholds, 0.0);
    let of_frequency = turning_points(&omegas, SHALLOW * omegas.iter().fold(0.0, |largest, omega| omega.max(largest)));
    let mut maxima = of_each(continuation, &visited, (&thresholds, of_threshold), &log_threshold);
    maxima.extend(of_each(continuation, &visited, (&omegas, of_frequency), &|_, v| v.point.omega()));
    insert_maxima(visited, maxima).0
}

/// Turning points of what has a value at every point, located along the arc.
fn of_each<'m, F: Formulation<'m>>(
    continuation: &mut Continuation<'_, F>,
    visited: &[TracedPoint],
    (values, turns): (&[f64], Vec<(usize, bool)>),
    measure: &Measure<'_, F, BranchPoint>,
) -> Vec<Maximum<BranchPoint>> {
    let inner = turns.into_iter().filter(|(i, _)| (1..visited.len() - 1).contains(i));
    inner
        .map(|(i, is_maximum)| {
            let sign = if is_maximum { 1.0 } else { -1.0 };
            let arcs = (visited[i].curve.step, visited[i + 1].curve.step);
            let around = [i - 1, i, i + 1].map(|i| sign * values[i]);
            locate_maximum(continuation, visited, i, arcs, around, &move |problem: &mut F, v: &TracedPoint| {
                sign * measure(problem, v)
            })
        })
        .collect()
}
