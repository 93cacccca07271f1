//! The log on standard error, for people or for programs.

use crate::terminal;
use std::io::IsTerminal;
use tracing_subscriber::EnvFilter;

/// How lines on standard error are written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum LogFormat {
    /// For people.
    #[default]
    Text,
    /// For programs that collect logs: a JSON object a line, with timestamp, level, target and fields.
    Json,
}

impl LogFormat {
    /// As typed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Json => "json",
        }
    }
}

/// Starts the log of this process: of what ISOLA_LOG says, or else of `default`. Another one may be there already, if this is part
/// of another program.
pub fn start(format: LogFormat, default: &str) {
    let filter = EnvFilter::try_from_env("ISOLA_LOG").unwrap_or_else(|_| EnvFilter::new(default));
    let log = tracing_subscriber::fmt().with_writer(|| terminal::Log);
    let _ = match format {
        LogFormat::Text => log.with_env_filter(filter).with_ansi(std::io::stderr().is_terminal()).try_init(),
        LogFormat::Json => {
            terminal::write_json();
            // What people are told is logged in any case.
            let told = format!("{}=info", terminal::TARGET).parse().expect("a name and a level");
            log.json().flatten_event(true).with_env_filter(filter.add_directive(told)).try_init()
        }
    };
}
