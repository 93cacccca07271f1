//! A figure cut to ranges of its axes that were asked for.

use super::request::option_of;
use crate::error::Error;
use crate::figure::{Axis, ColumnStore, Figure, Measure, Panel, Scale, Series};
use crate::words::digits;

/// Cuts panels to ranges of what they are drawn over and of what they show, in the units of their axes. Where frequencies alone are
/// given, amplitudes are scaled by what is left of the branches; where there are none, of all curves.
///
/// # Errors
/// If nothing is drawn over a range, with what is.
pub fn cut(figure: &mut Figure, store: &ColumnStore, ranges: &[(Measure, (f64, f64))]) -> Result<(), Error> {
    for &(measure, range) in ranges {
        is_there(figure, store, measure, range)?;
    }
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
    Ok(())
}

/// Refuses a range of what is drawn over that lies beside everything: it may be meant in another unit.
fn is_there(figure: &Figure, store: &ColumnStore, measure: Measure, (low, high): (f64, f64)) -> Result<(), Error> {
    let across = |panel: &Panel| panel.x.iter().position(|axis| axis.measure == Some(measure));
    let panels: Vec<(&Panel, usize)> = figure.panels.iter().filter_map(|panel| Some((panel, across(panel)?))).collect();
    let Some(&(panel, place)) = panels.first() else { return Ok(()) };
    let unit = &panel.x[place].unit;
    let values = panels.iter().flat_map(|(panel, place)| {
        panel
            .series
            .iter()
            .filter_map(|series| series.x.get(*place).or(series.x.first()))
            .flat_map(|x| store.values(x, 1.0))
    });
    let (first, last) = values
        .map(|value| value * unit.factor)
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(first, last), value| (first.min(value), last.max(value)));
    if first > last || (low <= last && high >= first) {
        return Ok(());
    }
    let ends = [first, last].map(|end| digits(end, 6));
    Err(Error::Usage(format!(
        "{} {low} {high}: nothing is drawn there; what is goes from {} to {} {}, the unit of the axis",
        option_of(measure),
        ends[0],
        ends[1],
        unit.name
    )))
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
