//! Amplitude over frequency along the backbone, with the windows of one forcing amplitude.

use super::axis::Axis;
use super::balance::{colors, name};
use super::panel::Panel;
use super::scene::{FREQUENCY, Scene};
use super::sheet::Sheet;
use super::style::{BOLD, GREY, INK, THIN, dash, solid};
use crate::error::Error;

/// The figure.
pub fn sheet(scene: &Scene<'_>) -> Result<Sheet, Error> {
    let backbone = scene.backbone()?;
    let level = scene.level()?;
    let amplitude = &backbone.amplitude[scene.monitor].values;
    let (factor, title) = scene.amplitude_title(amplitude.iter().copied().fold(0.0, f64::max));
    let (x, y) = (&backbone.omega.values, amplitude.iter().map(|a| a * factor).collect::<Vec<f64>>());
    let axes = (Axis::around(FREQUENCY, x.iter().copied()), Axis::around(title, y.iter().copied().chain([0.0])));
    let mut panel = Panel::new(axes.0, axes.1);
    if let Some(gap) = scene.report.monitors[scene.monitor].gap {
        panel.level(gap * factor, GREY, dash(2));
    }
    for (window, color) in level.windows.iter().zip(colors(level)) {
        let inside = window.first..(window.last + 1).min(y.len());
        panel.line(&x[inside.clone()], &y[inside], solid(color, 2.0 * BOLD), None);
        let middle = ((window.first + window.last) / 2).min(y.len() - 1);
        panel.label(name(window), (x[middle], y[middle]), color);
    }
    panel.line(x, &y, solid(INK, THIN), None);
    if let Some(gap) = scene.report.monitors[scene.monitor].gap {
        panel.label("gap", (panel.x.high, gap * factor), GREY);
    }
    Ok(Sheet { title: Some(format!("windows at A = {}", level.amplitude)), ..panel.into() })
}
