//! A figure cut to ranges of its axes that were asked for.

use crate::figure::{Axis, ColumnStore, Figure, Measure, Panel, Scale, Series};

/// Cuts panels to ranges of what they are drawn over and of what they show, in the units of their axes. Where frequencies alone are
/// given, amplitudes are scaled by what is left of the branches; where there are none, of all curves.
pub fn cut(figure: &mut Figure, store: &ColumnStore, ranges: &[(Measure, (f64, f64))]) {
    let of = |axis: &Axis| {
        let (_, (low, high)) = ranges.iter().find(|(measure, _)| Some(*measure) == axis.measure)?;
        Some((low / axis.unit.factor, high / axis.unit.factor))
    };
    for panel in &mut figure.panels {
        let across = panel.x.iter().find(|axis| axis.measure == Some(Measure::Frequency)).and_then(of);
        let tops = across.map_or_else(Vec::new, |across| tops(panel, store, across));
        for (axis, top) in panel.y.iter_mut().zip(tops) {
            // What was too high to be shown with the others stays so.
            if axis.scale == Scale::Linear && axis.range.0 == 0.0 && top > 0.0 {
                axis.range.1 = axis.range.1.min(ROOM * top);
            }
        }
        for axis in panel.x.iter_mut().chain(&mut panel.y) {
            if let Some(range) = of(axis) {
                (axis.range, axis.whole) = (range, None);
            }
        }
    }
}

/// Amplitudes are shown up to so many times the largest.
const ROOM: f64 = 1.08;

/// The largest value up, on each axis, of what lies in the range.
fn tops(panel: &Panel, store: &ColumnStore, (low, high): (f64, f64)) -> Vec<f64> {
    let is_branch = |series: &&Series| series.level.is_some();
    let has_branches = panel.series.iter().any(|series| is_branch(&series));
    let counted = || panel.series.iter().filter(|series| !has_branches || is_branch(series));
    let top = |m: usize| {
        let of = |series: &Series| {
            let (Some(x), Some(y)) = (series.x.first(), series.y.get(m)) else { return 0.0 };
            let (x, y) = (store.values(x, 1.0), store.values(y, 1.0));
            let inside = x.iter().zip(&y).filter(|(x, y)| (low..=high).contains(*x) && y.is_finite());
            inside.map(|(_, y)| *y).fold(0.0, f64::max)
        };
        counted().map(of).fold(0.0, f64::max)
    };
    (0..panel.y.len()).map(top).collect()
}
