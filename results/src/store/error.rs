//! What can go wrong with a run on disk.

use super::holder::Holder;
use protocol::array::ArrayError;
use rusqlite::{Error, ErrorCode, ffi};
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why the store of a run cannot be used. Every message names the file and what to do.
#[derive(Debug, Error)]
pub enum StoreError {
    /// No run there.
    #[error("{}: there is no such file; name the folder of a run, which holds `run.sqlite`", .file.display())]
    Missing {
        /// The file looked for.
        file: PathBuf,
    },
    /// A file where a folder is to be.
    #[error("{}: this is a file, not a folder; name another folder for the run", .file.display())]
    NotAFolder {
        /// The file.
        file: PathBuf,
    },
    /// A run there already.
    #[error(
        "{0}: this folder holds a run already; `isola resume {0}` goes on with it, or name another folder",
        .dir.display()
    )]
    Exists {
        /// Folder.
        dir: PathBuf,
    },
    /// Another process has it.
    #[error(
        "{}: another coordinator{} uses this run; stop it or wait until it ends{}", .dir.display(), of_process(.holder),
        if .holder.as_ref().is_some_and(|holder| !holder.is_here) { " (if that machine crashed, a minute is enough)" } else { "" }
    )]
    Locked {
        /// Folder.
        dir: PathBuf,
        /// Its process, if it can be told.
        holder: Option<Holder>,
    },
    /// Something else.
    #[error("{}: this is not a run of Isola ({found}); name the folder of a run", .file.display())]
    Foreign {
        /// The file.
        file: PathBuf,
        /// What it is.
        found: String,
    },
    /// From a program that knows more.
    #[error(
        "{}: written in version {found} of the format, this program knows version {known}; use a newer `isola`",
        .file.display()
    )]
    Newer {
        /// The file.
        file: PathBuf,
        /// Version of its format.
        found: i64,
        /// Latest version this program knows.
        known: i64,
    },
    /// From a program that knew less.
    #[error(
        "{}: written in version {found} of the format, this program goes on with runs of version {known} only, whose tasks \
         and tables are others; `report`, `plot` and `export` read it, `isola sweep` computes the study again",
        .file.display()
    )]
    Older {
        /// The file.
        file: PathBuf,
        /// Version of its format.
        found: i64,
        /// The version this program goes on with.
        known: i64,
    },
    /// Damaged.
    #[error(
        "{}: the file is damaged ({detail}); restore a copy, or start the study again in another folder",
        .file.display()
    )]
    Corrupt {
        /// The file.
        file: PathBuf,
        /// Where and how.
        detail: String,
    },
    /// No room. Nothing of what was to be written is stored, everything before is.
    #[error("{}: cannot be written ({detail}); free space, then `isola resume {}`", .file.display(), folder(.file))]
    Full {
        /// The file.
        file: PathBuf,
        /// What SQLite says.
        detail: String,
    },
    /// A branch or a backbone whose arrays do not fit the model.
    #[error("{}: not stored: {source}; the worker runs another model or another version", .file.display())]
    Array {
        /// The file.
        file: PathBuf,
        /// What does not fit.
        source: ArrayError,
    },
    /// The file system refuses.
    #[error("{}: {source}; check that the folder exists and that you may write there", .file.display())]
    Io {
        /// The file or folder.
        file: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// SQLite refuses.
    #[error(
        "{}: {source}; check that you may read the folder and that nothing else changes the file",
        .file.display()
    )]
    Sqlite {
        /// The file.
        file: PathBuf,
        /// Why.
        source: Error,
    },
}

impl StoreError {
    /// Whether another program holds the file, so that trying again helps.
    pub fn is_busy(&self) -> bool {
        let Self::Sqlite { source, .. } = self else { return false };
        matches!(source.sqlite_error_code(), Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked))
    }
}

fn of_process(holder: &Option<Holder>) -> String {
    match holder {
        Some(Holder { pid, is_here: true, .. }) => format!(" (process {pid})"),
        Some(Holder { pid, host, .. }) => format!(" (process {pid} on {host})"),
        None => String::new(),
    }
}

fn folder(file: &Path) -> String {
    file.parent().unwrap_or(file).display().to_string()
}

impl StoreError {
    /// An error of SQLite on `file`, told apart.
    pub(super) fn from_sqlite(file: &Path, source: Error) -> Self {
        let file = file.to_path_buf();
        let Error::SqliteFailure(error, _) = &source else { return Self::Sqlite { file, source } };
        let detail = source.to_string();
        match error.code {
            ErrorCode::NotADatabase => Self::Foreign { file, found: "not an SQLite file".into() },
            ErrorCode::DatabaseCorrupt => Self::Corrupt { file, detail },
            _ if error.extended_code == ffi::SQLITE_IOERR_SHORT_READ => Self::Corrupt { file, detail },
            ErrorCode::DiskFull | ErrorCode::SystemIoFailure => Self::Full { file, detail },
            _ => Self::Sqlite { file, source },
        }
    }

    /// An error of the file system on `file`.
    pub(super) fn from_io(file: &Path, source: io::Error) -> Self {
        let file = file.to_path_buf();
        match source.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                Self::Full { file, detail: source.to_string() }
            }
            _ => Self::Io { file, source },
        }
    }
}

/// Adds the file to errors.
pub(super) trait At<T> {
    /// With the file that it happened to.
    fn at(self, file: &Path) -> Result<T, StoreError>;
}

impl<T> At<T> for rusqlite::Result<T> {
    fn at(self, file: &Path) -> Result<T, StoreError> {
        self.map_err(|source| StoreError::from_sqlite(file, source))
    }
}

impl<T> At<T> for io::Result<T> {
    fn at(self, file: &Path) -> Result<T, StoreError> {
        self.map_err(|source| StoreError::from_io(file, source))
    }
}

impl<T> At<T> for Result<T, ArrayError> {
    fn at(self, file: &Path) -> Result<T, StoreError> {
        self.map_err(|source| StoreError::Array { file: file.to_path_buf(), source })
    }
}
