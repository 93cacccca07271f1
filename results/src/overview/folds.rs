//! Whether folds can be followed, and what happens along their curves.

use super::bounds::is_within;
use super::level::Level;
use super::windows::overlaps;
use crate::store::{CurvePoint, CurveRow, WindowRow};
use crate::words::digits;
use solver::response::critical::CriticalKind;
use solver::response::folds::{Critical, Extent, Quantity};
use solver::response::forced::SearchRange;
use solver::response::orders::orders;
use solver::settings::{FrequencySettings, Settings};
use solver::structure::Model;

/// Most folds that a run of this model follows.
pub fn most_folds(model: &Model, settings: &Settings) -> usize {
    let orders = orders(model, &settings.search).len();
    if why_no_folds(model, settings).is_some() { 0 } else { orders * settings.search.effort.folds() }
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

/// The births along fold curves between the lowest and the highest level, by forcing, at frequencies within `bounds`.
pub fn born_between<'c>(levels: &[Level], curves: &'c [CurveRow], bounds: FrequencySettings) -> Vec<&'c CurvePoint> {
    let range = |(low, high): (f64, f64), level: &Level| (low.min(level.value), high.max(level.value));
    let (low, high) = levels.iter().fold((f64::INFINITY, f64::NEG_INFINITY), range);
    let is_between =
        |birth: &&CurvePoint| birth.forcing > low && birth.forcing < high && is_within(bounds, birth.omega);
    events_of(curves, CriticalKind::Birth.name()).into_iter().filter(is_between).collect()
}

/// The first birth along fold curves above the highest level, at frequencies within `bounds`.
pub fn born_above<'c>(levels: &[Level], curves: &'c [CurveRow], bounds: FrequencySettings) -> Option<&'c CurvePoint> {
    let highest = levels.iter().map(|level| level.value).fold(0.0, f64::max);
    let is_above = |birth: &&CurvePoint| birth.forcing > highest && is_within(bounds, birth.omega);
    events_of(curves, CriticalKind::Birth.name()).into_iter().find(is_above)
}

/// The births along fold curves below the lowest level, by forcing, at frequencies within `bounds`.
pub fn born_below<'c>(levels: &[Level], curves: &'c [CurveRow], bounds: FrequencySettings) -> Vec<&'c CurvePoint> {
    let lowest = levels.iter().map(|level| level.value).fold(f64::INFINITY, f64::min);
    let is_below = |birth: &&CurvePoint| birth.forcing < lowest && is_within(bounds, birth.omega);
    events_of(curves, CriticalKind::Birth.name()).into_iter().filter(is_below).collect()
}

/// Levels at which what is born at none can be looked at, the lowest first, in few digits: half way to the next level above, or to where
/// isolas end or folds are followed to before.
pub fn levels_after(births: &[&CurvePoint], levels: &[Level], curves: &[CurveRow]) -> Vec<String> {
    let ends = [CriticalKind::Death, CriticalKind::Merge].into_iter().flat_map(|kind| events_of(curves, kind.name()));
    let values = levels.iter().map(|level| level.value);
    let followed = values.clone().fold(0.0, f64::max) * SearchRange::BEYOND;
    let others: Vec<f64> = values.chain(ends.map(|end| end.forcing)).chain([followed]).collect();
    let after = |birth: &&CurvePoint| {
        let above = others
            .iter()
            .copied()
            .filter(|other| *other > birth.forcing * (1.0 + CurvePoint::SAME))
            .reduce(f64::min)?;
        level_between(birth.forcing, above)
    };
    let mut list: Vec<String> = births.iter().filter_map(after).collect();
    list.dedup();
    list
}

/// A level half way between two forcing amplitudes, in few digits.
pub fn level_between(low: f64, high: f64) -> Option<String> {
    let middle = f64::midpoint(low, high);
    // A digit less than that keeps it between the two.
    let is_between = |count: &i32| digits(middle, *count).parse().is_ok_and(|a: f64| a > low && a < high);
    (1..=DIGITS).find(is_between).map(|count| digits(middle, count))
}

/// Most digits of such a level.
const DIGITS: i32 = 6;

/// Folds that are never followed: those of so many branches that branch off others. `None` if there are none.
pub fn not_followed(branches: usize) -> Option<String> {
    match branches {
        0 => None,
        1 => Some("folds of 1 branch that branches off others".into()),
        several => Some(format!("folds of {several} branches that branch off others")),
    }
}

/// What is not known of them.
pub fn not_followed_sentence(branches: usize) -> Option<String> {
    let folds = not_followed(branches)?;
    Some(format!("Births and merges along {folds} are not among these: such folds were not followed over the forcing."))
}

/// What happens along a fold curve.
#[derive(Debug, Clone, Copy)]
pub struct CurveEvent<'c> {
    /// Number of the curve, from 1.
    pub curve: usize,
    /// `birth`, `merge`, …
    pub kind: &'c str,
    /// Where.
    pub point: &'c CurvePoint,
}

/// What happens along the curves, one after the other; what two curves share stands once, at the first of them.
pub fn curve_events(curves: &[CurveRow]) -> Vec<CurveEvent<'_>> {
    let all = curves
        .iter()
        .flat_map(|curve| curve.events().map(|(kind, point)| CurveEvent { curve: curve.number, kind, point }));
    let mut kept: Vec<CurveEvent<'_>> = Vec::new();
    for event in all {
        if !kept.iter().any(|earlier| earlier.kind == event.kind && earlier.point.is_at(event.point)) {
            kept.push(event);
        }
    }
    kept
}

/// Points at which this happens, by forcing; what two curves share once.
pub fn events_of<'c>(curves: &'c [CurveRow], wanted: &str) -> Vec<&'c CurvePoint> {
    let found = curve_events(curves).into_iter().filter(|event| event.kind == wanted);
    let mut points: Vec<&CurvePoint> = found.map(|event| event.point).collect();
    points.sort_by(|a, b| a.forcing.total_cmp(&b.forcing));
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_two_curves_share_is_one_event() {
        let point = |forcing, omega, event: &str| CurvePoint {
            forcing,
            omega,
            amplitude: 1.0,
            event: (!event.is_empty()).then(|| event.into()),
            ..CurvePoint::default()
        };
        let curve = |number, points| CurveRow { number, points, ..CurveRow::default() };
        let curves = [
            curve(1, vec![point(3.0, 2.0, "merge"), point(2.0, 2.0, ""), point(1.0, 2.0, "birth")]),
            // The same birth but for rounding, a merge where the birth is, and another birth at the same forcing.
            curve(2, vec![point(1.0 + 1e-6, 2.0, "birth"), point(1.0, 2.0, "merge"), point(1.0, 2.1, "birth")]),
        ];
        let found: Vec<(usize, &str)> = curve_events(&curves).iter().map(|event| (event.curve, event.kind)).collect();
        assert_eq!(found, [(1, "merge"), (1, "birth"), (2, "merge"), (2, "birth")]);
        let forcings = |kind| events_of(&curves, kind).iter().map(|point| point.forcing).collect::<Vec<_>>();
        assert_eq!(forcings("birth"), [1.0, 1.0]);
        assert_eq!(forcings("merge"), [1.0, 3.0]);
    }

    #[test]
    fn what_is_born_between_levels_has_a_level_to_be_looked_at() {
        let point = |forcing: f64, event: Option<&str>| CurvePoint {
            forcing,
            event: event.map(str::to_string),
            ..CurvePoint::default()
        };
        let level = |value| Level { value, ..Level::default() };
        let levels = [1.0, 2.0].map(level);
        let curve = |points| [CurveRow { points, ..CurveRow::default() }];
        let after = |birth: f64, end: Option<f64>| {
            let points = [Some(point(birth, Some("birth"))), end.map(|end| point(end, Some("death")))];
            let curves = curve(points.into_iter().flatten().collect());
            levels_after(&[&curves[0].points[0]], &levels, &curves)
        };
        // Half way to the level above, or to the end of what is born, in as few digits as lie between.
        assert_eq!(after(1.246, None), ["1.6"]);
        assert_eq!(after(1.246, Some(1.25)), ["1.248"]);
        assert_eq!(after(1.99, None), ["1.995"]);
        // Above the highest level folds are followed to twice as much.
        assert_eq!(after(2.5, None), ["3"]);
        // A cusp ends no isola.
        let curves = curve(vec![point(1.246, Some("birth")), point(1.25, Some("cusp"))]);
        assert_eq!(levels_after(&[&curves[0].points[0]], &levels, &curves), ["1.6"]);
    }
}
