//! What twice the harmonics change of births, deaths and merges.

use crate::curve::problem::Problem;
use crate::formulation::Formulation;
use crate::formulation::pressure::{Degeneracy, PressureForm};
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::response::branch::{BranchPoint, Observer};
use crate::response::climb::{Top, maximum_near};
use crate::response::critical::{CriticalCurve, CriticalEvent, CriticalKind, Extent, Quantity};
use crate::settings::Settings;
use crate::structure::Model;

/// Relative change of A or ω beyond which what was found with twice the harmonics may be another birth or merge.
const NEAR: f64 = 0.2;

/// Relative distances in A and ω of two extrema that are one: A is known to the square of what ω is.
const SAME: (f64, f64) = (1e-6, 1e-4);

/// Looks for the births, deaths and merges of a curve of folds with twice the harmonics. The observer is told of every step;
/// breaking leaves out what is missing.
pub(super) fn certify(
    model: &Model,
    settings: &Settings,
    extent: Extent,
    curve: &mut CriticalCurve,
    observer: &mut Observer<'_>,
) {
    let is_wanted =
        |event: &CriticalEvent| matches!(event.kind, CriticalKind::Birth | CriticalKind::Death | CriticalKind::Merge);
    if curve.quantity != Some(Quantity::Frequency) || curve.is_cancelled() || !curve.events.iter().any(is_wanted) {
        return;
    }
    let unknown = Unknown::Extremum(Quantity::Frequency);
    let scales = Scales::new(model, settings.tracked(model));
    let built = PressureForm::build(model, settings.harmonics.doubled(), settings.tracked(model), unknown, scales);
    let Ok(mut problem) = built else { return };
    problem.measure_forcing_by(extent.forcing.1.max(scales.forcing));
    let is_closed = curve.is_closed();
    let extrema: Vec<usize> = curve.events.iter().map(|event| event.index).collect();
    for event in curve.events.iter_mut().filter(|event| is_wanted(event)) {
        let points = &curve.points;
        let forcing = |i: usize| points.get(i).map(|point| point.state.forcing);
        let here = points[event.index].state.forcing;
        let beside = forcing(event.index + 1).or_else(|| forcing(event.index.wrapping_sub(1)));
        let side = if beside.is_some_and(|beside| beside > here) { -1.0 } else { 1.0 };
        let measure = |point: &BranchPoint| side * point.state.forcing;
        let top = Top { points, is_closed, index: event.index };
        let found = maximum_near(&mut problem, settings.continuation, top, &extrema, &measure, observer);
        let omega = points[event.index].omega();
        event.doubled = found
            .filter(|point| is_of_kind(&mut problem, &point.state, event.kind))
            .map(|point| (point.state.forcing, point.omega()))
            .filter(|found| (found.0 / here - 1.0).abs() < NEAR && (found.1 / omega - 1.0).abs() < NEAR);
    }
    keep_the_nearest(curve);
}

/// Whether an extremum of A at a fold is what an event is, by the reduced Hessian: a point of the branch, or a crossing.
fn is_of_kind(problem: &mut PressureForm<'_>, state: &State, kind: CriticalKind) -> bool {
    let mut y = problem.encode(state);
    problem.linearise(&mut y);
    let is_crossing = kind == CriticalKind::Merge;
    problem
        .degeneracy()
        .is_some_and(|Degeneracy { hessian, .. }| if is_crossing { hessian < 0.0 } else { hessian > 0.0 })
}

/// What several events have come to is that of the nearest one; of the others nothing is known.
fn keep_the_nearest(curve: &mut CriticalCurve) {
    let place = |event: &CriticalEvent| curve.points[event.index].state.forcing;
    let found: Vec<(f64, (f64, f64))> =
        curve.events.iter().filter_map(|event| Some((place(event), event.doubled?))).collect();
    let off = |here: f64, there: (f64, f64)| (there.0 / here - 1.0).abs();
    let is_same = |a: (f64, f64), b: (f64, f64)| (a.0 / b.0 - 1.0).abs() < SAME.0 && (a.1 / b.1 - 1.0).abs() < SAME.1;
    let points = &curve.points;
    for event in &mut curve.events {
        let here = points[event.index].state.forcing;
        event.doubled = event.doubled.filter(|&own| {
            found.iter().all(|&(there, other)| !is_same(own, other) || off(here, own) <= off(there, other))
        });
    }
}
