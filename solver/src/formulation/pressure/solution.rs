//! From the unknowns that are factorised back to the full state.

use super::PressureForm;
use super::layout::{KeptAt, Unknowns};
use crate::formulation::harmonics::complex;
use crate::formulation::receptance::scatter;
use crate::linalg::{axpy, dot, vectorised};
use num_complex::Complex64;

impl PressureForm<'_> {
    /// Expands a solution of the bordered system to the full scaled state, dependent entries included.
    pub(super) fn expand(&self, solution: &[f64], out: &mut [f64]) {
        let mut force = vec![0.0; self.layout.arguments().len()];
        for block in &self.unknowns.blocks {
            let (range, unknowns) = (self.layout.element(&block.channels), &solution[block.unknowns.clone()]);
            out[range.clone()].copy_from_slice(unknowns);
            product(&self.forces[block.element].jacobian, unknowns, &mut force[range]);
        }
        self.expand_dependent(&self.unknowns, solution, &force, out);
    }

    /// Parameters, modal amplitudes and arguments of open nodes, from forces (channels × nc) and a solution for `unknowns`.
    pub(super) fn expand_dependent(&self, unknowns: &Unknowns, solution: &[f64], force: &[f64], out: &mut [f64]) {
        let nc = self.layout.nc;
        let (arguments, rest) = out.split_at_mut(self.layout.arguments().end);
        let (modal, parameters) = rest.split_at_mut(self.layout.modal().len());
        parameters.copy_from_slice(&solution[unknowns.parameters.clone()]);
        self.expand_modal(unknowns, solution, force, modal);
        for (parameter, rate) in parameters.iter().zip(&self.modal_rates) {
            axpy(parameter / self.system.scales.modal, rate, modal);
        }
        let mut series = vec![0.0; nc];
        for u in self.elements.iter().filter(|bound| !bound.active).flat_map(|bound| bound.channels.clone()) {
            let channel = self.channels[u];
            self.receptance.modal().displacement(u, modal, &mut series);
            let factor = channel.gain * self.system.scales.modal / channel.scale;
            for (a, x) in arguments[self.layout.channel(u)].iter_mut().zip(&series) {
                *a = factor * x;
            }
        }
    }

    /// Modal amplitudes, scaled, from forces (channels × nc) and the kept ones.
    fn expand_modal(&self, unknowns: &Unknowns, solution: &[f64], force: &[f64], modal: &mut [f64]) {
        let n = self.layout.modes;
        let mut work = vec![Complex64::default(); 2 * n];
        let (load, response) = work.split_at_mut(n);
        let amplitude = |at: &KeptAt| Complex64::new(solution[at.at.a], at.at.b.map_or(0.0, |b| -solution[b]));
        for k in 0..=self.system.harmonics {
            load.fill(Complex64::default());
            for u in self.unknowns.channels() {
                let f = complex(&force[self.layout.channel(u)], k);
                load.iter_mut().zip(self.receptance.modal().shape(u)).for_each(|(l, s)| *l -= f * s);
            }
            for at in unknowns.kept_at(k) {
                if let Some(coupling) = self.receptance.coupling(k, at.kept.mode) {
                    let q = amplitude(at);
                    load.iter_mut().zip(&coupling).for_each(|(l, c)| *l -= c * q * self.system.scales.modal);
                }
            }
            self.receptance.inverse_times(k, load, response);
            response.iter_mut().for_each(|r| *r /= self.system.scales.modal);
            for at in unknowns.kept_at(k) {
                response[at.kept.mode] = amplitude(at);
            }
            scatter(response, self.layout.nc, k, modal);
        }
    }
}

/// `out` = A v of a row-major matrix.
pub(super) fn product(matrix: &[f64], v: &[f64], out: &mut [f64]) {
    vectorised(
        #[inline(always)]
        || out.iter_mut().zip(matrix.chunks(v.len().max(1))).for_each(|(o, row)| *o = dot(row, v)),
    );
}
