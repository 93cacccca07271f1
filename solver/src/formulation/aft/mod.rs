//! Alternating frequency–time: from the harmonics of a law's arguments to those of its forces, with the exact Jacobian.
//!
//! Laws are evaluated on a uniform grid, polynomials on one that is just fine enough for them, and transformed by FFT. By default
//! those that switch are integrated between their switches instead: unilateral laws at the Gauss points of the arcs on which they act
//! ([`crate::formulation::arcs`]), regularised friction at those of `panels.rs`, sliders by their phases (`slider.rs`).

mod gauss;
mod hysteresis;
#[cfg(test)]
mod limit_tests;
mod samples;
mod second;
mod shape;

use crate::formulation::arcs::{Coverage, positive_arcs};
use crate::formulation::harmonics::{
    self, Transform, add_product_matrix, differentiate, series_from_coefficients, width,
};
use crate::formulation::panels::{is_sampled_well, panels};
use crate::settings::{HarmonicSettings, Quadrature};
use crate::structure::laws::{Instant, Law, MAX_ARGUMENTS, Response, Slider};
use gauss::ArcWork;
use num_complex::Complex64;
pub use second::Along;
use second::Basis;
use shape::Shape;

/// Harmonics of an element's forces and their derivatives. `c` arguments, nc = 2H + 1.
#[derive(Debug, Clone, Default)]
pub struct ElementForce {
    /// Forces, c × nc.
    pub force: Vec<f64>,
    /// ∂force/∂arguments, (c·nc)², row-major.
    pub jacobian: Vec<f64>,
    /// ∂force/∂ω at fixed argument harmonics, c × nc.
    pub domega: Vec<f64>,
    /// The arcs outside of which there is neither force nor derivative, as phases ωt; none if it acts all the period.
    pub arcs: Vec<(f64, f64)>,
}

/// Frequency and rotor speed of an evaluation.
#[derive(Debug, Clone, Copy)]
pub struct Rate {
    /// Response frequency ω, rad/s.
    pub omega: f64,
    /// Forcing harmonic m: the rotor turns at m ω.
    pub harmonic: f64,
}

/// Work space for the alternating frequency–time method.
pub struct Aft {
    /// Grids on which laws are sampled: the one that was set, and coarser ones for polynomials.
    grids: Vec<Transform>,
    /// A grid just fine enough to find arcs and maxima, which are then refined.
    search: Transform,
    u: [Vec<f64>; MAX_ARGUMENTS],
    v: [Vec<f64>; MAX_ARGUMENTS],
    scratch: Vec<f64>,
    slope: [Vec<f64>; 2],
    signals: Vec<Vec<f64>>,
    spectra: [Vec<Complex64>; 2],
    quadrature: Quadrature,
    arcs: ArcWork,
    basis: Basis,
}

/// What the forces of a law are summed over.
enum Parts {
    /// It does not act.
    None,
    /// The arcs on which it acts.
    Arcs(Vec<(f64, f64)>),
    /// Parts of the whole period on each of which it is smooth.
    Panels(Vec<(f64, f64)>),
    /// The phases of a slider.
    Slider(Slider),
    /// A uniform grid.
    Samples,
}

/// What a sampled signal of the law stands for in the frequency domain.
#[derive(Debug, Clone, Copy)]
enum Target {
    Force(usize),
    Displacement(usize, usize),
    Velocity(usize, usize),
    Omega(usize),
}

impl Aft {
    /// Work space for a truncation.
    pub fn new(truncation: HarmonicSettings) -> Self {
        let HarmonicSettings { count: harmonics, samples, quadrature } = truncation;
        let empty = || vec![0.0; samples];
        Self {
            grids: vec![Transform::new(harmonics, samples)],
            search: Transform::new(harmonics, (8 * harmonics).next_power_of_two().max(64)),
            u: std::array::from_fn(|_| empty()),
            v: std::array::from_fn(|_| empty()),
            scratch: Vec::new(),
            slope: std::array::from_fn(|_| vec![0.0; width(harmonics)]),
            signals: Vec::new(),
            spectra: std::array::from_fn(|_| vec![Complex64::default(); width(harmonics)]),
            quadrature,
            arcs: ArcWork::default(),
            basis: Basis::default(),
        }
    }

    /// Where on the period a series exceeds `threshold`, to rounding.
    pub fn coverage(&mut self, series: &[f64], threshold: f64) -> Coverage {
        let count = self.search.samples();
        self.scratch.resize(2 * count, 0.0);
        let (values, unused) = self.scratch.split_at_mut(count);
        self.search.synthesise(series, None, values, unused);
        positive_arcs(series, threshold, values)
    }

    /// Whether a predicted pressure is positive anywhere, as the quadrature sees it.
    pub fn touches(&mut self, pressure: &[f64]) -> bool {
        match self.quadrature {
            Quadrature::Arcs => self.coverage(pressure, 0.0) != Coverage::Never,
            Quadrature::Samples => {
                self.grids[0].synthesise(pressure, None, &mut self.u[0], &mut self.v[0]);
                self.u[0].iter().any(|&p| p > 0.0)
            }
        }
    }

    /// Maximum of |x| over a period of a series, between samples too.
    pub fn max_abs(&mut self, series: &[f64]) -> f64 {
        harmonics::max_abs(series, &mut self.search)
    }

    /// Forces of `law` for `arguments` (c × nc) and their derivatives, into `out`.
    pub fn evaluate<L: Law>(&mut self, law: &L, arguments: &[f64], rate: Rate, out: &mut ElementForce) {
        let (c, nc) = (law.arguments(), width(self.harmonics()));
        out.force.clear();
        out.force.resize(c * nc, 0.0);
        out.domega.clear();
        out.domega.resize(c * nc, 0.0);
        out.jacobian.clear();
        out.jacobian.resize(c * nc * c * nc, 0.0);
        out.arcs.clear();
        match self.parts(law, &arguments[..nc], rate) {
            Parts::None => return,
            Parts::Arcs(arcs) => {
                self.evaluate_arcs(law, arguments, &arcs, rate, out);
                out.arcs = arcs;
            }
            Parts::Panels(panels) => self.evaluate_arcs(law, arguments, &panels, rate, out),
            Parts::Slider(slider) => self.evaluate_slider(slider, arguments, out),
            Parts::Samples => {
                let grid = self.grid_of(law);
                self.sample_arguments(law, arguments, rate.omega, grid);
                if law.has_memory() {
                    self.evaluate_with_memory(law, rate, grid, out);
                } else {
                    self.evaluate_samples(law, rate, grid, out);
                }
            }
        }
        Shape::of(arguments, nc, law.is_odd()).impose(out, nc);
    }

    fn harmonics(&self) -> usize {
        self.search.harmonics()
    }

    /// The grid on which a law is sampled.
    fn grid_of<L: Law>(&mut self, law: &L) -> usize {
        let (samples, harmonics) = (self.samples_of(law), self.harmonics());
        self.grids.iter().position(|grid| grid.samples() == samples).unwrap_or_else(|| {
            self.grids.push(Transform::new(harmonics, samples));
            self.grids.len() - 1
        })
    }

    /// How many samples of the period a law is evaluated at: as many as were set, or fewer that are exact as well. Of a polynomial of
    /// degree p the force has p H harmonics and its derivatives, of which 2H are needed, have (p − 1)H: with more than (p + 1)H
    /// samples none of the others is taken for one that is needed, and with twice as many rounding averages out better.
    fn samples_of<L: Law>(&self, law: &L) -> usize {
        let (set, harmonics) = (self.grids[0].samples(), self.harmonics());
        let enough = |degree: usize| 2 * ((degree + 1) * harmonics + 1).next_power_of_two();
        law.degree().map_or(set, |degree| enough(degree as usize).min(set))
    }

    /// What the forces of a law are summed over; `argument` is its first one.
    fn parts<L: Law>(&mut self, law: &L, argument: &[f64], rate: Rate) -> Parts {
        if self.quadrature == Quadrature::Samples {
            return Parts::Samples;
        }
        if let Some(threshold) = law.threshold() {
            match self.coverage(argument, threshold) {
                Coverage::Never => Parts::None,
                Coverage::Arcs(arcs) => Parts::Arcs(arcs),
                // A force that never vanishes is smooth: samples converge as fast as anything.
                Coverage::Always => Parts::Samples,
            }
        } else if let Some(velocity) = law.turnover() {
            differentiate(argument, &mut self.slope[0]);
            let (slope, width) = (&self.slope[0], velocity / rate.omega);
            let is_gentle = is_sampled_well(slope, width, self.grids[0].samples());
            if is_gentle { Parts::Samples } else { Parts::Panels(panels(slope, width)) }
        } else if let Some(slider) = law.slider() {
            Parts::Slider(slider)
        } else {
            Parts::Samples
        }
    }

    /// Fills `u` and `v` with the samples the law needs.
    fn sample_arguments<L: Law>(&mut self, law: &L, arguments: &[f64], omega: f64, grid: usize) {
        let nc = width(self.harmonics());
        let pattern = law.pattern();
        for j in 0..law.arguments() {
            let series = &arguments[j * nc..(j + 1) * nc];
            let velocity = pattern.dv.iter().any(|row| row[j]);
            if velocity {
                differentiate(series, &mut self.slope[0]);
                self.slope[0].iter_mut().for_each(|x| *x *= omega);
            }
            let slope = velocity.then_some(self.slope[0].as_slice());
            self.grids[grid].synthesise(series, slope, &mut self.u[j], &mut self.v[j]);
        }
    }

    fn instant(&self, n: usize, speed: f64) -> Instant {
        Instant { u: std::array::from_fn(|j| self.u[j][n]), v: std::array::from_fn(|j| self.v[j][n]), speed }
    }
}

/// ∂force_i/∂ω at fixed harmonics: velocities are proportional to ω, the rotor speed is m ω.
fn explicit_omega(r: &Response, now: &Instant, i: usize, arguments: usize, rate: Rate) -> f64 {
    let velocities: f64 = (0..arguments).map(|j| r.dv[i][j] * now.v[j]).sum();
    velocities / rate.omega + r.dspeed[i] * rate.harmonic
}

const MAX_TARGETS: usize = MAX_ARGUMENTS * (2 + 2 * MAX_ARGUMENTS);

/// The signals that a law produces, from its pattern.
fn targets<L: Law>(law: &L) -> ([Target; MAX_TARGETS], usize) {
    let (pattern, c) = (law.pattern(), law.arguments());
    let mut list = [Target::Force(0); MAX_TARGETS];
    let mut count = 0;
    let mut push = |target| {
        list[count] = target;
        count += 1;
    };
    for i in 0..c {
        push(Target::Force(i));
        for j in 0..c {
            if pattern.du[i][j] {
                push(Target::Displacement(i, j));
            }
            if pattern.dv[i][j] {
                push(Target::Velocity(i, j));
            }
        }
        if pattern.dv[i].contains(&true) && !law.is_homogeneous_in_rate() {
            push(Target::Omega(i));
        }
    }
    (list, count)
}

fn scatter(target: Target, spectrum: &[Complex64], c: usize, omega: f64, out: &mut ElementForce) {
    let nc = spectrum.len();
    let stride = c * nc;
    match target {
        Target::Force(i) => series_from_coefficients(spectrum, &mut out.force[i * nc..(i + 1) * nc]),
        Target::Omega(i) => series_from_coefficients(spectrum, &mut out.domega[i * nc..(i + 1) * nc]),
        Target::Displacement(i, j) => {
            add_product_matrix(spectrum, None, &mut out.jacobian[i * nc * stride + j * nc..], stride);
        }
        Target::Velocity(i, j) => {
            add_product_matrix(spectrum, Some(omega), &mut out.jacobian[i * nc * stride + j * nc..], stride);
        }
    }
}

/// The signal of a target at one instant.
#[inline(always)]
fn signal(target: Target, r: &Response, now: &Instant, arguments: usize, rate: Rate) -> f64 {
    match target {
        Target::Force(i) => r.force[i],
        Target::Displacement(i, j) => r.du[i][j],
        Target::Velocity(i, j) => r.dv[i][j],
        Target::Omega(i) => explicit_omega(r, now, i, arguments, rate),
    }
}
