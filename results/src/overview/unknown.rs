//! What happens along fold curves, and is neither known to be a birth nor a merge.

use super::level::Level;
use crate::store::{CurvePoint, CurveRow};
use crate::words::{digits, listed_first};
use solver::response::critical::CriticalKind;

/// Events that a sentence names.
const NAMED: usize = 6;

/// Digits of forcing amplitudes.
const DIGITS: i32 = 5;

/// Relative distance from a located event within which one of unknown kind is the same.
const UNLOCATED: f64 = 1e-4;

/// Events along fold curves of which it is not known what they are: among the levels, and beyond them.
pub fn unknown_events<'c>(curves: &'c [CurveRow], levels: &[Level]) -> (Vec<&'c CurvePoint>, Vec<&'c CurvePoint>) {
    let events = || curves.iter().flat_map(CurveRow::events);
    let is_unknown = |kind: &str| kind == CriticalKind::Unknown.name();
    // The same extremum may be known: what is unknown is not located to rounding.
    let are_close = |one: &CurvePoint, other: &CurvePoint| {
        let is_close = |a: f64, b: f64| (a / b - 1.0).abs() < UNLOCATED;
        is_close(one.forcing, other.forcing) && is_close(one.omega, other.omega)
    };
    let is_told = |place: &CurvePoint| events().any(|(kind, point)| !is_unknown(kind) && are_close(point, place));
    let all = events().filter(|(kind, point)| is_unknown(kind) && !is_told(point)).map(|(_, point)| point);
    // Several curves may come by one, as those of motions that are mirror images of each other do.
    let mut unknown: Vec<&CurvePoint> = Vec::new();
    for point in all {
        if !unknown.iter().any(|known| are_close(known, point)) {
            unknown.push(point);
        }
    }
    let values = || levels.iter().map(|level| level.value);
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
    unknown.into_iter().partition(|point| (low..=high).contains(&point.forcing))
}

/// Where they are, in a sentence; `frequency` writes one, of rad/s.
pub fn unknown_sentence(events: &[&CurvePoint], frequency: impl Fn(f64) -> String) -> String {
    let place = |point: &&CurvePoint| format!("{} ({})", digits(point.forcing, DIGITS), frequency(point.omega));
    let mut sorted = events.to_vec();
    sorted.sort_by(|a, b| a.forcing.total_cmp(&b.forcing));
    let at = listed_first(sorted.iter().map(place).collect(), NAMED);
    format!("What happens along fold curves at A = {at} is not known: a birth, a merge or neither.")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_another_curve_knows_is_not_unknown() {
        let point = |(forcing, omega, event): (f64, f64, CriticalKind)| CurvePoint {
            forcing,
            omega,
            event: Some(event.name().into()),
            ..CurvePoint::default()
        };
        let curve = |points: &[(f64, f64, CriticalKind)]| CurveRow {
            points: points.iter().copied().map(point).collect(),
            ..CurveRow::default()
        };
        let level = |value| Level { value, ..Level::default() };
        let levels = [level(1.0), level(5.0)];
        let unknown = CriticalKind::Unknown;
        let curves = [
            curve(&[(2.0, 1.0, unknown), (3.0, 1.0, unknown), (6.0, 1.0, unknown)]),
            curve(&[(3.0, 1.0, CriticalKind::Birth), (2.00001, 1.0, unknown)]),
        ];
        let (among, beyond) = unknown_events(&curves, &levels);
        assert_eq!(
            unknown_sentence(&among, |omega| format!("{omega} rad/s")),
            "What happens along fold curves at A = 2 (1 rad/s) is not known: a birth, a merge or neither."
        );
        assert_eq!(beyond.iter().map(|point| point.forcing).collect::<Vec<_>>(), [6.0]);
    }
}
