//! What people are told. Whatever reads it may end early, as in `isola status RUN | head -1`: that is no error, so the rest
//! goes nowhere, and the program does its work and ends with its own exit code. (`println!` and `eprintln!` would panic.)

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

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

/// Writes a line to standard error; says whether somebody may have read it.
pub fn note(line: impl Display) -> bool {
    writeln!(io::stderr().lock(), "{line}").is_ok()
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
