//! Amplitude over frequency: main branches thin, isolas bold, darker with the forcing amplitude.

use super::axis::Axis;
use super::panel::Panel;
use super::scene::{FREQUENCY, Scene};
use super::sheet::Sheet;
use super::style::{BOLD, FINE, GREY, THIN, dash, dashed, nth, solid};
use crate::error::Error;
use crate::report::Curve;
use plotive::Rgba8;

/// Levels whose branches have labels at most.
const LABELLED: usize = 8;
/// A main branch is shown at least where it is higher than this share of its peak.
const HIGH: f64 = 0.8;
/// Room beside what is shown at least, as a share of its width.
const ROOM: f64 = 0.25;

/// The figure.
pub fn sheet(scene: &Scene<'_>) -> Result<Sheet, Error> {
    let branches = &scene.report.branches;
    if branches.is_empty() {
        return Err(scene.nothing("the branch", "no branch of these levels has been computed yet"));
    }
    let highest =
        branches.iter().flat_map(|branch| &branch.amplitude[scene.monitor].values).copied().fold(0.0, f64::max);
    let (factor, title) = scene.amplitude_title(highest);
    let x = Axis::exact(FREQUENCY, range(branches, scene.monitor));
    let mut panel = Panel::new(x, Axis::exact(title, (0.0, 1.08 * highest * factor)));
    add_gap(&mut panel, scene, factor);
    if let Some(backbone) = &scene.report.backbone {
        let y = scaled(&backbone.amplitude[scene.monitor].values, factor);
        panel.line(&backbone.omega.values, &y, dashed(GREY, FINE), None);
        // Labels may cover it.
        panel.traces.clear();
    }
    let drawn = drawn_levels(branches);
    let color = |branch: &Curve| nth(drawn.iter().position(|&l| l == branch.level).unwrap_or(0), drawn.len());
    // What a lower level has lies inside of what a higher one has.
    for level in drawn.iter().rev() {
        for branch in branches.iter().filter(|branch| branch.level == *level) {
            add_branch(&mut panel, scene, branch, factor, color(branch));
        }
    }
    for branch in labelled(branches, &drawn) {
        let place = peak(branch, scene.monitor);
        let at = (branch.omega.values[place], branch.amplitude[scene.monitor].values[place] * factor);
        panel.label(name(scene, branch), at, color(branch));
    }
    Ok(panel.into())
}

/// Indices of the levels that have a branch.
fn drawn_levels(branches: &[Curve]) -> Vec<usize> {
    let mut levels: Vec<usize> = branches.iter().map(|branch| branch.level).collect();
    levels.sort_unstable();
    levels.dedup();
    levels
}

/// Branches that have labels, the most important first: isolas before main branches, the highest level, the lowest one,
/// and those between as far as they are not too many.
fn labelled<'b>(branches: &'b [Curve], levels: &[usize]) -> Vec<&'b Curve> {
    let stride = levels.len().div_ceil(LABELLED).max(1);
    let mut named: Vec<usize> = levels.iter().copied().rev().step_by(stride).collect();
    if named.len() > 2 {
        let lowest = named.pop();
        named.splice(1..1, lowest);
    }
    let kinds = ["isola", "main"].into_iter().flat_map(|kind| named.iter().map(move |level| (kind, *level)));
    let of = |(kind, level)| branches.iter().filter(move |branch| branch.kind == kind && branch.level == level);
    kinds.flat_map(of).collect()
}

fn scaled(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|value| value * factor).collect()
}

fn peak(branch: &Curve, monitor: usize) -> usize {
    let values = &branch.amplitude[monitor].values;
    (0..branch.size).max_by(|&i, &j| values[i].total_cmp(&values[j])).unwrap_or(0)
}

fn name(scene: &Scene<'_>, branch: &Curve) -> String {
    let amplitude = &scene.report.levels[branch.level].amplitude;
    if branch.kind == "main" { format!("A = {amplitude}") } else { format!("{}, A = {amplitude}", branch.name) }
}

fn add_branch(panel: &mut Panel, scene: &Scene<'_>, branch: &Curve, factor: f64, color: Rgba8) {
    let (x, y) = (&branch.omega.values, scaled(&branch.amplitude[scene.monitor].values, factor));
    match (branch.kind, branch.closed) {
        ("main", _) => panel.line(x, &y, solid(color, THIN), None),
        (_, true) => panel.closed(x, &y, color, BOLD),
        (_, false) => panel.line(x, &y, solid(color, BOLD), None),
    }
}

fn add_gap(panel: &mut Panel, scene: &Scene<'_>, factor: f64) {
    if let Some(gap) = scene.report.monitors[scene.monitor].gap.filter(|gap| gap * factor < panel.y.high) {
        panel.level(gap * factor, GREY, dash(2));
        panel.label("gap", (panel.x.high, gap * factor), GREY);
    }
}

/// The frequencies where something happens: all isolas and the upper parts of all main branches, with room beside them.
fn range(branches: &[Curve], monitor: usize) -> (f64, f64) {
    let all = branches.iter().flat_map(|branch| &branch.omega.values);
    let (first, last) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
    let shown = branches.iter().flat_map(|branch| {
        let values = &branch.amplitude[monitor].values;
        let floor = if branch.kind == "main" { HIGH * values[peak(branch, monitor)] } else { 0.0 };
        (0..branch.size).filter(move |&i| values[i] >= floor).map(|i| branch.omega.values[i])
    });
    let (low, high) = shown.fold((last, first), |(low, high), v| (low.min(v), high.max(v)));
    let room = ROOM * (high - low);
    let ends = ((low - room).max(first), (high + room).min(last));
    if ends.1 > ends.0 { ends } else { (first - 1e-3 * first.abs(), last + 1e-3 * last.abs()) }
}
