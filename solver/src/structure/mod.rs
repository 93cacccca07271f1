//! The structure: matrices, modes, damping, forcing shape, nonlinear elements.
//!
//! A [`Model`] is always valid: it is only built by [`Model::new`] (matrices at hand) or read from a folder, and both
//! check everything. SI units throughout. [`config`] documents the settings of `model.toml`.

mod build;
pub mod config;
mod error;
pub mod laws;
mod layers;
mod matrix_market;
mod parts;
mod structure;

pub use error::{ModelError, Place};
pub use layers::Layers;
pub use parts::{DampingParts, ForcingShape, ModelParts};

use crate::linalg::Matrix;
use crate::structure::laws::LawKind;
use std::path::Path;

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
    /// Reads the folder `dir`: `model.toml` and the matrices that it names.
    pub fn load(dir: &Path) -> Result<Self, ModelError> {
        Self::load_with(dir, &[])
    }

    /// Reads a folder with some settings replaced: pairs of a dotted key and a TOML value as typed on a command line
    /// (`contact.friction`, `0`; `contact.nodes.0.gap`, `1e-4`). A bare word that is not a TOML value is a string.
    pub fn load_with(dir: &Path, overrides: &[(&str, &str)]) -> Result<Self, ModelError> {
        let mut layers = Self::settings(dir)?;
        for (key, typed) in overrides {
            layers.set("override", key, typed)?;
        }
        Self::from_layers(dir, &layers)
    }

    /// Settings of `model.toml` in the folder `dir`, to put others over.
    pub fn settings(dir: &Path) -> Result<Layers, ModelError> {
        Layers::read(&dir.join("model.toml"), "give a folder that holds a model.toml")
    }

    /// Model of the folder `dir` with these settings; those of its own `model.toml` are not read again.
    pub fn from_layers(dir: &Path, layers: &Layers) -> Result<Self, ModelError> {
        layers.check_sections(&config::SECTIONS)?;
        build::build(dir, layers.parsed()?, layers)
    }

    /// Number of dofs n.
    pub fn size(&self) -> usize {
        self.dofs.len()
    }
}
