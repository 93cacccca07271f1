//! `isola`: from a model to its isolas.

use clap::Parser;
use coordinator::cli::Cli;
use std::process::ExitCode;

fn main() -> ExitCode {
    match coordinator::commands::execute(Cli::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
