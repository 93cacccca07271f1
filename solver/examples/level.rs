//! Backbone, births and merges, and forcing levels of a model folder, printed:
//!
//!     cargo run --release --example level -- models/rotor67 20,60 contact.friction=0
//!
//! Settings of the model are overridden by `key=value`.

use solver::files;
use solver::response::backbone::Backbone;
use solver::response::branch::Branch;
use solver::response::level::{BranchId, Level};
use solver::response::windows::events;
use solver::settings::Settings;
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    match run(&std::env::args().skip(1).collect::<Vec<_>>()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[String]) -> Result<(), Box<dyn Error>> {
    let [folder, amplitudes, overrides @ ..] = arguments else {
        return Err("usage: level MODEL A[,A...] [key=value ...]".into());
    };
    let parse = |text: &str| match text.parse::<f64>() {
        Ok(amplitude) if amplitude > 0.0 && amplitude.is_finite() => Ok(amplitude),
        _ => Err(format!("forcing amplitude `{text}`: use a number above zero")),
    };
    let amplitudes = amplitudes.split(',').map(parse).collect::<Result<Vec<_>, _>>()?;
    let overrides = overrides
        .iter()
        .map(|text| text.split_once('=').ok_or_else(|| format!("`{text}`: use key=value")))
        .collect::<Result<Vec<_>, _>>()?;
    let model = files::load_with(Path::new(folder), &overrides)?;
    let settings = Settings::default();
    settings.validate(&model)?;

    let start = Instant::now();
    let backbone = Backbone::compute(&model, &settings)?;
    println!(
        "backbone of mode {}: {} points to {:.3e} m, {}, in {:.2} s",
        backbone.mode + 1,
        backbone.points.len(),
        backbone.max_amplitude(),
        backbone.outcome,
        start.elapsed().as_secs_f64()
    );
    for event in events(&backbone) {
        let mode = event.mode.map_or(String::new(), |mode| format!(", mode {}", mode + 1));
        println!(
            "  {:?} at A = {:.4}: {:.2} rad/s, {:.3e} m{mode}",
            event.kind, event.threshold, event.omega, event.amplitude
        );
    }
    for amplitude in amplitudes {
        let start = Instant::now();
        let level = Level::compute(&model, &settings, &backbone, amplitude)?;
        println!("A = {amplitude}, in {:.2} s", start.elapsed().as_secs_f64());
        for (id, branch) in level.branches() {
            print_branch(id, branch);
        }
        for (number, account) in level.windows.iter().enumerate() {
            let (low, high) = account.window.omega;
            let seeds: Vec<String> = account.seeds.iter().map(|seed| seed.outcome.to_string()).collect();
            println!("  window {} ({low:.2} to {high:.2} rad/s): {}", number + 1, seeds.join("; "));
        }
    }
    Ok(())
}

fn print_branch(id: BranchId, branch: &Branch) {
    let (low, high) = branch.frequency_range();
    let peak = branch.peak();
    println!(
        "  {id}: {}, {} points, {low:.2} to {high:.2} rad/s, at most {:.4e} m at {:.2} rad/s",
        branch.outcome,
        branch.points.len(),
        peak.amplitude(),
        peak.omega()
    );
}
