//! Time marching: the independent truth that harmonic balance solutions are checked against.
//!
//! Central differences in modal coordinates, x = Φ y, with A_h = I/h² + Ĉ/(2h):
//!
//! A_h y_{n+1} = (2/h² − ω_j²) y_n − (I/h² − Ĉ/(2h)) y_{n−1} + Φᵀ(A s cos(mωt_n) − F_n) − Φᵀ(N + μT)ᵀ λ_n
//!
//! Rigid contacts use forward-increment Lagrange multipliers: the pressures λ_n are those that leave no penetration at
//! t_{n+1} (Carpenter, Taylor & Katona, Int. J. Numer. Methods Eng. 32, 1991, pp. 103–128; paper, reference \[4\]). Every
//! other law acts explicitly, with u_n and the velocity extrapolated to t_n from the last two backward differences,
//! which keeps the scheme of second order in h; in a step in which a law begins or ceases to act, with its mean, and so do
//! laws whose force turns over with the sign of the velocity.
//!
//! # What this contact law does to an impact
//! The gap is closed to rounding at every step that ends in contact, so a lumped dof that hits a stop stays on it and
//! loses its velocity: the impact of a single mass is perfectly inelastic, whatever h. A continuous structure rebounds
//! by its own waves, and loses only the kinetic energy of the touching nodes. A touch with zero velocity, a steady
//! contact and a release cost nothing.
//!
//! # Starting
//! x_{−1} = x_0 − h v_0 + h²/2 a_0, with a_0 the acceleration without contact forces. No pressure needs to be guessed
//! at a start in contact: the first multiplier then comes out as half the contact force and the first increment is
//! h v_0 + h²/2 (a_0 + contact), as it should be.

mod columns;
mod complementarity;
mod contacts;
mod factors;
mod glide;
mod inverse;
mod lanes;
mod limits;
mod local;
mod offsets;
mod period;
mod phases;
mod tape;

use crate::linalg::{LinalgError, Matrix, vectorised};
use crate::structure::Model;
use crate::structure::laws::Law;
use contacts::Contacts;
use glide::Motion;
use inverse::Inverse;
use limits::{least_steps, stability_limit};
use local::LocalLaw;
pub(crate) use offsets::{Offset, reduced};
pub(crate) use period::Account;
use phases::Phases;
use std::f64::consts::TAU;
use std::sync::Arc;
use thiserror::Error;

/// Time step of a [`Marching`].
#[derive(Debug, Clone, PartialEq)]
pub struct MarchingSettings {
    /// Time step over the stability limit 2/ω_max, in (0, 1).
    pub step_fraction: f64,
    /// Least number of steps in one period of the response; without one, as many as suit the model.
    pub min_steps_per_period: Option<usize>,
}

impl Default for MarchingSettings {
    fn default() -> Self {
        Self { step_fraction: 0.4, min_steps_per_period: None }
    }
}

/// Why time marching could not start or go on.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MarchingError {
    /// A setting is out of its range.
    #[error("{name} = {value} is out of range: expected {expected}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// The matrix A_h of a full damping matrix could not be factorised.
    #[error("time stepping with full damping: {0}")]
    Damping(#[from] LinalgError),
    /// No contact pressures were found that leave no penetration.
    #[error(
        "no contact pressures found at t = {time} s: friction or dependent contact nodes make the problem unsolvable"
    )]
    Contact {
        /// Time t_n of the step, in s.
        time: f64,
    },
    /// The motion is not finite any more: the time step is too long for a stiffening law, or the motion is unbounded.
    #[error("the motion grew without bound before t = {time} s")]
    Diverged {
        /// Time at the end of the period, in s.
        time: f64,
    },
}

/// What happened in one period of the response.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodSummary {
    /// Largest |x| of each monitored dof, in m.
    pub max: Vec<f64>,
    /// Root mean square of each monitored dof, in m.
    pub rms: Vec<f64>,
    /// Share of the period that each contact element spends in contact, in the order of the model's elements.
    pub contact: Vec<f64>,
    /// Mean kinetic and elastic energy of the linear structure, in J.
    pub energy: f64,
}

/// Motion of a model under its forcing, one time step or one period at a time.
pub struct Marching<'m> {
    model: &'m Model,
    /// Forcing in modal coordinates, A Φᵀ s.
    forcing: Vec<f64>,
    /// ω_j².
    squares: Vec<f64>,
    inverse: Inverse,
    contacts: Contacts,
    laws: Vec<LocalLaw<'m>>,
    /// Modal rows of the monitored dofs.
    monitors: Matrix,
    step: f64,
    /// Phases of the forcing in a period, which marchings with the same steps share.
    phases: Arc<Phases>,
    /// Number of steps since the start.
    index: usize,
    /// y_n.
    y: Vec<f64>,
    /// y_n − y_{n−1}: marching on increments loses less to rounding than on three positions.
    increment: Vec<f64>,
    /// y_{n+1} − y_n, always one step ahead, so that velocities and pressures at t_n are known.
    next: Vec<f64>,
    force: Vec<f64>,
    ahead: Vec<f64>,
}

impl<'m> Marching<'m> {
    /// Prepares the motion of `model` under A = `amplitude` with a response of frequency `omega` (rad/s): forcing and
    /// rotor have m·`omega`. It starts at rest; see [`Marching::set_state`].
    ///
    /// # Errors
    /// Settings out of their range, full damping that cannot be factorised, and those of [`Marching::set_state`].
    pub fn new(
        model: &'m Model,
        settings: &MarchingSettings,
        amplitude: f64,
        omega: f64,
    ) -> Result<Self, MarchingError> {
        let fraction = settings.step_fraction;
        check("step_fraction", fraction, fraction > 0.0 && fraction < 1.0, "between 0 and 1")?;
        let least = settings.min_steps_per_period.unwrap_or(least_steps(model));
        check("min_steps_per_period", least as f64, least >= 8, "at least 8")?;
        check("omega", omega, omega > 0.0 && omega.is_finite(), "a finite frequency above zero, in rad/s")?;
        let speed = model.forcing().harmonic as f64 * omega;
        let longest = fraction * stability_limit(model, &local_laws(model, speed, 0.0));
        let steps = (TAU / omega / longest).ceil() as usize;
        Self::with_steps(model, steps.max(least), amplitude, omega)
    }

    /// The same with `steps` time steps in a period, whatever the limit of stability.
    ///
    /// # Errors
    /// As [`Marching::new`].
    pub fn with_steps(model: &'m Model, steps: usize, amplitude: f64, omega: f64) -> Result<Self, MarchingError> {
        check("steps", steps as f64, steps >= 8, "at least 8 in a period")?;
        Self::with_phases(model, Phases::new(steps, model.forcing().harmonic).into(), amplitude, omega)
    }

    /// The same with the phases of another marching of the model with as many steps.
    fn with_phases(model: &'m Model, phases: Arc<Phases>, amplitude: f64, omega: f64) -> Result<Self, MarchingError> {
        check("omega", omega, omega > 0.0 && omega.is_finite(), "a finite frequency above zero, in rad/s")?;
        check("amplitude", amplitude, amplitude.is_finite(), "a finite forcing amplitude")?;
        let n = model.size();
        let shapes = &model.modes().shapes;
        let speed = model.forcing().harmonic as f64 * omega;
        let step = TAU / omega / phases.steps as f64;
        let inverse = Inverse::new(model.damping(), step)?;
        let contacts = Contacts::new(model, &inverse, speed);
        let monitors = Matrix::from_fn(model.monitors().len(), n, |i, j| shapes[(model.monitors()[i], j)]);
        let forcing =
            (0..n).map(|j| (0..n).map(|i| amplitude * shapes[(i, j)] * model.forcing().shape[i]).sum()).collect();
        let zeros = vec![0.0; n];
        let mut marching = Self {
            model,
            forcing,
            squares: squares(model),
            inverse,
            contacts,
            laws: local_laws(model, speed, step),
            monitors,
            step,
            phases,
            index: 0,
            y: zeros.clone(),
            increment: zeros.clone(),
            next: zeros.clone(),
            force: zeros.clone(),
            ahead: zeros.clone(),
        };
        marching.set_state(&zeros, &zeros)?;
        Ok(marching)
    }

    /// Starts again at t = 0 with displacements `x` (m) and velocities `xdot` (m/s) of the n dofs. Laws with memory
    /// start without force.
    ///
    /// # Errors
    /// If no contact pressures are found for the first step.
    ///
    /// # Panics
    /// If `x` or `xdot` do not have n entries.
    pub fn set_state(&mut self, x: &[f64], xdot: &[f64]) -> Result<(), MarchingError> {
        let n = self.model.size();
        assert!(x.len() == n && xdot.len() == n, "{} and {} entries for {n} dofs", x.len(), xdot.len());
        let modal = |z: &[f64]| self.model.modes().shapes.transpose().mul_vec(&self.model.mass().mul_vec(z));
        let velocity = modal(xdot);
        self.y = modal(x);
        self.index = 0;
        self.contacts.forget();
        self.linear_force();
        for law in &mut self.laws {
            law.start(&self.y, &velocity, &mut self.force);
        }
        let damping = self.model.damping().times(&velocity);
        for j in 0..n {
            let acceleration = self.force[j] - damping[j];
            self.increment[j] = self.step * velocity[j] - 0.5 * self.step * self.step * acceleration;
        }
        self.advance()
    }

    /// One time step.
    ///
    /// # Errors
    /// If no contact pressures are found that leave no penetration.
    pub fn step(&mut self) -> Result<(), MarchingError> {
        self.index += 1;
        if let (Inverse::Diagonal(modes), true) = (&self.inverse, self.laws.is_empty()) {
            let cosine = self.phases.cosine(self.index);
            let touches = vectorised(
                #[inline(always)]
                || {
                    let motion = Motion { y: &mut self.y, increment: &mut self.increment, next: &mut self.next };
                    motion.glide(modes, (&self.forcing, cosine), &self.squares, &mut self.ahead);
                    self.contacts.touches(&self.ahead, &self.next)
                },
            );
            return if touches { self.correct() } else { Ok(()) };
        }
        for (y, next) in self.y.iter_mut().zip(&self.next) {
            *y += next;
        }
        std::mem::swap(&mut self.increment, &mut self.next);
        self.linear_force();
        for law in &mut self.laws {
            law.act(&self.y, &self.increment, 1.0 / self.step, &mut self.force);
        }
        self.advance()
    }

    /// One period 2π/ω of the response.
    ///
    /// # Errors
    /// Those of [`step`](Self::step), and a motion that is not finite any more.
    pub fn period(&mut self) -> Result<PeriodSummary, MarchingError> {
        let count = self.phases.steps as f64;
        let mut summary = PeriodSummary {
            max: vec![0.0; self.monitors.rows()],
            rms: vec![0.0; self.monitors.rows()],
            contact: vec![0.0; self.contacts.pressures().len()],
            energy: 0.0,
        };
        for _ in 0..self.phases.steps {
            self.step()?;
            for i in 0..self.monitors.rows() {
                let x = dot(self.monitors.row(i), &self.y);
                summary.max[i] = summary.max[i].max(x.abs());
                summary.rms[i] += x * x / count;
            }
            for (share, &pressure) in summary.contact.iter_mut().zip(self.contacts.pressures()) {
                *share += if pressure > 0.0 { 1.0 / count } else { 0.0 };
            }
            summary.energy += self.energy() / count;
        }
        summary.rms.iter_mut().for_each(|x| *x = x.sqrt());
        if summary.energy.is_finite() { Ok(summary) } else { Err(MarchingError::Diverged { time: self.time() }) }
    }

    /// Time t_n since the start, in s.
    pub fn time(&self) -> f64 {
        self.index as f64 * self.step
    }

    /// Time step h, in s.
    pub fn time_step(&self) -> f64 {
        self.step
    }

    /// Number of steps in one period of the response.
    pub fn steps_per_period(&self) -> usize {
        self.phases.steps
    }

    /// Displacements at t_n, n entries in m.
    pub fn displacements(&self) -> Vec<f64> {
        self.model.modes().shapes.mul_vec(&self.y)
    }

    /// Velocities (x_{n+1} − x_{n−1})/(2h) at t_n, n entries in m/s.
    pub fn velocities(&self) -> Vec<f64> {
        let scale = 0.5 / self.step;
        let velocity: Vec<f64> = self.increment.iter().zip(&self.next).map(|(a, b)| scale * (a + b)).collect();
        self.model.modes().shapes.mul_vec(&velocity)
    }

    /// Contact pressures λ_n of the contact elements, in N, in the order of the model's elements.
    pub fn pressures(&self) -> &[f64] {
        self.contacts.pressures()
    }

    /// Kinetic and elastic energy of the linear structure at t_n, in J.
    pub fn energy(&self) -> f64 {
        let scale = 0.5 / self.step;
        let motion = self.y.iter().zip(&self.squares).zip(self.increment.iter().zip(&self.next));
        motion.fold(0.0, |sum, ((y, square), (a, b))| {
            let velocity = scale * (a + b);
            sum + 0.5 * (velocity * velocity + square * y * y)
        })
    }

    /// Forcing and elastic forces at t_n, in modal coordinates.
    fn linear_force(&mut self) {
        let cosine = self.phases.cosine(self.index);
        let modes = self.forcing.iter().zip(&self.squares).zip(&self.y);
        for (force, ((forcing, square), y)) in self.force.iter_mut().zip(modes) {
            *force = forcing * cosine - square * y;
        }
    }

    /// The increment from t_n to t_{n+1}, without contact and then with the pressures that leave no penetration.
    fn advance(&mut self) -> Result<(), MarchingError> {
        let touches = vectorised(
            #[inline(always)]
            || {
                self.inverse.predict(&self.increment, &mut self.force, self.step, &mut self.next);
                for (ahead, (y, next)) in self.ahead.iter_mut().zip(self.y.iter().zip(&self.next)) {
                    *ahead = y + next;
                }
                self.contacts.touches(&self.ahead, &self.next)
            },
        );
        if touches { self.correct() } else { Ok(()) }
    }

    /// Adds the pressures that leave no penetration at t_{n+1} to an increment without contact.
    fn correct(&mut self) -> Result<(), MarchingError> {
        let slope = 1.0 / self.step;
        vectorised(
            #[inline(always)]
            || self.contacts.correct(&self.increment, slope, &mut self.next),
        )
        .map_err(|complementarity::Unsolvable| MarchingError::Contact { time: self.time() })
    }
}

/// Refuses a setting out of its range.
fn check(name: &'static str, value: f64, in_range: bool, expected: &'static str) -> Result<(), MarchingError> {
    if in_range { Ok(()) } else { Err(MarchingError::Setting { name, value, expected }) }
}

/// The laws that act explicitly, at a rotor speed in rad/s and with a time step in s.
fn local_laws(model: &Model, speed: f64, step: f64) -> Vec<LocalLaw<'_>> {
    let explicit = model.elements().iter().filter(|element| element.law.rigid().is_none());
    explicit.map(|element| LocalLaw::new(element, &model.modes().shapes, speed, step)).collect()
}

/// ω_j².
fn squares(model: &Model) -> Vec<f64> {
    model.modes().frequencies.iter().map(|w| w * w).collect()
}

/// bᵀΦ for each channel b of an element: relative displacements from modal coordinates.
fn modal_rows(channels: &[Vec<(usize, f64)>], shapes: &Matrix) -> Matrix {
    let entry = |i: usize, j| channels[i].iter().map(|&(dof, coefficient)| coefficient * shapes[(dof, j)]).sum();
    Matrix::from_fn(channels.len(), shapes.cols(), entry)
}

/// Scalar product with four partial sums: the step loop is made of these.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}
