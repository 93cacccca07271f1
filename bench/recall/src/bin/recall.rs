//! Runs the product on the structures whose responses are known, and says what it finds and what it misses.

use clap::Parser;
use recall::comparison::{Compared, compare};
use recall::product::{Row, kept, sweep};
use recall::record::Record;
use recall::survey::{CROWDED, HARMONICS};
use recall::tally::Tally;
use std::path::{Path, PathBuf};

/// Runs `isola sweep` on the structures whose responses are known, and compares.
///
/// Ends with 1 if recall is below 99 %, an isola is listed that is none, or a main peak is wrong.
#[derive(Debug, Parser)]
struct Options {
    /// Folder of the truth.
    #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/truth"))]
    truth: PathBuf,
    /// The product [default: `isola` beside this program].
    #[arg(long)]
    isola: Option<PathBuf>,
    /// Numbers of the structures [default: all].
    #[arg(long, value_delimiter = ',')]
    only: Vec<u64>,
    /// Keep models, studies and runs in this folder.
    #[arg(long)]
    keep: Option<PathBuf>,
    /// Compare the runs that are in that folder, and run nothing.
    #[arg(long, requires = "keep")]
    again: bool,
    /// Arguments for `isola sweep`, after `--`.
    #[arg(last = true)]
    arguments: Vec<String>,
}

/// Motions of an isola beyond the truth from which it is followed anew.
const ASKED: usize = 8;

fn main() -> Result<std::process::ExitCode, Box<dyn std::error::Error>> {
    let options = Options::parse();
    let beside = || Ok::<_, std::io::Error>(std::env::current_exe()?.with_file_name("isola"));
    let isola = options.isola.clone().map_or_else(beside, Ok)?;
    let temporary = tempfile::tempdir()?;
    let folder = options.keep.as_deref().unwrap_or(temporary.path());
    let mut tally = Tally::default();
    for record in records(&options.truth)? {
        if !options.only.is_empty() && !options.only.contains(&record.number) {
            continue;
        }
        let folder = folder.join(record.number.to_string());
        let run =
            if options.again { kept(&folder, None)? } else { sweep(&isola, &record, &folder, &options.arguments)? };
        let decided = record.levels.iter().filter(|level| !level.crowded);
        let mut levels: Vec<Compared> = decided.map(|level| compare(level, &run.rows)).collect();
        // Where both together have that many nobody can say what there is.
        levels.retain(|compared| compared.found.len() + compared.extra.len() <= CROWDED);
        for compared in &mut levels {
            compared.confirm(&record, |row| run.motions(&isola, row, HARMONICS, ASKED))?;
        }
        levels.iter().for_each(|compared| tell(&record, compared, &run.rows));
        tally.add(&record, &levels, run.code);
    }
    println!("\n{}", tally.report());
    Ok(if tally.is_good() { 0 } else { 1 }.into())
}

/// All structures, by their numbers.
fn records(folder: &Path) -> Result<Vec<Record>, Box<dyn std::error::Error>> {
    let mut records = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "json") {
            let text = std::fs::read_to_string(&path)?;
            records
                .push(serde_json::from_str::<Record>(&text).map_err(|error| format!("{}: {error}", path.display()))?);
        }
    }
    records.sort_by_key(|record| record.number);
    Ok(records)
}

/// Prints what the product misses, adds, or has wrong at a level.
fn tell(record: &Record, compared: &Compared, rows: &[Row]) {
    let place = format!("{} ({:?}) A = {}", record.number, record.kind, compared.level.forcing);
    for (isola, _) in compared.found.iter().filter(|(isola, row)| row.is_none() && isola.counts()) {
        let [low, high] = isola.omega;
        let listed: Vec<String> = rows
            .iter()
            .filter(|row| row.amplitude == compared.level.forcing && row.kind != "main")
            .filter(|row| row.omega_min.is_some_and(|min| min < high) && row.omega_max.is_some_and(|max| max > low))
            .map(described)
            .collect();
        println!(
            "{place}: missed {:?} {low:.6} to {high:.6} rad/s, peak {:.5} ({} of {} starts met it); listed there: [{}]",
            isola.resonance,
            isola.peak[1],
            isola.hits,
            compared.level.starts,
            listed.join("; ")
        );
    }
    for (isola, row) in &compared.confirmed {
        let change = isola.change.map_or_else(|| "not found".into(), |change| format!("{:.2} % off", 100.0 * change));
        println!(
            "{place}: not stored, {} by the equations of the truth (with twice the harmonics {change}; {} of {} points marched): {}",
            if isola.counts() { "an isola" } else { "unresolved" },
            isola.marched[0],
            isola.marched[1],
            described(row)
        );
    }
    for row in &compared.extra {
        println!("{place}: not in the truth: {}", described(row));
    }
    if let (Some(row), Some([omega, peak])) = (compared.wrong_main, compared.level.main) {
        println!("{place}: main peak {peak:.5} at {omega:.5} rad/s, listed: {}", described(row));
    }
}

fn described(row: &Row) -> String {
    let number = |value: Option<f64>| value.map_or_else(|| "?".into(), |value| format!("{value:.6}"));
    format!(
        "{} {} {} to {}, {} at {}",
        row.kind,
        row.branch,
        number(row.omega_min),
        number(row.omega_max),
        number(row.amplitude_max),
        number(row.omega_at_max)
    )
}
