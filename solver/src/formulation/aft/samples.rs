//! Laws on the uniform grid.

use super::{Aft, ElementForce, Rate, scatter, targets};
use crate::formulation::harmonics::{self, width};
use crate::structure::laws::{Before, Law};

impl Aft {
    pub(super) fn evaluate_samples<L: Law>(&mut self, law: &L, rate: Rate, grid: usize, out: &mut ElementForce) {
        let (c, samples) = (law.arguments(), self.grids[grid].samples());
        let (targets, count) = targets(law);
        let targets = &targets[..count];
        while self.signals.len() < targets.len() + 1 {
            self.signals.push(vec![0.0; self.grids[0].samples()]);
        }
        let mut signals = std::mem::take(&mut self.signals);
        for n in 0..samples {
            let now = self.instant(n, rate.omega * rate.harmonic);
            let r = law.respond(&now, &Before::default());
            for (signal, &target) in signals.iter_mut().zip(targets) {
                signal[n] = super::signal(target, &r, &now, c, rate);
            }
        }
        for (pair, target) in signals.chunks(2).zip(targets.chunks(2)) {
            let second = pair.get(1).unwrap_or(&pair[0]);
            let [first_spectrum, second_spectrum] = &mut self.spectra;
            self.grids[grid].analyse(&pair[0], second, first_spectrum, second_spectrum);
            for (&target, spectrum) in target.iter().zip(&self.spectra) {
                scatter(target, spectrum, c, rate.omega, out);
            }
        }
        self.signals = signals;
    }

    /// Laws with memory: two passes round the period (the first one forgets the start), with the derivatives of the
    /// force at each instant carried along as rows over the argument's harmonics.
    pub(super) fn evaluate_with_memory<L: Law>(&mut self, law: &L, rate: Rate, grid: usize, out: &mut ElementForce) {
        debug_assert_eq!(law.arguments(), 1);
        let (samples, nc) = (self.grids[grid].samples(), width(self.harmonics()));
        let step = std::f64::consts::TAU / samples as f64;
        let mut basis = vec![0.0; nc];
        let mut basis_before = vec![0.0; nc];
        let mut row = vec![0.0; nc];
        // A virgin element: no force at zero displacement, so that one that never slides is a plain spring.
        let mut before = Before::default();
        for n in 0..2 * samples {
            let (last_pass, n) = (n >= samples, n % samples);
            let now = self.instant(n, rate.omega * rate.harmonic);
            let r = law.respond(&now, &before);
            harmonics::basis(n as f64 * step, &mut basis);
            for i in 0..nc {
                row[i] = r.du[0][0] * basis[i] + r.du_before * basis_before[i] + r.dforce_before * row[i];
            }
            if last_pass {
                for (k, &b) in basis.iter().enumerate() {
                    let weight = b * if k == 0 { 1.0 } else { 2.0 } / samples as f64;
                    out.force[k] += weight * r.force[0];
                    crate::linalg::axpy(weight, &row, &mut out.jacobian[k * nc..(k + 1) * nc]);
                }
            }
            before = Before { u: now.u[0], force: r.force[0] };
            std::mem::swap(&mut basis, &mut basis_before);
        }
    }
}
