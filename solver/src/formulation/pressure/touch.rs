//! Where an argument comes closest to the threshold of its law: contact about to begin or to end (grazing); where sliders begin to
//! slide.
//!
//! Around an extremum of the argument u, of height h over the threshold, a force that grows with the excess acts on an arc of
//! length ∝ √h: the balance has a term ∝ h^{3/2}, its Jacobian one ∝ √h. On the side h < 0 everything is smooth up to h = 0.
//! (A. B. Nordmark, J. Sound Vib. 145, 279–297, 1991, has this square root for impacts.)

use super::PressureForm;
use crate::formulation::harmonics::{self, evaluate};
use crate::formulation::slider::passes_over_beginning;
use crate::structure::laws::Law;
use std::f64::consts::TAU;

/// Most steps of Newton's method to the instant of an extremum.
const ITERATIONS: usize = 20;

/// An extremum over the period of an argument that a threshold belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Number of the element.
    pub element: usize,
    /// Instant, ωt.
    pub instant: f64,
    /// Height over the threshold of a maximum, depth below it of a minimum, in scales of the argument: what is positive
    /// has an arc (or an opening) of its own.
    pub height: f64,
    /// Whether it is a maximum.
    pub is_maximum: bool,
    /// Range of the argument over the period, in its scale.
    range: f64,
}

impl Touch {
    /// Distance from the threshold relative to the range of the argument.
    pub fn distance(&self) -> f64 {
        self.height.abs() / self.range
    }

    /// Whether the argument is over the threshold there.
    pub fn is_above(&self) -> bool {
        (self.height > 0.0) == self.is_maximum
    }

    fn sign(&self) -> f64 {
        if self.is_maximum { 1.0 } else { -1.0 }
    }
}

impl PressureForm<'_> {
    /// Whether a slider begins or ceases to slide between two states that are too far apart for it.
    pub(super) fn begins_to_slide(&self, from: &[f64], to: &[f64]) -> bool {
        let mut sliders = self.elements.iter().filter_map(|bound| Some((bound.law.slider()?, bound.channels.start)));
        sliders.any(|(slider, u)| {
            let motion = |y: &[f64]| -> Vec<f64> {
                y[self.layout.channel(u)].iter().map(|a| a * self.channels[u].scale).collect()
            };
            passes_over_beginning(slider, [&motion(from), &motion(to)])
        })
    }

    /// Extrema of all arguments that have a threshold at the state last linearised, the closest to it first.
    pub fn touches(&self) -> Vec<Touch> {
        let mut touches = Vec::new();
        for (element, bound) in self.elements.iter().enumerate() {
            let Some(threshold) = bound.law.threshold() else { continue };
            let series = &self.current.arguments[self.layout.channel(bound.channels.start)];
            let scale = self.channels[bound.channels.start].scale;
            let count = 16 * series.len();
            let values: Vec<f64> = (0..count).map(|i| evaluate(series, TAU * i as f64 / count as f64)[0]).collect();
            let (low, high) =
                values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
            for i in 0..count {
                let (before, here, after) = (values[(i + count - 1) % count], values[i], values[(i + 1) % count]);
                let is_maximum = here > before && here >= after;
                let is_minimum = here < before && here <= after;
                if !(is_maximum || is_minimum) {
                    continue;
                }
                let Some(instant) = extremum(series, TAU * i as f64 / count as f64, TAU / count as f64) else {
                    continue;
                };
                let sign = if is_maximum { 1.0 } else { -1.0 };
                let height = sign * (evaluate(series, instant)[0] - threshold) / scale;
                touches.push(Touch { element, instant, height, is_maximum, range: (high - low) / scale });
            }
        }
        touches.sort_by(|a, b| a.distance().total_cmp(&b.distance()));
        touches
    }

    /// The same at a converged state, which becomes the one that [`PressureForm::again`] is asked of.
    pub fn touches_of(&mut self, y: &[f64]) -> Vec<Touch> {
        self.load(y);
        self.touches()
    }

    /// The same extremum at the state last linearised; none if it has left or turned.
    pub fn again(&self, touch: &Touch) -> Option<Touch> {
        let bound = &self.elements[touch.element];
        let series = &self.current.arguments[self.layout.channel(bound.channels.start)];
        let instant = extremum(series, touch.instant, TAU / (4 * series.len()) as f64)?;
        let [value, _, curvature] = evaluate(series, instant);
        let excess = (value - bound.law.threshold()?) / self.channels[bound.channels.start].scale;
        (touch.sign() * curvature < 0.0).then_some(Touch { instant, height: touch.sign() * excess, ..*touch })
    }

    /// Gradient of the height as a linear form on the state: by the envelope theorem that at a fixed instant.
    pub fn height_form(&self, touch: &Touch) -> Vec<f64> {
        let first = self.elements[touch.element].channels.start;
        let mut form = vec![0.0; self.layout.len()];
        let height = &mut form[self.layout.channel(first)];
        harmonics::basis(touch.instant, height);
        height.iter_mut().for_each(|h| *h *= touch.sign());
        form
    }
}

/// Instant of the extremum of a series near one.
fn extremum(series: &[f64], near: f64, reach: f64) -> Option<f64> {
    let mut tau = near;
    for _ in 0..ITERATIONS {
        let [_, slope, curvature] = evaluate(series, tau);
        let step = slope / curvature;
        tau -= step;
        if tau.is_nan() || (tau - near).abs() > 2.0 * reach {
            return None;
        }
        if step.abs() < 1e-14 * TAU {
            break;
        }
    }
    Some(tau)
}
