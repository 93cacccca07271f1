//! Dynamic stiffness and receptance in modal coordinates, with chosen poles kept apart.
//!
//! D̂_k(λ) = λ² I + λ Ĉ + Ω², λ_k = k(−ζ + iω): forced response with ζ = 0, damped nonlinear normal mode with E = 0
//! (paper [5, 22–24]). A channel u is a relative displacement bᵀx with modal shape b̂ = Φᵀb. Modes near a pole of
//! harmonic k are *kept*: their amplitudes stay unknowns and the receptance is that of the other modes,
//! x_u = Σ_κ t_uκ q_κ + b̂ᵀ D̂_oo⁻¹ g_o.

use crate::formulation::harmonics::{complex, set_complex};
use crate::formulation::modal::Modal;
use crate::formulation::state::Parameters;
use crate::linalg::{LinalgError, dot, multiply, multiply_transposed, solve_complex};
use crate::structure::{Damping, Model};
use num_complex::Complex64;
use std::sync::Arc;

/// A kept modal amplitude: mode `mode` at harmonic `harmonic`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RetainedMode {
    /// Harmonic k.
    pub harmonic: usize,
    /// Mode index, from 0.
    pub mode: usize,
}

/// D̂_oo⁻¹ of one harmonic, zero on the kept modes.
enum Inverse {
    Diagonal(Vec<Complex64>),
    Full(Vec<Complex64>),
}

/// Receptance of a model's channels for H harmonics at one point (ω, ζ).
pub struct Receptance {
    harmonics: usize,
    modes: usize,
    squares: Vec<f64>,
    damping: Damping,
    modal: Arc<Modal>,
    point: Parameters,
    kept: Vec<RetainedMode>,
    inverse: Vec<Inverse>,
}

impl Receptance {
    /// Receptance of `model` for the channels of `modal`, with or without its damping.
    pub fn new(model: &Model, harmonics: usize, modal: Arc<Modal>, damped: bool) -> Self {
        let modes = model.size();
        Self {
            harmonics,
            modes,
            squares: model.modes().frequencies.iter().map(|w| w * w).collect(),
            damping: if damped { model.damping().clone() } else { Damping::Modal(vec![0.0; modes]) },
            modal,
            point: Parameters { omega: 0.0, decay: 0.0, forcing: 0.0 },
            kept: Vec::new(),
            inverse: (0..=harmonics).map(|_| Inverse::Diagonal(vec![Complex64::default(); modes])).collect(),
        }
    }

    /// Forcing and channels.
    pub fn modal(&self) -> &Modal {
        &self.modal
    }

    /// The kept modal amplitudes.
    pub fn kept(&self) -> &[RetainedMode] {
        &self.kept
    }

    /// Modal amplitudes y = D̂_k⁻¹ `load` at a point, with no mode kept apart.
    ///
    /// # Errors
    /// At an undamped resonance of coupled modes.
    pub fn solve_all(
        &mut self,
        point: Parameters,
        k: usize,
        load: &[Complex64],
        y: &mut [Complex64],
    ) -> Result<(), LinalgError> {
        self.point = point;
        self.kept.clear();
        self.invert(k)?;
        self.inverse_times(k, load, y);
        Ok(())
    }

    /// Moves to another point, keeping the tracked mode at harmonic 1 and every amplitude within 2 % of a pole.
    ///
    /// # Errors
    /// At an undamped resonance of coupled modes that are not kept.
    pub fn update(&mut self, point: Parameters, tracked: usize) -> Result<(), LinalgError> {
        self.point = point;
        self.kept.clear();
        let reference = self.squares[tracked].sqrt();
        for k in 0..=self.harmonics {
            for j in 0..self.modes {
                let omega_j = self.squares[j].max(0.0).sqrt();
                let near = if k == 0 {
                    omega_j < 1e-6 * reference
                } else {
                    (k as f64 * point.omega - omega_j).abs() < 0.02 * omega_j
                };
                if near || (k == 1 && j == tracked) {
                    self.kept.push(RetainedMode { harmonic: k, mode: j });
                }
            }
            self.invert(k)?;
        }
        Ok(())
    }

    /// Modes kept at harmonic k.
    pub fn kept_at(&self, k: usize) -> impl Iterator<Item = usize> + '_ {
        self.kept.iter().filter(move |kept| kept.harmonic == k).map(|kept| kept.mode)
    }

    fn invert(&mut self, k: usize) -> Result<(), LinalgError> {
        let (n, lambda) = (self.modes, self.point.lambda(k));
        self.inverse[k] = match self.damping.uncoupled() {
            Some(c) => {
                let mut diagonal = match std::mem::replace(&mut self.inverse[k], Inverse::Diagonal(Vec::new())) {
                    Inverse::Diagonal(buffer) => buffer,
                    Inverse::Full(_) => vec![Complex64::default(); n],
                };
                for j in 0..n {
                    diagonal[j] = (lambda * (lambda + c[j]) + self.squares[j]).inv();
                }
                for kept in self.kept.iter().filter(|kept| kept.harmonic == k) {
                    diagonal[kept.mode] = Complex64::default();
                }
                Inverse::Diagonal(diagonal)
            }
            None => {
                let others: Vec<usize> = (0..n).filter(|&j| !self.kept_at(k).any(|kept| kept == j)).collect();
                let m = others.len();
                let mut d = vec![Complex64::default(); m * m];
                let mut identity = d.clone();
                for (a, &i) in others.iter().enumerate() {
                    for (b, &j) in others.iter().enumerate() {
                        d[a * m + b] = lambda * self.damping.entry(i, j);
                    }
                    d[a * m + a] += lambda * lambda + self.squares[i];
                    identity[a * m + a] = Complex64::new(1.0, 0.0);
                }
                if m > 0 {
                    solve_complex(&d, &mut identity, m, m)?;
                }
                let mut full = vec![Complex64::default(); n * n];
                for (a, &i) in others.iter().enumerate() {
                    for (b, &j) in others.iter().enumerate() {
                        full[i * n + j] = identity[a * m + b];
                    }
                }
                Inverse::Full(full)
            }
        };
        Ok(())
    }

    /// out = D̂_oo⁻¹ v at harmonic k, zero on the kept modes (the matrix is complex symmetric).
    pub fn inverse_times(&self, k: usize, v: &[Complex64], out: &mut [Complex64]) {
        match &self.inverse[k] {
            Inverse::Diagonal(d) => out.iter_mut().zip(d).zip(v).for_each(|((o, d), v)| *o = d * v),
            Inverse::Full(d) => {
                for (o, row) in out.iter_mut().zip(d.chunks(self.modes)) {
                    *o = row.iter().zip(v).map(|(d, v)| d * v).sum();
                }
            }
        }
    }

    /// (D̂ y)_j at harmonic k.
    pub fn stiffness_times(&self, k: usize, j: usize, y: &[Complex64]) -> Complex64 {
        let lambda = self.point.lambda(k);
        lambda * lambda * y[j] + lambda * self.damping.row_times(j, y) + self.squares[j] * y[j]
    }

    /// out = (∂D̂/∂λ) y = (2λ + Ĉ) y at harmonic k.
    pub fn rate_times(&self, k: usize, y: &[Complex64], out: &mut [Complex64]) {
        let twice = 2.0 * self.point.lambda(k);
        for j in 0..self.modes {
            out[j] = twice * y[j] + self.damping.row_times(j, y);
        }
    }

    /// Column D̂_oκ of the dynamic stiffness at harmonic k for a kept mode, zero on the kept modes; `None` if the modes
    /// are not coupled.
    pub fn coupling(&self, k: usize, mode: usize) -> Option<Vec<Complex64>> {
        if self.damping.uncoupled().is_some() {
            return None;
        }
        let lambda = self.point.lambda(k);
        let mut column: Vec<Complex64> = (0..self.modes).map(|i| lambda * self.damping.entry(i, mode)).collect();
        for kept in self.kept_at(k) {
            column[kept] = Complex64::default();
        }
        Some(column)
    }

    /// D̂_κκ' at harmonic k, before elimination of the other modes.
    pub fn entry(&self, k: usize, i: usize, j: usize) -> Complex64 {
        let lambda = self.point.lambda(k);
        let diagonal = if i == j { lambda * lambda + self.squares[i] } else { Complex64::default() };
        diagonal + lambda * self.damping.entry(i, j)
    }

    /// Receptances between the channels `channels` at harmonic k, into `re` and `im` (count × count, row-major).
    #[inline(always)]
    pub fn matrix(&self, k: usize, channels: &[usize], work: &mut Vec<f64>, re: &mut [f64], im: &mut [f64]) {
        let (n, count) = (self.modes, channels.len());
        work.clear();
        work.resize(2 * n, 0.0);
        let (response_re, response_im) = work.split_at_mut(n);
        for (b, &v) in channels.iter().enumerate() {
            match &self.inverse[k] {
                Inverse::Diagonal(d) => {
                    for (j, (d, s)) in d.iter().zip(self.modal.shape(v)).enumerate() {
                        (response_re[j], response_im[j]) = (s * d.re, s * d.im);
                    }
                }
                Inverse::Full(d) => {
                    for (i, row) in d.chunks(n).enumerate() {
                        let sum: Complex64 = row.iter().zip(self.modal.shape(v)).map(|(d, s)| d * s).sum();
                        (response_re[i], response_im[i]) = (sum.re, sum.im);
                    }
                }
            }
            for (a, &u) in channels.iter().enumerate().take(b + 1) {
                let sums = (dot(self.modal.shape(u), response_re), dot(self.modal.shape(u), response_im));
                for (i, j) in [(a, b), (b, a)] {
                    (re[i * count + j], im[i * count + j]) = sums;
                }
            }
        }
    }

    /// The same by products of matrices: faster for many channels, with other rounding errors. `shapes` are theirs
    /// (count × modes, row-major).
    pub fn matrix_by_products(&self, k: usize, shapes: &[f64], work: &mut Vec<f64>, re: &mut [f64], im: &mut [f64]) {
        let n = self.modes;
        work.clear();
        work.resize(shapes.len(), 0.0);
        for (part, out) in [(0, re), (1, im)] {
            let part = |d: &Complex64| if part == 0 { d.re } else { d.im };
            match &self.inverse[k] {
                Inverse::Diagonal(d) => {
                    for (row, shape) in work.chunks_mut(n).zip(shapes.chunks(n)) {
                        row.iter_mut().zip(shape).zip(d).for_each(|((r, s), d)| *r = s * part(d));
                    }
                }
                Inverse::Full(d) => {
                    let d: Vec<f64> = d.iter().map(part).collect();
                    multiply(shapes, &d, n, work);
                }
            }
            multiply_transposed(work, shapes, n, out);
        }
    }
}

/// Modal amplitudes Y_jk of one harmonic from modal series (modes × nc).
pub fn gather(modal: &[f64], nc: usize, k: usize, out: &mut [Complex64]) {
    for (y, series) in out.iter_mut().zip(modal.chunks(nc)) {
        *y = complex(series, k);
    }
}

/// Stores modal amplitudes Y_jk of one harmonic into modal series (modes × nc).
pub fn scatter(y: &[Complex64], nc: usize, k: usize, modal: &mut [f64]) {
    for (y, series) in y.iter().zip(modal.chunks_mut(nc)) {
        set_complex(series, k, *y);
    }
}
