//! The structure: matrices, modes, damping, forcing shape, nonlinear elements.
//!
//! A [`Model`] is always valid: it is only built by [`Model::new`] (matrices at hand) or read from a folder, and both
//! check everything. SI units throughout. [`config`] documents the settings of `model.toml`.

mod assembly;
mod build;
pub mod config;
mod error;
pub mod laws;
mod layers;
mod matrix_market;
mod model;
mod parts;
mod restore;

pub use error::{ModelError, Place};
pub use layers::Layers;
pub use model::{ContactElement, Damping, Element, Forcing, Model, Modes};
pub use parts::{DampingParts, ForcingShape, ModelParts};
pub use restore::ModelData;

use std::path::Path;

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
}
