//! Models from folders: settings in layers, Matrix Market files. [`config`] documents the settings of `model.toml`.

mod build;
pub mod config;
mod explain;
mod keys;
mod layers;
mod matrix_market;

pub use layers::Layers;

use crate::structure::{Model, ModelError};
use std::path::Path;

/// The file of a model, in its folder.
const MODEL: &str = "model.toml";

/// Reads the folder `dir`: `model.toml` and the matrices that it names.
///
/// # Errors
/// Files that cannot be read, settings that are unknown or out of range, matrices that make no structure; every message
/// names file, key, value and what would be right.
pub fn load(dir: &Path) -> Result<Model, ModelError> {
    load_with(dir, &[])
}

/// Reads a folder with some settings replaced: pairs of a dotted key and a TOML value as typed on a command line
/// (`contact.friction`, `0`; `contact.nodes.0.gap`, `1e-4`). A bare word that is not a TOML value is a string.
///
/// # Errors
/// Those of [`load`], and keys and values that cannot be applied.
pub fn load_with(dir: &Path, overrides: &[(&str, &str)]) -> Result<Model, ModelError> {
    let mut layers = settings(dir)?;
    for (key, typed) in overrides {
        layers.set("override", key, typed)?;
    }
    from_layers(dir, &layers)
}

/// Settings of `model.toml` in the folder `dir`, to put others over.
///
/// # Errors
/// A file that cannot be read or is not TOML.
pub fn settings(dir: &Path) -> Result<Layers, ModelError> {
    Layers::read(&dir.join(MODEL), "give a folder that holds a model.toml")
}

/// Model of the folder `dir` with these settings; those of its own `model.toml` are not read again.
///
/// # Errors
/// Those of [`load`].
pub fn from_layers(dir: &Path, layers: &Layers) -> Result<Model, ModelError> {
    layers.check_sections(&config::SECTIONS)?;
    let config = layers.parsed()?;
    layers.check_laws()?;
    build::build(dir, config, layers)
}
