//! Laws at the Gauss points of arcs or panels of the period.

use super::{Aft, ElementForce, Rate, Target, scatter, signal, targets};
use crate::formulation::arcs::GaussLegendre;
use crate::formulation::harmonics::width;
use crate::linalg;
use crate::structure::laws::{Before, Instant, Law};
use num_complex::Complex64;

/// Rules by number of points, and buffers.
#[derive(Debug, Clone, Default)]
pub(super) struct ArcWork {
    rules: Vec<Option<GaussLegendre>>,
    /// cos lτ and sin lτ, l = 0 … 2H.
    cosines: Vec<f64>,
    sines: Vec<f64>,
    /// Fourier coefficients of every signal, targets × (2H + 1).
    real: Vec<f64>,
    imaginary: Vec<f64>,
}

/// Points of a rule on an arc of half-length `half` for a law of `arguments` arguments: a linear law's integrand has
/// harmonics up to 3H (second derivatives 4H, but those of a linear law vanish): half its phase over the arc, and a margin,
/// are enough. The direction of sliding v/|v| is no polynomial: twice as many. Nor is regularised friction, on panels that
/// keep their distance from its singularities: with four more its error is that of rounding.
pub(super) fn points<L: Law>(harmonics: usize, half: f64, law: &L) -> usize {
    let exact = (1.5 * harmonics as f64 * half).ceil() as usize + 8;
    match law.arguments() {
        1 if law.turnover().is_some() => exact + 4,
        1 => exact,
        _ => 2 * exact,
    }
}

impl ArcWork {
    pub(super) fn rule(&mut self, count: usize) -> &GaussLegendre {
        if self.rules.len() <= count {
            self.rules.resize(count + 1, None);
        }
        self.rules[count].get_or_insert_with(|| GaussLegendre::new(count))
    }

    #[inline(always)]
    fn fill_basis(&mut self, tau: f64) {
        let step = Complex64::from_polar(1.0, tau);
        let mut e = Complex64::new(1.0, 0.0);
        for (c, s) in self.cosines.iter_mut().zip(&mut self.sines) {
            (*c, *s) = (e.re, e.im);
            e *= step;
        }
    }

    /// Value and τ-derivative of a series at the instant of the basis.
    #[inline(always)]
    fn evaluate(&self, series: &[f64]) -> (f64, f64) {
        let (mut value, mut slope) = (series[0], 0.0);
        for k in 1..=series.len() / 2 {
            let (a, b, c, s) = (series[2 * k - 1], series[2 * k], self.cosines[k], self.sines[k]);
            value += a * c + b * s;
            slope += k as f64 * (b * c - a * s);
        }
        (value, slope)
    }
}

impl Aft {
    /// Forces and derivatives of a law on the parts of the period given.
    pub(super) fn evaluate_arcs<L: Law>(
        &mut self,
        law: &L,
        arguments: &[f64],
        arcs: &[(f64, f64)],
        rate: Rate,
        out: &mut ElementForce,
    ) {
        let (c, harmonics) = (law.arguments(), self.harmonics());
        let nc = width(harmonics);
        let (list, count) = targets(law);
        let list: &[Target] = &list[..count];
        let work = &mut self.arcs;
        for buffer in [&mut work.cosines, &mut work.sines] {
            buffer.resize(nc, 0.0);
        }
        for buffer in [&mut work.real, &mut work.imaginary] {
            buffer.clear();
            buffer.resize(count * nc, 0.0);
        }
        linalg::vectorised(
            #[inline(always)]
            || {
                for &(begin, end) in arcs {
                    let (centre, half) = (0.5 * (begin + end), 0.5 * (end - begin));
                    let rule = work.rule(points(harmonics, half, law)).clone();
                    for (node, weight) in rule.nodes.iter().zip(&rule.weights) {
                        work.fill_basis(centre + half * node);
                        let mut now = Instant { speed: rate.omega * rate.harmonic, ..Instant::default() };
                        for (j, series) in arguments.chunks(nc).enumerate() {
                            let (value, slope) = work.evaluate(series);
                            (now.u[j], now.v[j]) = (value, rate.omega * slope);
                        }
                        let r = law.respond(&now, &Before::default());
                        let weight = weight * half / std::f64::consts::TAU;
                        for (t, &target) in list.iter().enumerate() {
                            let value = weight * signal(target, &r, &now, c, rate);
                            linalg::axpy(value, &work.cosines, &mut work.real[t * nc..(t + 1) * nc]);
                            linalg::axpy(-value, &work.sines, &mut work.imaginary[t * nc..(t + 1) * nc]);
                        }
                    }
                }
            },
        );
        let mut spectrum = std::mem::take(&mut self.spectra[0]);
        for (t, &target) in list.iter().enumerate() {
            let parts = self.arcs.real[t * nc..].iter().zip(&self.arcs.imaginary[t * nc..]);
            spectrum.iter_mut().zip(parts).for_each(|(c, (&re, &im))| *c = Complex64::new(re, im));
            scatter(target, &spectrum, c, rate.omega, out);
        }
        self.spectra[0] = spectrum;
    }
}
