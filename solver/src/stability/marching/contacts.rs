//! Contact pressures that leave no penetration at the end of a time step.

use super::complementarity::{Complementarity, Unsolvable};
use super::inverse::Inverse;
use super::{dot, modal_rows};
use crate::linalg::{Matrix, axpy};
use crate::structure::{ContactElement, Model};

/// One contact element.
struct Node {
    /// Clearance c, in m.
    gap: f64,
    /// Index of its normal channel; the two tangential channels follow if there is friction.
    normal: usize,
    friction: Option<Sliding>,
}

/// Friction of one node.
struct Sliding {
    /// Coefficient μ.
    coefficient: f64,
    /// Velocity σρΩ of the node at rest relative to the casing, in m/s.
    velocity: f64,
}

/// All contact elements of a model.
pub struct Contacts {
    nodes: Vec<Node>,
    /// BΦ: one row per channel.
    rows: Matrix,
    /// (A_h⁻¹ ΦᵀBᵀ)ᵀ: motion of the next position under a unit force on each channel, one row per channel.
    responses: Matrix,
    /// N A_h⁻¹ Bᵀ: motion of each normal channel under a unit force on each channel.
    compliance: Matrix,
    /// Components of (N + μT)ᵀ on the tangential channels of each node: μ v/|v|.
    tangents: Vec<[f64; 2]>,
    /// Sliding speeds |v|, in m/s.
    speeds: Vec<f64>,
    problem: Complementarity,
    /// Whether anything touches at the end of the last step.
    touching: bool,
}

impl Contacts {
    /// Contacts of `model` at a rotor speed in rad/s.
    pub fn new(model: &Model, inverse: &Inverse, speed: f64) -> Self {
        let (mut nodes, mut channels) = (Vec::new(), Vec::new());
        for ContactElement { element, law, .. } in model.contacts() {
            let friction = law.friction.map(|friction| Sliding {
                coefficient: friction.coefficient,
                velocity: friction.sense * friction.radius * speed,
            });
            nodes.push(Node { gap: law.gap, normal: channels.len(), friction });
            channels.extend(element.channels.iter().cloned());
        }
        let rows = modal_rows(&channels, &model.modes().shapes);
        let mut responses = Matrix::zeros(rows.rows(), rows.cols());
        for i in 0..rows.rows() {
            responses.row_mut(i).copy_from_slice(&inverse.apply(rows.row(i)));
        }
        let compliance =
            Matrix::from_fn(nodes.len(), rows.rows(), |i, j| dot(rows.row(nodes[i].normal), responses.row(j)));
        let problem = Complementarity::new(nodes.len());
        let (tangents, speeds) = (vec![[0.0; 2]; nodes.len()], vec![0.0; nodes.len()]);
        Self { nodes, rows, responses, compliance, tangents, speeds, problem, touching: false }
    }

    /// Whether there is friction at any node.
    pub fn has_friction(&self) -> bool {
        self.nodes.iter().any(|node| node.friction.is_some())
    }

    /// Pressures of the last step, in N.
    pub fn pressures(&self) -> &[f64] {
        &self.problem.solution
    }

    /// Corrects the increment `next` that leads to the predicted position `ahead`. `increment`·`slope` is the velocity
    /// of the step before, which gives the sliding directions: they lag by one step.
    pub fn correct(
        &mut self,
        ahead: &[f64],
        increment: &[f64],
        slope: f64,
        next: &mut [f64],
    ) -> Result<(), Unsolvable> {
        self.touching = false;
        for (penetration, node) in self.problem.offset.iter_mut().zip(&self.nodes) {
            *penetration = dot(self.rows.row(node.normal), ahead) - node.gap;
            self.touching |= *penetration > 0.0;
        }
        if !self.touching {
            self.problem.solution.fill(0.0);
            return Ok(());
        }
        self.find_tangents(increment, slope);
        let n = self.nodes.len();
        for i in 0..n {
            let compliance = self.compliance.row(i);
            for (j, node) in self.nodes.iter().enumerate() {
                let mut entry = compliance[node.normal];
                if node.friction.is_some() {
                    let [a, b] = self.tangents[j];
                    entry += a * compliance[node.normal + 1] + b * compliance[node.normal + 2];
                }
                self.problem.matrix[i * n + j] = entry;
            }
        }
        self.problem.solve()?;
        for (j, node) in self.nodes.iter().enumerate() {
            let pressure = self.problem.solution[j];
            if pressure > 0.0 {
                axpy(-pressure, self.responses.row(node.normal), next);
                if node.friction.is_some() {
                    let [a, b] = self.tangents[j];
                    axpy(-pressure * a, self.responses.row(node.normal + 1), next);
                    axpy(-pressure * b, self.responses.row(node.normal + 2), next);
                }
            }
        }
        Ok(())
    }

    /// Sliding directions times μ. A node that does not slide at all has no direction, and no friction.
    fn find_tangents(&mut self, increment: &[f64], slope: f64) {
        for ((tangent, speed), node) in self.tangents.iter_mut().zip(&mut self.speeds).zip(&self.nodes) {
            if let Some(friction) = &node.friction {
                let a = slope * dot(self.rows.row(node.normal + 1), increment) + friction.velocity;
                let b = slope * dot(self.rows.row(node.normal + 2), increment);
                *speed = (a * a + b * b).sqrt();
                let scale = if *speed > 0.0 { friction.coefficient / *speed } else { 0.0 };
                *tangent = [scale * a, scale * b];
            }
        }
    }

    /// The nodes that touch at the end of the last step.
    pub fn touching(&self) -> &[usize] {
        if self.touching { self.problem.active() } else { &[] }
    }

    /// Work that the pressures of the last step take from the structure, in J: `increment` led to the step, `next` leads on.
    pub fn work(&self, increment: &[f64], next: &[f64]) -> f64 {
        let along = |node: usize| {
            let row = self.rows.row(self.nodes[node].normal);
            0.5 * self.problem.solution[node] * (dot(row, increment) + dot(row, next))
        };
        self.touching().iter().map(|&node| along(node)).sum()
    }

    /// Rows that linearise the contacts of the last step, see [`Tape`](super::tape::Tape): P = W⁻¹N and G = (A_h⁻¹Bᵀ)ᵀ of the
    /// nodes that touch, n numbers each, all of P first.
    pub fn linearise(&mut self, out: &mut Vec<f64>) {
        let (m, n) = (self.problem.active().len(), self.rows.cols());
        let at = out.len();
        // Column after column, as the factors of the last solution want them.
        let mut columns = vec![0.0; m * n];
        for (i, &node) in self.problem.active().iter().enumerate() {
            let row = self.rows.row(self.nodes[node].normal);
            row.iter().enumerate().for_each(|(j, &entry)| columns[j * m + i] = entry);
        }
        self.problem.solve_again(&mut columns);
        out.extend((0..m).flat_map(|i| columns.iter().skip(i).step_by(m)));
        debug_assert_eq!(out.len(), at + m * n);
        for &node in self.problem.active() {
            let (normal, [a, b]) = (self.nodes[node].normal, self.tangents[node]);
            let at = out.len();
            out.extend(self.responses.row(normal));
            if self.nodes[node].friction.is_some() {
                axpy(a, self.responses.row(normal + 1), &mut out[at..]);
                axpy(b, self.responses.row(normal + 2), &mut out[at..]);
            }
        }
    }

    /// Rows that linearise the turning of the friction of the last step: μλ/(|v|h) τ⊥ᵀT and (A_h⁻¹Tᵀτ⊥)ᵀ of the nodes that
    /// rub, n numbers each, all of the former first; the number of these nodes.
    ///
    /// A change of velocity turns the friction only as far as it is perpendicular to the sliding: I − ττᵀ = τ⊥τ⊥ᵀ.
    pub fn linearise_friction(&self, slope: f64, out: &mut Vec<f64>) -> usize {
        let rubs = |&&node: &&usize| self.nodes[node].friction.is_some() && self.speeds[node] > 0.0;
        let rubbing: Vec<usize> = self.touching().iter().filter(rubs).copied().collect();
        for (matrix, is_response) in [(&self.rows, false), (&self.responses, true)] {
            for &node in &rubbing {
                // τ times μ; so that both factors together have μ once.
                let (normal, [a, b]) = (self.nodes[node].normal, self.tangents[node]);
                let length = a.hypot(b);
                let rate = self.problem.solution[node] * slope / self.speeds[node];
                let scale = if is_response { 1.0 / length } else { rate };
                let pair = matrix.row(normal + 1).iter().zip(matrix.row(normal + 2));
                out.extend(pair.map(|(theta, z)| scale * (a * z - b * theta)));
            }
        }
        rubbing.len()
    }
}
