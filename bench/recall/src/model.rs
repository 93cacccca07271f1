//! Models as `model.toml` says them: what the truth is computed of, and what the product is given, are one document.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A model, key by key as in `model.toml`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// Shown to people.
    pub name: String,
    /// Dofs whose amplitudes are reported: one, the driven one.
    pub monitors: Vec<String>,
    /// Mass and stiffness.
    pub matrices: Matrices,
    /// Modal damping.
    pub damping: Damping,
    /// Shape and harmonic of the forcing.
    pub forcing: Forcing,
    /// Nonlinear elements.
    pub laws: Vec<Element>,
}

/// Matrices by rows, `n × n`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Matrices {
    /// kg, diagonal.
    pub mass: Vec<Vec<f64>>,
    /// N/m, symmetric.
    pub stiffness: Vec<Vec<f64>>,
}

/// Modal damping.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Damping {
    /// Ratio of every mode.
    pub default_ratio: f64,
}

/// Forcing `A s cos(mωt)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Forcing {
    /// s.
    pub shape: Shape,
    /// m.
    pub harmonic: usize,
}

/// Shape of the forcing, N per unit of A.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// By dof.
    pub dofs: BTreeMap<String, f64>,
}

/// A nonlinear law on a sum of displacements.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Element {
    /// Shown to people.
    pub name: String,
    /// The sum: a coefficient for every dof in it.
    pub coefficients: BTreeMap<String, f64>,
    /// The law.
    pub law: Law,
}

/// Force of an element, on the left-hand side of the equations of motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Law {
    /// f = Σ c u^p.
    PolynomialSpring {
        /// Its terms.
        terms: Vec<Term>,
    },
    /// f = Σ c v^p, v the velocity.
    PolynomialDamper {
        /// Its terms.
        terms: Vec<Term>,
    },
    /// f = k max(0, u − g).
    PenaltySpring {
        /// k, N/m.
        stiffness: f64,
        /// g, m.
        gap: f64,
    },
}

/// One term c z^p of a polynomial.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Term {
    /// p.
    pub power: i32,
    /// c.
    pub coefficient: f64,
}

/// Name of dof `index`, from 0: what Isola calls it where the model does not say.
pub fn dof(index: usize) -> String {
    format!("x{}", index + 1)
}

impl Law {
    /// Force, and its derivatives by displacement and velocity.
    pub fn respond(&self, u: f64, v: f64) -> (f64, f64, f64) {
        match self {
            Self::PolynomialSpring { terms } => {
                let (force, slope) = polynomial(terms, u);
                (force, slope, 0.0)
            }
            Self::PolynomialDamper { terms } => {
                let (force, slope) = polynomial(terms, v);
                (force, 0.0, slope)
            }
            Self::PenaltySpring { stiffness, gap } if u > *gap => (stiffness * (u - gap), *stiffness, 0.0),
            Self::PenaltySpring { .. } => (0.0, 0.0, 0.0),
        }
    }

    /// The displacement beyond which the law acts, if it is one-sided.
    pub fn gap(&self) -> Option<f64> {
        match self {
            Self::PenaltySpring { gap, .. } => Some(*gap),
            _ => None,
        }
    }

    /// Whether the force changes its sign with displacement and velocity.
    pub fn is_odd(&self) -> bool {
        match self {
            Self::PolynomialSpring { terms } | Self::PolynomialDamper { terms } => {
                terms.iter().all(|term| term.power % 2 == 1)
            }
            Self::PenaltySpring { .. } => false,
        }
    }
}

/// Value and derivative of a polynomial.
fn polynomial(terms: &[Term], z: f64) -> (f64, f64) {
    terms.iter().fold((0.0, 0.0), |(value, slope), term| {
        let below = term.coefficient * z.powi(term.power - 1);
        (value + below * z, slope + f64::from(term.power) * below)
    })
}
