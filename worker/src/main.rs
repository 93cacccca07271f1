//! `isola-worker`: see the library.

use clap::Parser;
use std::process::ExitCode;

/// Computes branches for a coordinator of Isola until all work is done.
#[derive(Debug, Parser)]
#[command(name = "isola-worker", version)]
struct Command {
    #[command(flatten)]
    options: worker::Options,
}

fn main() -> ExitCode {
    worker::run(&Command::parse().options)
}
