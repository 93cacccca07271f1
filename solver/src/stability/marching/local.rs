//! Laws that act explicitly: everything but rigid contact.

use super::{dot, modal_rows};
use crate::linalg::{Matrix, axpy};
use crate::structure::Element;
use crate::structure::laws::{Before, Instant, Law, LawKind, MAX_ARGUMENTS};

/// A law of the model with what it remembers of the step before.
pub struct LocalLaw<'m> {
    law: &'m LawKind,
    /// bᵀΦ of each argument.
    rows: Matrix,
    /// Rotor speed, in rad/s.
    speed: f64,
    before: Before,
    /// Backward differences of the arguments one step earlier, in m/s.
    slopes: [f64; MAX_ARGUMENTS],
}

impl<'m> LocalLaw<'m> {
    pub fn new(element: &'m Element, shapes: &Matrix, speed: f64) -> Self {
        let rows = modal_rows(&element.channels, shapes);
        Self { law: &element.law, rows, speed, before: Before::default(), slopes: [0.0; MAX_ARGUMENTS] }
    }

    /// Largest stiffness and damping rates, k bᵀM⁻¹b in 1/s² and c bᵀM⁻¹b in 1/s, as far as they are known beforehand.
    pub fn steepest(&self) -> (f64, f64) {
        let mobility = dot(self.rows.row(0), self.rows.row(0));
        (self.law.stiffness_bound() * mobility, self.law.damping_bound() * mobility)
    }

    /// Forces of the start: `velocity` is known there. A law with memory starts without force.
    pub fn start(&mut self, y: &[f64], velocity: &[f64], force: &mut [f64]) {
        self.before = Before { u: dot(self.rows.row(0), y), force: 0.0 };
        for i in 0..self.rows.rows() {
            self.slopes[i] = dot(self.rows.row(i), velocity);
        }
        self.act(y, velocity, 1.0, force);
    }

    /// Takes the law's forces at t_n from `force`; `increment`·`scale` is the backward difference of y at t_n.
    pub fn act(&mut self, y: &[f64], increment: &[f64], scale: f64, force: &mut [f64]) {
        let mut now = Instant { speed: self.speed, ..Instant::default() };
        for i in 0..self.rows.rows() {
            let slope = scale * dot(self.rows.row(i), increment);
            now.u[i] = dot(self.rows.row(i), y);
            // Backward differences are velocities at t − h/2 and t − 3h/2: extrapolated to t.
            now.v[i] = 1.5 * slope - 0.5 * self.slopes[i];
            self.slopes[i] = slope;
        }
        let response = self.law.respond(&now, &self.before);
        self.before = Before { u: now.u[0], force: response.force[0] };
        for i in 0..self.rows.rows() {
            axpy(-response.force[i], self.rows.row(i), force);
        }
    }
}
