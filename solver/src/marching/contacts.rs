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

impl Sliding {
    /// Sliding speed of a node with friction and its direction times μ. A node that does not slide at all has no direction, and no
    /// friction.
    #[inline(always)]
    fn directed(node: &Node, rows: &Matrix, increment: &[f64], slope: f64) -> Option<(f64, [f64; 2])> {
        let friction = node.friction.as_ref()?;
        let a = slope * dot(rows.row(node.normal + 1), increment) + friction.velocity;
        let b = slope * dot(rows.row(node.normal + 2), increment);
        let speed = (a * a + b * b).sqrt();
        let scale = if speed > 0.0 { friction.coefficient / speed } else { 0.0 };
        Some((speed, [scale * a, scale * b]))
    }
}

/// All contact elements of a model.
pub struct Contacts {
    nodes: Vec<Node>,
    /// BΦ: one row per channel.
    rows: Matrix,
    /// (A_h⁻¹ ΦᵀBᵀ)ᵀ: motion of the next position under a unit force on each channel, one row per channel.
    responses: Matrix,
    /// B A_h⁻¹ Nᵀ: motion of the normal channels under a unit force on each channel, one row per channel.
    compliance: Matrix,
    /// Components of (N + μT)ᵀ on the tangential channels of each node: μ v/|v|.
    tangents: Vec<[f64; 2]>,
    /// Sliding speeds |v|, in m/s.
    speeds: Vec<f64>,
    problem: Complementarity,
    /// Whether anything touches at the end of the last step.
    touching: bool,
    /// Lengths ‖NΦ‖ of the normal rows.
    lengths: Vec<f64>,
    /// Way in modal coordinates that no node can reach its stop on, kg^½·m: none moves farther than ‖NΦ‖ times the way.
    reserve: f64,
}

/// Ways are taken to be longer by this share, far more than rounding.
const LONGER: f64 = 1e-9;

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
            Matrix::from_fn(rows.rows(), nodes.len(), |i, j| dot(rows.row(nodes[j].normal), responses.row(i)));
        let problem = Complementarity::new(nodes.len());
        let (tangents, speeds) = (vec![[0.0; 2]; nodes.len()], vec![0.0; nodes.len()]);
        let length = |node: &Node| dot(rows.row(node.normal), rows.row(node.normal)).sqrt();
        let lengths = nodes.iter().map(length).collect();
        let (touching, reserve) = (false, 0.0);
        Self { nodes, rows, responses, compliance, tangents, speeds, problem, touching, lengths, reserve }
    }

    /// Whether there is friction at any node.
    pub fn has_friction(&self) -> bool {
        self.nodes.iter().any(|node| node.friction.is_some())
    }

    /// Pressures of the last step, in N.
    pub fn pressures(&self) -> &[f64] {
        &self.problem.solution
    }

    /// The next position may be anywhere: what is known of how far the stops are is of another motion.
    pub fn forget(&mut self) {
        self.reserve = 0.0;
    }

    /// Whether anything touches at the predicted position `ahead`, to which the increment `next` leads from the last one: where it
    /// does, [`correct`](Self::correct) has the pressures.
    #[inline(always)]
    pub fn touches(&mut self, ahead: &[f64], next: &[f64]) -> bool {
        if self.nodes.is_empty() {
            return false;
        }
        if self.reserve > 0.0 {
            self.reserve -= (1.0 + LONGER) * dot(next, next).sqrt();
            if self.reserve > 0.0 {
                return false;
            }
        }
        let was_touching = std::mem::replace(&mut self.touching, false);
        self.reserve = f64::INFINITY;
        for (i, (penetration, node)) in self.problem.offset.iter_mut().zip(&self.nodes).enumerate() {
            *penetration = dot(self.rows.row(node.normal), ahead) - node.gap;
            self.touching |= *penetration > 0.0;
            self.reserve = self.reserve.min(-*penetration / self.lengths[i]);
        }
        if was_touching && !self.touching {
            self.problem.solution.fill(0.0);
        }
        self.touching
    }

    /// Corrects the increment `next` that leads to a position at which something touches. `increment`·`slope` is the velocity
    /// of the step before, which gives the sliding directions: they lag by one step.
    #[inline(always)]
    pub fn correct(&mut self, increment: &[f64], slope: f64, next: &mut [f64]) -> Result<(), Unsolvable> {
        self.reserve = 0.0;
        let n = self.nodes.len();
        self.problem.solve(|j, matrix| {
            let node = &self.nodes[j];
            let sliding = Sliding::directed(node, &self.rows, increment, slope);
            let compliance = |channel: usize| self.compliance.row(node.normal + channel);
            matrix.iter_mut().skip(j).step_by(n).zip(compliance(0)).for_each(|(entry, c)| *entry = *c);
            if let Some((speed, [a, b])) = sliding {
                (self.speeds[j], self.tangents[j]) = (speed, [a, b]);
                let entries = matrix.iter_mut().skip(j).step_by(n);
                entries
                    .zip(compliance(1).iter().zip(compliance(2)))
                    .for_each(|(entry, (c, d))| *entry += a * c + b * d);
            }
        })?;
        for &j in self.problem.active() {
            let (node, pressure) = (&self.nodes[j], self.problem.solution[j]);
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

    /// The nodes that touch at the end of the last step.
    pub fn touching(&self) -> &[usize] {
        if self.touching { self.problem.active() } else { &[] }
    }

    /// Work that the pressures of the last step take from the structure, in J: `increment` led to the step, `next` leads on.
    #[inline(always)]
    pub fn work(&self, increment: &[f64], next: &[f64]) -> f64 {
        let along = |node: usize| {
            let row = self.rows.row(self.nodes[node].normal);
            0.5 * self.problem.solution[node] * (dot(row, increment) + dot(row, next))
        };
        self.touching().iter().map(|&node| along(node)).sum()
    }

    /// Rows that linearise the contacts of the last step, see [`Tape`](super::tape::Tape): P = W⁻¹N and G = (A_h⁻¹Bᵀ)ᵀ of the
    /// nodes that touch, n numbers each, all of P first.
    #[inline(always)]
    pub fn linearise(&mut self, out: &mut Vec<f64>) {
        let (at, n) = (out.len(), self.rows.cols());
        for &node in self.problem.active() {
            out.extend(self.rows.row(self.nodes[node].normal));
        }
        self.problem.solve_again(&mut out[at..], n);
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
    #[inline(always)]
    pub fn linearise_friction(&self, slope: f64, out: &mut Vec<f64>) -> usize {
        let rubs = |&&node: &&usize| self.nodes[node].friction.is_some() && self.speeds[node] > 0.0;
        let rubbing: Vec<usize> = self.touching().iter().filter(rubs).copied().collect();
        for (matrix, is_response) in [(&self.rows, false), (&self.responses, true)] {
            for &node in &rubbing {
                // τ times μ; so that both factors together have μ once.
                let (normal, [a, b]) = (self.nodes[node].normal, self.tangents[node]);
                let length = (a * a + b * b).sqrt();
                let rate = self.problem.solution[node] * slope / self.speeds[node];
                let scale = if is_response { 1.0 / length } else { rate };
                let pair = matrix.row(normal + 1).iter().zip(matrix.row(normal + 2));
                out.extend(pair.map(|(theta, z)| scale * (a * z - b * theta)));
            }
        }
        rubbing.len()
    }
}
