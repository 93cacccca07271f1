//! Convergence study on rotor 67 without friction at A = 60: peak of the main branch and range of the first isola over
//! the number of harmonics and the quadrature, as a table.
//!
//!     cargo run --release --example convergence

use solver::files;
use solver::response::backbone::Backbone;
use solver::response::level::Level;
use solver::settings::{HarmonicSettings, Quadrature, Settings};
use solver::structure::Model;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/rotor67");
    let model = files::load_with(&folder, &[("contact.friction", "0")])?;
    println!("| H | N_t | main peak, mm | at, rad/s | isola, rad/s | isola top, mm | points | time, s |");
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    for count in [5, 10, 20, 40] {
        for samples in [Some(128), Some(256), Some(512), Some(1024), None] {
            // N_t ≥ 4 H.
            if samples.is_some_and(|samples| samples < 4 * count) {
                continue;
            }
            let quadrature = if samples.is_some() { Quadrature::Samples } else { Quadrature::Arcs };
            let harmonics = HarmonicSettings { count, samples: samples.unwrap_or(512), quadrature };
            let label = samples.map_or("arcs".into(), |n| n.to_string());
            println!("| {count} | {label} | {} |", row(&model, harmonics)?);
        }
    }
    Ok(())
}

fn row(model: &Model, harmonics: HarmonicSettings) -> Result<String, Box<dyn Error>> {
    let mut settings = Settings { harmonics, ..Settings::default() };
    // Enough of the backbone for the first isola.
    settings.backbone.max_amplitude = Some(1.45e-3);
    settings.frequency.max = Some(2800.0);
    let start = Instant::now();
    let backbone = Backbone::compute(model, &settings)?;
    let level = Level::compute(model, &settings, &backbone, 60.0)?;
    let seconds = start.elapsed().as_secs_f64();
    let peak = level.main().peak();
    let isola = level.isolas().next();
    let range = isola.map_or("none".into(), |branch| {
        let (low, high) = branch.frequency_range();
        let how = if branch.is_closed() { String::new() } else { format!(" ({})", branch.outcome) };
        format!("{low:.2} to {high:.2}{how}")
    });
    let top = isola.map_or("".into(), |branch| format!("{:.4}", 1e3 * branch.peak().amplitude()));
    let points = level.branches().map(|(_, branch)| branch.points.len()).sum::<usize>();
    Ok(format!("{:.5} | {:.2} | {range} | {top} | {points} | {seconds:.1}", 1e3 * peak.amplitude(), peak.omega()))
}
