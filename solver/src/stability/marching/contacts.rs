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
    problem: Complementarity,
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
        let tangents = vec![[0.0; 2]; nodes.len()];
        Self { nodes, rows, responses, compliance, tangents, problem }
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
        let mut touching = false;
        for (penetration, node) in self.problem.offset.iter_mut().zip(&self.nodes) {
            *penetration = dot(self.rows.row(node.normal), ahead) - node.gap;
            touching |= *penetration > 0.0;
        }
        if !touching {
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
        for (tangent, node) in self.tangents.iter_mut().zip(&self.nodes) {
            if let Some(friction) = &node.friction {
                let a = slope * dot(self.rows.row(node.normal + 1), increment) + friction.velocity;
                let b = slope * dot(self.rows.row(node.normal + 2), increment);
                let speed = (a * a + b * b).sqrt();
                let scale = if speed > 0.0 { friction.coefficient / speed } else { 0.0 };
                *tangent = [scale * a, scale * b];
            }
        }
    }
}
