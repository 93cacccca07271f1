//! Bordered Jacobian of the pressure form.

use super::PressureForm;
use super::layout::{Block, KeptAt, Pair, Unknowns};
use crate::formulation::harmonics::complex;
use crate::formulation::receptance::{RetainedMode, gather, scatter};
use crate::formulation::unknown::Parameter;
use crate::linalg::axpy;
use crate::structure::laws::MAX_ARGUMENTS;
use num_complex::Complex64;

/// Rows of a row-major matrix being filled.
pub(super) struct Target<'a> {
    pub data: &'a mut [f64],
    /// Columns of the matrix.
    pub size: usize,
    /// Number of the first row.
    pub first: usize,
}

impl Target<'_> {
    fn at(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.data[(row - self.first) * self.size + column]
    }

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
        let begin = (rows.a - self.first) * self.size + column;
        match (rows.b, source_b) {
            (Some(row_b), Some(source_b)) => {
                let offset = (row_b - self.first) * self.size + column;
                let (head, tail) = self.data.split_at_mut(offset);
                let (dest_a, dest_b) = (&mut head[begin..begin + width], &mut tail[..width]);
                let source_b = &source_b[..width];
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
        *self.at(rows.a, cols.a) += factor.re;
        if let Some(row_b) = rows.b {
            *self.at(row_b, cols.a) -= factor.im;
        }
        if let Some(col_b) = cols.b {
            *self.at(rows.a, col_b) += factor.im;
            if let Some(row_b) = rows.b {
                *self.at(row_b, col_b) += factor.re;
            }
        }
    }
}

/// Columns of a matrix being filled: those of the unknowns, or fewer ([`super::reduced`], [`super::compressed`]).
pub(super) struct Columns<'a> {
    /// Where blocks, kept amplitudes and parameters stand.
    pub unknowns: &'a Unknowns,
    /// Those of every block.
    pub blocks: Vec<BlockColumns<'a>>,
}

/// Columns of a block.
pub(super) struct BlockColumns<'a> {
    /// Derivatives of the forces with respect to them: channels · nc rows.
    pub jacobian: &'a [f64],
    /// For each force, how many of them it depends on.
    pub reach: [usize; MAX_ARGUMENTS],
}

/// Receptances between the channels of the active elements: a matrix (channels × channels) for every harmonic.
#[derive(Default)]
pub(super) struct Receptances {
    re: Vec<f64>,
    im: Vec<f64>,
    response: Vec<f64>,
}

impl Receptances {
    /// Real and imaginary part of every entry, matrix after matrix.
    pub fn parts(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.re.iter().copied().zip(self.im.iter().copied())
    }
}

impl PressureForm<'_> {
    /// Fills the bordered matrix of the state last evaluated.
    pub(super) fn assemble(&mut self, row: &[f64]) {
        let size = self.unknowns.len();
        debug_assert_eq!(size, self.residual.len() + 1);
        let mut lu = std::mem::take(&mut self.lu);
        let mut target = Target { data: lu.reset(size), size, first: 0 };
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
        let mut receptances = std::mem::take(&mut self.receptances);
        let mut rates = std::mem::take(&mut self.modal_rates);
        self.assemble_rows(target, &self.columns(), &mut receptances, &mut rates);
        (self.receptances, self.modal_rates) = (receptances, rates);
    }

    /// The unknowns as columns.
    pub(super) fn columns(&self) -> Columns<'_> {
        let blocks = self.unknowns.blocks.iter();
        let blocks = blocks.map(|block| self.block_columns(block, &self.forces[block.element].jacobian));
        Columns { unknowns: &self.unknowns, blocks: blocks.collect() }
    }

    /// Columns of a block that stand for its series one after the other.
    pub(super) fn block_columns<'a>(&self, block: &Block, jacobian: &'a [f64]) -> BlockColumns<'a> {
        let rank = jacobian.len() / (block.unknowns.len() * block.channels.len());
        BlockColumns { jacobian, reach: self.elements[block.element].reach.map(|reach| reach * rank) }
    }

    /// Adds the rows of the harmonic balance, but for the arguments themselves (δa in the rows of the arguments).
    pub(super) fn assemble_rows(
        &self,
        target: &mut Target<'_>,
        columns: &Columns<'_>,
        receptances: &mut Receptances,
        rates: &mut [Vec<f64>],
    ) {
        self.fill_receptances(receptances, false);
        self.assemble_kept(target, columns, rates);
        for block in &self.unknowns.blocks {
            self.assemble_block(target, columns, block, receptances, rates);
        }
    }

    /// Receptances between the channels of the active elements, by products of matrices or not.
    pub(super) fn fill_receptances(&self, receptances: &mut Receptances, by_products: bool) {
        let active: Vec<usize> = self.unknowns.channels().collect();
        let (square, count) = (active.len().pow(2), self.system.harmonics + 1);
        let Receptances { re, im, response } = receptances;
        re.resize(count * square, 0.0);
        im.resize(count * square, 0.0);
        let length = square.max(1);
        let parts = re.chunks_mut(length).zip(im.chunks_mut(length)).take(count).enumerate();
        if by_products {
            let modal = self.receptance.modal();
            let shapes: Vec<f64> = active.iter().flat_map(|u| modal.shape(*u)).copied().collect();
            parts.for_each(|(k, (re, im))| self.receptance.matrix_by_products(k, &shapes, response, re, im));
        } else {
            crate::linalg::vectorised(
                #[inline(always)]
                || {
                    parts.for_each(|(k, (re, im))| self.receptance.matrix(k, &active, response, re, im));
                },
            );
        }
    }

    /// Rows of the kept amplitudes, and the (scaled) rates of the modal amplitudes with every parameter.
    pub(super) fn assemble_kept(&self, target: &mut Target<'_>, columns: &Columns<'_>, rates: &mut [Vec<f64>]) {
        for row in &self.unknowns.kept {
            self.kept_row(target, columns, row);
        }
        for (p, (rate, &parameter)) in rates.iter_mut().zip(self.system.unknown.parameters()).enumerate() {
            self.kept_rates(target, columns.unknowns.parameters.start + p, parameter, rate);
            rate.iter_mut().for_each(|r| *r *= parameter.unit(&self.system.scales));
        }
    }

    /// Rows of the arguments of a block, but for the arguments themselves.
    pub(super) fn assemble_block(
        &self,
        target: &mut Target<'_>,
        columns: &Columns<'_>,
        block: &Block,
        receptances: &Receptances,
        rates: &[Vec<f64>],
    ) {
        crate::linalg::vectorised(
            #[inline(always)]
            || self.assemble_arguments(target, columns, block, receptances),
        );
        for kept in &columns.unknowns.kept {
            self.kept_column(target, block, kept);
        }
        for (p, (rate, &parameter)) in rates.iter().zip(self.system.unknown.parameters()).enumerate() {
            self.argument_rates(target, block, columns.unknowns.parameters.start + p, parameter, rate);
        }
    }

    /// −δ ∂f + s R ∂f, scaled, in the rows of a block.
    #[inline(always)]
    fn assemble_arguments(
        &self,
        target: &mut Target<'_>,
        columns: &Columns<'_>,
        rows: &Block,
        receptances: &Receptances,
    ) {
        let nc = self.layout.nc;
        let count = self.unknowns.arguments().len() / nc;
        for k in 0..=self.system.harmonics {
            let [re, im] = [&receptances.re, &receptances.im].map(|part| &part[k * count * count..]);
            let parts = Pair::of(k);
            let blocks = self.unknowns.blocks.iter().zip(&columns.unknowns.blocks);
            for ((block, narrow), own) in blocks.zip(&columns.blocks) {
                let width = narrow.unknowns.len();
                for (i, _, start) in block.arguments() {
                    let source = |part: usize| {
                        let begin = (i * nc + part) * width;
                        &own.jacobian[begin..begin + own.reach[i]]
                    };
                    let (source_a, source_b) = (source(parts.a), parts.b.map(source));
                    let v = start / nc;
                    for (_, u, row) in rows.arguments() {
                        let a = row / nc;
                        let channel = self.channels[u];
                        let gain = channel.gain / channel.scale;
                        let mut factor = Complex64::new(gain * re[a * count + v], gain * im[a * count + v]);
                        if a == v {
                            factor.re -= channel.feedback / channel.scale;
                        }
                        target.add_complex_row(parts.after(row), narrow.unknowns.start, factor, source_a, source_b);
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

    /// D̂_oo⁻¹ D̂_oκ of a kept amplitude, if the modes are coupled.
    fn kept_response(&self, kept: &RetainedMode) -> Option<Vec<Complex64>> {
        let column = self.receptance.coupling(kept.harmonic, kept.mode)?;
        let mut response = vec![Complex64::default(); self.layout.modes];
        self.receptance.inverse_times(kept.harmonic, &column, &mut response);
        Some(response)
    }

    /// Column of a kept modal amplitude in the rows of a block.
    fn kept_column(&self, target: &mut Target<'_>, block: &Block, column: &KeptAt) {
        let (response, parts) = (self.kept_response(&column.kept), Pair::of(column.kept.harmonic));
        for (_, u, start) in block.arguments() {
            let shape = self.kept_shape(u, column.kept.mode, response.as_deref());
            let channel = self.channels[u];
            let gain = -channel.gain / channel.scale * self.system.scales.modal;
            target.add_complex(parts.after(start), column.at, gain * shape);
        }
    }

    /// Row of a kept modal amplitude.
    fn kept_row(&self, target: &mut Target<'_>, columns: &Columns<'_>, row: &KeptAt) {
        let nc = self.layout.nc;
        let (k, mode) = (row.kept.harmonic, row.kept.mode);
        let (scale, parts) = (self.kept_scale(&row.kept), Pair::of(k));
        let response = self.kept_response(&row.kept);
        let blocks = self.unknowns.blocks.iter().zip(&columns.unknowns.blocks);
        for ((block, narrow), own) in blocks.zip(&columns.blocks) {
            let width = narrow.unknowns.len();
            for (i, u, _) in block.arguments() {
                let shape = self.kept_shape(u, mode, response.as_deref());
                let source = |part: usize| {
                    let begin = (i * nc + part) * width;
                    &own.jacobian[begin..begin + width]
                };
                let (source_a, source_b) = (source(parts.a), parts.b.map(source));
                target.add_complex_row(row.at, narrow.unknowns.start, shape / scale, source_a, source_b);
            }
        }
        for other in columns.unknowns.kept_at(k) {
            let mut entry = self.receptance.entry(k, mode, other.kept.mode);
            if let (Some(response), Some(column)) = (&response, self.receptance.coupling(k, other.kept.mode)) {
                entry -= response.iter().zip(&column).map(|(r, c)| r * c).sum::<Complex64>();
            }
            target.add_complex(row.at, other.at, entry * (self.system.scales.modal / scale));
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
                *target.at(at.a, column) = scaled.re;
                if let Some(b) = at.b {
                    *target.at(b, column) = -scaled.im;
                }
            }
        }
    }

    /// A parameter's column in the rows of a block, from the (scaled) rates of the modal amplitudes.
    fn argument_rates(
        &self,
        target: &mut Target<'_>,
        block: &Block,
        column: usize,
        parameter: Parameter,
        rate: &[f64],
    ) {
        let nc = self.layout.nc;
        let unit = parameter.unit(&self.system.scales);
        let mut series = vec![0.0; nc];
        let element = &self.forces[block.element];
        for (i, u, start) in block.arguments() {
            let channel = self.channels[u];
            self.receptance.modal().displacement(u, rate, &mut series);
            for (h, x) in series.iter().enumerate() {
                let explicit = if parameter == Parameter::Frequency { unit * element.domega[i * nc + h] } else { 0.0 };
                *target.at(start + h, column) = -(channel.gain * x + channel.feedback * explicit) / channel.scale;
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
}
