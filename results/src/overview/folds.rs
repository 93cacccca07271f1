//! Whether folds can be followed, and what happens along their curves.

use crate::store::{CurvePoint, CurveRow, WindowRow};
use crate::words::digits;
use solver::response::critical::CriticalKind;
use solver::response::folds::{Critical, Extent, Quantity};
use solver::settings::Settings;
use solver::structure::Model;

/// Most folds that a run of this model follows.
pub fn most_folds(model: &Model, settings: &Settings) -> usize {
    if why_no_folds(model, settings).is_some() { 0 } else { settings.search.effort.folds() }
}

/// Why folds cannot be followed, if so: a law has no second derivatives.
pub fn why_no_folds(model: &Model, settings: &Settings) -> Option<String> {
    let extent = Extent { forcing: (1.0, 2.0), frequency: (1.0, 2.0), points: 1 };
    Critical::new(model, settings, Quantity::Frequency, extent).err().map(|error| error.to_string())
}

/// Where fold curves have an isola born in the frequency range of a window, at a larger forcing than the window's: there the
/// balance predicts it too early.
pub fn later_birth<'c>(curves: &'c [CurveRow], forcing: f64, window: &WindowRow) -> Option<&'c CurvePoint> {
    let births = curves.iter().flat_map(CurveRow::events).filter(|(kind, _)| *kind == CriticalKind::Birth.name());
    let is_later =
        |point: &&CurvePoint| point.forcing > forcing && (window.omega.0..=window.omega.1).contains(&point.omega);
    births.map(|(_, point)| point).filter(is_later).min_by(|a, b| a.forcing.total_cmp(&b.forcing))
}

/// Births or merges that a sentence names.
const EVENTS: usize = 6;

fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-6 * a.abs().max(b.abs())
}

/// Where isolas are born and where branches merge, as fold curves say.
pub fn events_sentence(curves: &[CurveRow], frequency: impl Fn(f64) -> String) -> Option<String> {
    let of = |wanted: &str| -> Vec<String> {
        let points = curves.iter().flat_map(CurveRow::events).filter(|(kind, _)| *kind == wanted);
        let mut points: Vec<(f64, f64)> = points.map(|(_, point)| (point.forcing, point.omega)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Where a curve stops at grazing, another one may begin on it again.
        points.dedup_by(|a, b| is_same(a.0, b.0) && is_same(a.1, b.1));
        points.into_iter().map(|(forcing, omega)| format!("{} ({})", digits(forcing, 5), frequency(omega))).collect()
    };
    let part = |wanted: &str, one: &str, many: &str| {
        let list = of(wanted);
        let verb = if list.len() == 1 { one } else { many };
        let more = list.len().saturating_sub(EVENTS);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let named: Vec<String> = list.iter().take(EVENTS).cloned().collect();
        (!list.is_empty()).then(|| format!("{verb} at A = {}{more}", named.join(", ")))
    };
    let parts: Vec<String> = [
        part("birth", "an isola is born", "isolas are born"),
        part("death", "an isola vanishes", "isolas vanish"),
        part("merge", "two branches merge or part", "branches merge or part"),
    ]
    .into_iter()
    .flatten()
    .collect();
    (!parts.is_empty()).then(|| format!("Computed along fold curves: {}.", parts.join("; ")))
}
