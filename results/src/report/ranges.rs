//! Ranges of frequencies and of levels, in words.

use crate::overview::{BranchRow, Level};
use crate::summary_table::FrequencyUnit;
use crate::told::range_first_in;
use crate::words::more_ranges;

/// Complete levels with isolas as runs of neighbours: first and last, as typed. A level of which not all is known ends a
/// run.
pub(super) fn runs(levels: &[Level]) -> Vec<(String, String)> {
    let state = |level: &Level| (level.is_complete(), level.highest_isola().is_some());
    let runs = levels.chunk_by(|a, b| state(a) == state(b)).filter(|run| state(&run[0]) == (true, true));
    runs.map(|run| (run[0].amplitude.clone(), run[run.len() - 1].amplitude.clone())).collect()
}

/// Frequencies of isolas, rad/s, and how far they go there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    /// The first and the last of them.
    omega: (f64, f64),
    /// Largest amplitude, m.
    amplitude: f64,
}

/// The ranges of isolas in order, those that overlap as one.
pub(super) fn joined<'r>(isolas: impl Iterator<Item = &'r BranchRow>) -> Vec<Range> {
    let own = |row: &BranchRow| Range { omega: row.omega, amplitude: row.amplitude_max };
    let mut sorted: Vec<Range> =
        isolas.map(own).filter(|Range { omega: (low, high), .. }| low.is_finite() && high.is_finite()).collect();
    sorted.sort_by(|a, b| a.omega.0.total_cmp(&b.omega.0));
    let mut list: Vec<Range> = Vec::new();
    for next in sorted {
        match list.last_mut() {
            Some(last) if next.omega.0 <= last.omega.1 => {
                last.omega.1 = last.omega.1.max(next.omega.1);
                last.amplitude = last.amplitude.max(next.amplitude);
            }
            _ => list.push(next),
        }
    }
    list
}

/// Of which levels the ranges of isolas are: at one of them alone, or of all together, each of which has a part of them.
pub(super) fn over(levels: &[&Level]) -> String {
    match levels {
        [] => String::new(),
        [only] => format!(", at A = {}", only.amplitude),
        [first, last] => {
            format!(", taken over both levels with isolas (A = {} and {})", first.amplitude, last.amplitude)
        }
        [first, .., last] => {
            let (first, last) = (&first.amplitude, &last.amplitude);
            format!(", taken over all {} levels with isolas (A = {first} to {last})", levels.len())
        }
    }
}

/// Ranges that a sentence names; the others are only counted.
const NAMED: usize = 3;

/// Ranges in words, in this unit first: those with the largest responses, in order.
pub(super) fn in_words(ranges: &[Range], first: FrequencyUnit) -> String {
    let mut largest: Vec<&Range> = ranges.iter().collect();
    largest.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    largest.truncate(NAMED);
    largest.sort_by(|a, b| a.omega.0.total_cmp(&b.omega.0));
    let list: Vec<String> = largest.into_iter().map(|range| range_first_in(range.omega, first)).collect();
    let more = more_ranges(ranges.len().saturating_sub(NAMED)).map(|more| format!(", or {more}"));
    list.join(", or between ") + &more.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ranges_of_the_largest_responses_are_named() {
        let isola = |omega: (f64, f64), amplitude_max: f64| BranchRow { omega, amplitude_max, ..BranchRow::default() };
        let rows = [
            isola((1.0, 2.0), 3.0),
            isola((1.5, 2.5), 1.0),
            isola((3.0, 4.0), 0.1),
            isola((5.0, 6.0), 0.5),
            isola((7.0, 8.0), 9.0),
        ];
        let ranges = joined(rows.iter());
        assert_eq!(ranges[0], Range { omega: (1.0, 2.5), amplitude: 3.0 });
        let said = in_words(&ranges, FrequencyUnit::RadianPerSecond);
        assert!(!said.contains("3 and 4") && said.ends_with(", or in 1 more range"), "{said}");
        let places: Vec<usize> =
            ["1 and 2.5", "5 and 6", "7 and 8"].iter().map(|part| said.find(part).expect(&said)).collect();
        assert!(places.is_sorted(), "{said}");
    }
}
