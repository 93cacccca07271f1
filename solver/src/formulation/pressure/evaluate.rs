//! Residual of the pressure form.

use super::PressureForm;
use crate::formulation::aft::Rate;
use crate::formulation::harmonics::complex;
use crate::formulation::receptance::{Point, gather, scatter};
use crate::structure::laws::with_law;
use rustfft::num_complex::Complex64;

impl PressureForm<'_> {
    /// Completes `y`, evaluates forces, displacements and residual; returns the largest scaled residual.
    pub(super) fn evaluate(&mut self, y: &mut [f64]) -> f64 {
        self.load(y);
        let point = Point { omega: self.current.omega, decay: self.current.decay };
        if !y.iter().all(|v| v.is_finite())
            || point.omega <= 0.0
            || self.receptance.update(point, self.tracked).is_err()
        {
            return f64::NAN;
        }
        self.mark_touching();
        for e in 0..self.slots.len() {
            if self.slots[e].active {
                self.evaluate_element(e);
            }
        }
        // Nodes held to be open are explicit: one that turns out to touch joins the unknowns.
        loop {
            self.complete_modal();
            if !self.complete_open_nodes() {
                break;
            }
        }
        self.store_completed(y);
        self.evaluate_residual();
        self.residual.iter().fold(0.0f64, |m, r| if r.is_nan() { f64::NAN } else { m.max(r.abs()) })
    }

    fn argument(&self, u: usize) -> &[f64] {
        &self.current.arguments[u * self.nc..(u + 1) * self.nc]
    }

    /// Elements other than contact always act; contact nodes act while their predicted pressure is positive somewhere.
    fn mark_touching(&mut self) {
        for e in 0..self.slots.len() {
            let first = self.slots[e].first;
            let series = &self.current.arguments[first * self.nc..(first + 1) * self.nc];
            self.slots[e].active = self.slots[e].contact.is_none() || self.aft.touches(series);
        }
    }

    fn evaluate_element(&mut self, e: usize) {
        let slot = &self.slots[e];
        let range = slot.first * self.nc..(slot.first + slot.count) * self.nc;
        let rate = Rate { omega: self.current.omega, harmonic: self.model.forcing.harmonic as f64 };
        let out = &mut self.forces[e];
        let arguments = &self.current.arguments[range];
        with_law!(&slot.law, law => self.aft.evaluate(law, arguments, rate, out));
        let width = slot.count * self.nc;
        let scales = &self.channels[slot.first..slot.first + slot.count];
        for row in out.jacobian.chunks_mut(width) {
            for (part, channel) in row.chunks_mut(self.nc).zip(scales) {
                part.iter_mut().for_each(|d| *d *= channel.scale);
            }
        }
    }

    /// Modal forces E − F of harmonic k into `out`.
    pub(super) fn modal_load(&self, k: usize, out: &mut [Complex64]) {
        out.fill(Complex64::default());
        if k == self.model.forcing.harmonic && !self.unknown.is_autonomous() {
            let forcing = self.current.forcing;
            out.iter_mut().zip(&self.modal_forcing).for_each(|(o, s)| *o = Complex64::new(forcing * s, 0.0));
        }
        for (slot, element) in self.slots.iter().zip(&self.forces).filter(|(slot, _)| slot.active) {
            for (i, series) in element.force.chunks(self.nc).enumerate() {
                let force = complex(series, k);
                let shape = self.receptance.shape(slot.first + i);
                out.iter_mut().zip(shape).for_each(|(o, s)| *o -= force * s);
            }
        }
    }

    /// Modal amplitudes that are not kept, from the forces.
    fn complete_modal(&mut self) {
        let n = self.model.size();
        let mut work = std::mem::take(&mut self.work);
        work.resize(3 * n, Complex64::default());
        let (load, rest) = work.split_at_mut(n);
        let (y, old) = rest.split_at_mut(n);
        for k in 0..=self.harmonics {
            self.modal_load(k, load);
            gather(&self.current.modal, self.nc, k, old);
            for kept in self.receptance.kept().iter().filter(|kept| kept.harmonic == k) {
                if let Some(column) = self.receptance.coupling(k, kept.mode) {
                    load.iter_mut().zip(&column).for_each(|(l, c)| *l -= c * old[kept.mode]);
                }
            }
            self.receptance.inverse_times(k, load, y);
            for kept in self.receptance.kept().iter().filter(|kept| kept.harmonic == k) {
                y[kept.mode] = old[kept.mode];
            }
            scatter(y, self.nc, k, &mut self.current.modal);
        }
        self.work = work;
    }

    /// Arguments of the nodes that do not touch, explicitly. True if one of them touches after all; its force then has
    /// been added.
    fn complete_open_nodes(&mut self) -> bool {
        let nc = self.nc;
        for (u, out) in self.displacement.chunks_mut(nc).enumerate() {
            self.receptance.channel(u, &self.current.modal, out);
        }
        let mut touched = false;
        for e in 0..self.slots.len() {
            if self.slots[e].active {
                continue;
            }
            let (first, count) = (self.slots[e].first, self.slots[e].count);
            for u in first..first + count {
                let channel = self.channels[u];
                let argument = &mut self.current.arguments[u * nc..(u + 1) * nc];
                for (a, x) in argument.iter_mut().zip(&self.displacement[u * nc..(u + 1) * nc]) {
                    *a = channel.gain * x;
                }
                argument[0] -= channel.offset;
            }
            let series = &self.current.arguments[first * nc..(first + 1) * nc];
            if self.aft.touches(series) {
                self.slots[e].active = true;
                self.evaluate_element(e);
                touched = true;
            }
        }
        touched
    }

    /// Writes the completed entries back into the scaled state: open nodes, and those that were held to be open but touch.
    fn store_completed(&self, y: &mut [f64]) {
        for (u, channel) in self.channels.iter().enumerate() {
            let target = &mut y[u * self.nc..(u + 1) * self.nc];
            target.iter_mut().zip(self.argument(u)).for_each(|(t, a)| *t = a / channel.scale);
        }
        let start = self.current.arguments.len();
        for (t, q) in y[start..].iter_mut().zip(&self.current.modal) {
            *t = q / self.scales.modal;
        }
    }

    fn evaluate_residual(&mut self) {
        let nc = self.nc;
        let mut residual = std::mem::take(&mut self.residual);
        residual.clear();
        for (slot, element) in self.slots.iter().zip(&self.forces).filter(|(slot, _)| slot.active) {
            for i in 0..slot.count {
                let (u, channel) = (slot.first + i, self.channels[slot.first + i]);
                let (argument, x) = (self.argument(u), &self.displacement[u * nc..(u + 1) * nc]);
                let force = &element.force[i * nc..(i + 1) * nc];
                for h in 0..nc {
                    let offset = if h == 0 { channel.offset } else { 0.0 };
                    let balance = argument[h] - channel.feedback * force[h] - channel.gain * x[h] + offset;
                    residual.push(balance / channel.scale);
                }
            }
        }
        let n = self.model.size();
        let mut work = std::mem::take(&mut self.work);
        work.resize(2 * n, Complex64::default());
        let (load, y) = work.split_at_mut(n);
        for (index, kept) in self.receptance.kept().iter().enumerate() {
            self.modal_load(kept.harmonic, load);
            gather(&self.current.modal, nc, kept.harmonic, &mut y[..n]);
            let balance = self.receptance.stiffness_times(kept.harmonic, kept.mode, &y[..n]) - load[kept.mode];
            let scaled = balance / self.kept_scale(index);
            residual.push(scaled.re);
            if kept.harmonic > 0 {
                residual.push(-scaled.im);
            }
        }
        if let Some(phase) = &self.phase {
            let modal = &phase[self.current.arguments.len()..];
            residual
                .push(crate::linalg::dot(&modal[..self.current.modal.len()], &self.current.modal) / self.scales.modal);
        }
        self.work = work;
        self.residual = residual;
    }

    /// Scale of the equation of a kept amplitude: modal amplitude times the square of its eigenfrequency.
    pub(super) fn kept_scale(&self, index: usize) -> f64 {
        let omega = self.model.modes.frequencies[self.receptance.kept()[index].mode];
        self.scales.modal * omega.max(self.scales.frequency).powi(2)
    }
}
