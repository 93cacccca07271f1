//! Certificates by which coordinator, workers and viewers know each other on encrypted connections.
//!
//! They lie in a folder with the names that Kubernetes gives them: `ca.crt` for whom to trust, `tls.crt` and `tls.key` for oneself.

use crate::role::Role;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;
use thiserror::Error;
use x509_parser::pem::parse_x509_pem;
use x509_parser::time::ASN1Time;

/// Whose certificates are trusted.
pub const AUTHORITY: &str = "ca.crt";
/// One's own.
pub const CERTIFICATE: &str = "tls.crt";
/// The key to it.
pub const KEY: &str = "tls.key";
/// The variable of the environment that may name the folder.
pub const ENVIRONMENT: &str = "ISOLA_TLS";
/// A link in the folder of a run to the certificates of its coordinator.
pub const LINK: &str = "tls";

/// A folder with certificates that are valid now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Certificate {
    folder: PathBuf,
    role: Role,
    ends: Date,
}

/// A day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Date {
    /// Seconds since 1970.
    at: i64,
}

/// Why a folder holds no certificate that is of use.
#[derive(Debug, Error)]
pub enum CertificateError {
    /// A file cannot be read.
    #[error("{}: {source}; a folder of certificates holds {AUTHORITY}, {CERTIFICATE} and {KEY}: `isola cert` makes some", file.display())]
    Io {
        /// The file.
        file: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// It is something else.
    #[error("{}: not a certificate in PEM format ({reason})", file.display())]
    Malformed {
        /// The file.
        file: PathBuf,
        /// Why.
        reason: String,
    },
    /// It is too late.
    #[error("{}: the certificate ended on {ends}, nobody accepts it any more; `isola cert` makes a new one", file.display())]
    Ended {
        /// The file.
        file: PathBuf,
        /// When.
        ends: Date,
    },
    /// It is too early.
    #[error("{}: the certificate begins on {begins}; is the clock of this machine right?", file.display())]
    NotYet {
        /// The file.
        file: PathBuf,
        /// When.
        begins: Date,
    },
    /// Nobody's.
    #[error(
        "{}: the certificate is of `{name}`, which is no role; common names are {}", file.display(),
        Role::ALL.map(Role::common_name).join(", ")
    )]
    Stranger {
        /// The file.
        file: PathBuf,
        /// Its common name.
        name: String,
    },
    /// Of somebody who may not do that.
    #[error(
        "{}: the certificate is that of {}, who may not {what}: use that of {}",
        file.display(),
        is.with_article(),
        needed.with_article()
    )]
    Role {
        /// The file.
        file: PathBuf,
        /// Whose it is.
        is: Role,
        /// Who may.
        needed: Role,
        /// What.
        what: &'static str,
    },
}

impl fmt::Display for Date {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match ASN1Time::from_timestamp(self.at) {
            Ok(time) => write!(f, "{}", time.to_datetime().date()),
            Err(_) => write!(f, "{} s after 1970", self.at),
        }
    }
}

impl Date {
    /// Whole days from now, none if it is past.
    pub fn days_left(self) -> u64 {
        (self.at - now()).max(0).unsigned_abs() / 86_400
    }
}

/// Seconds since 1970.
fn now() -> i64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    i64::try_from(since.as_secs()).unwrap_or(i64::MAX)
}

impl Certificate {
    /// The certificates in a folder, if they are of use now.
    ///
    /// # Errors
    /// If one of the three files cannot be read, is none, is not valid now, or gives no role.
    pub fn read(folder: &Path) -> Result<Self, CertificateError> {
        // Zenoh wants it as text, and the working directory may change.
        let folder = std::path::absolute(folder)
            .map_err(|source| CertificateError::Io { file: folder.to_path_buf(), source })?;
        let key = folder.join(KEY);
        std::fs::read(&key).map_err(|source| CertificateError::Io { file: key, source })?;
        let (_, authority) = valid(&folder.join(AUTHORITY))?;
        let file = folder.join(CERTIFICATE);
        let (name, own) = valid(&file)?;
        let role = Role::of_common_name(&name).ok_or(CertificateError::Stranger { file, name })?;
        Ok(Self { folder, role, ends: Date { at: own.at.min(authority.at) } })
    }

    /// Those in the folder that is named, or that the environment names, if one does.
    ///
    /// # Errors
    /// Those of [`Self::read`].
    pub fn given(folder: Option<&Path>) -> Result<Option<Self>, CertificateError> {
        let named = std::env::var_os(ENVIRONMENT).filter(|name| !name.is_empty()).map(PathBuf::from);
        folder.map(Path::to_path_buf).or(named).map(|folder| Self::read(&folder)).transpose()
    }

    /// Where they lie.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// When the first of them ends.
    pub fn ends(&self) -> Date {
        self.ends
    }

    /// A file of the folder.
    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Nothing, if the role is this one or one that may do more.
    ///
    /// # Errors
    /// If it is one that may not do `what`: Zenoh would say nothing.
    pub fn require(&self, needed: Role, what: &'static str) -> Result<(), CertificateError> {
        if self.role.includes(needed) {
            Ok(())
        } else {
            Err(CertificateError::Role { file: self.file(CERTIFICATE), is: self.role, needed, what })
        }
    }
}

/// Common name and end of a certificate that is valid now.
fn valid(file: &Path) -> Result<(String, Date), CertificateError> {
    let io = |source| CertificateError::Io { file: file.to_path_buf(), source };
    let malformed = |reason: String| CertificateError::Malformed { file: file.to_path_buf(), reason };
    let bytes = std::fs::read(file).map_err(io)?;
    let (_, pem) = parse_x509_pem(&bytes).map_err(|error| malformed(error.to_string()))?;
    let certificate = pem.parse_x509().map_err(|error| malformed(error.to_string()))?;
    let name = certificate.subject().iter_common_name().next().and_then(|name| name.as_str().ok()).unwrap_or_default();
    let (begins, ends) = (certificate.validity().not_before.timestamp(), certificate.validity().not_after.timestamp());
    if ends < now() {
        return Err(CertificateError::Ended { file: file.to_path_buf(), ends: Date { at: ends } });
    }
    if begins > now() {
        return Err(CertificateError::NotYet { file: file.to_path_buf(), begins: Date { at: begins } });
    }
    Ok((name.to_string(), Date { at: ends }))
}
