//! Frequency and size of the largest response over the forcing amplitude, three ways.

use super::axis::Axis;
use super::panel::Panel;
use super::scene::Scene;
use super::sheet::Sheet;
use super::style::{ALERT, GREY, LABEL, MEDIUM, THIN, dash, marker, separate, solid};
use crate::error::Error;
use crate::report::words::length_unit;
use crate::report::{Resonance, Ways};
use plotive::Rgba8;
use plotive::des::figure::LegendPos;
use plotive::style::MarkerShape;

/// A way to the largest response, and how it looks.
struct Way<'w> {
    name: &'static str,
    curve: &'w Resonance,
    color: Rgba8,
    pattern: usize,
    width: f32,
    shape: Option<MarkerShape>,
}

/// The figure.
pub fn sheet(scene: &Scene<'_>) -> Result<Sheet, Error> {
    let ways = looks(&scene.report.ways);
    let values = |of: fn(&Resonance) -> &[f64]| ways.iter().flat_map(move |way| of(way.curve).iter().copied());
    if values(|curve| &curve.value).next().is_none() {
        return Err(Error::Other("nothing to draw: the run has neither a backbone nor a branch yet".into()));
    }
    let (factor, unit) = length_unit(values(|curve| &curve.amplitude).fold(0.0, f64::max));
    let x = Axis::around("forcing amplitude A", values(|curve| &curve.value).chain([0.0]));
    let mut above = Panel::new(x.bare(), Axis::around("frequency (rad/s)", values(|curve| &curve.omega)));
    let title = format!("largest response ({unit})");
    let amplitudes = values(|curve| &curve.amplitude).map(|a| a * factor).chain([0.0]);
    let mut below = Panel::new(x, Axis::around(title, amplitudes));
    for way in &ways {
        let amplitude: Vec<f64> = way.curve.amplitude.iter().map(|a| a * factor).collect();
        add(&mut above, way, &way.curve.omega, true);
        add(&mut below, way, &amplitude, false);
    }
    Ok(Sheet { panels: vec![above, below], columns: 1, title: None, legend: Some(LegendPos::Top) })
}

fn looks(ways: &Ways) -> [Way<'_>; 3] {
    let way = |name, curve, color, pattern, width, shape| Way { name, curve, color, pattern, width, shape };
    [
        way("energy balance", &ways.balance, GREY, 0, THIN, None),
        way("main branches alone", &ways.continuation, ALERT, 1, MEDIUM, Some(MarkerShape::Square)),
        way("with isolas", &ways.isolas, separate(0), 2, MEDIUM, Some(MarkerShape::Circle)),
    ]
}

fn add(panel: &mut Panel, way: &Way<'_>, y: &[f64], is_named: bool) {
    let name = is_named.then_some(way.name);
    let stroke = solid(way.color, way.width).with_pattern(dash(way.pattern));
    match way.shape {
        None => panel.line(&way.curve.value, y, stroke, name),
        Some(shape) => {
            let marker = marker(shape, way.color, 0.75 * LABEL, shape == MarkerShape::Circle);
            panel.chain(&way.curve.value, y, (stroke, marker), name);
        }
    }
}
