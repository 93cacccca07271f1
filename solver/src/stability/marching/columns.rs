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
use super::local::LocalLaw;
use super::tape::{Bound, Move, Tape};
use crate::linalg::{Matrix, vectorised};
use crate::structure::laws::{MAX_ARGUMENTS, Response};

/// Columns that are taken through the steps together: their numbers stay in the nearest cache.
const LANES: usize = 16;

type Lane = [f64; LANES];

/// Sixteen deviations.
struct Block {
    eta: Vec<Lane>,
    delta: Vec<Lane>,
    memory: Vec<Lane>,
    ahead: Vec<Lane>,
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
    /// One unit deviation for each of 2n + m numbers.
    pub fn identity(size: usize, memory: usize, step: f64) -> Self {
        let total = 2 * size + memory;
        let zeros = |count: usize| vec![[0.0; LANES]; count];
        let empty = || Block { eta: zeros(size), delta: zeros(size), memory: zeros(memory), ahead: zeros(size) };
        let mut blocks: Vec<Block> = (0..total.div_ceil(LANES)).map(|_| empty()).collect();
        for i in 0..total {
            let (block, lane) = (&mut blocks[i / LANES], i % LANES);
            if i < size {
                block.eta[i][lane] = 1.0;
            } else if i < 2 * size {
                block.delta[i - size][lane] = step;
            } else {
                block.memory[i - 2 * size][lane] = 1.0;
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
                block.eta[i][lane]
            } else if i < 2 * n {
                block.delta[i - n][lane] / step
            } else {
                block.memory[i - 2 * n][lane]
            }
        })
    }

    /// Takes all columns through the steps on a tape.
    pub fn follow(&mut self, linear: &Linear<'_, '_>, tape: &Tape) {
        let flights = linear.flights(tape);
        for block in &mut self.blocks {
            vectorised(
                #[inline(always)]
                || block.follow(linear, tape, &flights),
            );
        }
    }
}

impl Linear<'_, '_> {
    /// The 2 × 2 matrices of every free flight of uncoupled modes, on (η, δ).
    fn flights(&self, tape: &Tape) -> Vec<Vec<[f64; 4]>> {
        let Inverse::Diagonal(modes) = self.inverse else { return Vec::new() };
        let flight = |count: usize| -> Vec<[f64; 4]> {
            let mode = |((decay, compliance), square): (&(f64, f64), &f64)| {
                let stiff = compliance * square;
                power([1.0 - stiff, *decay, -stiff, *decay], count)
            };
            modes.iter().zip(self.squares).map(mode).collect()
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

impl Block {
    #[inline(always)]
    fn follow(&mut self, linear: &Linear<'_, '_>, tape: &Tape, flights: &[Vec<[f64; 4]>]) {
        let mut flights = flights.iter();
        for step in &tape.moves {
            match step {
                Move::Bound(bound) => self.bound(linear, tape, bound),
                Move::Free(count) => match flights.next() {
                    Some(modes) => self.fly(modes),
                    None => (0..*count).for_each(|_| {
                        self.predict(linear);
                        self.arrive();
                    }),
                },
            }
        }
    }

    #[inline(always)]
    fn fly(&mut self, modes: &[[f64; 4]]) {
        for (m, (eta, delta)) in modes.iter().zip(self.eta.iter_mut().zip(&mut self.delta)) {
            for k in 0..LANES {
                let (e, d) = (eta[k], delta[k]);
                eta[k] = m[0] * e + m[1] * d;
                delta[k] = m[2] * e + m[3] * d;
            }
        }
    }

    /// δ̂ of linear motion, from old η and δ.
    #[inline(always)]
    fn predict(&mut self, linear: &Linear<'_, '_>) {
        match linear.inverse {
            Inverse::Diagonal(modes) => {
                let motions = self.eta.iter().zip(&mut self.delta);
                for (((decay, compliance), square), (eta, delta)) in modes.iter().zip(linear.squares).zip(motions) {
                    let stiff = compliance * square;
                    for k in 0..LANES {
                        delta[k] = decay * delta[k] - stiff * eta[k];
                    }
                }
            }
            Inverse::Full(inverse) => {
                let scale = 2.0 / (linear.step * linear.step);
                let motions = self.eta.iter().zip(&self.delta).zip(linear.squares);
                for (ahead, ((eta, delta), square)) in self.ahead.iter_mut().zip(motions) {
                    for k in 0..LANES {
                        ahead[k] = scale * delta[k] - square * eta[k];
                    }
                }
                for (i, delta) in self.delta.iter_mut().enumerate() {
                    let sum = gather(inverse.row(i), &self.ahead);
                    for k in 0..LANES {
                        delta[k] = sum[k] - delta[k];
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn arrive(&mut self) {
        for (eta, delta) in self.eta.iter_mut().zip(&self.delta) {
            for k in 0..LANES {
                eta[k] += delta[k];
            }
        }
    }

    #[inline(always)]
    fn bound(&mut self, linear: &Linear<'_, '_>, tape: &Tape, step: &Bound) {
        let n = self.eta.len();
        let mut forces = [[0.0; LANES]; 8];
        // Everything explicit is of the old motion, and acts on the new one: forces first, then the prediction.
        let mut laws = Vec::new();
        let mut at = 0;
        for (law, response) in linear.laws.iter().zip(&tape.responses[step.laws..]) {
            laws.push(self.law_forces(law, response, linear.step, at));
            at += law.memory_size();
        }
        let (rubbing, at) = step.friction;
        let turning: Vec<Lane> =
            (0..rubbing).map(|i| gather(&tape.rows[at + i * n..at + (i + 1) * n], &self.delta)).collect();
        self.predict(linear);
        for (responses, forces) in linear.responses.iter().zip(&laws) {
            for i in 0..responses.rows() {
                scatter(responses.row(i), &forces[i], &mut self.delta);
            }
        }
        for (i, force) in turning.iter().enumerate() {
            scatter(&tape.rows[at + (rubbing + i) * n..at + (rubbing + i + 1) * n], force, &mut self.delta);
        }
        self.contact(&tape.rows[step.contact.1..], step.contact.0, &mut forces);
        self.arrive();
    }

    /// Takes the pressures of m nodes from δ̂.
    #[inline(always)]
    fn contact(&mut self, rows: &[f64], m: usize, forces: &mut [Lane; 8]) {
        if m == 0 {
            return;
        }
        let n = self.eta.len();
        for (ahead, (eta, delta)) in self.ahead.iter_mut().zip(self.eta.iter().zip(&self.delta)) {
            for k in 0..LANES {
                ahead[k] = eta[k] + delta[k];
            }
        }
        let (all, responses) = rows.split_at(m * n);
        // Pressures of at most eight nodes are taken at a time; those of all refer to the same η + δ̂.
        for first in (0..m).step_by(forces.len()) {
            let count = forces.len().min(m - first);
            for i in 0..count {
                forces[i] = gather(&all[(first + i) * n..(first + i + 1) * n], &self.ahead);
            }
            for i in 0..count {
                scatter(&responses[(first + i) * n..(first + i + 1) * n], &forces[i], &mut self.delta);
            }
        }
    }

    /// Deviations of a law's forces; its memory, which begins at `at`, goes on by a step.
    #[inline(always)]
    fn law_forces(&mut self, law: &LocalLaw<'_>, response: &Response, step: f64, at: usize) -> [Lane; MAX_ARGUMENTS] {
        let count = law.rows.rows();
        let (mut u, mut v, mut slopes) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for i in 0..count {
            u[i] = gather(law.rows.row(i), &self.eta);
            slopes[i] = gather(law.rows.row(i), &self.delta);
            slopes[i].iter_mut().for_each(|slope| *slope /= step);
            if law.has_rate() {
                let before = std::mem::replace(&mut self.memory[at + i], slopes[i]);
                for k in 0..LANES {
                    v[i][k] = 1.5 * slopes[i][k] - 0.5 * before[k];
                }
            }
        }
        let mut forces = [[0.0; LANES]; MAX_ARGUMENTS];
        for i in 0..count {
            for j in 0..count {
                for k in 0..LANES {
                    forces[i][k] += response.du[i][j] * u[j][k] + response.dv[i][j] * v[j][k];
                }
            }
        }
        if law.has_memory() {
            let at = at + law.memory_size() - 1;
            for k in 0..LANES {
                let before = u[0][k] - step * slopes[0][k];
                forces[0][k] += response.du_before * before + response.dforce_before * self.memory[at][k];
            }
            self.memory[at] = forces[0];
        }
        forces
    }
}

/// Σ_j row_j x_j.
#[inline(always)]
fn gather(row: &[f64], x: &[Lane]) -> Lane {
    let mut sum = [0.0; LANES];
    for (c, x) in row.iter().zip(x) {
        for k in 0..LANES {
            sum[k] += c * x[k];
        }
    }
    sum
}

/// x_j ← x_j − row_j w.
#[inline(always)]
fn scatter(row: &[f64], w: &Lane, x: &mut [Lane]) {
    for (c, x) in row.iter().zip(x) {
        for k in 0..LANES {
            x[k] -= c * w[k];
        }
    }
}
