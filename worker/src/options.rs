//! Command line.

use crate::log::LogFormat;
use protocol::ids::RunId;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

const AFTER_HELP: &str = "\
Examples:
  On the coordinator's machine, with all cores:
    isola-worker
  On another machine, with four of them, giving a branch two minutes to finish when told to end:
    isola-worker --connect tcp/cluster-head:7447 --slots 4 --grace 120

Exit codes:
  0  all work is done, the run was cancelled, nothing was to be done for --idle-exit, or the worker was told to end
  1  no coordinator or run was found, or the coordinator was gone for too long
  2  wrong options
  3  this worker and this run do not fit: starting it again will not help
  130, 143  a second SIGINT or SIGTERM: ended at once

ISOLA_LOG sets what is logged to standard error, as in ISOLA_LOG=worker=debug,zenoh=warn.";

/// Options of a worker.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Options {
    /// Where the coordinator, or a Zenoh router between, listens: tcp/HOST:PORT, or tls/HOST:PORT with --tls.
    #[arg(long, value_name = "ENDPOINT", env = "ISOLA_CONNECT", default_value = "tcp/127.0.0.1:7447")]
    pub connect: String,

    /// File with the secret of the run: `secret` in its folder, or a copy. Default: what ISOLA_SECRET holds, if anything.
    #[arg(long, value_name = "FILE", env = "ISOLA_SECRET_FILE")]
    pub secret_file: Option<PathBuf>,

    /// Folder with the certificates of a worker, for endpoints that begin with tls/: ca.crt, tls.crt, tls.key. Default: what
    /// ISOLA_TLS names.
    #[arg(long, value_name = "DIR")]
    pub tls: Option<PathBuf>,

    /// First part of every key on the bus, if several projects share one.
    #[arg(long, value_name = "NAME", default_value = protocol::keys::NAMESPACE, value_parser = protocol::keys::namespace)]
    pub namespace: String,

    /// Which run to work for. Default: the only one with work to do.
    #[arg(long, value_name = "RUN")]
    pub run: Option<RunId>,

    /// Computing threads, each of which follows one branch at a time. Default: one per available core.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub slots: Option<NonZeroUsize>,

    /// How long to look for a coordinator and a run at the start, s.
    #[arg(long, value_name = "SECONDS", default_value = "10", allow_negative_numbers = true, value_parser = seconds)]
    pub wait: Duration,

    /// How long to go on, and keep results, while the coordinator does not answer, s.
    #[arg(long, value_name = "SECONDS", default_value = "600", allow_negative_numbers = true, value_parser = seconds)]
    pub patience: Duration,

    /// How long branches under way may go on after SIGTERM or SIGINT, before they are given back, s.
    #[arg(long, value_name = "SECONDS", default_value = "0", allow_negative_numbers = true, value_parser = seconds)]
    pub grace: Duration,

    /// End, with exit code 0, when there has been nothing to do for so long, s. Default: stay until the run ends.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = seconds)]
    pub idle_exit: Option<Duration>,

    /// How lines on standard error are written.
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t)]
    pub log_format: LogFormat,

    /// End when standard input ends, as after SIGTERM, and leave SIGINT to whoever holds its other end: a worker does not
    /// outlive the coordinator that started it.
    #[arg(long, hide = true)]
    pub lifeline: bool,

    /// Log more to standard error; twice: everything.
    #[arg(short, long, action = clap::ArgAction::Count)]
    pub verbose: u8,
}

impl Options {
    /// Number of computing threads.
    pub fn threads(&self) -> usize {
        let cores = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        self.slots.map_or_else(cores, NonZeroUsize::get)
    }
}

fn seconds(text: &str) -> Result<Duration, String> {
    let number: f64 = text.parse().map_err(|_| "use a number of seconds".to_string())?;
    Duration::try_from_secs_f64(number)
        .ok()
        .filter(|duration| *duration < Duration::from_secs(1 << 31))
        .ok_or_else(|| "use seconds, from 0 to 2^31".to_string())
}
