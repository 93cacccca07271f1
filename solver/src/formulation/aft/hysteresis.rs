//! A spring behind a slider by the exact instants at which it sticks and slides.
//!
//! While the slider sticks, since it came to rest at the extremum τ_r of the displacement, the force is k (u − u(τ_r)) ± F: by
//! the harmonics of u it has the derivative k (φ(τ) − φ(τ_r)), since u′(τ_r) = 0. While it slides, the force is constant.
//! Harmonics over such phases have closed forms.

use super::second::Along;
use super::{Aft, ElementForce, Target, scatter};
use crate::formulation::harmonics::{self, differentiate, evaluate, series_from_coefficients};
use crate::formulation::slider::{Does, Phase, phases};
use crate::linalg::{axpy, dot};
use crate::structure::laws::Slider;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Fourier coefficients c_0, c_1, … of what is `height` from `begin` to `end` and nothing elsewhere.
fn box_coefficients(height: f64, begin: f64, end: f64, out: &mut [Complex64]) {
    let scale = height / TAU;
    let (first, last) = (Complex64::from_polar(1.0, -begin), Complex64::from_polar(1.0, -end));
    let (mut at_begin, mut at_end) = (first, last);
    for (l, c) in out.iter_mut().enumerate() {
        if l == 0 {
            *c = Complex64::new(scale * (end - begin), 0.0);
        } else {
            *c = (at_begin - at_end) * Complex64::new(0.0, -scale / l as f64);
            at_begin *= first;
            at_end *= last;
        }
    }
}

impl Aft {
    fn slider_phases(&mut self, slider: Slider, series: &[f64]) -> Vec<Phase> {
        differentiate(series, &mut self.slope[0]);
        let count = self.search.samples();
        self.scratch.resize(2 * count, 0.0);
        let (slopes, unused) = self.scratch.split_at_mut(count);
        self.search.synthesise(&self.slope[0], None, slopes, unused);
        phases(slider, series, &self.slope[0], slopes)
    }

    /// Forces and derivatives of a slider behind a spring at `series` (nc).
    pub(super) fn evaluate_slider(&mut self, slider: Slider, series: &[f64], out: &mut ElementForce) {
        let nc = series.len();
        let found = self.slider_phases(slider, series);
        let mut part = vec![Complex64::default(); nc];
        let mut sticking = part.clone();
        let (mut harmonics, mut basis) = (vec![0.0; nc], vec![0.0; nc]);
        // The moving ends of the spring: after the product matrix, which the force is made of as well.
        let mut rests = Vec::new();
        for phase in found {
            match phase.does {
                Does::Slide(force) => {
                    box_coefficients(force, phase.begin, phase.end, &mut part);
                    series_from_coefficients(&part, &mut harmonics);
                    axpy(1.0, &harmonics, &mut out.force);
                }
                Does::Stick { at, since } => {
                    box_coefficients(slider.stiffness, phase.begin, phase.end, &mut part);
                    sticking.iter_mut().zip(&part).for_each(|(sum, c)| *sum += c);
                    series_from_coefficients(&part, &mut harmonics);
                    axpy(-at, &harmonics, &mut out.force);
                    rests.extend(since.map(|since| (since, harmonics.clone())));
                }
            }
        }
        scatter(Target::Displacement(0, 0), &sticking, 1, 0.0, out);
        for (force, row) in out.force.iter_mut().zip(out.jacobian.chunks(nc)) {
            *force += dot(row, series);
        }
        for (since, harmonics) in rests {
            harmonics::basis(since, &mut basis);
            for (stiffness, row) in harmonics.iter().zip(out.jacobian.chunks_mut(nc)) {
                axpy(-stiffness, &basis, row);
            }
        }
    }

    /// Second derivatives of the same, as [`Aft::second_derivative`] has them: the instants of rest move with the motion, and
    /// where sliding begins the first derivative jumps.
    pub(super) fn second_of_slider(&mut self, slider: Slider, series: &[f64], along: Along<'_>, row: &mut [f64]) {
        let nc = series.len();
        let found = self.slider_phases(slider, series);
        let mut part = vec![Complex64::default(); nc];
        let (mut harmonics, mut at_rest, mut at_end) = (vec![0.0; nc], vec![0.0; nc], vec![0.0; nc]);
        for phase in found {
            let Does::Stick { since: Some(since), .. } = phase.does else { continue };
            box_coefficients(slider.stiffness, phase.begin, phase.end, &mut part);
            series_from_coefficients(&part, &mut harmonics);
            let (turning, drift) = (evaluate(series, since)[2], evaluate(along.arguments, since)[1]);
            harmonics::basis(since, &mut at_rest);
            if turning != 0.0 {
                // φ′ of the extremum.
                let moved = dot(along.weights, &harmonics) * drift / turning;
                for k in 1..=nc / 2 {
                    row[2 * k - 1] -= moved * k as f64 * at_rest[2 * k];
                    row[2 * k] += moved * k as f64 * at_rest[2 * k - 1];
                }
            }
            if phase.end - phase.begin == TAU {
                continue;
            }
            harmonics::basis(phase.end, &mut at_end);
            let weight = along.weights[0] + 2.0 * dot(&along.weights[1..], &at_end[1..]);
            axpy(-1.0, &at_rest, &mut at_end);
            let jump = slider.stiffness * dot(along.arguments, &at_end);
            axpy(-weight * jump / (TAU * evaluate(series, phase.end)[1]), &at_end, row);
        }
    }
}
