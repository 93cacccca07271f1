//! Why a command fails, in one message.

use crate::store::StoreError;
use crate::study::StudyError;
use protocol::session::{RequestError, SessionError};
use solver::backbone::BackboneError;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Why a command fails.
#[derive(Debug, Error)]
pub enum Error {
    /// The study is not one.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The run cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// No session on the bus.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// There is no backbone.
    #[error("{0}")]
    Backbone(#[from] BackboneError),
    /// A setting and the backbone contradict each other.
    #[error("{0}")]
    Settings(#[from] solver::settings::SettingsError),
    /// The bus does not answer.
    #[error("{what}: {source}")]
    Request {
        /// What was asked.
        what: String,
        /// Why not.
        source: RequestError,
    },
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The files of a run cannot be written.
    #[error(transparent)]
    Export(#[from] crate::export::ExportError),
    /// Anything else, in words.
    #[error("{0}")]
    Other(String),
}

impl Error {
    /// An input or output error at a path.
    pub fn io(path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        |source| Self::Io { path, source }
    }
}
