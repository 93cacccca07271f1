//! A backbone from curves that were walked: extrema of its threshold located, every point evaluated.

use super::crossing::curves_across;
use super::way::Way;
use super::{Backbone, BackbonePoint};
use crate::curve::continuation::Continuation;
use crate::curve::extrema::{insert_maxima, locate_maximum};
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
            curve.visited = with_threshold_extrema(&mut continuation, curve.visited, criterion);
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

/// Inserts the minima and maxima of the threshold curve, located along the arc.
fn with_threshold_extrema<'m, F: Formulation<'m>>(
    continuation: &mut Continuation<'_, F>,
    visited: Vec<TracedPoint>,
    criterion: Criterion,
) -> Vec<TracedPoint> {
    let log_threshold = |problem: &mut F, v: &TracedPoint| {
        Energies::evaluate(problem, &v.curve.y, &v.point.state).threshold(criterion).ln()
    };
    let values: Vec<f64> = visited.iter().map(|v| log_threshold(continuation.problem(), v)).collect();
    let mut maxima = Vec::new();
    for i in 1..visited.len().saturating_sub(1) {
        let (before, here, after) = (values[i - 1], values[i], values[i + 1]);
        let sign = match (here < before && here <= after, here > before && here >= after) {
            (true, _) => -1.0,
            (_, true) => 1.0,
            _ => continue,
        };
        let arcs = (visited[i].curve.step, visited[i + 1].curve.step);
        let values = [before, here, after].map(|v| sign * v);
        let measure = move |problem: &mut F, v: &TracedPoint| sign * log_threshold(problem, v);
        maxima.push(locate_maximum(continuation, &visited, i, arcs, values, &measure));
    }
    insert_maxima(visited, maxima).0
}
