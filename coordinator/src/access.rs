//! Who may take part in a run: whoever has its secret, and a certificate where connections are encrypted.

use crate::error::Error;
use clap::Args;
use protocol::certificate::{Certificate, LINK};
use protocol::credentials::{Credentials, CredentialsError};
use protocol::role::Role;
use protocol::secret::{FILE, Secret};
use std::path::{Path, PathBuf};
use worker::terminal;

/// Certificates that end within so many days are spoken of.
const SOON: u64 = 30;

/// What protects a run.
#[derive(Debug, Clone, Default, Args)]
pub struct AccessArgs {
    /// File with the secret that workers and viewers have to know [default: one of its own, in the file `secret` in the folder of
    /// the run]. Of a router: the one that it asks for.
    #[arg(long, value_name = "FILE", conflicts_with = "insecure")]
    pub secret_file: Option<PathBuf>,
    /// Ask for no secret: let everybody in who reaches the port, to cancel, to read, to send results; of tls/... whoever has a
    /// certificate.
    #[arg(long)]
    pub insecure: bool,
    /// Folder with the certificates of a coordinator, for endpoints that begin with tls/: ca.crt, tls.crt, tls.key, as `isola cert`
    /// makes them [default: what ISOLA_TLS names].
    #[arg(long, value_name = "DIR")]
    pub tls: Option<PathBuf>,
}

impl AccessArgs {
    /// What protects a run that is served here, in this folder if it has a secret already; no secret over a router that asks for
    /// none, or if there shall be none. `endpoint` is where it is served if somebody has chosen that.
    ///
    /// # Errors
    /// If a secret or certificates cannot be read, or are not those of a coordinator.
    pub fn credentials(
        &self,
        directory: Option<&Path>,
        endpoint: Option<&str>,
        is_over_router: bool,
    ) -> Result<Credentials, Error> {
        let certificate = match endpoint {
            Some(_) => Certificate::given(self.tls.as_deref()).map_err(CredentialsError::from)?,
            None if self.tls.is_some() => {
                return Err(Error::Usage("--tls is for --listen tls/ADDRESS:PORT, or --connect of a router".into()));
            }
            // What the environment names is of no use on the loopback interface.
            None => None,
        };
        if let Some(certificate) = &certificate {
            certificate.require(Role::Coordinator, "serve a run").map_err(CredentialsError::from)?;
            if certificate.ends().days_left() < SOON {
                let (folder, ends) = (certificate.folder().display(), certificate.ends());
                terminal::note(format_args!(
                    "the certificates in {folder} end on {ends}: nobody new is let in afterwards"
                ));
            }
        }
        Ok(Credentials { secret: self.secret(directory, is_over_router)?, certificate })
    }

    fn secret(&self, directory: Option<&Path>, is_over_router: bool) -> Result<Option<Secret>, CredentialsError> {
        if self.insecure {
            return Ok(None);
        }
        if let Some(given) = Secret::given(self.secret_file.as_deref())? {
            return Ok(Some(given));
        }
        match directory.map(|directory| directory.join(FILE)).filter(|file| file.exists()) {
            Some(file) => Ok(Some(Secret::read(&file)?)),
            None if is_over_router => Ok(None),
            None => Ok(Some(random())),
        }
    }
}

/// The credentials for a run by its folder, or by what is given.
///
/// # Errors
/// If a file that holds some cannot be read, and of certificates that are not valid.
pub fn known(
    directory: Option<&Path>,
    secret_file: Option<&Path>,
    tls: Option<&Path>,
) -> Result<Credentials, CredentialsError> {
    let own = |name: &str, given: Option<&Path>| {
        directory.map(|directory| directory.join(name)).filter(|own| given.is_none() && own.exists())
    };
    Ok(Credentials {
        secret: match own(FILE, secret_file) {
            Some(own) => Some(Secret::read(&own)?),
            None => Secret::given(secret_file)?,
        },
        certificate: match own(LINK, tls) {
            Some(own) => Some(Certificate::read(&own)?),
            None => Certificate::given(tls)?,
        },
    })
}

/// Puts the secret of a run into its folder, and a link to its certificates; without them there are none left.
///
/// # Errors
/// If it cannot be written.
pub fn keep(directory: &Path, credentials: &Credentials) -> Result<(), Error> {
    let (file, link) = (directory.join(FILE), directory.join(LINK));
    // Missing is as good as removed.
    let _ = std::fs::remove_file(&link);
    if let Some(certificate) = &credentials.certificate {
        std::os::unix::fs::symlink(certificate.folder(), &link).map_err(Error::io(&link))?;
    }
    match &credentials.secret {
        Some(secret) => secret.write(&file).map_err(Error::io(&file)),
        None => {
            let _ = std::fs::remove_file(&file);
            Ok(())
        }
    }
}

/// A secret that nobody has had before.
fn random() -> Secret {
    let [a, b] = [(); 2].map(|()| uuid::Uuid::new_v4().simple().to_string());
    format!("{a}{b}").parse().expect("digits and letters")
}
