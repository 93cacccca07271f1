//! Who may take part in a run: whoever has its secret.

use crate::error::Error;
use clap::Args;
use protocol::secret::{FILE, Secret};
use std::path::{Path, PathBuf};

/// What protects a run.
#[derive(Debug, Clone, Default, Args)]
pub struct AccessArgs {
    /// File with the secret that workers and viewers have to know [default: one of its own, in the file `secret` in the folder of
    /// the run]. Of a router: the one that it asks for.
    #[arg(long, value_name = "FILE", conflicts_with = "insecure")]
    pub secret_file: Option<PathBuf>,
    /// Let everybody in who reaches the port: to cancel, to read, to send results.
    #[arg(long)]
    pub insecure: bool,
}

impl AccessArgs {
    /// The secret of a run that is served here, in this folder if it has one already; none over a router that asks for none, or if
    /// there shall be none.
    ///
    /// # Errors
    /// If the file that holds it cannot be read.
    pub fn secret(&self, directory: Option<&Path>, is_over_router: bool) -> Result<Option<Secret>, Error> {
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

/// The secret of a run by its folder, or by what is given.
///
/// # Errors
/// If the file that holds it cannot be read.
pub fn known(directory: Option<&Path>, file: Option<&Path>) -> Result<Option<Secret>, Error> {
    let own = directory.map(|directory| directory.join(FILE)).filter(|own| file.is_none() && own.exists());
    Ok(match own {
        Some(own) => Some(Secret::read(&own)?),
        None => Secret::given(file)?,
    })
}

/// Puts the secret of a run into its folder; without one there is none left.
///
/// # Errors
/// If it cannot be written.
pub fn keep(directory: &Path, secret: Option<&Secret>) -> Result<(), Error> {
    let file = directory.join(FILE);
    match secret {
        Some(secret) => secret.write(&file).map_err(Error::io(&file)),
        None => {
            // Missing is as good as removed.
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
