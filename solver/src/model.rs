//! The structure: matrices, modes, damping, forcing shape, nonlinear elements.
//!
//! A [`Model`] is always valid: it is only built by [`Model::new`] (matrices at hand) or read from a folder, and both
//! check everything. SI units throughout.

use crate::laws::LawKind;
use crate::linalg::Matrix;

/// A linear structure with nonlinear elements and one forcing shape.
#[derive(Debug, Clone)]
pub struct Model {
    /// Name shown to people.
    pub name: String,
    /// Names of the n dofs.
    pub dofs: Vec<String>,
    /// Mass matrix M, n × n, kg.
    pub mass: Matrix,
    /// Stiffness matrix K, n × n, N/m.
    pub stiffness: Matrix,
    /// Linear modes of (K, M).
    pub modes: Modes,
    /// Damping in modal coordinates.
    pub damping: Damping,
    /// Forcing shape and harmonic.
    pub forcing: Forcing,
    /// Nonlinear elements.
    pub elements: Vec<Element>,
    /// Dofs whose amplitude is reported; the first one is the one that plots and bounds use.
    pub monitors: Vec<usize>,
}

/// Undamped linear modes.
#[derive(Debug, Clone)]
pub struct Modes {
    /// Eigenfrequencies ω_j, ascending, rad/s.
    pub frequencies: Vec<f64>,
    /// Mass-normalised mode shapes Φ, n × n, one column per mode.
    pub shapes: Matrix,
}

/// Damping in modal coordinates, Ĉ = Φᵀ C Φ.
#[derive(Debug, Clone)]
pub enum Damping {
    /// Diagonal: 2 ξ_j ω_j per mode, 1/s.
    Modal(Vec<f64>),
    /// Full n × n matrix, 1/s.
    Full(Matrix),
}

/// External force f(t) = A s cos(mωt).
#[derive(Debug, Clone)]
pub struct Forcing {
    /// Shape s, n entries, N per unit of the dimensionless amplitude A.
    pub shape: Vec<f64>,
    /// Harmonic m of the response that the forcing acts on, ≥ 1.
    pub harmonic: usize,
}

/// A nonlinear element: a law acting on relative displacements.
#[derive(Debug, Clone)]
pub struct Element {
    /// Name shown to people (a contact node, say).
    pub name: String,
    /// One relative displacement bᵀx per argument of the law: (dof, coefficient) pairs.
    /// A force on an argument acts on the structure along the same b.
    pub channels: Vec<Vec<(usize, f64)>>,
    /// The law.
    pub law: LawKind,
}

impl Model {
    /// Number of dofs n.
    pub fn size(&self) -> usize {
        self.dofs.len()
    }
}
