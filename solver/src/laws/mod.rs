//! Nonlinear laws: pure functions of one instant and, for laws with memory, the one before.
//!
//! A law sees up to three *arguments* (relative displacements; for rigid contact the first one is the predicted contact
//! pressure of the DLFT, in newtons) and their time derivatives, and returns as many forces, counted on the left-hand
//! side of the balance D X + F = E, with exact derivatives. Parameters are plain serde structs; the choice of law is
//! made once per element, outside the sample loop.

mod contact;

pub use contact::{Contact, Friction};

use serde::{Deserialize, Serialize};

/// Largest number of arguments of a law: normal and two tangential directions.
pub const MAX_ARGUMENTS: usize = 3;

/// What a law sees of one instant.
#[derive(Debug, Clone, Copy, Default)]
pub struct Instant {
    /// Arguments: relative displacements in m (contact: argument 0 is the predicted pressure in N).
    pub u: [f64; MAX_ARGUMENTS],
    /// Time derivatives of the arguments, in m/s.
    pub v: [f64; MAX_ARGUMENTS],
    /// Rotor speed Ω in rad/s: the forcing frequency.
    pub speed: f64,
}

/// What a law with memory sees of the instant before. Laws without memory ignore it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Before {
    /// Argument 0 one sample earlier, in m.
    pub u: f64,
    /// Force 0 one sample earlier, in N.
    pub force: f64,
}

/// Forces and their exact derivatives at one instant.
#[derive(Debug, Clone, Copy, Default)]
pub struct Response {
    /// Forces on the left-hand side of the balance, in N.
    pub force: [f64; MAX_ARGUMENTS],
    /// ∂force[i]/∂u[j].
    pub du: [[f64; MAX_ARGUMENTS]; MAX_ARGUMENTS],
    /// ∂force[i]/∂v[j].
    pub dv: [[f64; MAX_ARGUMENTS]; MAX_ARGUMENTS],
    /// ∂force[i]/∂speed.
    pub dspeed: [f64; MAX_ARGUMENTS],
    /// ∂force[0]/∂(argument 0 one sample earlier); laws with memory only.
    pub du_before: f64,
    /// ∂force[0]/∂(force 0 one sample earlier); laws with memory only.
    pub dforce_before: f64,
}

/// Which derivatives of a law can differ from zero: the others are never transformed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Pattern {
    /// Entries of [`Response::du`].
    pub du: [[bool; MAX_ARGUMENTS]; MAX_ARGUMENTS],
    /// Entries of [`Response::dv`].
    pub dv: [[bool; MAX_ARGUMENTS]; MAX_ARGUMENTS],
}

impl Pattern {
    /// Pattern of a scalar law.
    pub fn scalar(du: bool, dv: bool) -> Self {
        let mut pattern = Self::default();
        pattern.du[0][0] = du;
        pattern.dv[0][0] = dv;
        pattern
    }
}

/// A nonlinear law.
pub trait Law {
    /// Number of arguments (and of forces), 1 to [`MAX_ARGUMENTS`].
    fn arguments(&self) -> usize;
    /// Derivatives that can differ from zero.
    fn pattern(&self) -> Pattern;
    /// Whether the force depends on the instant before.
    fn has_memory(&self) -> bool {
        false
    }
    /// Whether the forces do not change when all velocities and the rotor speed are multiplied by one factor: then they
    /// have no explicit ω-derivative.
    fn is_homogeneous_in_rate(&self) -> bool {
        false
    }
    /// Forces and derivatives at one instant.
    fn respond(&self, now: &Instant, before: &Before) -> Response;
}

/// Parameters of every law, as they stand in files and messages.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LawKind {
    /// Rigid unilateral contact, with or without permanent-sliding friction.
    Contact(Contact),
}

impl LawKind {
    /// Number of arguments of the law.
    pub fn arguments(&self) -> usize {
        match self {
            LawKind::Contact(law) => law.arguments(),
        }
    }
}
