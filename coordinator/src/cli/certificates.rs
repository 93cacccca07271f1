//! Options of the certificates for encrypted connections.

use clap::Args;
use std::path::PathBuf;

pub(super) const CERT: &str = "\
Examples:
  isola cert certificates --name head.cluster.example --name 10.0.0.1
  isola sweep STUDY --listen tls/0.0.0.0:7447 --tls certificates/coordinator --workers 0
  isola worker --connect tls/head.cluster.example:7447 --tls worker --secret-file secret";

/// Arguments of `cert`.
#[derive(Debug, Args)]
pub struct CertArgs {
    /// Folder to make them in; what is there already stays as it is.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Name or address by which workers and viewers reach the coordinator, besides localhost and the name of this machine; several
    /// may be given.
    #[arg(long = "name", value_name = "HOST")]
    pub names: Vec<String>,
    /// For how many days the certificates are accepted; their authority is for ten years.
    #[arg(long, value_name = "N", default_value_t = 365, value_parser = clap::value_parser!(i64).range(1..=3650))]
    pub days: i64,
}
