//! Why a study was refused.

use solver::structure::ModelError;
use std::path::PathBuf;
use thiserror::Error;

/// Why a study was refused. Every message names the file or option, the key, the value and a remedy.
#[derive(Debug, Error)]
pub enum StudyError {
    /// There is no study at this path.
    #[error("{}: {problem}", path.display())]
    NoStudy {
        /// The path as given.
        path: PathBuf,
        /// What is there instead, and what to do.
        problem: String,
    },
    /// A setting, or the model, is refused.
    #[error(transparent)]
    Refused(#[from] ModelError),
    /// The settings cannot be written as TOML.
    #[error("{}: the settings cannot be written as TOML: {source}", file.display())]
    Unwritable {
        /// The study file.
        file: PathBuf,
        /// What the writer says.
        source: toml::ser::Error,
    },
}

impl StudyError {
    /// Whether what is refused was typed after an option, and does not stand in a file.
    pub fn is_typed(&self) -> bool {
        let Self::Refused(error) = self else { return false };
        error.place().and_then(|place| place.set_by.as_deref()).is_some_and(|by| by.starts_with("--"))
    }
}
