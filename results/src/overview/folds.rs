//! Whether folds can be followed, and what happens along their curves.

use super::level::Level;
use crate::store::{BranchRow, CurvePoint, CurveRow, WindowRow};
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

/// Where fold curves have the first isola born in the frequency range of a window of a level, if that is at a larger forcing and no
/// isola is there at the level: the balance predicts it too early.
pub fn later_birth<'c>(curves: &'c [CurveRow], level: &Level, window: &WindowRow) -> Option<&'c CurvePoint> {
    if level.isolas().any(|isola| overlaps(isola, window)) {
        return None;
    }
    let (low, high) = window.omega;
    let births = events_of(curves, CriticalKind::Birth.name());
    let first = births.into_iter().find(|birth| (low..=high).contains(&birth.omega));
    first.filter(|birth| birth.forcing > level.value)
}

/// Whether a branch has frequencies of a window.
pub fn overlaps(branch: &BranchRow, window: &WindowRow) -> bool {
    branch.omega.0 <= window.omega.1 && branch.omega.1 >= window.omega.0
}

/// Relative distance up to which what happens along two curves is one thing: where a curve stops at grazing, another one may
/// begin on it again.
const SAME: f64 = 1e-5;

/// Points of all curves at which this happens, by forcing; what two curves share once.
pub fn events_of<'c>(curves: &'c [CurveRow], wanted: &str) -> Vec<&'c CurvePoint> {
    let points = curves.iter().flat_map(CurveRow::events).filter(|(kind, _)| *kind == wanted);
    let mut points: Vec<&CurvePoint> = points.map(|(_, point)| point).collect();
    points.sort_by(|a, b| a.forcing.total_cmp(&b.forcing));
    let mut kept: Vec<&CurvePoint> = Vec::new();
    for point in points {
        let mut near = kept.iter().rev().take_while(|earlier| is_near(earlier.forcing, point.forcing));
        if !near.any(|earlier| is_same(earlier, point)) {
            kept.push(point);
        }
    }
    kept
}

/// Whether what happens at two points is one thing.
pub(super) fn is_same(one: &CurvePoint, other: &CurvePoint) -> bool {
    is_near(one.forcing, other.forcing) && is_near(one.omega, other.omega)
}

fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}
