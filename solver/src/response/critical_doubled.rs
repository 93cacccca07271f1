//! What twice the harmonics change of births, deaths and merges.

use crate::formulation::Formulation;
use crate::formulation::pressure::PressureForm;
use crate::formulation::scales::Scales;
use crate::formulation::unknown::Unknown;
use crate::response::branch::{BranchPoint, Observer};
use crate::response::climb::maximum_near;
use crate::response::critical::{CriticalCurve, CriticalEvent, CriticalKind, Extent, Quantity};
use crate::settings::Settings;
use crate::structure::Model;

/// Relative change of A beyond which what was found with twice the harmonics may be another birth or merge.
const NEAR: f64 = 0.2;

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
    let scales = Scales::new(model, settings.tracked());
    let built = PressureForm::build(model, settings.harmonics.doubled(), settings.tracked(), unknown, scales);
    let Ok(mut problem) = built else { return };
    problem.measure_forcing_by(extent.forcing.1.max(scales.forcing));
    let is_closed = curve.is_closed();
    for event in curve.events.iter_mut().filter(|event| is_wanted(event)) {
        let points = &curve.points;
        let forcing = |i: usize| points.get(i).map(|point| point.state.forcing);
        let here = points[event.index].state.forcing;
        let beside = forcing(event.index + 1).or_else(|| forcing(event.index.wrapping_sub(1)));
        let side = if beside.is_some_and(|beside| beside > here) { -1.0 } else { 1.0 };
        let measure = |point: &BranchPoint| side * point.state.forcing;
        let curve = (points.as_slice(), is_closed);
        let found = maximum_near(&mut problem, settings.continuation, curve, event.index, &measure, observer);
        event.doubled = found
            .map(|point| (point.state.forcing, point.omega()))
            .filter(|(forcing, _)| (forcing / here - 1.0).abs() < NEAR);
    }
}
