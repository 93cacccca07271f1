//! Why results cannot be shown or written, in one message.

use crate::export::ExportError;
use crate::store::StoreError;
use thiserror::Error;

/// Why results cannot be shown or written.
#[derive(Debug, Error)]
pub enum Error {
    /// The run cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A file cannot be written.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// What was asked for makes no sense, or not for this run.
    #[error("{0}")]
    Usage(String),
    /// There is nothing to show, or it cannot be shown.
    #[error("{0}")]
    Other(String),
}
