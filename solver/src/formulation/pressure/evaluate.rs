//! Residual of the pressure form.

use super::PressureForm;
use super::assemble::Receptances;
use super::layout::Unknowns;
use crate::formulation::aft::Rate;
use crate::formulation::harmonics::complex;
use crate::formulation::receptance::{RetainedMode, gather, scatter};
use crate::structure::laws::with_law;
use num_complex::Complex64;

impl PressureForm<'_> {
    /// Completes `y`, evaluates forces, displacements and residual; returns the largest scaled residual.
    pub(super) fn evaluate(&mut self, y: &mut [f64]) -> f64 {
        self.load(y);
        let point = self.current.parameters();
        if !y.iter().all(|v| v.is_finite())
            || point.omega <= 0.0
            || self.receptance.update(point, self.system.tracked).is_err()
        {
            return f64::NAN;
        }
        self.mark_touching();
        for e in 0..self.elements.len() {
            if self.elements[e].active {
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

    /// Elements other than contact always act; contact nodes act while their predicted pressure is positive somewhere.
    fn mark_touching(&mut self) {
        for bound in &mut self.elements {
            let series = &self.current.arguments[self.layout.channel(bound.channels.start)];
            bound.active = !bound.is_contact || self.aft.touches(series);
        }
    }

    fn evaluate_element(&mut self, e: usize) {
        let bound = &self.elements[e];
        let rate = Rate { omega: self.current.omega, harmonic: self.system.model.forcing().harmonic as f64 };
        let out = &mut self.forces[e];
        let arguments = &self.current.arguments[self.layout.element(&bound.channels)];
        with_law!(&bound.law, law => self.aft.evaluate(law, arguments, rate, out));
        let scales = &self.channels[bound.channels.clone()];
        for row in out.jacobian.chunks_mut(arguments.len()) {
            for (part, channel) in row.chunks_mut(self.layout.nc).zip(scales) {
                part.iter_mut().for_each(|d| *d *= channel.scale);
            }
        }
    }

    /// Modal forces E − F of harmonic k into `out`.
    pub(super) fn modal_load(&self, k: usize, out: &mut [Complex64]) {
        out.fill(Complex64::default());
        let modal = self.receptance.modal();
        if k == modal.harmonic() && !self.system.unknown.is_autonomous() {
            let forcing = self.current.forcing;
            out.iter_mut().zip(modal.forcing()).for_each(|(o, s)| *o = Complex64::new(forcing * s, 0.0));
        }
        let fundamental = self.system.unknown.fundamental();
        if k == 1 && fundamental != Complex64::default() {
            out.iter_mut().zip(modal.forcing()).for_each(|(o, s)| *o += fundamental * s);
        }
        for (bound, element) in self.elements.iter().zip(&self.forces).filter(|(bound, _)| bound.active) {
            for (u, series) in bound.channels.clone().zip(element.force.chunks(self.layout.nc)) {
                let force = complex(series, k);
                out.iter_mut().zip(modal.shape(u)).for_each(|(o, s)| *o -= force * s);
            }
        }
    }

    /// Modal amplitudes that are not kept, from the forces.
    fn complete_modal(&mut self) {
        let n = self.system.model.size();
        let mut work = std::mem::take(&mut self.work);
        work.resize(3 * n, Complex64::default());
        let (load, rest) = work.split_at_mut(n);
        let (y, old) = rest.split_at_mut(n);
        for k in 0..=self.system.harmonics {
            self.modal_load(k, load);
            gather(&self.current.modal, self.layout.nc, k, old);
            for mode in self.receptance.kept_at(k) {
                if let Some(column) = self.receptance.coupling(k, mode) {
                    load.iter_mut().zip(&column).for_each(|(l, c)| *l -= c * old[mode]);
                }
            }
            self.receptance.inverse_times(k, load, y);
            for mode in self.receptance.kept_at(k) {
                y[mode] = old[mode];
            }
            scatter(y, self.layout.nc, k, &mut self.current.modal);
        }
        self.work = work;
    }

    /// Arguments of the nodes that do not touch, explicitly. True if one of them touches after all; its force then has
    /// been added.
    fn complete_open_nodes(&mut self) -> bool {
        let layout = self.layout;
        for (u, out) in self.displacement.chunks_mut(layout.nc).enumerate() {
            self.receptance.modal().displacement(u, &self.current.modal, out);
        }
        let mut touched = false;
        for e in 0..self.elements.len() {
            if self.elements[e].active {
                continue;
            }
            let channels = self.elements[e].channels.clone();
            for u in channels.clone() {
                let channel = self.channels[u];
                let argument = &mut self.current.arguments[layout.channel(u)];
                for (a, x) in argument.iter_mut().zip(&self.displacement[layout.channel(u)]) {
                    *a = channel.gain * x;
                }
                argument[0] -= channel.offset;
            }
            if self.aft.touches(&self.current.arguments[layout.channel(channels.start)]) {
                self.elements[e].active = true;
                self.evaluate_element(e);
                touched = true;
            }
        }
        touched
    }

    /// Writes the completed entries back into the scaled state: open nodes, and those that were held to be open but touch.
    fn store_completed(&self, y: &mut [f64]) {
        let (arguments, rest) = y.split_at_mut(self.layout.arguments().end);
        let series = arguments.chunks_mut(self.layout.nc).zip(self.current.arguments.chunks(self.layout.nc));
        for ((target, argument), channel) in series.zip(&self.channels) {
            target.iter_mut().zip(argument).for_each(|(t, a)| *t = a / channel.scale);
        }
        for (t, q) in rest.iter_mut().zip(&self.current.modal) {
            *t = q / self.system.scales.modal;
        }
    }

    /// Residuals in the order of the unknowns, which are those that are active and kept here.
    fn evaluate_residual(&mut self) {
        let active = self.elements.iter().enumerate().filter(|(_, bound)| bound.active);
        let active = active.map(|(e, bound)| (e, bound.channels.clone()));
        self.unknowns = Unknowns::new(active, self.receptance.kept(), &self.layout);
        let mut residual = std::mem::take(&mut self.residual);
        residual.clear();
        self.argument_residuals(&mut residual);
        self.kept_residuals(&mut residual);
        if let Some(phase) = &self.phase {
            residual
                .push(crate::linalg::dot(&phase[self.layout.modal()], &self.current.modal) / self.system.scales.modal);
        }
        self.residual = residual;
    }

    /// Rounding error of the residual, from the largest terms that it is the sum of: amplitudes within 2 % of a pole are
    /// kept, so that the others are at most 50 times less exact than their forces; and from the forces, whose largest harmonic
    /// rounds them all, those as well to which the structure is more compliant.
    pub(super) fn rounding_error(&self) -> f64 {
        let size = |values: &[f64]| values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let (layout, shape) = (&self.layout, |u: usize| self.receptance.modal().shape(u));
        let mut largest = size(&self.current.modal) / self.system.scales.modal;
        let (mut channels, mut forces) = (Vec::new(), Vec::new());
        for block in &self.unknowns.blocks {
            for ((_, u, _), force) in block.arguments().zip(self.forces[block.element].force.chunks(layout.nc)) {
                let (channel, force) = (self.channels[u], size(force));
                let argument = size(&self.current.arguments[layout.channel(u)]);
                let displacement = size(shape(u)) * size(&self.current.modal);
                let terms = [argument, channel.feedback * force, channel.gain * displacement, channel.offset];
                largest = largest.max(size(&terms) / channel.scale);
                for kept in self.receptance.kept() {
                    largest = largest.max((shape(u)[kept.mode] * force).abs() / self.kept_scale(kept));
                }
                channels.push(u);
                forces.push(force);
            }
        }
        let (count, mut receptances) = (channels.len(), Receptances::default());
        self.fill_receptances(&mut receptances, self.has_many_unknowns());
        for (i, (re, im)) in receptances.parts().enumerate() {
            let (channel, force) = (self.channels[channels[i / count % count]], forces[i % count]);
            let displaced = |receptance: f64| channel.gain * receptance * force / channel.scale;
            // A square root takes longer than all of the rest.
            if (1.0 + 1e-9) * displaced(re.abs() + im.abs()) > largest {
                largest = largest.max(displaced(re.hypot(im)));
            }
        }
        64.0 * f64::EPSILON * largest
    }

    fn argument_residuals(&self, residual: &mut Vec<f64>) {
        let layout = self.layout;
        for block in &self.unknowns.blocks {
            for ((_, u, _), force) in block.arguments().zip(self.forces[block.element].force.chunks(layout.nc)) {
                let channel = self.channels[u];
                let (argument, x) = (&self.current.arguments[layout.channel(u)], &self.displacement[layout.channel(u)]);
                for h in 0..layout.nc {
                    let offset = if h == 0 { channel.offset } else { 0.0 };
                    let balance = argument[h] - channel.feedback * force[h] - channel.gain * x[h] + offset;
                    residual.push(balance / channel.scale);
                }
            }
        }
    }

    fn kept_residuals(&mut self, residual: &mut Vec<f64>) {
        let n = self.layout.modes;
        let mut work = std::mem::take(&mut self.work);
        work.resize(2 * n, Complex64::default());
        let (load, y) = work.split_at_mut(n);
        for kept in self.receptance.kept() {
            self.modal_load(kept.harmonic, load);
            gather(&self.current.modal, self.layout.nc, kept.harmonic, &mut y[..n]);
            let balance = self.receptance.stiffness_times(kept.harmonic, kept.mode, &y[..n]) - load[kept.mode];
            let scaled = balance / self.kept_scale(kept);
            residual.push(scaled.re);
            if kept.harmonic > 0 {
                residual.push(-scaled.im);
            }
        }
        self.work = work;
    }

    /// Scale of the equation of a kept amplitude: modal amplitude times the square of its eigenfrequency.
    pub(super) fn kept_scale(&self, kept: &RetainedMode) -> f64 {
        let omega = self.system.model.modes().frequencies[kept.mode];
        self.system.scales.modal * omega.max(self.system.scales.frequency).powi(2)
    }
}
