//! Two masses, the light one before a rigid stop: from their matrices to an isola, printed.
//!
//!     cargo run --release -p solver --example two_masses

use solver::{Backbone, Level, Model, Settings, events};
use std::error::Error;

/// Fails if there is no isola.
pub fn main() -> Result<(), Box<dyn Error>> {
    let model = Model::builder("two masses and a stop")
        .mass([[1.0, 0.0], [0.0, 0.05]])
        .stiffness([[2.0, -1.0], [-1.0, 1.05]])
        .damping_ratio(0.01)
        .force("x1", 1.0)
        .stop("stop", "x2", 1.0)
        .build()?;
    let mut settings = Settings::default();
    settings.harmonics.count = 20;
    let backbone = Backbone::compute(&model, &settings)?;
    for event in events(&backbone) {
        println!("{:?} at A = {:.4}, {:.4} rad/s", event.kind, event.threshold, event.omega);
    }
    let level = Level::compute(&model, &settings, &backbone, 0.028)?;
    for (name, branch) in level.branches() {
        let (low, high) = branch.frequency_range();
        let peak = branch.peak();
        println!("{name}: {low:.4} to {high:.4} rad/s, {}", branch.outcome);
        println!("  at most {:.4} m, at {:.4} rad/s", peak.amplitude(), peak.omega());
    }
    let isola = level.isolas().find(|branch| branch.is_closed()).ok_or("no isola")?;
    for [x, v] in isola.peak().state.over_period(&model, 0, 8) {
        println!("  x1 = {x:7.4} m, {v:7.4} m/s");
    }
    Ok(())
}
