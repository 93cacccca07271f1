//! Small deviations of a motion, many at once, taken through recorded steps.
//!
//! Deviations (η, δ) of y_n and of y_n − y_{n−1}, and of what the laws remember, follow the linearised step
//!
//! δ̂ = D δ − a(ω_j² η + Bᵀδf) − Σ g (q·δ),  δ⁺ = δ̂ − Σ G (P·(η + δ̂)),  η⁺ = η + δ⁺,
//!
//! with the rows q, g of sliding friction that turns and P, G of contacts that are closed at the end of the step: the
//! derivative of the step as it was made, contacts included, exact as long as none of them grazes. Free flight of
//! uncoupled modes is one 2 × 2 matrix a mode.

use super::inverse::Inverse;
use super::lanes::{LANES, Lane, Pressed, add, combine, gather, more, press, rows, scatter, scatter_and_add};
use super::local::{Action, LocalLaw};
use super::tape::{Bound, Move, Tape};
use crate::linalg::Matrix;
use crate::structure::laws::MAX_ARGUMENTS;
use pulp::{Arch, Simd, WithSimd};

/// [`LANES`] deviations: numbers of each, row after row.
struct Block {
    eta: Vec<f64>,
    delta: Vec<f64>,
    memory: Vec<f64>,
    /// η + δ̂.
    ahead: Vec<f64>,
    /// Deviations of forces.
    forces: Vec<f64>,
}

/// What does not change from step to step.
pub struct Linear<'l, 'm> {
    pub squares: &'l [f64],
    pub inverse: &'l Inverse,
    pub laws: &'l [LocalLaw<'m>],
    /// Of each law: [`LocalLaw::responses`].
    pub responses: &'l [Matrix],
    pub step: f64,
}

/// Deviations, as columns of (y, (y_n − y_{n−1})/h, memory of the laws).
pub struct Columns {
    size: usize,
    memory: usize,
    blocks: Vec<Block>,
}

impl Columns {
    /// One unit deviation for each of 2n + m numbers; `forces` is the number of forces that can act on n modes at once.
    pub fn identity(size: usize, memory: usize, forces: usize, step: f64) -> Self {
        let total = 2 * size + memory;
        let zeros = |count: usize| vec![0.0; LANES * count];
        let empty = |_| Block {
            eta: zeros(size),
            delta: zeros(size),
            memory: zeros(memory),
            ahead: zeros(size),
            forces: zeros(forces),
        };
        let mut blocks: Vec<Block> = (0..total.div_ceil(LANES)).map(empty).collect();
        for i in 0..total {
            let (block, lane) = (&mut blocks[i / LANES], i % LANES);
            if i < size {
                block.eta[LANES * i + lane] = 1.0;
            } else if i < 2 * size {
                block.delta[LANES * (i - size) + lane] = step;
            } else {
                block.memory[LANES * (i - 2 * size) + lane] = 1.0;
            }
        }
        Self { size, memory, blocks }
    }

    /// The columns as a matrix.
    pub fn matrix(&self, step: f64) -> Matrix {
        let (n, total) = (self.size, 2 * self.size + self.memory);
        Matrix::from_fn(total, total, |i, j| {
            let (block, lane) = (&self.blocks[j / LANES], j % LANES);
            if i < n {
                block.eta[LANES * i + lane]
            } else if i < 2 * n {
                block.delta[LANES * (i - n) + lane] / step
            } else {
                block.memory[LANES * (i - 2 * n) + lane]
            }
        })
    }

    /// Takes all columns through the steps on a tape.
    pub fn follow(&mut self, linear: &Linear<'_, '_>, tape: &Tape) {
        let (flights, stiffs) = (linear.flights(tape), linear.stiffs());
        for block in &mut self.blocks {
            Arch::new().dispatch(Follow { block, linear, tape, flights: &flights, stiffs: &stiffs });
        }
    }
}

impl Linear<'_, '_> {
    /// a ω_j² of uncoupled modes.
    fn stiffs(&self) -> Vec<f64> {
        let Inverse::Diagonal(modes) = self.inverse else { return Vec::new() };
        modes.compliances.iter().zip(self.squares).map(|(compliance, square)| compliance * square).collect()
    }

    /// The 2 × 2 matrices of every free flight of uncoupled modes, on (η, δ).
    fn flights(&self, tape: &Tape) -> Vec<Vec<[f64; 4]>> {
        let Inverse::Diagonal(modes) = self.inverse else { return Vec::new() };
        let flight = |count: usize| -> Vec<[f64; 4]> {
            let mode = |((decay, compliance), square): ((&f64, &f64), &f64)| {
                let stiff = compliance * square;
                power([1.0 - stiff, *decay, -stiff, *decay], count)
            };
            modes.decays.iter().zip(&modes.compliances).zip(self.squares).map(mode).collect()
        };
        let free = |step: &Move| if let Move::Free(count) = step { Some(flight(*count)) } else { None };
        tape.moves.iter().filter_map(free).collect()
    }
}

/// A 2 × 2 matrix to a power, by squaring.
fn power(mut square: [f64; 4], mut exponent: usize) -> [f64; 4] {
    let product = |a: &[f64; 4], b: &[f64; 4]| {
        [a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2], a[2] * b[1] + a[3] * b[3]]
    };
    let mut result = [1.0, 0.0, 0.0, 1.0];
    while exponent > 0 {
        if exponent % 2 == 1 {
            result = product(&result, &square);
        }
        square = product(&square, &square);
        exponent /= 2;
    }
    result
}

/// One block of columns and the steps that it is to be taken through.
struct Follow<'f, 'm> {
    block: &'f mut Block,
    linear: &'f Linear<'f, 'm>,
    tape: &'f Tape,
    flights: &'f [Vec<[f64; 4]>],
    stiffs: &'f [f64],
}

impl WithSimd for Follow<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match S::F64_LANES {
            8 => self.run::<S, 1>(simd),
            4 => self.run::<S, 2>(simd),
            2 => self.run::<S, 4>(simd),
            _ => self.run::<S, LANES>(simd),
        }
    }
}

impl Follow<'_, '_> {
    #[inline(always)]
    fn run<S: Simd, const R: usize>(self, simd: S) {
        let mut lanes = Lanes::<S, R> {
            simd,
            linear: self.linear,
            stiffs: self.stiffs,
            eta: rows::<S, R>(&mut self.block.eta),
            delta: rows::<S, R>(&mut self.block.delta),
            memory: rows::<S, R>(&mut self.block.memory),
            ahead: rows::<S, R>(&mut self.block.ahead),
        };
        let forces = rows::<S, R>(&mut self.block.forces);
        let mut flights = self.flights.iter();
        for step in &self.tape.moves {
            match step {
                Move::Bound(bound) => lanes.bound(self.tape, bound, forces),
                Move::Free(count) => match flights.next() {
                    Some(modes) => lanes.fly(modes),
                    None => (0..*count).for_each(|_| {
                        lanes.predict();
                        lanes.arrive();
                    }),
                },
            }
        }
    }
}

/// A block in the vectors of a processor.
struct Lanes<'f, 'm, S: Simd, const R: usize> {
    simd: S,
    linear: &'f Linear<'f, 'm>,
    stiffs: &'f [f64],
    eta: &'f mut [Lane<S, R>],
    delta: &'f mut [Lane<S, R>],
    memory: &'f mut [Lane<S, R>],
    ahead: &'f mut [Lane<S, R>],
}

impl<S: Simd, const R: usize> Lanes<'_, '_, S, R> {
    #[inline(always)]
    fn fly(&mut self, modes: &[[f64; 4]]) {
        for (m, (eta, delta)) in modes.iter().zip(self.eta.iter_mut().zip(self.delta.iter_mut())) {
            let flown = combine(self.simd, (m[0], eta), (m[1], delta));
            *delta = combine(self.simd, (m[2], eta), (m[3], delta));
            *eta = flown;
        }
    }

    /// δ̂ of linear motion, from old η and δ.
    #[inline(always)]
    fn predict(&mut self) {
        let simd = self.simd;
        match self.linear.inverse {
            Inverse::Diagonal(modes) => {
                let motions = self.eta.iter().zip(self.delta.iter_mut());
                let coefficients = modes.decays.iter().zip(&modes.compliances).zip(self.linear.squares);
                for (((decay, compliance), square), (eta, delta)) in coefficients.zip(motions) {
                    *delta = combine(simd, (*decay, delta), (-compliance * square, eta));
                }
            }
            // As the marcher itself does: A_h⁻¹ (2/h² δ − ω² η) − δ.
            Inverse::Full(inverse) => {
                let scale = 2.0 / (self.linear.step * self.linear.step);
                let motions = self.eta.iter().zip(self.delta.iter()).zip(self.linear.squares);
                for (ahead, ((eta, delta), square)) in self.ahead.iter_mut().zip(motions) {
                    *ahead = combine(simd, (scale, delta), (-square, eta));
                }
                for (i, delta) in self.delta.iter_mut().enumerate() {
                    let mut sum = [simd.splat_f64s(0.0); R];
                    for (entry, ahead) in inverse.row(i).iter().zip(self.ahead.iter()) {
                        more(simd, &mut sum, *entry, ahead);
                    }
                    *delta = combine(simd, (1.0, &sum), (-1.0, delta));
                }
            }
        }
    }

    #[inline(always)]
    fn arrive(&mut self) {
        for (eta, delta) in self.eta.iter_mut().zip(self.delta.iter()) {
            *eta = add(self.simd, eta, delta);
        }
    }

    /// A step of uncoupled modes with a few nodes in contact and nothing else, if it is one.
    #[inline(always)]
    fn pressed(&mut self, tape: &Tape, step: &Bound) -> bool {
        let Inverse::Diagonal(modes) = self.linear.inverse else { return false };
        let ((rubbing, turning), (touching, contact), n) = (step.friction, step.contact, self.eta.len());
        let is_alike = rubbing == 0 || rubbing == touching;
        // Narrow vectors have no registers for it; the result is the same.
        if !self.linear.laws.is_empty() || !is_alike || S::F64_LANES < 4 {
            return false;
        }
        let count = touching * n;
        let pair = |at: usize| [&tape.rows[at..][..count], &tape.rows[at + count..][..count]];
        let friction = (rubbing > 0).then(|| pair(turning));
        let rows = Pressed { decays: &modes.decays, stiffs: self.stiffs, friction, contact: pair(contact) };
        match touching {
            1 => press::<S, R, 1>(self.simd, &rows, self.eta, self.delta),
            2 => press::<S, R, 2>(self.simd, &rows, self.eta, self.delta),
            3 => press::<S, R, 3>(self.simd, &rows, self.eta, self.delta),
            4 => press::<S, R, 4>(self.simd, &rows, self.eta, self.delta),
            5 => press::<S, R, 5>(self.simd, &rows, self.eta, self.delta),
            6 => press::<S, R, 6>(self.simd, &rows, self.eta, self.delta),
            _ => return false,
        }
        true
    }

    #[inline(always)]
    fn bound(&mut self, tape: &Tape, step: &Bound, forces: &mut [Lane<S, R>]) {
        if self.pressed(tape, step) {
            return;
        }
        let (simd, n) = (self.simd, self.eta.len());
        // Everything explicit is of the old motion, and acts on the new one: forces first, then the prediction.
        let (mut explicit, mut at) = (0, 0);
        for (law, action) in self.linear.laws.iter().zip(&tape.actions[step.laws..]) {
            let count = law.rows.rows();
            forces[explicit..explicit + count].copy_from_slice(&self.law_forces(law, action, at)[..count]);
            explicit += count;
            at += law.memory_size();
        }
        let (rubbing, at) = step.friction;
        let turning = &mut forces[explicit..explicit + rubbing];
        gather(simd, &tape.rows[at..at + rubbing * n], self.delta, turning);
        self.predict();
        if rubbing > 0 {
            scatter(simd, &tape.rows[at + rubbing * n..], turning, self.delta);
        }
        let mut first = 0;
        for responses in self.linear.responses {
            let count = responses.rows();
            scatter(simd, responses.entries(), &forces[first..first + count], self.delta);
            first += count;
        }
        let (touching, at) = step.contact;
        if touching == 0 {
            return self.arrive();
        }
        for (ahead, (eta, delta)) in self.ahead.iter_mut().zip(self.eta.iter().zip(self.delta.iter())) {
            *ahead = add(simd, eta, delta);
        }
        let (rows, pressures) = (&tape.rows[at..], &mut forces[..touching]);
        gather(simd, &rows[..touching * n], self.ahead, pressures);
        scatter_and_add(simd, &rows[touching * n..], pressures, self.delta, self.eta);
    }

    /// Deviations of a law's forces; its memory, which begins at `at`, goes on by a step.
    #[inline(always)]
    fn law_forces(&mut self, law: &LocalLaw<'_>, action: &Action, at: usize) -> [Lane<S, R>; MAX_ARGUMENTS] {
        let (simd, count, rate) = (self.simd, law.rows.rows(), 1.0 / self.linear.step);
        let zero = [[simd.splat_f64s(0.0); R]; MAX_ARGUMENTS];
        let response = &action.response;
        let (mut u, mut v, mut moved, mut change) = (zero, zero, zero, zero[0]);
        gather(simd, law.rows.entries(), self.eta, &mut u[..count]);
        gather(simd, law.rows.entries(), self.delta, &mut moved[..count]);
        if law.has_rate() {
            for i in 0..count {
                let before = &mut self.memory[at + i];
                if i == 0 {
                    change = combine(simd, (rate, &moved[0]), (-1.0, before));
                }
                v[i] = combine(simd, (1.5 * rate, &moved[i]), (-0.5, before));
                *before = combine(simd, (rate, &moved[i]), (0.0, &zero[0]));
            }
        } else {
            // Laws without rates depend on the last slope in steps that cross their threshold.
            v[0] = combine(simd, (rate, &moved[0]), (0.0, &zero[0]));
        }
        let mut forces = zero;
        for (force, (du, dv)) in forces.iter_mut().zip(response.du.iter().zip(&response.dv)).take(count) {
            for j in 0..count {
                more(simd, force, du[j], &u[j]);
                more(simd, force, dv[j], &v[j]);
            }
        }
        more(simd, &mut forces[0], action.by_change, &change);
        if law.has_memory() {
            let memory = &mut self.memory[at + law.memory_size() - 1];
            more(simd, &mut forces[0], response.du_before, &u[0]);
            more(simd, &mut forces[0], -response.du_before, &moved[0]);
            more(simd, &mut forces[0], response.dforce_before, memory);
            *memory = forces[0];
        }
        forces
    }
}
