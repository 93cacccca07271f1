//! Replays a finished run with any number of workers, and says how busy they were kept.

use clap::{Parser, Subcommand};
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use replay::bound::Bound;
use replay::measure::{Measured, idle, replay};
use replay::recording::Recording;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Replays finished runs with any number of workers that sleep instead of computing.
#[derive(Debug, Parser)]
struct Options {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Replays a run from its beginning to its end, once for every number of workers.
    Run {
        #[command(flatten)]
        given: Given,
        /// Numbers of workers.
        #[arg(long, value_delimiter = ',', default_value = "1,2,7,16,64")]
        workers: Vec<usize>,
        /// Write the figures to this file, JSON.
        #[arg(long)]
        json: Option<PathBuf>,
    },
    /// Measures what workers cost that have nothing to do: all but those that hold on to a task.
    Idle {
        #[command(flatten)]
        given: Given,
        /// Number of workers.
        #[arg(long, default_value_t = 512)]
        workers: usize,
        /// How long it is measured, s.
        #[arg(long, default_value_t = 10.0)]
        seconds: f64,
    },
}

#[derive(Debug, clap::Args)]
struct Given {
    /// Folder of a finished run.
    recording: PathBuf,
    /// The product [default: `isola` beside this program].
    #[arg(long)]
    isola: Option<PathBuf>,
    /// What recorded times are multiplied by: 0 for tasks that take no time.
    #[arg(long, default_value_t = 1.0)]
    scale: f64,
    /// Keep the runs in this folder.
    #[arg(long)]
    keep: Option<PathBuf>,
}

impl Given {
    fn read(&self) -> Result<(PathBuf, Arc<Recording>), Box<dyn Error>> {
        let beside = || Ok::<_, std::io::Error>(std::env::current_exe()?.with_file_name("isola"));
        let isola = self.isola.clone().map_or_else(beside, Ok)?;
        Ok((isola, Arc::new(Recording::read(&self.recording, self.scale)?)))
    }
}

#[tokio::main]
async fn main() -> Result<(), Box<dyn Error>> {
    let temporary = tempfile::tempdir()?;
    match Options::parse().command {
        Command::Run { given, workers, json } => {
            let (isola, recording) = given.read()?;
            let bound = Bound::of(&recording);
            println!(
                "{} tasks, {:.2} s of work, longest chain {:.2} s",
                recording.tasks.len(),
                bound.work,
                bound.chain
            );
            let folder = given.keep.as_deref().unwrap_or(temporary.path());
            let mut list = Vec::new();
            for count in workers {
                let folder = folder.join(format!("{count}-{}", list.len()));
                list.push(replay(&isola, &recording, &given.recording, count, &folder).await?);
                println!("{}", table(&list));
                write(&list, json.as_deref())?;
            }
        }
        Command::Idle { given, workers, seconds } => {
            let (isola, recording) = given.read()?;
            let folder = given.keep.as_deref().unwrap_or(temporary.path()).join("idle");
            let share = idle(&isola, &recording, workers, seconds, &folder).await?;
            println!("{workers} workers: {:.1} % of a core", 100.0 * share);
        }
    }
    Ok(())
}

fn write(list: &[Measured], json: Option<&Path>) -> Result<(), Box<dyn Error>> {
    if let Some(file) = json {
        std::fs::write(file, serde_json::to_string_pretty(list)?)?;
    }
    Ok(())
}

fn table(list: &[Measured]) -> Table {
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED).set_header([
        "workers",
        "tasks",
        "s",
        "bound, s",
        "efficiency",
        "tasks/s",
        "coordinator, CPU s",
        "MB",
        "closing, s",
        "manifest, B",
        "status, B",
        "same",
    ]);
    for m in list {
        table.add_row([
            m.workers.to_string(),
            format!("{} ({} more)", m.tasks, m.speculative),
            format!("{:.2}", m.seconds),
            format!("{:.2}", m.bound),
            format!("{:.0} %", 100.0 * m.efficiency),
            format!("{:.0}", m.rate),
            format!("{:.2}", m.processor),
            format!("{:.0}", m.memory),
            format!("{:.2}", m.closing),
            m.manifest.to_string(),
            m.status.to_string(),
            if m.same { "yes" } else { "no" }.to_string(),
        ]);
    }
    table
}
