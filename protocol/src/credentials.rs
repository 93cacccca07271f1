//! What somebody shows to be let in: the secret of a run, and a certificate on encrypted connections.

use crate::certificate::{AUTHORITY, CERTIFICATE, Certificate, CertificateError, KEY};
use crate::secret::{Secret, SecretError};
use std::path::Path;
use thiserror::Error;

/// Beginning of endpoints of encrypted connections.
pub const ENCRYPTED: &str = "tls/";

/// What somebody shows to be let in.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Credentials {
    /// Secret of the run.
    pub secret: Option<Secret>,
    /// Certificate, for endpoints that begin with `tls/`.
    pub certificate: Option<Certificate>,
}

/// Why there are none.
#[derive(Debug, Error)]
pub enum CredentialsError {
    /// No secret.
    #[error(transparent)]
    Secret(#[from] SecretError),
    /// No certificate.
    #[error(transparent)]
    Certificate(#[from] CertificateError),
}

impl Credentials {
    /// Of a file with a secret and a folder with certificates, or of what the environment says.
    ///
    /// # Errors
    /// If what is named there is none.
    pub fn given(secret_file: Option<&Path>, certificates: Option<&Path>) -> Result<Self, CredentialsError> {
        Ok(Self { secret: Secret::given(secret_file)?, certificate: Certificate::given(certificates)? })
    }

    /// Those for an endpoint that nobody has chosen: without certificates, if it is not an encrypted one.
    #[must_use]
    pub fn for_endpoint(mut self, endpoint: &str) -> Self {
        self.certificate = self.certificate.filter(|_| endpoint.starts_with(ENCRYPTED));
        self
    }

    /// Settings of Zenoh for the certificates of this side, if the endpoint is one of encrypted connections: both sides show one.
    /// What is wrong, in words, if endpoint and certificates do not go together.
    pub(crate) fn encryption(&self, endpoint: &str) -> Result<Vec<(&'static str, String)>, &'static str> {
        let certificate = match (endpoint.starts_with(ENCRYPTED), &self.certificate) {
            (true, Some(certificate)) => certificate,
            (true, None) => {
                return Err(
                    "an encrypted connection needs certificates: name a folder of them with --tls (or in ISOLA_TLS), \
                            `isola cert` makes some",
                );
            }
            (false, Some(_)) => {
                return Err("certificates were named, but only connections to tls/HOST:PORT are encrypted");
            }
            (false, None) => return Ok(Vec::new()),
        };
        let file = |name| format!("{:?}", certificate.file(name).display().to_string());
        Ok(vec![
            ("transport/link/tls/enable_mtls", "true".to_string()),
            ("transport/link/tls/root_ca_certificate", file(AUTHORITY)),
            ("transport/link/tls/listen_certificate", file(CERTIFICATE)),
            ("transport/link/tls/listen_private_key", file(KEY)),
            ("transport/link/tls/connect_certificate", file(CERTIFICATE)),
            ("transport/link/tls/connect_private_key", file(KEY)),
        ])
    }
}

impl From<Option<Secret>> for Credentials {
    fn from(secret: Option<Secret>) -> Self {
        Self { secret, certificate: None }
    }
}
