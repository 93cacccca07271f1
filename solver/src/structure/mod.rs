//! The structure: matrices, modes, damping, forcing shape, nonlinear elements.
//!
//! A [`Model`] is always valid: it is built by a [`ModelBuilder`], read from a folder ([`crate::files`]) or restored from
//! [`ModelData`], and all three check what they are given (of restored models, whose modes
//! come with them: sizes, numbers and laws, but not that modes belong to matrices). SI units throughout.

pub(crate) mod assembly;
mod builder;
mod damped;
mod error;
pub mod laws;
mod model;
mod restore;
mod symmetry;
pub(crate) mod validation;

pub use builder::DEFAULT_RATIO;
pub use builder::{Channel, Dof, ModelBuilder};
pub use error::{ModelError, Place};
pub use model::{ContactElement, DampedMode, Damping, Element, Forcing, Model, Modes};
pub use restore::ModelData;
pub use symmetry::Exchange;
