//! Alternating frequency–time: from the harmonics of a law's arguments to those of its forces, with the exact Jacobian.

use crate::harmonics::{self, Transform, add_product_matrix, differentiate, series_from_coefficients, width};
use crate::laws::{Before, Instant, Law, MAX_ARGUMENTS, Response};
use rustfft::num_complex::Complex64;

/// Harmonics of an element's forces and their derivatives. `c` arguments, nc = 2H + 1.
#[derive(Debug, Clone, Default)]
pub struct ElementForce {
    /// Forces, c × nc.
    pub force: Vec<f64>,
    /// ∂force/∂arguments, (c·nc)², row-major.
    pub jacobian: Vec<f64>,
    /// ∂force/∂ω at fixed argument harmonics, c × nc.
    pub domega: Vec<f64>,
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
    transform: Transform,
    u: [Vec<f64>; MAX_ARGUMENTS],
    v: [Vec<f64>; MAX_ARGUMENTS],
    unused: Vec<f64>,
    slope: [Vec<f64>; 2],
    signals: Vec<Vec<f64>>,
    spectra: [Vec<Complex64>; 2],
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
    /// Work space for `harmonics` harmonics and `samples` instants a period.
    pub fn new(harmonics: usize, samples: usize) -> Self {
        let empty = || vec![0.0; samples];
        Self {
            transform: Transform::new(harmonics, samples),
            u: std::array::from_fn(|_| empty()),
            v: std::array::from_fn(|_| empty()),
            unused: empty(),
            slope: std::array::from_fn(|_| vec![0.0; width(harmonics)]),
            signals: Vec::new(),
            spectra: std::array::from_fn(|_| vec![Complex64::default(); width(harmonics)]),
        }
    }

    /// The frequency–time transform.
    pub fn transform(&mut self) -> &mut Transform {
        &mut self.transform
    }

    /// Largest sample of a series: decides whether a contact node touches.
    pub fn max_sample(&mut self, series: &[f64]) -> f64 {
        self.transform.synthesise(series, None, &mut self.u[0], &mut self.unused);
        self.u[0].iter().fold(f64::NEG_INFINITY, |m, &v| m.max(v))
    }

    /// Largest samples of two series at once.
    pub fn max_samples(&mut self, a: &[f64], b: &[f64]) -> [f64; 2] {
        self.transform.synthesise(a, Some(b), &mut self.u[0], &mut self.unused);
        [&self.u[0], &self.unused].map(|s| s.iter().fold(f64::NEG_INFINITY, |m, &v| m.max(v)))
    }

    /// Share of the period during which a series is positive.
    pub fn positive_fraction(&mut self, series: &[f64]) -> f64 {
        self.transform.synthesise(series, None, &mut self.u[0], &mut self.unused);
        self.u[0].iter().filter(|&&v| v > 0.0).count() as f64 / self.transform.samples() as f64
    }

    /// Forces of `law` for `arguments` (c × nc) and their derivatives, into `out`.
    pub fn evaluate<L: Law>(&mut self, law: &L, arguments: &[f64], rate: Rate, out: &mut ElementForce) {
        let (c, nc) = (law.arguments(), width(self.transform.harmonics()));
        out.force.clear();
        out.force.resize(c * nc, 0.0);
        out.domega.clear();
        out.domega.resize(c * nc, 0.0);
        out.jacobian.clear();
        out.jacobian.resize(c * nc * c * nc, 0.0);
        self.sample_arguments(law, arguments, rate.omega);
        if law.has_memory() {
            self.evaluate_with_memory(law, rate, out);
        } else {
            self.evaluate_memoryless(law, rate, out);
        }
    }

    /// Fills `u` and `v` with the samples the law needs.
    fn sample_arguments<L: Law>(&mut self, law: &L, arguments: &[f64], omega: f64) {
        let nc = width(self.transform.harmonics());
        let pattern = law.pattern();
        for j in 0..law.arguments() {
            let series = &arguments[j * nc..(j + 1) * nc];
            let velocity = pattern.dv.iter().any(|row| row[j]);
            if velocity {
                differentiate(series, &mut self.slope[0]);
                self.slope[0].iter_mut().for_each(|x| *x *= omega);
            }
            let slope = velocity.then_some(self.slope[0].as_slice());
            self.transform.synthesise(series, slope, &mut self.u[j], &mut self.v[j]);
        }
    }

    fn instant(&self, n: usize, speed: f64) -> Instant {
        Instant { u: std::array::from_fn(|j| self.u[j][n]), v: std::array::from_fn(|j| self.v[j][n]), speed }
    }

    fn evaluate_memoryless<L: Law>(&mut self, law: &L, rate: Rate, out: &mut ElementForce) {
        let (c, samples) = (law.arguments(), self.transform.samples());
        let (targets, count) = targets(law);
        let targets = &targets[..count];
        while self.signals.len() < targets.len() + 1 {
            self.signals.push(vec![0.0; samples]);
        }
        let mut signals = std::mem::take(&mut self.signals);
        for n in 0..samples {
            let now = self.instant(n, rate.omega * rate.harmonic);
            let r = law.respond(&now, &Before::default());
            for (signal, &target) in signals.iter_mut().zip(targets) {
                signal[n] = match target {
                    Target::Force(i) => r.force[i],
                    Target::Displacement(i, j) => r.du[i][j],
                    Target::Velocity(i, j) => r.dv[i][j],
                    Target::Omega(i) => explicit_omega(&r, &now, i, c, rate),
                };
            }
        }
        for (pair, target) in signals.chunks(2).zip(targets.chunks(2)) {
            let second = pair.get(1).unwrap_or(&pair[0]);
            let [first_spectrum, second_spectrum] = &mut self.spectra;
            self.transform.analyse(&pair[0], second, first_spectrum, second_spectrum);
            for (&target, spectrum) in target.iter().zip(&self.spectra) {
                scatter(target, spectrum, c, rate.omega, out);
            }
        }
        self.signals = signals;
    }

    /// Laws with memory: two passes round the period (the first one forgets the start), with the derivatives of the
    /// force at each instant carried along as rows over the argument's harmonics.
    fn evaluate_with_memory<L: Law>(&mut self, law: &L, rate: Rate, out: &mut ElementForce) {
        debug_assert_eq!(law.arguments(), 1);
        let (samples, nc) = (self.transform.samples(), width(self.transform.harmonics()));
        let step = std::f64::consts::TAU / samples as f64;
        let mut basis = vec![0.0; nc];
        let mut basis_before = vec![0.0; nc];
        let mut row = vec![0.0; nc];
        // A virgin element: no force at zero displacement, so that one that never slides is a plain spring.
        let mut before = Before::default();
        for n in 0..2 * samples {
            let (last_pass, n) = (n >= samples, n % samples);
            let now = self.instant(n, rate.omega * rate.harmonic);
            let r = law.respond(&now, &before);
            fill_basis(n as f64 * step, &mut basis);
            for i in 0..nc {
                row[i] = r.du[0][0] * basis[i] + r.du_before * basis_before[i] + r.dforce_before * row[i];
            }
            if last_pass {
                for (k, &b) in basis.iter().enumerate() {
                    let weight = b * if k == 0 { 1.0 } else { 2.0 } / samples as f64;
                    out.force[k] += weight * r.force[0];
                    crate::linalg::axpy(weight, &row, &mut out.jacobian[k * nc..(k + 1) * nc]);
                }
            }
            before = Before { u: now.u[0], force: r.force[0] };
            std::mem::swap(&mut basis, &mut basis_before);
        }
    }
}

/// Values of 1, cos τ, sin τ, cos 2τ, … at τ.
fn fill_basis(tau: f64, basis: &mut [f64]) {
    basis[0] = 1.0;
    for k in 1..=basis.len() / 2 {
        (basis[2 * k], basis[2 * k - 1]) = (k as f64 * tau).sin_cos();
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

/// Maximum of |x| over a period of a series, between samples too.
impl Aft {
    /// See [`harmonics::max_abs`].
    pub fn max_abs(&mut self, series: &[f64]) -> f64 {
        harmonics::max_abs(series, &mut self.transform)
    }
}
