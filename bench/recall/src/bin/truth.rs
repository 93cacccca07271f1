//! Finds the forced responses of random structures, by code that shares nothing with the product, and stores them.

use clap::Parser;
use recall::{draw, survey::survey};
use std::path::PathBuf;
use std::time::Instant;

/// Finds the forced responses of random structures and stores a file for each.
#[derive(Debug, Parser)]
struct Options {
    /// Number of the first structure.
    #[arg(long, default_value_t = 1)]
    from: u64,
    /// Number of structures.
    #[arg(long, default_value_t = 110)]
    count: u64,
    /// Random starts of a batch; a forcing level has two to ten batches.
    #[arg(long, default_value_t = 1000)]
    starts: usize,
    /// Folder of the files.
    #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/truth"))]
    to: PathBuf,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let options = Options::parse();
    for number in options.from..options.from + options.count {
        let begun = Instant::now();
        let record = survey(number, &draw::structure(number), options.starts);
        std::fs::write(options.to.join(format!("{number:03}.json")), serde_json::to_string(&record)? + "\n")?;
        let found: Vec<String> = record
            .levels
            .iter()
            .map(|level| {
                let isolas = level.isolas.iter().map(|isola| format!("{:?} {:?}", isola.standing, isola.resonance));
                let main = if level.main.is_some() { "" } else { "no main " };
                format!("{main}{} open [{}]", level.open, isolas.collect::<Vec<_>>().join(", "))
            })
            .collect();
        println!("{number} {:?}: {:.1} s: {}", record.kind, begun.elapsed().as_secs_f64(), found.join("; "));
    }
    Ok(())
}
