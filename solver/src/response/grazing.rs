//! Contacts that are about to begin or to end.

use crate::formulation::harmonics::{evaluate, width};
use crate::formulation::state::State;
use crate::structure::Model;
use crate::structure::laws::Law;
use std::f64::consts::TAU;

/// Extrema of a threshold law's argument closer to the threshold than this share of its range are grazing.
const GRAZING: f64 = 1e-2;

/// The element whose threshold an extremum of its argument comes closest to, if it is about to touch or to open.
pub(super) fn grazing(model: &Model, state: &State) -> Option<usize> {
    let nc = width(state.harmonics);
    let mut closest: Option<(f64, usize)> = None;
    for (number, (channel, element)) in model.numbered().enumerate() {
        let Some(threshold) = element.law.threshold() else { continue };
        let series = &state.arguments[channel * nc..(channel + 1) * nc];
        let count = 64 * nc;
        let values: Vec<f64> = (0..count).map(|i| evaluate(series, TAU * i as f64 / count as f64)[0]).collect();
        let (low, high) =
            values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
        let is_extremum = |i: &usize| {
            let (before, here, after) = (values[(i + count - 1) % count], values[*i], values[(i + 1) % count]);
            (here - before) * (after - here) <= 0.0
        };
        let distances = (0..count).filter(is_extremum).map(|i| (values[i] - threshold).abs() / (high - low));
        let distance = distances.fold(f64::INFINITY, f64::min);
        if distance < GRAZING && closest.is_none_or(|(other, _)| distance < other) {
            closest = Some((distance, number));
        }
    }
    closest.map(|(_, number)| number)
}
