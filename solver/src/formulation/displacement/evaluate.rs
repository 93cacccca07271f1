//! Residual of the displacement form.

use super::DisplacementForm;
use crate::formulation::aft::Rate;
use crate::formulation::harmonics::{complex, set_complex};
use crate::linalg::{LinalgError, axpy};
use crate::structure::laws::with_law;
use num_complex::Complex64;

impl DisplacementForm<'_> {
    /// Condenses, evaluates forces and residual at the state last loaded.
    pub(super) fn evaluate(&mut self) -> Result<(), LinalgError> {
        self.condensed.clear();
        for k in 0..=self.system.harmonics {
            let is_forced = k == self.system.model.forcing().harmonic || self.force(k) != Complex64::default();
            self.condensed.push(self.condensation.condense(self.at.lambda(k), is_forced)?);
        }
        self.linear_balance();
        for e in 0..self.parts.len() {
            if self.parts[e].contact.is_none() {
                self.take_displacements(e, 0);
                self.add_force(e);
            }
        }
        // Every prediction before any contact force is added.
        for e in 0..self.parts.len() {
            if self.parts[e].contact.is_some() {
                self.predict_pressure(e);
                self.take_displacements(e, 1);
            }
        }
        for e in 0..self.parts.len() {
            if self.parts[e].contact.is_some() {
                self.add_force(e);
            }
        }
        if self.system.unknown.is_autonomous() {
            let first = self.displacement.chunks(self.nc).map(|series| complex(series, 1));
            let amplitude: Complex64 = self.condensed[1].mode.iter().zip(first).map(|(w, x)| w * x).sum();
            self.residual.push(amplitude.re / self.system.scales.modal);
        }
        Ok(())
    }

    /// Complex amplitude of the force of harmonic k, over the forcing shape.
    pub(super) fn force(&self, k: usize) -> Complex64 {
        let forced = if k == self.system.model.forcing().harmonic { self.at.forcing } else { 0.0 };
        let fundamental = if k == 1 { self.system.unknown.fundamental() } else { Complex64::default() };
        fundamental + forced
    }

    /// D X − E.
    fn linear_balance(&mut self) {
        let (c, nc) = (self.condensation.kept().len(), self.nc);
        self.residual.clear();
        self.residual.resize(c * nc, 0.0);
        for (k, condensed) in self.condensed.iter().enumerate() {
            let x: Vec<Complex64> = self.displacement.chunks(nc).map(|series| complex(series, k)).collect();
            for (i, row) in condensed.stiffness.chunks(c).enumerate() {
                let elastic: Complex64 = row.iter().zip(&x).map(|(d, x)| d * x).sum();
                let balance = elastic - self.force(k) * condensed.force[i];
                set_complex(&mut self.residual[i * nc..(i + 1) * nc], k, balance);
            }
        }
    }

    /// Relative displacements of an element as arguments, from the channel `from` on.
    fn take_displacements(&mut self, e: usize, from: usize) {
        let (part, nc) = (&self.parts[e], self.nc);
        for (i, channel) in part.channels.iter().enumerate().skip(from) {
            let argument = &mut self.arguments[(part.first + i) * nc..(part.first + i + 1) * nc];
            argument.fill(0.0);
            for &(dof, factor) in channel {
                axpy(factor, &self.displacement[dof * nc..(dof + 1) * nc], argument);
            }
        }
    }

    /// p̂ = P(E − D X − F_other) − ε ĝ.
    fn predict_pressure(&mut self, e: usize) {
        let (part, nc) = (&self.parts[e], self.nc);
        let Some(normal) = part.contact else { return };
        let pressure = &mut self.arguments[part.first * nc..(part.first + 1) * nc];
        pressure.fill(0.0);
        for (weight, balance) in self.left_inverse.row(normal.index).iter().zip(self.residual.chunks(nc)) {
            axpy(-weight, balance, pressure);
        }
        for &(dof, factor) in &part.channels[0] {
            axpy(normal.epsilon * factor, &self.displacement[dof * nc..(dof + 1) * nc], pressure);
        }
        pressure[0] -= normal.epsilon * normal.gap;
    }

    /// Evaluates the law of an element at its arguments and adds its forces to the balance.
    fn add_force(&mut self, e: usize) {
        let (part, nc) = (&self.parts[e], self.nc);
        let arguments = &self.arguments[part.first * nc..(part.first + part.channels.len()) * nc];
        let rate = Rate { omega: self.at.omega, harmonic: self.system.model.forcing().harmonic as f64 };
        let out = &mut self.forces[e];
        with_law!(&part.law, law => self.aft.evaluate(law, arguments, rate, out));
        for (channel, force) in part.channels.iter().zip(out.force.chunks(nc)) {
            for &(dof, factor) in channel {
                axpy(factor, force, &mut self.residual[dof * nc..(dof + 1) * nc]);
            }
        }
    }
}
