//! What a model is made of: matrices at hand.

use super::Element;
use crate::linalg::Matrix;

/// What [`Model::new`](super::Model::new) needs. SI units.
#[derive(Debug, Clone)]
pub struct ModelParts {
    /// Name shown to people.
    pub name: String,
    /// Names of the n dofs; empty: `x1` … `xn`.
    pub dofs: Vec<String>,
    /// Mass matrix, n × n, symmetric positive definite, kg.
    pub mass: Matrix,
    /// Stiffness matrix, n × n, symmetric positive semi-definite, N/m.
    pub stiffness: Matrix,
    /// Damping.
    pub damping: DampingParts,
    /// Forcing shape.
    pub shape: ForcingShape,
    /// Harmonic of the response that is forced, ≥ 1.
    pub harmonic: usize,
    /// Nonlinear elements.
    pub elements: Vec<Element>,
    /// Reported dofs, counted from 0; empty: the first dof.
    pub monitors: Vec<usize>,
}

/// The ways to give damping.
#[derive(Debug, Clone)]
pub enum DampingParts {
    /// Modal damping ratios ξ_j, 0 ≤ ξ < 1, one per mode: C = M Φ diag(2 ξ_j ω_j) Φᵀ M.
    Ratios(Vec<f64>),
    /// C = mass · M + stiffness · K.
    Rayleigh {
        /// Factor of M, 1/s, ≥ 0.
        mass: f64,
        /// Factor of K, s, ≥ 0.
        stiffness: f64,
    },
    /// Symmetric n × n matrix C, N·s/m.
    Matrix(Matrix),
}

/// The ways to give the forcing shape s, in N per unit of amplitude.
#[derive(Debug, Clone)]
pub enum ForcingShape {
    /// s = M Φ_j: forces mode j alone; j counts from 1.
    Mode(usize),
    /// s = Φ_j; j counts from 1.
    ModeShape(usize),
    /// The n entries of s.
    Vector(Vec<f64>),
}
