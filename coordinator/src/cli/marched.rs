//! Options of what time marching says of a run.

use super::{ServeArgs, one_of};
use clap::Args;
use clap::builder::TypedValueParser;
use solver::settings::VerifyEffort;
use std::path::PathBuf;

/// Arguments of `verify`.
#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// Folder of the run.
    pub run: PathBuf,
    /// What is verified.
    #[arg(long, value_name = "EFFORT", default_value = "all", value_parser = verify_efforts())]
    pub effort: VerifyEffort,
    /// Go on with the study as it was when the run began, though its file or model has changed and the run is not finished.
    #[arg(long)]
    pub as_started: bool,
    /// Where it is served and who works for it.
    #[command(flatten)]
    pub serve: ServeArgs,
}

/// Arguments of `disturb`.
#[derive(Debug, Args)]
pub struct DisturbArgs {
    /// Folder of the run.
    pub run: PathBuf,
    /// Modes that are pushed, one after the other: the first so many.
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..))]
    pub modes: u16,
    /// Go on with the study as it was when the run began, though its file or model has changed and the run is not finished.
    #[arg(long)]
    pub as_started: bool,
    /// Where it is served and who works for it.
    #[command(flatten)]
    pub serve: ServeArgs,
}

fn verify_efforts() -> impl TypedValueParser<Value = VerifyEffort> {
    one_of(&[
        (
            VerifyEffort::Standard,
            "standard",
            "Every branch that is not a main one, and what is around the peaks of main branches",
        ),
        (
            VerifyEffort::All,
            "all",
            "Every branch, and what unstable motions turn into where it loses its stability or never has it",
        ),
    ])
}
