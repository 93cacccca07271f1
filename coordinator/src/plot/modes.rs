//! Contributions of the modes along the backbone, with the resonances between them.

use super::axis::Axis;
use super::panel::Panel;
use super::scene::Scene;
use super::sheet::Sheet;
use super::style::{INK, MEDIUM, THIN, dash, separate, solid};
use crate::error::Error;
use crate::report::words::digits;
use crate::report::{ModeShare, Peak};
use plotive::Rgba8;
use plotive::des::figure::LegendPos;

/// Contributions below this are not drawn.
const FLOOR: f64 = 1e-6;

/// The figure.
pub fn sheet(scene: &Scene<'_>) -> Result<Sheet, Error> {
    let backbone = scene.backbone()?;
    if backbone.modes.len() < 2 {
        return Err(Error::Other("nothing to draw: one mode alone makes the backbone".into()));
    }
    let (x, over) = scene.over(backbone);
    let shares = backbone.modes.iter().flat_map(|mode| &mode.share.values).copied().filter(|&share| share > FLOOR);
    let mut panel = Panel::new(x, Axis::logarithmic("contribution to the motion", shares));
    for (i, mode) in backbone.modes.iter().enumerate() {
        let (color, width) = look(i);
        let stroke = solid(color, width).with_pattern(dash(i));
        panel.line(&over, &mode.share.values, stroke, Some(&legend(mode)));
    }
    for peak in &backbone.peaks {
        let place = backbone.modes.iter().position(|mode| mode.mode == peak.mode).unwrap_or(0);
        panel.label(name(peak), (over[peak.index], peak.share), look(place).0);
    }
    Ok(Sheet { legend: Some(LegendPos::Top), ..panel.into() })
}

/// The mode followed is black and bold.
fn look(place: usize) -> (Rgba8, f32) {
    if place == 0 { (INK, MEDIUM) } else { (separate(place - 1), THIN) }
}

fn legend(mode: &ModeShare) -> String {
    format!("mode {} ({} rad/s)", mode.mode + 1, digits(mode.frequency, 4))
}

/// Modes are counted from 1. Out of resonance only the largest harmonic is said.
fn name(peak: &Peak) -> String {
    let (mode, harmonic) = (peak.mode + 1, peak.harmonic);
    let multiple = if harmonic == 1 { "ω".into() } else { format!("{harmonic}ω") };
    if peak.resonant { format!("mode {mode} at {multiple}") } else { format!("mode {mode} ({multiple})") }
}
