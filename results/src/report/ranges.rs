//! Ranges of frequencies and of levels, in words.

use crate::overview::Level;
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

/// Ranges in order, those that overlap as one.
pub(super) fn joined(ranges: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut sorted: Vec<(f64, f64)> = ranges.filter(|(low, high)| low.is_finite() && high.is_finite()).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut list: Vec<(f64, f64)> = Vec::new();
    for (low, high) in sorted {
        match list.last_mut() {
            Some(last) if low <= last.1 => last.1 = last.1.max(high),
            _ => list.push((low, high)),
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

/// Ranges in words, in this unit first.
pub(super) fn in_words(ranges: &[(f64, f64)], first: FrequencyUnit) -> String {
    let list: Vec<String> = ranges.iter().take(NAMED).map(|&omega| range_first_in(omega, first)).collect();
    let more = more_ranges(ranges.len().saturating_sub(NAMED)).map(|more| format!(", or {more}"));
    list.join(", or between ") + &more.unwrap_or_default()
}
