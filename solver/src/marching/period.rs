//! The state of the marcher as a vector, and the map of a period with its derivative.

use super::columns::{Columns, Linear};
use super::tape::Tape;
use super::{Marching, MarchingError, dot};
use crate::formulation::harmonics::evaluate;
use crate::formulation::state::State;
use crate::linalg::Matrix;
use std::f64::consts::TAU;

/// What a period does besides leading to its end.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Account {
    /// Work of the forcing, in J.
    pub supplied: f64,
    /// What the forcing gives and what it takes, together, in J.
    pub exchanged: f64,
    /// Work that the contact pressures take from the structure, in J: impacts only, since neither a steady contact nor a
    /// release takes any.
    pub impacts: f64,
    /// Of the impact that takes most: what it takes, and the kinetic energy before it, in J.
    pub hardest: (f64, f64),
}

impl<'m> Marching<'m> {
    /// Numbers of a state: n modal displacements (kg^½·m), n modal velocities (y_n − y_{n−1})/h, and what the laws carry from
    /// step to step (slopes in m/s, forces in N).
    pub fn state_size(&self) -> usize {
        2 * self.y.len() + self.laws.iter().map(|law| law.memory_size()).sum::<usize>()
    }

    /// The state at t_n, everything that the motion after it depends on besides the phase of the forcing.
    pub fn state(&self) -> Vec<f64> {
        let mut state = Vec::with_capacity(self.state_size());
        state.extend(&self.y);
        state.extend(self.increment.iter().map(|d| d / self.step));
        self.laws.iter().for_each(|law| law.memory(&mut state));
        state
    }

    /// The state at t = 0 of a periodic motion of the balance, whatever its frequency is to the marcher's: positions of the last
    /// steps before t = 0, and forces that laws with memory come to on its displacements.
    pub fn state_of(&self, motion: &State) -> Vec<f64> {
        let turn = TAU / self.phases.steps as f64;
        let at = |series: &[f64], steps: f64| evaluate(series, steps * turn)[0];
        let n = self.y.len();
        let mut state: Vec<f64> = (0..n).map(|j| at(motion.mode(j), 0.0)).collect();
        state.extend((0..n).map(|j| (state[j] - at(motion.mode(j), -1.0)) / self.step).collect::<Vec<_>>());
        for law in &self.laws {
            let arguments: Vec<Vec<f64>> =
                (0..law.rows.rows()).map(|i| motion.combine(law.rows.row(i).iter().copied())).collect();
            if law.has_rate() {
                state.extend(arguments.iter().map(|series| (at(series, -1.0) - at(series, -2.0)) / self.step));
            }
            if law.has_memory() {
                let period = self.phases.steps as i32;
                // Two periods: after one, the force of a slider that slips has forgotten where it began.
                let path = (-2 * period..0).map(|i| at(&arguments[0], f64::from(i)));
                state.push(law.force_after(path));
            }
        }
        state
    }

    /// Sizes of the numbers of a state in a motion of modal size `size` (kg^½·m) and frequency `omega` (rad/s).
    pub fn scales(&self, size: f64, omega: f64) -> Vec<f64> {
        let n = self.y.len();
        let mut scales = vec![size; n];
        scales.resize(2 * n, omega * size);
        for law in &self.laws {
            let reach = |i: usize| size * dot(law.rows.row(i), law.rows.row(i)).sqrt();
            if law.has_rate() {
                scales.extend((0..law.rows.rows()).map(|i| omega * reach(i)));
            }
            if law.has_memory() {
                scales.push(law.stiffness() * reach(0));
            }
        }
        scales
    }

    /// Another marching of the model with as many steps in a period, under A = `amplitude` with a response of frequency `omega` (rad/s), at rest.
    ///
    /// # Errors
    /// As [`Marching::new`].
    pub(crate) fn beside(&self, amplitude: f64, omega: f64) -> Result<Self, MarchingError> {
        Self::with_phases(self.model, self.phases.clone(), amplitude, omega)
    }

    /// Starts again at t = 0 with a state of [`state`](Self::state).
    ///
    /// # Errors
    /// If no contact pressures are found for the first step.
    ///
    /// # Panics
    /// If it does not have [`state_size`](Self::state_size) numbers.
    pub fn restart(&mut self, state: &[f64]) -> Result<(), MarchingError> {
        self.restart_at(state, 0)
    }

    /// Starts again at t_`index`, with the phase that the forcing has there.
    ///
    /// # Errors
    /// If no contact pressures are found for the first step.
    ///
    /// # Panics
    /// If the state does not have [`state_size`](Self::state_size) numbers.
    pub fn restart_at(&mut self, state: &[f64], index: usize) -> Result<(), MarchingError> {
        assert_eq!(state.len(), self.state_size(), "numbers of a state");
        let n = self.y.len();
        self.y.copy_from_slice(&state[..n]);
        self.increment.iter_mut().zip(&state[n..]).for_each(|(d, v)| *d = v * self.step);
        self.index = index;
        self.contacts.forget();
        self.linear_force();
        let mut memory = &state[2 * n..];
        for law in &mut self.laws {
            let own;
            (own, memory) = memory.split_at(law.memory_size());
            law.remember(own, &self.y, &self.increment);
            law.act(&self.y, &self.increment, 1.0 / self.step, &mut self.force);
        }
        self.advance()
    }

    /// One period, telling `visit` of every t_n before its step.
    ///
    /// # Errors
    /// Those of [`Marching::step`], and a motion that is not finite any more.
    pub(crate) fn walk(&mut self, visit: &mut dyn FnMut(&mut Self)) -> Result<(), MarchingError> {
        for _ in 0..self.phases.steps {
            visit(self);
            self.step()?;
        }
        let finite = self.y.iter().chain(&self.next).all(|y| y.is_finite());
        if finite { Ok(()) } else { Err(MarchingError::Diverged { time: self.time() }) }
    }

    /// One period, and the derivative of the state at its end with respect to the state at its begin: the monodromy matrix,
    /// of order [`state_size`](Self::state_size).
    ///
    /// Every step is differentiated as it was made, with the contacts that close in it: exact unless a contact grazes.
    ///
    /// # Errors
    /// Those of [`Marching::step`], and a motion that is not finite any more.
    pub fn monodromy(&mut self) -> Result<Matrix, MarchingError> {
        self.walk_with_tangent(&mut |_| {})
    }

    /// [`monodromy`](Self::monodromy), telling `visit` of every t_n before its step.
    ///
    /// # Errors
    /// Those of [`Marching::step`], and a motion that is not finite any more.
    pub(crate) fn walk_with_tangent(&mut self, visit: &mut dyn FnMut(&mut Self)) -> Result<Matrix, MarchingError> {
        let n = self.y.len();
        let responses: Vec<Matrix> = self.laws.iter().map(|law| law.responses(&self.inverse)).collect();
        let forces = self.model.arguments();
        let mut columns = Columns::identity(n, self.state_size() - 2 * n, forces, self.step);
        let mut tape = Tape::default();
        self.walk(&mut |marching| {
            visit(marching);
            marching.record(&mut tape);
            if tape.is_full() {
                columns.follow(&marching.linear(&responses), &tape);
                tape.clear();
            }
        })?;
        columns.follow(&self.linear(&responses), &tape);
        Ok(columns.matrix(self.step))
    }

    fn linear<'l>(&'l self, responses: &'l [Matrix]) -> Linear<'l, 'l> {
        Linear { squares: &self.squares, inverse: &self.inverse, laws: &self.laws, responses, step: self.step }
    }

    /// Adds what the step that is made ready does.
    #[inline(always)]
    pub(crate) fn balance(&self, account: &mut Account) {
        if !self.contacts.touching().is_empty() {
            let taken = self.contacts.work(&self.increment, &self.next);
            account.impacts += taken;
            if taken > account.hardest.0 {
                account.hardest = (taken, 0.5 * dot(&self.increment, &self.increment) / (self.step * self.step));
            }
        }
        let motion = 0.5 * (dot(&self.forcing, &self.increment) + dot(&self.forcing, &self.next));
        let work = self.phases.cosine(self.index) * motion;
        account.supplied += work;
        account.exchanged += work.abs();
    }

    /// Whether the step that is made ready is as smooth as its laws: nothing touches, slips, or begins or ceases to act.
    pub(crate) fn is_smooth(&self) -> bool {
        self.contacts.touching().is_empty() && self.laws.iter().all(|law| law.is_smooth())
    }

    /// Number of steps since the start.
    pub(crate) fn index(&self) -> usize {
        self.index
    }

    /// Modal displacements at t_n, kg^½·m.
    pub(crate) fn modal(&self) -> &[f64] {
        &self.y
    }

    /// Displacement of the monitored dof of this number at t_n, m.
    #[inline(always)]
    pub(crate) fn monitored(&self, number: usize) -> f64 {
        dot(self.monitors.row(number), &self.y)
    }
}
