//! Elements that are about to act or to cease: contacts that begin or end, sliders that begin to slide.

use crate::formulation::harmonics::{evaluate, width};
use crate::formulation::slider::excess;
use crate::formulation::state::State;
use crate::structure::Model;
use crate::structure::laws::Law;
use std::f64::consts::TAU;

/// Elements closer to acting or ceasing than this share of their argument's range are grazing.
const GRAZING: f64 = 1e-2;

/// The element that is closest to beginning or ceasing to act, if one is about to: of a law with a threshold an extremum of the
/// argument comes close to it; a slider behind a spring that has stuck so far is about to slide in every period.
pub(super) fn grazing(model: &Model, state: &State) -> Option<usize> {
    let nc = width(state.harmonics);
    let mut closest: Option<(f64, usize)> = None;
    for (number, (channel, element)) in model.numbered().enumerate() {
        let series = &state.arguments[channel * nc..(channel + 1) * nc];
        let distance = match (element.law.threshold(), element.law.slider()) {
            (Some(threshold), _) => Sampled::new(series).nearest_extremum(threshold),
            (None, Some(slider)) => excess(slider, series).abs(),
            (None, None) => continue,
        };
        if distance < GRAZING && closest.is_none_or(|(other, _)| distance < other) {
            closest = Some((distance, number));
        }
    }
    closest.map(|(_, number)| number)
}

/// An argument at many instants of a period.
struct Sampled {
    values: Vec<f64>,
    range: f64,
}

impl Sampled {
    fn new(series: &[f64]) -> Self {
        let count = 64 * series.len();
        let values: Vec<f64> = (0..count).map(|i| evaluate(series, TAU * i as f64 / count as f64)[0]).collect();
        let (low, high) =
            values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
        Self { values, range: high - low }
    }

    /// Distance of the nearest extremum from a value, over the range.
    fn nearest_extremum(&self, value: f64) -> f64 {
        let count = self.values.len();
        let is_extremum = |i: &usize| {
            let [before, here, after] = [i + count - 1, *i, i + 1].map(|i| self.values[i % count]);
            (here - before) * (after - here) <= 0.0
        };
        let distances = (0..count).filter(is_extremum).map(|i| (self.values[i] - value).abs() / self.range);
        distances.fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::laws::{Jenkins, PenaltySpring};

    #[test]
    fn stops_that_are_just_touched_and_sliders_that_just_slide_are_grazing() {
        let model = |jenkins: f64, gap: f64| {
            Model::builder("mass")
                .mass([[1.0]])
                .stiffness([[1.0]])
                .force("x1", 1.0)
                .element("slider", Jenkins { stiffness: 2.0, limit: jenkins }, ["x1"])
                .element("stop", PenaltySpring { stiffness: 2.0, gap }, ["x1"])
                .build()
                .unwrap()
        };
        let graze = |jenkins: f64, gap: f64| {
            let cosine = vec![0.0, 1.0, 0.0];
            let arguments = [cosine.clone(), cosine.clone()].concat();
            let state = State { harmonics: 1, omega: 1.0, decay: 0.0, forcing: 1.0, arguments, modal: cosine };
            grazing(&model(jenkins, gap), &state)
        };
        assert_eq!(graze(1.0, 2.0), None);
        assert_eq!(graze(1.0, 1.001), Some(1));
        assert_eq!(graze(1.999, 2.0), Some(0));
        assert_eq!(graze(2.001, 1.015), Some(0));
    }
}
