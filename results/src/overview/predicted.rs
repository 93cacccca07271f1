//! Separate responses that the energy balance predicts where the run has no level.

use super::bounds::is_within;
use super::level::Level;
use crate::words::digits_beside;
use solver::response::backbone::Backbone;
use solver::response::forced::SearchRange;
use solver::response::windows::{Event, EventKind, events};
use solver::settings::FrequencySettings;
use std::ops::Range;

/// A window that no level looks into, over the forcing: an estimate of an isola.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predicted {
    /// Forcing amplitude A* at which it is born.
    pub from: f64,
    /// That at which it merges with its neighbour; infinite if the backbone ends before.
    pub to: f64,
    /// Frequency at which it is born, rad/s.
    pub omega: f64,
}

/// A window that is born below this share of the lowest level is one at any forcing: A* goes to zero where what is fed in and what the
/// damping takes cancel.
const NOTHING: f64 = 1e-6;

/// Digits of forcing amplitudes that the energy balance, an estimate, predicts.
const DIGITS: i32 = 3;

/// A threshold A* as texts and figures have it: in three digits, or as many more as keep it on its side of the levels.
pub fn told_threshold(threshold: f64, levels: impl Iterator<Item = f64> + Clone) -> String {
    digits_beside(threshold, DIGITS, levels)
}

/// The windows that are born, and merge, between the levels, below the lowest, or above the highest as far as folds are followed there,
/// at frequencies within `bounds`; by forcing.
pub fn between_levels(backbones: &[&Backbone], levels: &[Level], bounds: FrequencySettings) -> Vec<Predicted> {
    let highest = levels.iter().map(|level| level.value).fold(0.0, f64::max);
    let lowest = levels.iter().map(|level| level.value).fold(f64::INFINITY, f64::min);
    let is_missed = |window: &Predicted| {
        let has_level = levels.iter().any(|level| (window.from..window.to).contains(&level.value));
        let is_real = window.from > NOTHING * lowest;
        !has_level && is_real && window.from < highest * SearchRange::BEYOND && is_within(bounds, window.omega)
    };
    let mut all: Vec<Predicted> = backbones.iter().flat_map(|backbone| separate(backbone)).filter(is_missed).collect();
    all.sort_by(|a, b| a.from.total_cmp(&b.from));
    all
}

/// Every window of a backbone that is born apart from others, from its birth to its merge.
fn separate(backbone: &Backbone) -> Vec<Predicted> {
    let events = events(backbone);
    let mut first = 0;
    let pieces = backbone.pieces().flat_map(|piece| {
        let range = first..first + piece.len();
        first = range.end;
        let births = events.iter().filter(|event| event.kind == EventKind::Birth);
        births.filter(|birth| range.contains(&birth.index)).map(|birth| (birth, range.clone())).collect::<Vec<_>>()
    });
    let window = |(birth, piece): (&Event, Range<usize>)| {
        let barrier = |side: Range<usize>| {
            let merges = events.iter().filter(|event| event.kind == EventKind::Merge && side.contains(&event.index));
            merges
                .map(|merge| (merge.index.abs_diff(birth.index), merge.threshold))
                .min_by_key(|(distance, _)| *distance)
        };
        let sides = [barrier(piece.start..birth.index), barrier(birth.index..piece.end)];
        // Where a piece crosses another one its windows are one with those of that.
        let crossing = (piece.start > 0).then(|| backbone.points[piece.start].threshold());
        let barriers = sides.into_iter().flatten().map(|(_, threshold)| threshold).chain(crossing);
        let to = barriers.filter(|barrier| *barrier > birth.threshold).fold(f64::INFINITY, f64::min);
        Predicted { from: birth.threshold, to, omega: birth.omega }
    };
    pieces.map(window).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Study;

    /// A window counts where no level looks into it, within twice the largest forcing and the bounds of the frequency.
    #[test]
    fn windows_between_levels() {
        let backbone = Study::damper().backbone;
        let all = separate(&backbone);
        let [window] = all[..] else { panic!("{all:?}") };
        let birth = events(&backbone).into_iter().find(|event| event.kind == EventKind::Birth).unwrap();
        assert_eq!((window.from, window.omega), (birth.threshold, birth.omega));
        assert!(window.to > window.from);
        let missed = |multiples: &[f64], bounds| {
            let level = |multiple: &f64| Level { value: multiple * window.from, ..Level::default() };
            let levels: Vec<Level> = multiples.iter().map(level).collect();
            between_levels(&[&backbone], &levels, bounds)
        };
        let anywhere = FrequencySettings::default();
        assert_eq!(missed(&[0.9], anywhere), [window]);
        assert_eq!(missed(&[0.9, 1.01], anywhere), []);
        assert_eq!(missed(&[0.4], anywhere), []);
        assert_eq!(missed(&[0.9], FrequencySettings { max: Some(0.9 * window.omega), ..anywhere }), []);
        // It merges before the backbone ends: a level above that does not look into it either.
        assert!(window.to.is_finite(), "{window:?}");
        assert_eq!(missed(&[1.01 * window.to / window.from], anywhere), [window]);
    }
}
