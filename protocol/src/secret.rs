//! What lets somebody take part in a run: a secret that coordinator, workers and viewers share.
//!
//! It is the password of Zenoh's own authentication, in which it does not cross the network. Who has it may do everything: take
//! tasks, cancel, read. What crosses the network is not encrypted by it.

use std::fmt;
use std::fs::OpenOptions;
use std::io::{self, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use thiserror::Error;

/// The file of a run that holds its secret, in its folder.
pub const FILE: &str = "secret";
/// The variable of the environment that may hold a secret.
pub const ENVIRONMENT: &str = "ISOLA_SECRET";
/// The one user.
pub const USER: &str = "isola";
/// Fewest characters that nobody guesses.
const SHORTEST: usize = 16;

/// A secret. It is not shown by mistake.
#[derive(Clone, PartialEq, Eq)]
pub struct Secret(String);

/// Why something is no secret.
#[derive(Debug, Error)]
pub enum SecretError {
    /// Too short, or with characters that would be read as something else.
    #[error("a secret is {SHORTEST} letters, digits, `-` or `_` at least, after `{USER}:` or alone")]
    Malformed,
    /// The file cannot be read.
    #[error("{}: {source}", file.display())]
    Io {
        /// The file.
        file: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file holds none.
    #[error("{}: {problem}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// What is wrong with what it holds.
        problem: Box<SecretError>,
    },
}

impl fmt::Debug for Secret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Secret")
    }
}

impl std::str::FromStr for Secret {
    type Err = SecretError;

    /// Of text, with or without the name of the user before it.
    fn from_str(text: &str) -> Result<Self, SecretError> {
        let text = text.trim();
        let password = text.strip_prefix(USER).and_then(|rest| rest.strip_prefix(':')).unwrap_or(text).trim();
        let is_allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if password.len() >= SHORTEST && password.chars().all(is_allowed) {
            Ok(Self(password.to_string()))
        } else {
            Err(SecretError::Malformed)
        }
    }
}

impl Secret {
    /// The secret in a file.
    ///
    /// # Errors
    /// If it cannot be read or holds none.
    pub fn read(file: &Path) -> Result<Self, SecretError> {
        let text =
            std::fs::read_to_string(file).map_err(|source| SecretError::Io { file: file.to_path_buf(), source })?;
        text.parse().map_err(|problem| SecretError::File { file: file.to_path_buf(), problem: Box::new(problem) })
    }

    /// The secret of the environment, if there is one.
    ///
    /// # Errors
    /// If it is none.
    pub fn of_environment() -> Result<Option<Self>, SecretError> {
        std::env::var(ENVIRONMENT).ok().filter(|text| !text.is_empty()).map(|text| text.parse()).transpose()
    }

    /// The one in a file if that is named, or that of the environment, if there is one.
    ///
    /// # Errors
    /// If what is there is none.
    pub fn given(file: Option<&Path>) -> Result<Option<Self>, SecretError> {
        file.map_or_else(Self::of_environment, |file| Self::read(file).map(Some))
    }

    /// Writes it to a new file that only its owner may read, in the form that Zenoh's routers read as well.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, file: &Path) -> io::Result<()> {
        match std::fs::remove_file(file) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        let mut file = OpenOptions::new().write(true).create_new(true).mode(0o600).open(file)?;
        writeln!(file, "{USER}:{}", self.0)?;
        file.sync_all()
    }

    /// As text, for the environment of other processes of one's own.
    pub fn reveal(&self) -> &str {
        &self.0
    }
}

/// A secret in a file, as long as a session is opened: Zenoh reads it from nowhere else.
pub(crate) struct Dictionary(PathBuf);

impl Dictionary {
    pub(crate) fn of(secret: &Secret) -> io::Result<Self> {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let file = std::env::temp_dir().join(format!("isola-{}-{number}", std::process::id()));
        secret.write(&file)?;
        Ok(Self(file))
    }

    pub(crate) fn file(&self) -> &Path {
        &self.0
    }
}

impl Drop for Dictionary {
    fn drop(&mut self) {
        // It was read, or nothing was.
        let _ = std::fs::remove_file(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_a_secret() {
        let secret: Secret = "0123456789abcdef".parse().unwrap();
        assert_eq!("isola:0123456789abcdef\n".parse::<Secret>().unwrap(), secret);
        assert_eq!(format!("{secret:?}"), "Secret");
        for other in ["", "short", "isola:", "0123456789abcde:f", "0123456789abcde f", "0123456789abcde\nf"] {
            assert!(other.parse::<Secret>().is_err(), "{other}");
        }
    }
}
