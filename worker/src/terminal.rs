//! What people are told. Whatever reads it may end early, as in `isola status RUN | head -1`: that is no error, so the rest
//! goes nowhere, and the program does its work and ends with its own exit code. (`println!` and `eprintln!` would panic.)

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Writes to standard output.
///
/// # Errors
/// If it cannot be written for another reason than that nobody reads it any more.
pub fn print(text: impl Display) -> io::Result<()> {
    let mut output = io::stdout().lock();
    match write!(output, "{text}").and_then(|()| output.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error),
        _ => Ok(()),
    }
}

/// What is told to people where everything is written as JSON.
pub(crate) const TARGET: &str = "isola";

/// Whether lines on standard error are JSON.
static IS_JSON: AtomicBool = AtomicBool::new(false);

/// From now on what people are told is part of the log.
pub(crate) fn write_json() {
    IS_JSON.store(true, Ordering::Relaxed);
}

/// Whether what people are told is part of the log.
pub fn is_json() -> bool {
    IS_JSON.load(Ordering::Relaxed)
}

/// Writes a line to standard error; says whether somebody may have read it.
pub fn note(line: impl Display) -> bool {
    if is_json() {
        tracing::info!(target: TARGET, "{line}");
        return true;
    }
    writeln!(io::stderr().lock(), "{line}").is_ok()
}

/// Says on standard error why this process ends.
pub fn complain(error: impl Display) {
    if is_json() {
        tracing::error!(target: TARGET, "{error}");
    } else {
        note(format_args!("error: {error}"));
    }
}

/// Standard error for a log, which would have nowhere else to go.
#[derive(Debug, Clone, Copy, Default)]
pub struct Log;

impl Write for Log {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // What cannot be written is lost.
        let _ = io::stderr().lock().write_all(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
