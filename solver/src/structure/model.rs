//! The model: what all of the numerics ask.

use super::laws::LawKind;
use crate::linalg::Matrix;

/// A linear structure with nonlinear elements and one forcing shape, n dofs. It is always valid.
#[derive(Debug, Clone)]
pub struct Model {
    pub(super) name: String,
    pub(super) dofs: Vec<String>,
    pub(super) mass: Matrix,
    pub(super) stiffness: Matrix,
    pub(super) modes: Modes,
    pub(super) damping: Damping,
    pub(super) forcing: Forcing,
    pub(super) elements: Vec<Element>,
    pub(super) monitors: Vec<usize>,
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
    /// Number of dofs n, 1 or more.
    pub fn size(&self) -> usize {
        self.dofs.len()
    }

    /// Name shown to people.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Names of the n dofs.
    pub fn dofs(&self) -> &[String] {
        &self.dofs
    }

    /// Mass matrix M, n × n, kg.
    pub fn mass(&self) -> &Matrix {
        &self.mass
    }

    /// Stiffness matrix K, n × n, N/m.
    pub fn stiffness(&self) -> &Matrix {
        &self.stiffness
    }

    /// Linear modes of (K, M).
    pub fn modes(&self) -> &Modes {
        &self.modes
    }

    /// Damping in modal coordinates.
    pub fn damping(&self) -> &Damping {
        &self.damping
    }

    /// Forcing shape and harmonic.
    pub fn forcing(&self) -> &Forcing {
        &self.forcing
    }

    /// Nonlinear elements.
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// Dofs whose amplitude is reported, one or more; the first one is the one that plots and bounds use.
    pub fn monitors(&self) -> &[usize] {
        &self.monitors
    }
}
