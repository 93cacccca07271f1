//! Command line of `isola`.

mod certificates;
mod first_steps;
mod marched;
#[cfg(feature = "figures")]
mod plot;
mod remote;
mod serving;

pub use certificates::CertArgs;
pub use first_steps::{CheckArgs, NewArgs, SchemaArgs};
pub use marched::{DisturbArgs, VerifyArgs};
#[cfg(feature = "figures")]
pub use plot::PlotArgs;
pub use remote::{RemoteArgs, StatusArgs};
pub use serving::ServeArgs;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use results::export::Format;
use results::resolved_study::UNITS;
use results::summary_table::UnitChoice;
#[cfg(feature = "page")]
use serving::host_port;
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// Finds the isolated branches (isolas) of the forced response of nonlinear structures.
#[derive(Debug, Parser)]
#[command(
    name = "isola",
    version,
    after_help = "\
Examples:
  isola sweep mine                                           one command from a model to its isolas
  isola sweep STUDY --amplitudes 5:140:5 --set contact.friction=0
  isola sweep STUDY --listen tcp/0.0.0.0:7447 --workers 0    wait for workers elsewhere:
  isola worker --connect tcp/HOST:7447                       ... on each of them
  isola resume runs/NAME                                     go on after Ctrl-C or a crash
  isola report runs/NAME                                     one page that shows what was found
  isola plot runs/NAME --figure response -o response.pdf     one figure for a paper

Exit codes: 0 done (also if nobody reads the output to its end); 1 error; 2 wrong usage, as\nan option with a wrong value; 3 ended with tasks missing (cancelled or given up), or\nsomething stored is damaged and was left out; 4 complete, but a main branch, a backbone or a\nfold curve stopped before its end, and what lies beyond is not known; 130 interrupted."
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// Commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Write a small model with its study, every key commented, to start from.
    #[command(after_help = first_steps::NEW)]
    New(NewArgs),
    /// Print what may stand in model.toml and study.toml: a JSON Schema for editors, or the meaning of one key or of all.
    #[command(after_help = first_steps::SCHEMA)]
    Schema(SchemaArgs),
    /// Validate a study; print its eigenfrequencies, gaps and size.
    #[command(after_help = "\
Examples:
  isola check mine --set contact.gap=3e-4
  isola check mine --units mm,Hz")]
    Check(CheckArgs),
    /// Compute a study: backbone, windows, every branch of every forcing level.
    #[command(after_help = "\
Examples:
  isola sweep mine
  isola sweep mine --amplitudes 20,60 --set contact.friction=0 --out runs/frictionless
  isola sweep STUDY --listen tcp/0.0.0.0:7447 --workers 0    workers elsewhere: isola worker --connect tcp/HOST:7447")]
    Sweep(SweepArgs),
    /// Go on with a run that was interrupted or cancelled; nothing that was accepted is computed again.
    #[command(after_help = "Example:\n  isola resume runs/nasa-rotor-67-20261121-101500")]
    Resume(ResumeArgs),
    /// Add forcing levels to a run, finished or interrupted; nothing is computed twice.
    #[command(
        after_help = "Example:\n  isola extend runs/NAME --amplitudes 5:140:5        those that it does not have yet"
    )]
    Extend(ExtendArgs),
    /// Verify the branches of a run by time marching: is what was found stable? Whatever the run left to do is done too.
    #[command(after_help = "\
Examples:
  isola verify runs/NAME                        every branch from end to end
  isola verify runs/NAME --effort standard      isolas, and main branches around their peaks")]
    Verify(VerifyArgs),
    /// How hard a push throws the structure from its main motion onto an isola: the smallest found, by time marching.
    #[command(after_help = "\
Examples:
  isola disturb runs/NAME                       pushes in the first three modes, onto every isola with a stable part
  isola disturb runs/NAME --modes 1

Of each push it is said how strong it is, and when it comes: so much of a period of the isola's motion after an instant at which the
force (not the response) is largest. Also where the motion ends, at the same frequency, when the force is switched on at rest.")]
    Disturb(DisturbArgs),
    /// Say how a run is doing (also one that is not running).
    #[command(after_help = "Examples:\n  isola status runs/NAME\n  isola status --connect tcp/HOST:7447 --json")]
    Status(StatusArgs),
    /// Say in one line whether a coordinator carries a run on: exit code 0 if so, else 1. For healthchecks of containers.
    #[command(after_help = "Examples:\n  isola health runs/NAME\n  isola health --connect tcp/HOST:7447")]
    Health(RemoteArgs),
    /// Follow a run live, from anywhere on the bus, in the terminal or in a browser.
    #[command(after_help = "\
Examples:
  isola watch runs/NAME
  isola watch runs/NAME --page                  the response in a browser, as it grows
  isola watch --connect tcp/HOST:7447")]
    Watch(WatchArgs),
    /// Stop a run; what is stored stays, and `resume` goes on.
    #[command(after_help = "Example:\n  isola cancel runs/NAME")]
    Cancel(RemoteArgs),
    /// Try the tasks that were given up again.
    #[command(after_help = "Example:\n  isola retry-dead runs/NAME")]
    RetryDead(RemoteArgs),
    /// Show a run, also one in progress, on one HTML page that needs no network, or several beside each other.
    #[cfg(feature = "page")]
    #[command(after_help = "\
Examples:
  isola report runs/NAME                        writes runs/NAME/report.html
  isola report runs/LIGHT runs/HEAVY            compares runs
  isola report runs/NAME --levels 20:60:20 -o isolas.html")]
    Report(ReportArgs),
    /// Draw one figure of a run, also of one in progress, for a paper: SVG, PDF or PNG.
    #[cfg(feature = "figures")]
    #[command(after_help = "\
Examples:
  isola plot runs/NAME --figure response -o response.pdf
  isola plot runs/NAME --figure map --frequency 2400 2500 -o map.png
  isola plot runs/NAME --figure balance --amplitude 60 --width 85 --height 70 -o balance.svg
  isola plot runs/NAME --figure motion --at \"20/isola 1/43\" -o motion.png")]
    Plot(PlotArgs),
    /// Write the results of a run, at any stage, as files for spreadsheets, MATLAB or NumPy.
    #[command(after_help = "Examples:\n  isola export runs/NAME --to results\n  isola export runs/NAME --format mat")]
    Export(ExportArgs),
    /// Make certificates for encrypted connections: of coordinator, workers and viewers, each with its rights.
    #[command(after_help = certificates::CERT)]
    Cert(CertArgs),
    /// Work for a run: the same as isola-worker.
    Worker(worker::Options),
    /// Print a completion script.
    #[command(after_help = "Example:\n  isola completions bash > /etc/bash_completion.d/isola")]
    Completions {
        /// Shell.
        shell: clap_complete::Shell,
    },
}

impl Command {
    /// Where it serves a run, if it does.
    pub fn serving(&self) -> Option<&ServeArgs> {
        match self {
            Self::Sweep(args) => Some(&args.serve),
            Self::Resume(args) => Some(&args.serve),
            Self::Extend(args) => Some(&args.serve),
            Self::Verify(args) => Some(&args.serve),
            Self::Disturb(args) => Some(&args.serve),
            _ => None,
        }
    }
}

/// The key that `--orders` sets.
pub const ORDERS: &str = "search.harmonics";

/// A study and what is changed in it.
#[derive(Debug, Args)]
pub struct StudyArgs {
    /// Study file, or a folder with a study.toml.
    pub study: PathBuf,
    /// Change a key: contact.friction=0, harmonics.count=20, laws.NAME.law.jenkins.limit=3 (of the law of this name) ...
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_value)]
    pub set: Vec<(String, String)>,
    /// Forcing amplitudes: 20,60 or start:stop:step with both ends.
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub amplitudes: Option<String>,
    /// How hard isolas are looked for beyond the energy balance (search.effort): none, standard or thorough.
    #[arg(long, value_name = "EFFORT", value_parser = ["none", "standard", "thorough"], hide_possible_values = true)]
    pub search: Option<String>,
    /// Orders of the motions that are looked for: order m lasts m periods of the force (search.harmonics): 1,2,3.
    #[arg(long, value_name = "LIST")]
    pub orders: Option<String>,
    /// What of the branches is verified by time marching, with its stability (verify.effort): none, standard (isolas and
    /// peaks) or all.
    #[arg(long, value_name = "EFFORT", value_parser = ["none", "standard", "all"], hide_possible_values = true)]
    pub verify: Option<String>,
}

impl StudyArgs {
    /// All keys that are changed, the units of the study among them if some are asked for.
    pub fn changes(&self, units: Option<UnitChoice>) -> Vec<(String, String)> {
        let change = |key: &str, value: &Option<String>| value.clone().map(|value| (key.to_string(), value));
        let options = [
            change("search.effort", &self.search),
            change(ORDERS, &self.orders),
            change("verify.effort", &self.verify),
        ];
        let units = units.map(|units| (UNITS.to_string(), format!("\"{units}\"")));
        self.set.iter().cloned().chain(options.into_iter().flatten()).chain(units).collect()
    }
}

/// Arguments of `sweep`.
#[derive(Debug, Args)]
pub struct SweepArgs {
    /// Study.
    #[command(flatten)]
    pub study: StudyArgs,
    /// Folder of the run, new or empty [default: a new one under runs/].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Where it is served and who works for it.
    #[command(flatten)]
    pub serve: ServeArgs,
}

/// Arguments of `resume`.
#[derive(Debug, Args)]
pub struct ResumeArgs {
    /// Folder of the run.
    pub run: PathBuf,
    /// Go on with the study as it was when the run began, though its file or model has changed.
    #[arg(long)]
    pub as_started: bool,
    /// Where it is served and who works for it.
    #[command(flatten)]
    pub serve: ServeArgs,
}

/// Arguments of `extend`.
#[derive(Debug, Args)]
pub struct ExtendArgs {
    /// Folder of the run.
    pub run: PathBuf,
    /// Forcing amplitudes: 20,60 or start:stop:step with both ends; those that the run has are left out.
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub amplitudes: String,
    /// Go on with the study as it was when the run began, though its file or model has changed.
    #[arg(long)]
    pub as_started: bool,
    /// Where it is served and who works for it.
    #[command(flatten)]
    pub serve: ServeArgs,
}

/// Arguments of `watch`.
#[derive(Debug, Args)]
pub struct WatchArgs {
    /// The run.
    #[command(flatten)]
    pub run: RemoteArgs,
    /// Show it in a browser: serve a page here, as HOST:PORT [default: a free port on the loopback interface].
    #[cfg(feature = "page")]
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "127.0.0.1:0", value_parser = host_port)]
    pub page: Option<String>,
}

/// Arguments of `report`.
#[cfg(feature = "page")]
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// Folders of runs; several are compared, each with the first.
    #[arg(required = true, value_name = "RUN")]
    pub runs: Vec<PathBuf>,
    /// File to write; of further orders of motions others beside it, as FILE-m3.html [default: report.html, of several runs compare.html, in
    /// the folder of the first run].
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Draw the branches of these forcing amplitudes only: 20,60 or start:stop:step with both ends.
    #[arg(long, value_name = "LIST")]
    pub levels: Option<String>,
    /// Of motions that last so many periods of the force (search.harmonics) [default: of the first order; those of others are written
    /// to folders of their own, as m3/report.html].
    #[arg(long, value_name = "M", value_parser = whole)]
    pub order: Option<usize>,
    /// Units that the page begins with: one of m, mm, um and one of rad/s, Hz, as in mm,Hz, or one of them only [default: those of the run,
    /// else rad/s, and what lengths are read best in].
    #[arg(long, value_name = "UNITS", value_parser = str::parse::<UnitChoice>)]
    pub units: Option<UnitChoice>,
}

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct ExportArgs {
    /// Folder of the run.
    pub run: PathBuf,
    /// What kind of files.
    #[arg(long, default_value = "csv", value_parser = formats())]
    pub format: Format,
    /// Where to write [default: the folder of the run].
    #[arg(short = 'o', long, visible_alias = "out", value_name = "DIR", value_parser = export_folder)]
    pub to: Option<PathBuf>,
}

/// Where several files are written to: not the name of one.
fn export_folder(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_file = ["csv", "mat", "npz"].iter().any(|ending| path.extension().is_some_and(|own| own == *ending));
    if is_file && !path.is_dir() { Err("several files are written: name a folder for them".into()) } else { Ok(path) }
}

fn key_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() && !value.trim().is_empty() => {
            Ok((key.trim().to_string(), value.trim().to_string()))
        }
        _ => Err("write it as key=value, like contact.friction=0".to_string()),
    }
}

fn whole(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| "use a whole number that is not negative".into())
}

/// A number within bounds, and of what.
fn within(text: &str, bounds: RangeInclusive<f64>, what: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| bounds.contains(number));
    number.ok_or_else(|| format!("use {} to {} {what}", bounds.start(), bounds.end()))
}

/// One of a few values, each with its name and what it is.
fn one_of<T: Copy + Send + Sync + 'static>(
    values: &'static [(T, &'static str, &'static str)],
) -> impl TypedValueParser<Value = T> {
    let names = values.iter().map(|&(_, name, about)| PossibleValue::new(name).help(about));
    PossibleValuesParser::new(names).map(move |chosen| {
        let value = values.iter().find(|(_, name, _)| *name == chosen);
        value.expect("clap lets no other name through").0
    })
}

fn formats() -> impl TypedValueParser<Value = Format> {
    one_of(&[
        (Format::Csv, "csv", "summary.csv, backbone.csv, windows.csv, folds.csv, events.csv, …, branches/*.csv"),
        (Format::Mat, "mat", "For MATLAB and Octave, with all harmonics: run.mat, branches/*.mat"),
        (Format::Npz, "npz", "For NumPy, with all harmonics: run.npz, branches/*.npz"),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory;
        Cli::command().debug_assert();
    }

    #[cfg(feature = "figures")]
    #[test]
    fn figures_are_listed_where_an_unknown_one_is_asked_for() {
        let line = ["isola", "plot", "run", "-o", "a.svg", "--figure", "pie"];
        let error = Cli::try_parse_from(line).unwrap_err().to_string();
        assert!(error.contains("response, balance, backbone, map, folds, resonance, modes, motion"), "{error}");
    }
}
