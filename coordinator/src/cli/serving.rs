//! Options of where a run is served and who works for it.

use super::{whole, within};
use crate::access::AccessArgs;
use crate::ledger::Rules;
use clap::Args;
use protocol::keys::namespace;
use results::summary_table::UnitChoice;
use worker::LogFormat;

/// Where a run is served and who works for it.
#[derive(Debug, Clone, Args)]
pub struct ServeArgs {
    /// Local worker processes; 0: only workers elsewhere [default: one a core].
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole)]
    pub workers: Option<usize>,
    /// Listen here for workers and viewers, as tcp/ADDRESS:PORT, or tls/ADDRESS:PORT with --tls [default: a free port on the loopback interface].
    #[arg(long, value_name = "ENDPOINT", conflicts_with = "connect")]
    pub listen: Option<String>,
    /// Serve /healthz, /metrics (Prometheus) and the live page here, as HOST:PORT; port 0: a free one. With certificates (--tls) over
    /// HTTPS, else in clear text. Page and metrics are for
    /// who has the token that the terminal says, unless the run has no secret.
    #[arg(long, value_name = "ADDRESS", value_parser = host_port)]
    pub http: Option<String>,
    /// Meet workers and viewers at a Zenoh router instead.
    #[arg(long, value_name = "ENDPOINT")]
    pub connect: Option<String>,
    /// Who may take part.
    #[command(flatten)]
    pub access: AccessArgs,
    /// First chunk of all keys; a run that is resumed keeps its own.
    #[arg(long, default_value = protocol::keys::NAMESPACE, value_parser = namespace)]
    pub namespace: String,
    /// A task without a sign of life for so many seconds is handed out again.
    #[arg(long, value_name = "SECONDS", default_value_t = 15.0, value_parser = lease)]
    pub lease: f64,
    /// Share of the computing time for which results that no equation confirms, as that nothing is there, are computed again by another
    /// worker; 0: none. What workers disagree on is computed again in any case. It is not kept with the run.
    #[arg(long, value_name = "SHARE", default_value_t = Rules::default().repeated, value_parser = share)]
    pub repeat: f64,
    /// Units of tables and figures: one of m, mm, um and one of rad/s, Hz, as in mm,Hz; a sweep's run keeps them [default: as the study
    /// says, else m,rad/s].
    #[arg(long, value_name = "UNITS", value_parser = str::parse::<UnitChoice>)]
    pub units: Option<UnitChoice>,
    /// How lines on standard error are written, also those of local workers.
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t)]
    pub log_format: LogFormat,
    /// Stay on the bus after the end, for viewers, until Ctrl-C.
    #[arg(long)]
    pub stay: bool,
}

fn lease(text: &str) -> Result<f64, String> {
    within(text, 0.5..=86400.0, "seconds")
}

fn share(text: &str) -> Result<f64, String> {
    within(text, 0.0..=1.0, "of the computing time")
}

/// HOST:PORT of this machine.
pub(super) fn host_port(text: &str) -> Result<String, String> {
    match text.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => Ok(text.to_string()),
        _ => Err("give HOST:PORT of this machine, as in 127.0.0.1:8080".to_string()),
    }
}
