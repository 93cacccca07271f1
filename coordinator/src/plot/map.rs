//! Isola map: the threshold along the backbone, where windows are born and merge, and what every level has.

use super::axis::Axis;
use super::panel::Panel;
use super::scene::{FREQUENCY, Scene};
use super::sheet::Sheet;
use super::style::{ALERT, BOLD, FINE, GREY, INK, LABEL, MEDIUM, PENDING, dashed, dotted, marker, separate, solid};
use crate::error::Error;
use crate::report::Window;
use crate::report::words::digits;
use crate::survey::{BranchRow, Level};
use plotive::des::figure::LegendPos;
use plotive::style::MarkerShape;
use plotive::style::series::Stroke;
use solver::windows::EventKind;

/// Thresholds within this factor of the levels are shown.
const NEAR: f64 = 4.0;

/// The figure.
pub fn sheet(scene: &Scene<'_>) -> Result<Sheet, Error> {
    let backbone = scene.backbone()?;
    let isolas = || scene.levels.iter().flat_map(|level| level.isolas().map(move |isola| (level, isola)));
    let ends = isolas().flat_map(|(_, isola)| [isola.omega.0, isola.omega.1]);
    let x = Axis::around(FREQUENCY, backbone.omega.values.iter().copied().chain(ends));
    let y = Axis::logarithmic("forcing amplitude A, threshold A*", thresholds(scene, &backbone.threshold.values));
    let mut panel = Panel::new(x, y);
    panel.line(
        &backbone.omega.values,
        &backbone.threshold.values,
        solid(INK, MEDIUM),
        Some("threshold A* of the backbone"),
    );

    let bars =
        |levels: Vec<(&Level, (f64, f64))>| segments(levels.into_iter().map(|(level, ends)| (level.value, ends)));
    let mains = scene.levels.iter().filter_map(|level| Some((level, level.main()?.omega))).collect();
    add(&mut panel, bars(mains), solid(GREY, FINE), "main branches");
    let found = isolas().map(|(level, isola): (_, &BranchRow)| (level, isola.omega)).collect();
    add(&mut panel, bars(found), solid(separate(0), BOLD), "isolas");
    add_windows(&mut panel, scene, "not_found", dashed(ALERT, MEDIUM), "windows not found");
    add_windows(&mut panel, scene, "pending", dotted(PENDING, MEDIUM), "windows pending");
    let (x, y): (Vec<f64>, Vec<f64>) =
        windows(scene, "not_found").map(|(value, window)| (window.omega_best, value)).unzip();
    panel.points(&x, &y, marker(MarkerShape::Cross, ALERT, 0.8 * LABEL, true), None);
    add_events(&mut panel, scene, EventKind::Birth, MarkerShape::TriangleUp, "births");
    add_events(&mut panel, scene, EventKind::Merge, MarkerShape::TriangleDown, "merges");
    Ok(Sheet { legend: Some(LegendPos::Top), ..panel.into() })
}

/// What the axis of A spans: all levels, and thresholds within a few times as much or as little.
fn thresholds<'s>(scene: &'s Scene<'_>, backbone: &'s [f64]) -> impl Iterator<Item = f64> + 's {
    let levels = scene.levels.iter().map(|level| level.value);
    let (low, high) = levels.clone().fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| (low.min(v), high.max(v)));
    let is_near = move |value: &f64| (low / NEAR..=high * NEAR).contains(value);
    levels.chain(backbone.iter().copied().filter(is_near))
}

/// Level lines with gaps between them.
fn segments(bars: impl Iterator<Item = (f64, (f64, f64))>) -> (Vec<f64>, Vec<f64>) {
    bars.flat_map(|(value, (low, high))| [(low, value), (high, value), (f64::NAN, f64::NAN)]).unzip()
}

fn add(panel: &mut Panel, (x, y): (Vec<f64>, Vec<f64>), stroke: Stroke, name: &str) {
    panel.line(&x, &y, stroke, Some(name));
}

/// Windows of the chosen levels with this outcome, each with its forcing amplitude.
fn windows<'s>(scene: &'s Scene<'_>, outcome: &'static str) -> impl Iterator<Item = (f64, &'s Window)> {
    let chosen = |value: f64| scene.levels.iter().any(|level| level.value == value);
    let levels = scene.report.levels.iter().filter(move |level| chosen(level.value));
    let all = levels.flat_map(|level| level.windows.iter().map(|window| (level.value, window)));
    all.filter(move |(_, window)| window.outcome == outcome)
}

fn add_windows(panel: &mut Panel, scene: &Scene<'_>, outcome: &'static str, stroke: Stroke, name: &str) {
    add(panel, segments(windows(scene, outcome).map(|(value, window)| (value, window.omega))), stroke, name);
}

fn add_events(panel: &mut Panel, scene: &Scene<'_>, kind: EventKind, shape: MarkerShape, name: &str) {
    let Some(backbone) = &scene.report.backbone else { return };
    let is_shown = |threshold: f64| (0.0..=1.0).contains(&panel.y.share(threshold));
    let events: Vec<_> =
        backbone.events.iter().filter(|event| event.kind == kind && is_shown(event.threshold)).collect();
    let (x, y): (Vec<f64>, Vec<f64>) = events.iter().map(|event| (event.omega, event.threshold)).unzip();
    panel.points(&x, &y, marker(shape, INK, LABEL, kind == EventKind::Birth), Some(name));
    for event in events {
        panel.label(digits(event.threshold, 3), (event.omega, event.threshold), INK);
    }
}
