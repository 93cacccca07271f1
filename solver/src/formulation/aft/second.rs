//! Second derivatives of a law's force harmonics in one direction, weighed: what the gradients of the conditions of fold
//! and peak curves are made of.

use super::{Aft, Parts, Rate};
use crate::formulation::harmonics::width;
use crate::linalg::{self, axpy, dot};
use crate::settings::Quadrature;
use crate::structure::laws::{Before, Instant, Law, MAX_ARGUMENTS};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// What is differentiated, and in which direction. `c` arguments, nc = 2H + 1.
#[derive(Debug, Clone, Copy)]
pub struct Along<'a> {
    /// Weights of the force harmonics, c × nc.
    pub weights: &'a [f64],
    /// Direction of the argument harmonics, c × nc.
    pub arguments: &'a [f64],
    /// Direction of ω, rad/s.
    pub omega: f64,
}

/// The functions of a series and their slopes at one instant: 1, cos τ, sin τ, cos 2τ, …
#[derive(Debug, Clone, Default)]
pub(super) struct Basis {
    value: Vec<f64>,
    slope: Vec<f64>,
}

impl Basis {
    #[inline(always)]
    fn fill(&mut self, tau: f64) {
        self.value[0] = 1.0;
        self.slope[0] = 0.0;
        let rotation = Complex64::from_polar(1.0, tau);
        let mut e = rotation;
        for k in 1..=self.value.len() / 2 {
            let kf = k as f64;
            (self.value[2 * k - 1], self.value[2 * k]) = (e.re, e.im);
            (self.slope[2 * k - 1], self.slope[2 * k]) = (-kf * e.im, kf * e.re);
            e *= rotation;
        }
    }
}

/// Of a law at its arguments: what its second derivatives are summed from, instant by instant.
struct Bend<'a, L> {
    law: &'a L,
    arguments: &'a [f64],
    rate: Rate,
    along: Along<'a>,
    /// Weights of the force at an instant: harmonics above the mean are twice the mean of force × basis.
    weights: Vec<f64>,
}

impl<L: Law> Bend<'_, L> {
    /// State, its direction, the slopes of both and the weights of the forces at the instant of a basis.
    #[inline(always)]
    fn at(&self, basis: &Basis) -> (Instant, Instant, [[f64; MAX_ARGUMENTS]; 2], [f64; MAX_ARGUMENTS]) {
        let Rate { omega, harmonic } = self.rate;
        let mut now = Instant { speed: omega * harmonic, ..Instant::default() };
        let mut along = Instant { speed: self.along.omega * harmonic, ..Instant::default() };
        let (mut slopes, mut weights) = ([[0.0; MAX_ARGUMENTS]; 2], [0.0; MAX_ARGUMENTS]);
        let nc = basis.value.len();
        for j in 0..self.law.arguments() {
            let range = j * nc..(j + 1) * nc;
            let (u, v) = (&self.arguments[range.clone()], &self.along.arguments[range.clone()]);
            slopes[0][j] = dot(u, &basis.slope);
            slopes[1][j] = dot(v, &basis.slope);
            now.u[j] = dot(u, &basis.value);
            now.v[j] = omega * slopes[0][j];
            along.u[j] = dot(v, &basis.value);
            along.v[j] = omega * slopes[1][j] + self.along.omega * slopes[0][j];
            weights[j] = dot(&self.weights[range], &basis.value);
        }
        (now, along, slopes, weights)
    }

    /// Adds an instant's share; returns that of ω.
    #[inline(always)]
    fn add(&self, basis: &Basis, share: f64, row: &mut [f64]) -> f64 {
        let (c, nc) = (self.law.arguments(), basis.value.len());
        let (now, along, slopes, weights) = self.at(basis);
        let first = self.law.respond(&now, &Before::default());
        let second = self.law.respond_along(&now, &Before::default(), &along, &Before::default());
        let mut by_omega = 0.0;
        for j in 0..c {
            let (mut by_value, mut by_slope) = (0.0, 0.0);
            for (i, weight) in weights.iter().take(c).enumerate() {
                let weight = share * weight;
                by_value += weight * second.du[i][j];
                by_slope += weight * (self.rate.omega * second.dv[i][j] + self.along.omega * first.dv[i][j]);
                by_omega += weight * (second.dv[i][j] * slopes[0][j] + first.dv[i][j] * slopes[1][j]);
            }
            let row = &mut row[j * nc..(j + 1) * nc];
            axpy(by_value, &basis.value, row);
            axpy(by_slope, &basis.slope, row);
        }
        let turning: f64 = (0..c).map(|i| weights[i] * second.dspeed[i]).sum();
        by_omega + share * turning * self.rate.harmonic
    }

    /// Adds what the end of an arc contributes by moving: there the first derivative jumps.
    fn add_switch(&self, basis: &Basis, threshold: f64, row: &mut [f64]) {
        let (mut now, along, slopes, weights) = self.at(basis);
        // On the side on which the law acts.
        now.u[0] = threshold.next_up();
        let jump = self.law.respond_along(&now, &Before::default(), &along, &Before::default()).force;
        let weighed: f64 = weights.iter().zip(jump).map(|(w, f)| w * f).sum();
        let nc = basis.value.len();
        axpy(weighed / (TAU * slopes[0][0].abs()), &basis.value, &mut row[..nc]);
    }
}

impl Aft {
    /// Whether the force of `law` has second derivatives: not where samples tell when it acts, sticks or slides.
    pub fn has_second_derivatives<L: Law>(law: &L, quadrature: Quadrature) -> bool {
        quadrature == Quadrature::Arcs || (!law.has_memory() && law.threshold().is_none())
    }

    /// Second derivatives Σ weights · ∂²force\[along, ·\] of the force harmonics of `law` at `arguments` (c × nc): adds
    /// those by the arguments to `row` (c × nc) and returns the one by ω. They are those of the same quadrature as
    /// [`Aft::evaluate`]'s; on arcs the moving ends count: there the force is continuous, its first derivative not.
    pub fn second_derivative<L: Law>(
        &mut self,
        law: &L,
        arguments: &[f64],
        rate: Rate,
        along: Along<'_>,
        row: &mut [f64],
    ) -> f64 {
        let harmonics = self.harmonics();
        let nc = width(harmonics);
        let weights = along.weights.iter().enumerate().map(|(h, w)| if h % nc == 0 { *w } else { 2.0 * w }).collect();
        let bend = Bend { law, arguments, rate, along, weights };
        let parts = self.parts(law, &arguments[..nc], rate);
        let mut basis = std::mem::take(&mut self.basis);
        basis.value.resize(nc, 0.0);
        basis.slope.resize(nc, 0.0);
        let by_omega = match parts {
            Parts::None => 0.0,
            Parts::Samples => self.over_samples(&bend, &mut basis, row),
            Parts::Panels(panels) => self.over_arcs(&bend, &panels, &mut basis, row),
            Parts::Slider(slider) => {
                self.second_of_slider(slider, arguments, along, row);
                0.0
            }
            Parts::Arcs(arcs) => {
                let threshold = law.threshold().unwrap_or_default();
                for instant in arcs.iter().flat_map(|&(begin, end)| [begin, end]) {
                    basis.fill(instant);
                    bend.add_switch(&basis, threshold, row);
                }
                self.over_arcs(&bend, &arcs, &mut basis, row)
            }
        };
        self.basis = basis;
        by_omega
    }

    fn over_samples<L: Law>(&self, bend: &Bend<'_, L>, basis: &mut Basis, row: &mut [f64]) -> f64 {
        let samples = self.samples_of(bend.law);
        linalg::vectorised(
            #[inline(always)]
            || {
                let mut by_omega = 0.0;
                for n in 0..samples {
                    basis.fill(TAU * n as f64 / samples as f64);
                    by_omega += bend.add(basis, 1.0 / samples as f64, row);
                }
                by_omega
            },
        )
    }

    fn over_arcs<L: Law>(
        &mut self,
        bend: &Bend<'_, L>,
        arcs: &[(f64, f64)],
        basis: &mut Basis,
        row: &mut [f64],
    ) -> f64 {
        let mut by_omega = 0.0;
        for &(begin, end) in arcs {
            let (centre, half) = (0.5 * (begin + end), 0.5 * (end - begin));
            let points = super::gauss::points(self.harmonics(), half, bend.law);
            let rule = self.arcs.rule(points).clone();
            by_omega += linalg::vectorised(
                #[inline(always)]
                || {
                    let mut by_omega = 0.0;
                    for (node, weight) in rule.nodes.iter().zip(&rule.weights) {
                        basis.fill(centre + half * node);
                        by_omega += bend.add(basis, weight * half / TAU, row);
                    }
                    by_omega
                },
            );
        }
        by_omega
    }
}
