//! What people take away from a run: CSV files.

mod files;
mod table;
#[cfg(test)]
mod tests;

pub use files::csv;

use crate::store::StoreError;
use std::path::PathBuf;
use thiserror::Error;

/// Why an export failed.
#[derive(Debug, Error)]
pub enum ExportError {
    /// The run cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A file cannot be written.
    #[error("{}: {source}; check that there is space and that you may write there", .file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}
