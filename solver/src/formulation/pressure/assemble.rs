//! Bordered Jacobian of the pressure form.

use super::PressureForm;
use super::layout::{KeptAt, Pair, Unknowns};
use crate::formulation::harmonics::complex;
use crate::formulation::receptance::{gather, scatter};
use crate::formulation::unknown::Parameter;
use crate::linalg::{axpy, dot};
use num_complex::Complex64;

/// A row-major square matrix being filled.
pub(super) struct Target<'a> {
    pub data: &'a mut [f64],
    pub size: usize,
}

impl Target<'_> {
    /// Adds the complex row `factor` × (row_a − i row_b) to a pair of rows, columns from `column`.
    #[inline(always)]
    fn add_complex_row(
        &mut self,
        rows: Pair,
        column: usize,
        factor: Complex64,
        source_a: &[f64],
        source_b: Option<&[f64]>,
    ) {
        let width = source_a.len();
        let begin = rows.a * self.size + column;
        match (rows.b, source_b) {
            (Some(row_b), Some(source_b)) => {
                let offset = row_b * self.size + column;
                let (head, tail) = self.data.split_at_mut(offset);
                let (dest_a, dest_b) = (&mut head[begin..begin + width], &mut tail[..width]);
                for i in 0..width {
                    dest_a[i] += factor.re * source_a[i] + factor.im * source_b[i];
                    dest_b[i] += factor.re * source_b[i] - factor.im * source_a[i];
                }
            }
            _ => axpy(factor.re, source_a, &mut self.data[begin..begin + width]),
        }
    }

    /// Adds the 2 × 2 (or 1 × 1) real form of multiplication by `factor`.
    fn add_complex(&mut self, rows: Pair, cols: Pair, factor: Complex64) {
        self.data[rows.a * self.size + cols.a] += factor.re;
        if let Some(row_b) = rows.b {
            self.data[row_b * self.size + cols.a] -= factor.im;
        }
        if let Some(col_b) = cols.b {
            self.data[rows.a * self.size + col_b] += factor.im;
            if let Some(row_b) = rows.b {
                self.data[row_b * self.size + col_b] += factor.re;
            }
        }
    }
}

/// Columns of a matrix being filled: those of the unknowns, or fewer ([`super::reduced`]).
pub(super) struct Columns<'a> {
    /// Where blocks, kept amplitudes and parameters stand.
    pub unknowns: &'a Unknowns,
    /// Derivatives of the forces of every block with respect to its columns: channels · nc rows.
    pub jacobians: Vec<&'a [f64]>,
}

/// Buffers of receptances.
#[derive(Default)]
pub(super) struct Work {
    re: Vec<f64>,
    im: Vec<f64>,
    response: Vec<f64>,
}

impl PressureForm<'_> {
    /// Fills the bordered matrix of the state last evaluated.
    pub(super) fn assemble(&mut self, row: &[f64]) {
        let size = self.unknowns.len();
        debug_assert_eq!(size, self.residual.len() + 1);
        let mut lu = std::mem::take(&mut self.lu);
        let mut target = Target { data: lu.reset(size), size };
        if let Some(condition) = self.condition.take() {
            let gradient = self.condition_gradient(&condition);
            let (equations, rest) = target.data.split_at_mut((size - 2) * size);
            equations.copy_from_slice(condition.equations());
            self.assemble_form(&mut rest[..size], &gradient);
            self.condition = Some(condition);
        } else {
            self.assemble_equations(&mut target);
        }
        if let Some(phase) = &self.phase {
            self.assemble_form(&mut target.data[(size - 2) * size..(size - 1) * size], phase);
        }
        self.assemble_form(&mut target.data[(size - 1) * size..], row);
        self.lu = lu;
    }

    /// Fills the rows of the harmonic balance.
    pub(super) fn assemble_equations(&mut self, target: &mut Target<'_>) {
        for i in self.unknowns.arguments() {
            target.data[i * target.size + i] = 1.0;
        }
        let (mut work, mut rates) = (std::mem::take(&mut self.assembly), std::mem::take(&mut self.modal_rates));
        self.assemble_rows(target, &self.columns(), &mut work, &mut rates);
        (self.assembly, self.modal_rates) = (work, rates);
    }

    /// The unknowns as columns.
    fn columns(&self) -> Columns<'_> {
        let blocks = self.unknowns.blocks.iter();
        let jacobians = blocks.map(|block| self.forces[block.element].jacobian.as_slice()).collect();
        Columns { unknowns: &self.unknowns, jacobians }
    }

    /// Adds the rows of the harmonic balance, but for the arguments themselves (δa in the rows of the arguments).
    pub(super) fn assemble_rows(
        &self,
        target: &mut Target<'_>,
        columns: &Columns<'_>,
        work: &mut Work,
        rates: &mut [Vec<f64>],
    ) {
        crate::linalg::vectorised(|| self.assemble_arguments(target, columns, work));
        for (row, column) in self.unknowns.kept.iter().zip(&columns.unknowns.kept) {
            self.assemble_kept(target, columns, row, column.at);
        }
        self.assemble_parameters(target, columns.unknowns.parameters.start, rates);
    }

    /// −δ ∂f + s R ∂f, scaled.
    #[inline(always)]
    fn assemble_arguments(&self, target: &mut Target<'_>, columns: &Columns<'_>, work: &mut Work) {
        let nc = self.layout.nc;
        let active: Vec<usize> = self.unknowns.channels().collect();
        let count = active.len();
        work.re.resize(count * count, 0.0);
        work.im.resize(count * count, 0.0);
        for k in 0..=self.system.harmonics {
            self.receptance.matrix(k, &active, &mut work.response, &mut work.re, &mut work.im);
            let rows = Pair::of(k);
            let blocks = self.unknowns.blocks.iter().zip(&columns.unknowns.blocks);
            for ((block, narrow), jacobian) in blocks.zip(&columns.jacobians) {
                let (bound, width) = (&self.elements[block.element], narrow.unknowns.len());
                for (i, _, start) in block.arguments() {
                    // Force i does not depend on the arguments from `reach` on.
                    let reach = bound.reach[i] * (width / block.channels.len());
                    let source = |part: usize| {
                        let begin = (i * nc + part) * width;
                        &jacobian[begin..begin + reach]
                    };
                    let (source_a, source_b) = (source(rows.a), rows.b.map(source));
                    let v = start / nc;
                    for (a, &u) in active.iter().enumerate() {
                        let channel = self.channels[u];
                        let gain = channel.gain / channel.scale;
                        let mut factor = Complex64::new(gain * work.re[a * count + v], gain * work.im[a * count + v]);
                        if a == v {
                            factor.re -= channel.feedback / channel.scale;
                        }
                        target.add_complex_row(rows.after(a * nc), narrow.unknowns.start, factor, source_a, source_b);
                    }
                }
            }
        }
    }

    /// Shape t_uκ of channel `u` for a kept amplitude and the correction D̂_oo⁻¹ D̂_oκ of the other modes.
    fn kept_shape(&self, u: usize, mode: usize, response: Option<&[Complex64]>) -> Complex64 {
        let shape = self.receptance.modal().shape(u);
        let own = Complex64::new(shape[mode], 0.0);
        match response {
            None => own,
            Some(response) => own - shape.iter().zip(response).map(|(s, r)| r * *s).sum::<Complex64>(),
        }
    }

    /// Column and row of a kept modal amplitude.
    fn assemble_kept(&self, target: &mut Target<'_>, columns: &Columns<'_>, kept: &KeptAt, column_at: Pair) {
        let nc = self.layout.nc;
        let (k, mode) = (kept.kept.harmonic, kept.kept.mode);
        let (scale, parts) = (self.kept_scale(&kept.kept), Pair::of(k));
        let response = self.receptance.coupling(k, mode).map(|column| {
            let mut response = vec![Complex64::default(); self.layout.modes];
            self.receptance.inverse_times(k, &column, &mut response);
            response
        });
        let blocks = self.unknowns.blocks.iter().zip(&columns.unknowns.blocks);
        for ((block, narrow), jacobian) in blocks.zip(&columns.jacobians) {
            let width = narrow.unknowns.len();
            for (i, u, start) in block.arguments() {
                let shape = self.kept_shape(u, mode, response.as_deref());
                let channel = self.channels[u];
                let gain = -channel.gain / channel.scale * self.system.scales.modal;
                target.add_complex(parts.after(start), column_at, gain * shape);
                let source = |part: usize| {
                    let begin = (i * nc + part) * width;
                    &jacobian[begin..begin + width]
                };
                let (source_a, source_b) = (source(parts.a), parts.b.map(source));
                target.add_complex_row(kept.at, narrow.unknowns.start, shape / scale, source_a, source_b);
            }
        }
        for other in columns.unknowns.kept_at(k) {
            let mut entry = self.receptance.entry(k, mode, other.kept.mode);
            if let (Some(response), Some(column)) = (&response, self.receptance.coupling(k, other.kept.mode)) {
                entry -= response.iter().zip(&column).map(|(r, c)| r * c).sum::<Complex64>();
            }
            target.add_complex(kept.at, other.at, entry * (self.system.scales.modal / scale));
        }
    }

    /// Columns of the parameters, from `first` on; also the rates of the dependent modal amplitudes.
    fn assemble_parameters(&self, target: &mut Target<'_>, first: usize, rates: &mut [Vec<f64>]) {
        for (p, (rate, &parameter)) in rates.iter_mut().zip(self.system.unknown.parameters()).enumerate() {
            let column = first + p;
            self.kept_rates(target, column, parameter, rate);
            rate.iter_mut().for_each(|r| *r *= parameter.unit(&self.system.scales));
            self.argument_rates(target, column, parameter, rate);
        }
    }

    /// A parameter's column in the rows of the kept amplitudes; `rate`: derivatives of the others.
    fn kept_rates(&self, target: &mut Target<'_>, column: usize, parameter: Parameter, rate: &mut [f64]) {
        let (nc, n) = (self.layout.nc, self.layout.modes);
        let mut buffer = vec![Complex64::default(); 4 * n];
        let (y, rest) = buffer.split_at_mut(n);
        let (moved, rest) = rest.split_at_mut(n);
        let (load, response) = rest.split_at_mut(n);
        let modal = self.receptance.modal();
        for k in 0..=self.system.harmonics {
            // `moved` = (∂D/∂p) Y, `load` = ∂(E − F)/∂p.
            gather(&self.current.modal, nc, k, y);
            moved.fill(Complex64::default());
            load.fill(Complex64::default());
            if parameter != Parameter::Forcing {
                self.receptance.rate_times(k, y, moved);
                moved.iter_mut().for_each(|m| *m *= parameter.rate(k));
            } else if k == modal.harmonic() {
                load.iter_mut().zip(modal.forcing()).for_each(|(l, &s)| *l = s.into());
            }
            if parameter == Parameter::Frequency {
                self.add_explicit_force_rates(k, load);
            }
            for j in 0..n {
                y[j] = load[j] - moved[j];
            }
            self.receptance.inverse_times(k, y, response);
            scatter(response, nc, k, rate);
            for KeptAt { kept, at } in self.unknowns.kept_at(k) {
                let balance =
                    moved[kept.mode] - load[kept.mode] + self.receptance.stiffness_times(k, kept.mode, response);
                let scaled = balance * (parameter.unit(&self.system.scales) / self.kept_scale(kept));
                target.data[at.a * target.size + column] = scaled.re;
                if let Some(b) = at.b {
                    target.data[b * target.size + column] = -scaled.im;
                }
            }
        }
    }

    /// A parameter's column in the rows of the arguments, from the (scaled) rates of the modal amplitudes.
    fn argument_rates(&self, target: &mut Target<'_>, column: usize, parameter: Parameter, rate: &[f64]) {
        let nc = self.layout.nc;
        let unit = parameter.unit(&self.system.scales);
        let mut series = vec![0.0; nc];
        for block in &self.unknowns.blocks {
            let element = &self.forces[block.element];
            for (i, u, start) in block.arguments() {
                let channel = self.channels[u];
                self.receptance.modal().displacement(u, rate, &mut series);
                for (h, x) in series.iter().enumerate() {
                    let explicit =
                        if parameter == Parameter::Frequency { unit * element.domega[i * nc + h] } else { 0.0 };
                    target.data[(start + h) * target.size + column] =
                        -(channel.gain * x + channel.feedback * explicit) / channel.scale;
                }
            }
        }
    }

    /// Subtracts b̂ ∂f/∂ω (at fixed arguments) of harmonic k.
    fn add_explicit_force_rates(&self, k: usize, load: &mut [Complex64]) {
        for block in &self.unknowns.blocks {
            let rates = self.forces[block.element].domega.chunks(self.layout.nc);
            for (u, series) in block.channels.clone().zip(rates) {
                let rate = complex(series, k);
                load.iter_mut().zip(self.receptance.modal().shape(u)).for_each(|(l, s)| *l -= rate * s);
            }
        }
    }

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
        for (narrow, jacobian) in columns.unknowns.blocks.iter().zip(&columns.jacobians) {
            let border = &mut border[narrow.unknowns.clone()];
            let rows = jacobian.chunks(border.len());
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
