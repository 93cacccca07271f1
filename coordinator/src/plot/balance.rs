//! Energies along the backbone: what is dissipated against the work of the forcing at one amplitude.

use super::axis::Axis;
use super::panel::Panel;
use super::scene::Scene;
use super::sheet::Sheet;
use super::style::{INK, MEDIUM, dashed, separate, solid};
use crate::error::Error;
use crate::report::{Level, Window};
use plotive::Rgba8;
use plotive::des::figure::LegendPos;

/// Energies that span more than this factor are drawn logarithmically.
const WIDE: f64 = 20.0;

/// The figure.
pub fn sheet(scene: &Scene<'_>) -> Result<Sheet, Error> {
    let backbone = scene.backbone()?;
    let level = scene.level()?;
    let (x, over) = scene.over(backbone);
    let needed = &backbone.needed.values;
    let work: Vec<f64> = backbone.work.values.iter().map(|work| level.value * work).collect();
    let mut panel = Panel::new(x, energies(needed.iter().chain(&work).copied()));
    for (window, color) in level.windows.iter().zip(colors(level)) {
        let inside = window.first..(window.last + 1).min(over.len());
        panel.between(&over[inside.clone()], &needed[inside.clone()], &work[inside], color);
        let best = window.best.min(over.len() - 1);
        panel.label(name(window), (over[best], (needed[best] * work[best]).sqrt()), color);
    }
    panel.line(
        &over,
        &work,
        dashed(separate(4), MEDIUM),
        Some(&format!("work of the forcing A·W, A = {}", level.amplitude)),
    );
    panel.line(&over, needed, solid(INK, MEDIUM), Some("dissipated energy, A*·W"));
    Ok(Sheet { legend: Some(LegendPos::Top), ..panel.into() })
}

fn energies(values: impl Iterator<Item = f64> + Clone) -> Axis {
    const TITLE: &str = "energy a period (J)";
    let positive = values.clone().filter(|&value| value > 0.0);
    let (low, high) = positive.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| (low.min(v), high.max(v)));
    if high > WIDE * low { Axis::logarithmic(TITLE, values) } else { Axis::around(TITLE, values.chain([0.0])) }
}

/// Colours of the windows of a level: one for each thing that they led to.
pub fn colors(level: &Level) -> Vec<Rgba8> {
    let names: Vec<String> = level.windows.iter().map(name).collect();
    let first = |name| names.iter().position(|other| other == name).unwrap_or(0);
    names.iter().map(|name| separate(first(name))).collect()
}

/// A window and what it led to.
pub fn name(window: &Window) -> String {
    match window.outcome.as_str() {
        "found" => window.branches.clone(),
        "not_found" => format!("window {}, not found", window.number),
        _ => format!("window {}, pending", window.number),
    }
}
