//! `isola`: from a model to its isolas.

// They panic when nobody reads any more: see `worker::terminal`.
#![warn(clippy::print_stdout, clippy::print_stderr)]

use clap::Parser;
use coordinator::cli::Cli;
use std::process::ExitCode;
use worker::terminal;

fn main() -> ExitCode {
    match coordinator::commands::execute(Cli::parse()) {
        Ok(code) => code,
        Err(error) => {
            terminal::complain(&error);
            ExitCode::from(error.exit_code())
        }
    }
}
