//! Linear forms on the state as rows over the unknowns.

use super::PressureForm;
use super::assemble::Columns;
use super::layout::{KeptAt, Pair};
use crate::formulation::receptance::gather;
use crate::linalg::{axpy, dot};
use num_complex::Complex64;

impl PressureForm<'_> {
    /// Entries of a linear form on modal amplitudes, those on the arguments of open nodes (a = s x − c) carried over to them.
    fn carried_over(&self, row: &[f64]) -> Vec<f64> {
        let mut modal = row[self.layout.modal()].to_vec();
        for u in self.elements.iter().filter(|bound| !bound.active).flat_map(|bound| bound.channels.clone()) {
            let (channel, series) = (self.channels[u], &row[self.layout.channel(u)]);
            if series.iter().all(|entry| *entry == 0.0) {
                continue;
            }
            let factor = channel.gain * self.system.scales.modal / channel.scale;
            for (shape, target) in self.receptance.modal().shape(u).iter().zip(modal.chunks_mut(self.layout.nc)) {
                axpy(factor * shape, series, target);
            }
        }
        modal
    }

    /// A linear form on the state as a row over the unknowns: entries of dependent arguments and modal amplitudes are carried
    /// over to the unknowns by the chain rule.
    pub(super) fn assemble_form(&self, border: &mut [f64], row: &[f64]) {
        self.assemble_dependent_form(border, row, &self.columns());
        for block in &self.unknowns.blocks {
            axpy(1.0, &row[self.layout.element(&block.channels)], &mut border[block.unknowns.clone()]);
        }
    }

    /// The same without its own entries for the arguments that are unknowns.
    pub(super) fn assemble_dependent_form(&self, border: &mut [f64], row: &[f64], columns: &Columns<'_>) {
        let (nc, n) = (self.layout.nc, self.layout.modes);
        let modal = self.carried_over(row);
        let mut weight = vec![0.0; self.layout.arguments().len()];
        let mut work = vec![Complex64::default(); 2 * n];
        let (conjugate, response) = work.split_at_mut(n);
        for k in 0..=self.system.harmonics {
            gather(&modal, nc, k, conjugate);
            if conjugate.iter().all(|w| w.re == 0.0 && w.im == 0.0) {
                continue;
            }
            conjugate.iter_mut().for_each(|w| *w = w.conj());
            self.receptance.inverse_times(k, conjugate, response);
            let parts = Pair::of(k);
            for u in self.unknowns.channels() {
                let shape = self.receptance.modal().shape(u);
                let z: Complex64 = shape.iter().zip(response.iter()).map(|(s, r)| r * *s).sum();
                weight[u * nc + parts.a] = -z.re / self.system.scales.modal;
                if let Some(b) = parts.b {
                    weight[u * nc + b] = -z.im / self.system.scales.modal;
                }
            }
            for KeptAt { kept, at } in columns.unknowns.kept_at(k) {
                let own = conjugate[kept.mode];
                let coupled = self.receptance.coupling(k, kept.mode).map_or(Complex64::default(), |column| {
                    column.iter().zip(response.iter()).map(|(c, r)| c * r).sum()
                });
                border[at.a] += own.re - coupled.re;
                if let Some(b) = at.b {
                    border[b] += own.im - coupled.im;
                }
            }
        }
        for (narrow, own) in columns.unknowns.blocks.iter().zip(&columns.blocks) {
            let border = &mut border[narrow.unknowns.clone()];
            let rows = own.jacobian.chunks(border.len().max(1));
            for (w, source) in weight[self.layout.element(&narrow.channels)].iter().zip(rows) {
                axpy(*w, source, border);
            }
        }
        let parameters = row[self.layout.parameters()].iter().zip(&self.modal_rates);
        for (border, (own, rate)) in border[columns.unknowns.parameters.clone()].iter_mut().zip(parameters) {
            *border = own + dot(&modal, rate) / self.system.scales.modal;
        }
    }
}
