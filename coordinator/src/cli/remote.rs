//! Options of a run that another process conducts.

use clap::Args;
use protocol::ids::RunId;
use protocol::keys::namespace;
use results::summary_table::UnitChoice;
use std::path::PathBuf;

/// A run, by folder or on the bus.
#[derive(Debug, Args)]
pub struct RemoteArgs {
    /// Folder of the run.
    #[arg(required_unless_present = "connect", conflicts_with = "connect")]
    pub directory: Option<PathBuf>,
    /// Where its coordinator or router listens: tcp/HOST:PORT or tls/HOST:PORT.
    #[arg(long, value_name = "ENDPOINT")]
    pub connect: Option<String>,
    /// File with the secret of the run [default: what ISOLA_SECRET holds; of a folder, its own].
    #[arg(long, value_name = "FILE")]
    pub secret_file: Option<PathBuf>,
    /// Folder with certificates, for endpoints that begin with tls/: ca.crt, tls.crt, tls.key; of a viewer at least, of the
    /// coordinator to cancel and to retry [default: of a folder, those of its coordinator; else what ISOLA_TLS names].
    #[arg(long, value_name = "DIR")]
    pub tls: Option<PathBuf>,
    /// Which run, if there are several.
    #[arg(long, value_name = "RUN", requires = "connect")]
    pub run: Option<RunId>,
    /// First chunk of all keys.
    #[arg(long, default_value = protocol::keys::NAMESPACE, value_parser = namespace)]
    pub namespace: String,
}

/// Arguments of `status`.
#[derive(Debug, Args)]
pub struct StatusArgs {
    /// The run.
    #[command(flatten)]
    pub run: RemoteArgs,
    /// For programs: the `status` message of MESSAGES.md as JSON, and whether somebody conducts the run.
    #[arg(long)]
    pub json: bool,
    /// Units of the table of a run that nobody conducts: one of m, mm, um and one of rad/s, Hz, as in mm,Hz [default: those of
    /// the run].
    #[arg(long, value_name = "UNITS", value_parser = str::parse::<UnitChoice>, conflicts_with = "json")]
    pub units: Option<UnitChoice>,
}
