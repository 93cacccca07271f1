//! Why a command fails, in one message, and its exit code.

use crate::exit;
use crate::study::StudyError;
use protocol::credentials::CredentialsError;
use protocol::follow::FollowError;
use protocol::session::{RequestError, SessionError};
use results::store::StoreError;
use solver::response::backbone::BackboneError;
use solver::structure::ModelError;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Why a command fails.
#[derive(Debug, Error)]
pub enum Error {
    /// The study is not one.
    #[error("{_0}{}", written(_0))]
    Study(#[from] StudyError),
    /// The run cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// No session on the bus.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// What should protect a run cannot be read.
    #[error(transparent)]
    Credentials(#[from] CredentialsError),
    /// There is no backbone.
    #[error("{0}")]
    Backbone(#[from] BackboneError),
    /// There can be none, in words.
    #[error("{0}")]
    NoBackbone(String),
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
    /// A run cannot be followed.
    #[error(transparent)]
    Follow(#[from] FollowError),
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Results cannot be shown or written.
    #[error(transparent)]
    Results(#[from] results::error::Error),
    /// An option has a value that makes no sense.
    #[error("{0}")]
    Usage(String),
    /// Anything else, in words.
    #[error("{0}")]
    Other(String),
}

/// How a key is written, after a value of a wrong type.
fn written(error: &StudyError) -> String {
    let StudyError::Refused(ModelError::Type { place, .. }) = error else { return String::new() };
    crate::reference::example_of(&place.key).map_or_else(String::new, |example| format!("; for example {example}"))
}

impl From<results::export::ExportError> for Error {
    fn from(error: results::export::ExportError) -> Self {
        Self::Results(error.into())
    }
}

impl Error {
    /// Exit code: wrong usage is told from everything else. A wrong value in the file of a study is not one of usage.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_)
            | Self::Credentials(_)
            | Self::Session(SessionError::Endpoint { .. } | SessionError::Encryption { .. })
            | Self::Results(results::error::Error::Usage(_)) => exit::USAGE,
            Self::Study(error) if error.is_typed() => exit::USAGE,
            _ => exit::ERROR,
        }
    }

    /// Whether the same study would fail in the same way again, before anything of it is known.
    pub fn is_of_study(&self) -> bool {
        matches!(self, Self::Backbone(_) | Self::NoBackbone(_) | Self::Settings(_))
    }

    /// An input or output error at a path.
    pub fn io(path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        |source| Self::Io { path, source }
    }
}
