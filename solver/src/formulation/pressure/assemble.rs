//! Bordered Jacobian of the pressure form.

use super::PressureForm;
use crate::formulation::harmonics::complex;
use crate::formulation::receptance::{gather, scatter};
use crate::formulation::unknown::Parameter;
use rustfft::num_complex::Complex64;

/// Rows or columns (a_k, b_k) of harmonic k within a series; b_0 does not exist.
fn parts(k: usize) -> (usize, Option<usize>) {
    if k == 0 { (0, None) } else { (2 * k - 1, Some(2 * k)) }
}

/// A row-major square matrix being filled.
struct Target<'a> {
    data: &'a mut [f64],
    size: usize,
}

impl Target<'_> {
    /// Adds the complex row `factor` × (row_a − i row_b) to rows `start + parts(k)`, columns from `column`.
    #[inline(always)]
    fn add_complex_row(
        &mut self,
        rows: (usize, Option<usize>),
        column: usize,
        factor: Complex64,
        source_a: &[f64],
        source_b: Option<&[f64]>,
    ) {
        let width = source_a.len();
        let begin = rows.0 * self.size + column;
        match (rows.1, source_b) {
            (Some(row_b), Some(source_b)) => {
                let offset = row_b * self.size + column;
                let (head, tail) = self.data.split_at_mut(offset);
                let (dest_a, dest_b) = (&mut head[begin..begin + width], &mut tail[..width]);
                for i in 0..width {
                    dest_a[i] += factor.re * source_a[i] + factor.im * source_b[i];
                    dest_b[i] += factor.re * source_b[i] - factor.im * source_a[i];
                }
            }
            _ => crate::linalg::axpy(factor.re, source_a, &mut self.data[begin..begin + width]),
        }
    }

    /// Adds the 2 × 2 (or 1 × 1) real form of multiplication by `factor`.
    fn add_complex(&mut self, rows: (usize, Option<usize>), cols: (usize, Option<usize>), factor: Complex64) {
        self.data[rows.0 * self.size + cols.0] += factor.re;
        if let Some(row_b) = rows.1 {
            self.data[row_b * self.size + cols.0] -= factor.im;
        }
        if let Some(col_b) = cols.1 {
            self.data[rows.0 * self.size + col_b] += factor.im;
            if let Some(row_b) = rows.1 {
                self.data[row_b * self.size + col_b] += factor.re;
            }
        }
    }
}

fn shifted((a, b): (usize, Option<usize>), start: usize) -> (usize, Option<usize>) {
    (start + a, b.map(|b| start + b))
}

impl PressureForm<'_> {
    /// Fills the bordered matrix of the state last evaluated.
    pub(super) fn assemble(&mut self, row: &[f64]) {
        let size = self.residual.len() + 1;
        let mut lu = std::mem::take(&mut self.lu);
        let mut target = Target { data: lu.reset(size), size };
        crate::linalg::vectorised(|| self.assemble_arguments(&mut target));
        let kept_start = self.argument_unknowns();
        self.assemble_kept(&mut target, kept_start);
        let parameter_start = size - self.parameters();
        self.assemble_parameters(&mut target, kept_start, parameter_start);
        if let Some(phase) = &self.phase {
            let row = &mut target.data[(size - 2) * size..(size - 1) * size];
            self.assemble_form(row, phase, kept_start, parameter_start);
        }
        self.assemble_form(&mut target.data[(size - 1) * size..], row, kept_start, parameter_start);
        self.lu = lu;
    }

    /// Number of argument unknowns: all channels of the active elements.
    fn argument_unknowns(&self) -> usize {
        self.slots.iter().filter(|slot| slot.active).map(|slot| slot.count * self.nc).sum()
    }

    /// I − δ ∂f + s R ∂f, scaled.
    #[inline(always)]
    fn assemble_arguments(&mut self, target: &mut Target<'_>) {
        let nc = self.nc;
        let active: Vec<usize> =
            self.slots.iter().filter(|slot| slot.active).flat_map(|slot| slot.first..slot.first + slot.count).collect();
        let count = active.len();
        for i in 0..count * nc {
            target.data[i * target.size + i] = 1.0;
        }
        self.receptance_re.resize(count * count, 0.0);
        self.receptance_im.resize(count * count, 0.0);
        for k in 0..=self.harmonics {
            self.receptance.matrix(
                k,
                &active,
                &mut self.receptance_work,
                &mut self.receptance_re,
                &mut self.receptance_im,
            );
            let (row_a, row_b) = parts(k);
            let mut column = 0;
            for (slot, element) in self.slots.iter().zip(&self.forces).filter(|(slot, _)| slot.active) {
                let width = slot.count * nc;
                for i in 0..slot.count {
                    // Force i does not depend on the arguments from `reach` on.
                    let reach = slot.reach[i] * nc;
                    let source = |part: usize| {
                        let start = (i * nc + part) * width;
                        &element.jacobian[start..start + reach]
                    };
                    let (source_a, source_b) = (source(row_a), row_b.map(source));
                    let v = column / nc + i;
                    for (a, &u) in active.iter().enumerate() {
                        let channel = self.channels[u];
                        let gain = channel.gain / channel.scale;
                        let mut factor = Complex64::new(
                            gain * self.receptance_re[a * count + v],
                            gain * self.receptance_im[a * count + v],
                        );
                        if a == v {
                            factor.re -= channel.feedback / channel.scale;
                        }
                        target.add_complex_row(shifted(parts(k), a * nc), column, factor, source_a, source_b);
                    }
                }
                column += width;
            }
        }
    }

    /// Shape t_uκ of channel `u` for a kept amplitude and the correction D̂_oo⁻¹ D̂_oκ of the other modes.
    fn kept_shape(&self, u: usize, mode: usize, response: Option<&[Complex64]>) -> Complex64 {
        let shape = self.receptance.shape(u);
        let own = Complex64::new(shape[mode], 0.0);
        match response {
            None => own,
            Some(response) => own - shape.iter().zip(response).map(|(s, r)| r * *s).sum::<Complex64>(),
        }
    }

    /// Columns and rows of the kept modal amplitudes.
    fn assemble_kept(&self, target: &mut Target<'_>, kept_start: usize) {
        let (nc, n) = (self.nc, self.model.size());
        let mut start = kept_start;
        for (index, kept) in self.receptance.kept().iter().enumerate() {
            let (k, mode) = (kept.harmonic, kept.mode);
            let place = if k == 0 { (start, None) } else { (start, Some(start + 1)) };
            let scale = self.kept_scale(index);
            let response = self.receptance.coupling(k, mode).map(|column| {
                let mut response = vec![Complex64::default(); n];
                self.receptance.inverse_times(k, &column, &mut response);
                response
            });
            let mut column = 0;
            for (slot, element) in self.slots.iter().zip(&self.forces).filter(|(slot, _)| slot.active) {
                let width = slot.count * nc;
                for i in 0..slot.count {
                    let u = slot.first + i;
                    let shape = self.kept_shape(u, mode, response.as_deref());
                    let channel = self.channels[u];
                    let gain = -channel.gain / channel.scale * self.scales.modal;
                    target.add_complex(shifted(parts(k), column + i * nc), place, gain * shape);
                    let source = |part: usize| {
                        let begin = (i * nc + part) * width;
                        &element.jacobian[begin..begin + width]
                    };
                    let (a, b) = parts(k);
                    target.add_complex_row(place, column, shape / scale, source(a), b.map(source));
                }
                column += width;
            }
            let mut other_start = kept_start;
            for other in self.receptance.kept() {
                let other_place =
                    if other.harmonic == 0 { (other_start, None) } else { (other_start, Some(other_start + 1)) };
                if other.harmonic == k {
                    let mut entry = self.receptance.entry(k, mode, other.mode);
                    if let (Some(response), Some(column)) = (&response, self.receptance.coupling(k, other.mode)) {
                        entry -= response.iter().zip(&column).map(|(r, c)| r * c).sum::<Complex64>();
                    }
                    target.add_complex(place, other_place, entry * (self.scales.modal / scale));
                }
                other_start += if other.harmonic == 0 { 1 } else { 2 };
            }
            start += if k == 0 { 1 } else { 2 };
        }
    }

    /// Columns of the parameters; also the rates of the dependent modal amplitudes.
    fn assemble_parameters(&mut self, target: &mut Target<'_>, kept_start: usize, parameter_start: usize) {
        let (nc, n) = (self.nc, self.model.size());
        let mut rates = std::mem::take(&mut self.modal_rates);
        let mut buffer = vec![Complex64::default(); 4 * n];
        let (y, rest) = buffer.split_at_mut(n);
        let (moved, rest) = rest.split_at_mut(n);
        let (load, response) = rest.split_at_mut(n);
        for (p, (rate, &parameter)) in rates.iter_mut().zip(self.unknown.parameters()).enumerate() {
            let column = parameter_start + p;
            let unit = parameter.unit(&self.scales);
            let is_omega = parameter == Parameter::Frequency;
            for k in 0..=self.harmonics {
                // `moved` = (∂D/∂p) Y, `load` = ∂(E − F)/∂p.
                gather(&self.current.modal, nc, k, y);
                moved.fill(Complex64::default());
                load.fill(Complex64::default());
                if parameter != Parameter::Forcing {
                    self.receptance.rate_times(k, y, moved);
                    moved.iter_mut().for_each(|m| *m *= parameter.rate(k));
                } else if k == self.model.forcing.harmonic {
                    load.iter_mut().zip(&self.modal_forcing).for_each(|(l, &s)| *l = s.into());
                }
                if is_omega {
                    self.add_explicit_force_rates(k, load);
                }
                for j in 0..n {
                    y[j] = load[j] - moved[j];
                }
                self.receptance.inverse_times(k, y, response);
                scatter(response, nc, k, rate);
                let mut start = kept_start;
                for (index, kept) in self.receptance.kept().iter().enumerate() {
                    if kept.harmonic == k {
                        let balance = moved[kept.mode] - load[kept.mode]
                            + self.receptance.stiffness_times(k, kept.mode, response);
                        let scaled = balance * (unit / self.kept_scale(index));
                        target.data[start * target.size + column] = scaled.re;
                        if k > 0 {
                            target.data[(start + 1) * target.size + column] = -scaled.im;
                        }
                    }
                    start += if kept.harmonic == 0 { 1 } else { 2 };
                }
            }
            rate.iter_mut().for_each(|r| *r *= unit);
            let mut series = vec![0.0; nc];
            let mut row = 0;
            for (slot, element) in self.slots.iter().zip(&self.forces).filter(|(slot, _)| slot.active) {
                for i in 0..slot.count {
                    let channel = self.channels[slot.first + i];
                    self.receptance.channel(slot.first + i, rate, &mut series);
                    for (h, x) in series.iter().enumerate() {
                        let explicit = if is_omega { unit * element.domega[i * nc + h] } else { 0.0 };
                        target.data[row * target.size + column] =
                            -(channel.gain * x + channel.feedback * explicit) / channel.scale;
                        row += 1;
                    }
                }
            }
        }
        self.modal_rates = rates;
    }

    /// Subtracts b̂ ∂f/∂ω (at fixed arguments) of harmonic k.
    fn add_explicit_force_rates(&self, k: usize, load: &mut [Complex64]) {
        for (slot, element) in self.slots.iter().zip(&self.forces).filter(|(slot, _)| slot.active) {
            for (i, series) in element.domega.chunks(self.nc).enumerate() {
                let rate = complex(series, k);
                let shape = self.receptance.shape(slot.first + i);
                load.iter_mut().zip(shape).for_each(|(l, s)| *l -= rate * s);
            }
        }
    }

    /// A linear form on the state as a row over the unknowns: entries of dependent modal amplitudes are carried over to the unknowns by the chain rule.
    fn assemble_form(&self, border: &mut [f64], row: &[f64], kept_start: usize, parameter_start: usize) {
        let (nc, n) = (self.nc, self.model.size());
        let (arguments, rest) = row.split_at(self.current.arguments.len());
        let (modal, parameters) = rest.split_at(self.current.modal.len());
        let mut weight = vec![0.0; self.current.arguments.len()];
        let mut work = vec![Complex64::default(); 2 * n];
        let (conjugate, response) = work.split_at_mut(n);
        for k in 0..=self.harmonics {
            gather(modal, nc, k, conjugate);
            if conjugate.iter().all(|w| w.re == 0.0 && w.im == 0.0) {
                continue;
            }
            conjugate.iter_mut().for_each(|w| *w = w.conj());
            self.receptance.inverse_times(k, conjugate, response);
            let (a, b) = parts(k);
            for slot in self.slots.iter().filter(|slot| slot.active) {
                for u in slot.first..slot.first + slot.count {
                    let shape = self.receptance.shape(u);
                    let z: Complex64 = shape.iter().zip(response.iter()).map(|(s, r)| r * *s).sum();
                    weight[u * nc + a] = -z.re / self.scales.modal;
                    if let Some(b) = b {
                        weight[u * nc + b] = -z.im / self.scales.modal;
                    }
                }
            }
            let mut start = kept_start;
            for kept in self.receptance.kept() {
                if kept.harmonic == k {
                    let own = conjugate[kept.mode];
                    let coupled = self.receptance.coupling(k, kept.mode).map_or(Complex64::default(), |column| {
                        column.iter().zip(response.iter()).map(|(c, r)| c * r).sum()
                    });
                    border[start] += own.re - coupled.re;
                    if k > 0 {
                        border[start + 1] += own.im - coupled.im;
                    }
                }
                start += if kept.harmonic == 0 { 1 } else { 2 };
            }
        }
        let mut column = 0;
        for (slot, element) in self.slots.iter().zip(&self.forces).filter(|(slot, _)| slot.active) {
            let width = slot.count * nc;
            let range = slot.first * nc..slot.first * nc + width;
            border[column..column + width].copy_from_slice(&arguments[range.clone()]);
            for (w, source) in weight[range].iter().zip(element.jacobian.chunks(width)) {
                crate::linalg::axpy(*w, source, &mut border[column..column + width]);
            }
            column += width;
        }
        for (p, rate) in self.modal_rates.iter().enumerate() {
            border[parameter_start + p] = parameters[p] + crate::linalg::dot(modal, rate) / self.scales.modal;
        }
    }

    /// Expands a solution of the bordered system to the full scaled state, dependent entries included.
    pub(super) fn expand(&self, solution: &[f64], out: &mut [f64]) {
        let (nc, n) = (self.nc, self.model.size());
        let kept_start = self.argument_unknowns();
        let parameter_start = solution.len() - self.parameters();
        let (arguments, rest) = out.split_at_mut(self.current.arguments.len());
        let (modal, parameters) = rest.split_at_mut(self.current.modal.len());
        parameters.copy_from_slice(&solution[parameter_start..]);
        // Forces, then modal amplitudes.
        let mut force = vec![0.0; arguments.len()];
        let mut column = 0;
        for (slot, element) in self.slots.iter().zip(&self.forces).filter(|(slot, _)| slot.active) {
            let width = slot.count * nc;
            let start = slot.first * nc;
            let unknowns = &solution[column..column + width];
            arguments[start..start + width].copy_from_slice(unknowns);
            for (f, row) in force[start..start + width].iter_mut().zip(element.jacobian.chunks(width)) {
                *f = crate::linalg::dot(row, unknowns);
            }
            column += width;
        }
        let mut work = vec![Complex64::default(); 2 * n];
        let (load, response) = work.split_at_mut(n);
        for k in 0..=self.harmonics {
            load.fill(Complex64::default());
            for slot in self.slots.iter().filter(|slot| slot.active) {
                for u in slot.first..slot.first + slot.count {
                    let f = complex(&force[u * nc..(u + 1) * nc], k);
                    load.iter_mut().zip(self.receptance.shape(u)).for_each(|(l, s)| *l -= f * s);
                }
            }
            let mut start = kept_start;
            let mut amplitudes = Vec::new();
            for kept in self.receptance.kept() {
                let step = if kept.harmonic == 0 { 1 } else { 2 };
                if kept.harmonic == k {
                    let imaginary = if k == 0 { 0.0 } else { -solution[start + 1] };
                    let q = Complex64::new(solution[start], imaginary);
                    if let Some(coupling) = self.receptance.coupling(k, kept.mode) {
                        load.iter_mut().zip(&coupling).for_each(|(l, c)| *l -= c * q * self.scales.modal);
                    }
                    amplitudes.push((kept.mode, q));
                }
                start += step;
            }
            self.receptance.inverse_times(k, load, response);
            response.iter_mut().for_each(|r| *r /= self.scales.modal);
            for (mode, q) in amplitudes {
                response[mode] = q;
            }
            scatter(response, nc, k, modal);
        }
        for (p, rate) in self.modal_rates.iter().enumerate() {
            crate::linalg::axpy(parameters[p] / self.scales.modal, rate, modal);
        }
        let mut series = vec![0.0; nc];
        for slot in self.slots.iter().filter(|slot| !slot.active) {
            for u in slot.first..slot.first + slot.count {
                let channel = self.channels[u];
                self.receptance.channel(u, modal, &mut series);
                let factor = channel.gain * self.scales.modal / channel.scale;
                for (a, x) in arguments[u * nc..(u + 1) * nc].iter_mut().zip(&series) {
                    *a = factor * x;
                }
            }
        }
    }
}
