//! Laws that act explicitly: everything but rigid contact.

use super::inverse::Inverse;
use super::{dot, modal_rows};
use crate::linalg::{Matrix, axpy};
use crate::structure::Element;
use crate::structure::laws::{Before, Instant, Law, LawKind, MAX_ARGUMENTS, MeanForce, Response};

/// Forces of a law in a step, with their derivatives.
#[derive(Debug, Clone, Copy, Default)]
pub struct Action {
    /// By the arguments, and by their velocities extrapolated to t_n.
    pub response: Response,
    /// ∂force[0]/∂(change of velocity 0 in the step), N·s/m.
    pub by_change: f64,
}

impl From<MeanForce> for Action {
    /// Of a law whose force may turn over within a step: the velocity changes by as much as in the step before, from t_n − h/2,
    /// where it is known, to t_n + h/2.
    fn from(MeanForce { force, by_velocity: [first, last] }: MeanForce) -> Self {
        let mut response = Response::default();
        response.force[0] = force;
        response.dv[0][0] = first + last;
        Self { response, by_change: 0.5 * (last - first) }
    }
}

/// A law of the model with what it remembers of the step before.
pub struct LocalLaw<'m> {
    law: &'m LawKind,
    /// bᵀΦ of each argument.
    pub rows: Matrix,
    /// Rotor speed, in rad/s.
    speed: f64,
    /// Time step, in s.
    step: f64,
    /// Whether its forces depend on velocities.
    has_rate: bool,
    before: Before,
    /// Backward differences of the arguments one step earlier, in m/s.
    slopes: [f64; MAX_ARGUMENTS],
    /// What the last forces were computed from, and what they are.
    used: (Before, [f64; MAX_ARGUMENTS]),
    action: Action,
}

impl<'m> LocalLaw<'m> {
    pub fn new(element: &'m Element, shapes: &Matrix, speed: f64, step: f64) -> Self {
        let (law, pattern) = (&element.law, element.law.pattern());
        let is_of_velocity = law.arguments() == 1 && !law.has_memory() && !pattern.du[0][0];
        debug_assert!(law.turnover().is_some() == law.mean_force([0.0; 2]).is_some(), "{law:?}");
        debug_assert!(law.turnover().is_none() || is_of_velocity, "{law:?}");
        Self {
            law: &element.law,
            rows: modal_rows(&element.channels, shapes),
            speed,
            step,
            has_rate: element.law.pattern().dv.as_flattened().contains(&true),
            before: Before::default(),
            slopes: [0.0; MAX_ARGUMENTS],
            used: (Before::default(), [0.0; MAX_ARGUMENTS]),
            action: Action::default(),
        }
    }

    /// Largest stiffness and damping rates, k bᵀM⁻¹b in 1/s² and c bᵀM⁻¹b in 1/s, as far as they are known beforehand.
    pub fn steepest(&self) -> (f64, f64) {
        let mobility = dot(self.rows.row(0), self.rows.row(0));
        (self.law.stiffness_bound() * mobility, self.law.damping_bound() * mobility)
    }

    /// Largest stiffness that is known beforehand, N/m.
    pub fn stiffness(&self) -> f64 {
        self.law.stiffness_bound()
    }

    /// Motion of the next position under a unit force on each argument, A_h⁻¹ΦᵀBᵀ, one row per argument.
    pub fn responses(&self, inverse: &Inverse) -> Matrix {
        let mut responses = Matrix::zeros(self.rows.rows(), self.rows.cols());
        for i in 0..self.rows.rows() {
            responses.row_mut(i).copy_from_slice(&inverse.apply(self.rows.row(i)));
        }
        responses
    }

    /// Whether its forces depend on velocities.
    pub fn has_rate(&self) -> bool {
        self.has_rate
    }

    /// Whether its forces depend on those of the step before.
    pub fn has_memory(&self) -> bool {
        self.law.has_memory()
    }

    /// Whether the last forces are those of a law on one side of its threshold, or of a slider that sticks.
    pub fn is_smooth(&self) -> bool {
        let crosses = |threshold: f64| 2.0 * (self.before.u - threshold).abs() < self.step * self.slopes[0].abs();
        !self.law.threshold().is_some_and(crosses) && (!self.has_memory() || self.sticks())
    }

    /// Whether a slider did not slip: its force goes on from that of the step before.
    pub fn sticks(&self) -> bool {
        self.action.response.dforce_before == 1.0
    }

    /// Numbers that the law carries from step to step beside the motion: the slopes of the arguments one step earlier if
    /// it depends on velocities, then the force one step earlier if it has memory.
    pub fn memory_size(&self) -> usize {
        let slopes = if self.has_rate { self.rows.rows() } else { 0 };
        slopes + usize::from(self.has_memory())
    }

    /// Appends what the last forces took from the step before them.
    pub fn memory(&self, out: &mut Vec<f64>) {
        let (before, slopes) = &self.used;
        if self.has_rate {
            out.extend(&slopes[..self.rows.rows()]);
        }
        if self.has_memory() {
            out.push(before.force);
        }
    }

    /// Takes up `memory` ([`memory_size`](Self::memory_size) numbers) of the step before the one that leads by `increment`
    /// to `y`.
    pub fn remember(&mut self, memory: &[f64], y: &[f64], increment: &[f64]) {
        self.before = Before::default();
        if self.has_rate {
            let count = self.rows.rows();
            self.slopes[..count].copy_from_slice(&memory[..count]);
        }
        if self.has_memory() {
            let row = self.rows.row(0);
            self.before = Before { u: dot(row, y) - dot(row, increment), force: memory[memory.len() - 1] };
        }
    }

    /// Force of a law with memory at the end of a path of its argument, in N. As in the balance, it has none at rest: where
    /// the path begins otherwise, the law is taken there first.
    pub fn force_after(&self, path: impl Iterator<Item = f64>) -> f64 {
        let mut before = Before::default();
        for u in path {
            let now = Instant { u: [u, 0.0, 0.0], speed: self.speed, ..Instant::default() };
            before = Before { u, force: self.law.respond(&now, &before).force[0] };
        }
        before.force
    }

    /// The last forces with their derivatives.
    pub fn action(&self) -> &Action {
        &self.action
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
        self.used = (self.before, self.slopes);
        let slope_before = self.slopes[0];
        for i in 0..self.rows.rows() {
            let slope = scale * dot(self.rows.row(i), increment);
            now.u[i] = dot(self.rows.row(i), y);
            // Backward differences are velocities at t − h/2 and t − 3h/2: extrapolated to t.
            now.v[i] = 1.5 * slope - 0.5 * self.slopes[i];
            self.slopes[i] = slope;
        }
        let [u, slope] = [now.u[0], self.slopes[0]];
        self.action = match self.law.threshold() {
            Some(threshold) if !self.has_rate && 2.0 * (u - threshold).abs() < self.step * slope.abs() => {
                Action { response: self.mean(&mut now, threshold), by_change: 0.0 }
            }
            _ => match self.law.mean_force([slope, 2.0 * slope - slope_before]) {
                Some(mean) => Action::from(mean),
                None => Action { response: self.law.respond(&now, &self.before), by_change: 0.0 },
            },
        };
        let force_now = &self.action.response.force;
        self.before = Before { u, force: force_now[0] };
        for (i, component) in force_now.iter().enumerate().take(self.rows.rows()) {
            axpy(-component, self.rows.row(i), force);
        }
    }

    /// Forces of a law that begins to act beyond a threshold, in a step that crosses it: their mean over the step.
    ///
    /// Forces of single instants would make the time of a touch a whole number of steps, and the tangent of a stiff law err by
    /// its stiffness times the step. The part of the step beyond the threshold is a, of w = |slope| h in all; the force acts
    /// with the share a/w, as it is in the middle of this part: exact for linear laws.
    fn mean(&self, now: &mut Instant, threshold: f64) -> Response {
        let slope = self.slopes[0];
        let w = self.step * slope.abs();
        let a = now.u[0] - threshold + 0.5 * w;
        now.u[0] = threshold + 0.5 * a;
        let mut response = self.law.respond(now, &self.before);
        let share = a / w;
        for i in 0..self.rows.rows() {
            let (force, stiffness) = (response.force[i], response.du[i][0]);
            response.force[i] *= share;
            response.du[i].iter_mut().for_each(|entry| *entry *= share);
            response.du[i][0] = force / w + 0.5 * share * stiffness;
            // By the slope, which changes w and with it a.
            let widening = (0.5 - share) / w * force + 0.25 * share * stiffness;
            response.dv[i][0] = self.step.copysign(slope) * widening;
        }
        response
    }
}
