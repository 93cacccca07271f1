//! A figure cut to a range of frequencies that was asked for.

use crate::figure::{Axis, ColumnStore, Figure, Panel, Scale, Series};

/// Cuts the panels that are drawn over the frequency to a range of it, rad/s. Amplitudes are scaled by what is left of the branches;
/// where there are none, of all curves.
pub fn cut(figure: &mut Figure, store: &ColumnStore, range: (f64, f64)) {
    for panel in &mut figure.panels {
        let is_over_frequency = |axis: &Axis| axis.name == Axis::of_frequencies(range, 1).name;
        let tops = tops(panel, store, range);
        for axis in panel.x.iter_mut().filter(|axis| is_over_frequency(axis)) {
            (axis.range, axis.whole) = (range, None);
        }
        for (axis, top) in panel.y.iter_mut().zip(tops) {
            // What was too high to be shown with the others stays so.
            if axis.scale == Scale::Linear && axis.range.0 == 0.0 && top > 0.0 {
                axis.range.1 = axis.range.1.min(ROOM * top);
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
