//! Second derivatives of the harmonic balance, weighed: w, v ↦ wᵀ R_yy\[v, ·\].
//!
//! Taken from the system before anything is eliminated, in all modal amplitudes Y and all arguments u,
//!
//! D(ω) Y + Σ b̂ f(u, ω) − A Φᵀs = 0, (u − δ f(u, ω) − γ b̂ᵀY + c) / scale = 0,
//!
//! where only D and the forces are not linear. Directions and weights of what was eliminated follow from those of what was
//! not, and the result is the second derivative of the condensed system.

use super::PressureForm;
use super::layout::KeptAt;
use crate::formulation::aft::{Along, Rate};
use crate::formulation::harmonics::{complex, set_complex};
use crate::formulation::receptance::{gather, scatter};
use crate::linalg::axpy;
use crate::structure::laws::with_law;
use num_complex::Complex64;

/// Weights of all equations, in physical units.
struct Weights {
    /// Of the modal balances, modes × nc.
    modal: Vec<f64>,
    /// Of the arguments' equations, channels × nc, each divided by the argument's scale; zero where no force acts.
    arguments: Vec<f64>,
}

impl PressureForm<'_> {
    /// wᵀ R_yy\[v, ·\] as a linear form on the scaled state, at the state last linearised: `weights` of the equations that
    /// are there, in their order; `rest`, on modal amplitudes, is what else of the transposed system acts on the eliminated
    /// ones: weight × row of every row that is no equation; `direction` a direction of the full state.
    pub(super) fn second_form(&mut self, weights: &[f64], rest: &[f64], direction: &[f64]) -> Vec<f64> {
        let weights = self.all_weights(weights, rest);
        let mut form = vec![0.0; self.layout.len()];
        self.add_stiffness_second(&weights, direction, &mut form);
        for index in 0..self.unknowns.blocks.len() {
            self.add_force_second(index, &weights, direction, &mut form);
        }
        form
    }

    /// Weights of the eliminated modal balances from those that are kept: the transposed equations of their amplitudes.
    fn all_weights(&self, weights: &[f64], rest: &[f64]) -> Weights {
        let (nc, n, scale) = (self.layout.nc, self.layout.modes, self.system.scales.modal);
        let mut all = Weights {
            modal: vec![0.0; self.layout.modal().len()],
            arguments: vec![0.0; self.layout.arguments().len()],
        };
        for block in &self.unknowns.blocks {
            for (_, u, start) in block.arguments() {
                let target = &mut all.arguments[self.layout.channel(u)];
                let scale = self.channels[u].scale;
                target.iter_mut().zip(&weights[start..start + nc]).for_each(|(t, w)| *t = w / scale);
            }
        }
        let rest = &rest[self.layout.modal()];
        let mut work = vec![Complex64::default(); 2 * n];
        let (load, response) = work.split_at_mut(n);
        for k in 0..=self.system.harmonics {
            gather(rest, nc, k, load);
            load.iter_mut().for_each(|l| *l = -*l / scale);
            for u in self.unknowns.channels() {
                let weight = self.channels[u].gain * complex(&all.arguments[self.layout.channel(u)], k);
                load.iter_mut().zip(self.receptance.modal().shape(u)).for_each(|(l, s)| *l += weight * s);
            }
            let own = |at: &KeptAt| {
                Complex64::new(weights[at.at.a], -at.at.b.map_or(0.0, |b| weights[b])) / self.kept_scale(&at.kept)
            };
            for at in self.unknowns.kept_at(k) {
                if let Some(column) = self.receptance.coupling(k, at.kept.mode) {
                    let weight = own(at);
                    load.iter_mut().zip(&column).for_each(|(l, c)| *l -= c.conj() * weight);
                }
            }
            // D is complex symmetric: its real form transposed is that of its conjugate.
            load.iter_mut().for_each(|l| *l = l.conj());
            self.receptance.inverse_times(k, load, response);
            response.iter_mut().for_each(|r| *r = r.conj());
            for at in self.unknowns.kept_at(k) {
                response[at.kept.mode] = own(at);
            }
            scatter(response, nc, k, &mut all.modal);
        }
        all
    }

    /// D_ω and D_ωω: D_k = −k²ω² + ikω Ĉ + Ω².
    fn add_stiffness_second(&self, weights: &Weights, direction: &[f64], form: &mut [f64]) {
        let (nc, n, scales) = (self.layout.nc, self.layout.modes, &self.system.scales);
        let at = self.layout.parameters().start;
        let along_omega = direction[at] * scales.frequency;
        let mut work = vec![Complex64::default(); 4 * n];
        let (weight, work) = work.split_at_mut(n);
        let (moved, work) = work.split_at_mut(n);
        let (along, y) = work.split_at_mut(n);
        let mut by_omega = 0.0;
        for k in 1..=self.system.harmonics {
            let rate = Complex64::new(0.0, k as f64);
            gather(&weights.modal, nc, k, weight);
            gather(&direction[self.layout.modal()], nc, k, along);
            gather(&self.current.modal, nc, k, y);
            weight.iter_mut().for_each(|w| *w = w.conj());
            self.receptance.rate_times(k, weight, moved);
            let series = form[self.layout.modal()].chunks_mut(nc);
            for (((target, m), w), (v, y)) in series.zip(&*moved).zip(&*weight).zip(along.iter().zip(&*y)) {
                let by_amplitude = rate * m;
                by_omega += (by_amplitude * v * scales.modal + w * 2.0 * rate * rate * along_omega * y).re;
                set_complex(target, k, (by_amplitude * along_omega * scales.modal).conj());
            }
        }
        form[at] += by_omega * scales.frequency;
    }

    /// Forces of one active element.
    fn add_force_second(&mut self, index: usize, weights: &Weights, direction: &[f64], form: &mut [f64]) {
        let block = &self.unknowns.blocks[index];
        let (nc, range) = (self.layout.nc, self.layout.element(&block.channels));
        let channels = &self.channels[block.channels.clone()];
        let mut on_force = vec![0.0; range.len()];
        for ((target, u), channel) in on_force.chunks_mut(nc).zip(block.channels.clone()).zip(channels) {
            for (shape, series) in self.receptance.modal().shape(u).iter().zip(weights.modal.chunks(nc)) {
                axpy(*shape, series, target);
            }
            axpy(-channel.feedback, &weights.arguments[self.layout.channel(u)], target);
        }
        let scaled = |values: &mut [f64]| {
            for (series, channel) in values.chunks_mut(nc).zip(channels) {
                series.iter_mut().for_each(|v| *v *= channel.scale);
            }
        };
        let mut along = direction[range.clone()].to_vec();
        scaled(&mut along);
        let at = self.layout.parameters().start;
        let unit = self.system.scales.frequency;
        let along = Along { weights: &on_force, arguments: &along, omega: direction[at] * unit };
        let rate = Rate { omega: self.current.omega, harmonic: self.system.model.forcing().harmonic as f64 };
        let arguments = &self.current.arguments[range.clone()];
        let mut row = vec![0.0; range.len()];
        let by_omega = with_law!(&self.elements[block.element].law, law =>
            self.aft.second_derivative(law, arguments, rate, along, &mut row));
        scaled(&mut row);
        form[range].copy_from_slice(&row);
        form[at] += by_omega * unit;
    }
}
