//! Whether enough harmonics were kept: peaks of all branches, ranges of isolas and points of branches against those with twice the
//! harmonics.

#[cfg(test)]
mod tests;

use super::confirmed::doubled;
use super::elsewhere::{CONVERGED, elsewhere, not_found};
use super::level::Level;
use super::penetration::deepest;
use crate::store::BranchRow;
use crate::words::digits;
use solver::response::certificate::Standing;
use solver::settings::Settings;
use solver::structure::Model;

/// The same for the width of an isola.
const SAME_WIDTH: f64 = 0.05;

/// Changes below this are not told with a number.
const NEGLIGIBLE: f64 = 1e-4;

/// An amplitude that changes by less is the same but for rounding. If it is found at another frequency the branch is flat, as where
/// contact holds: where its largest amplitude lies says nothing.
const SAME_AMPLITUDE: f64 = 1e-9;

/// How what is told of a peak that changes or is lost begins.
const NOT_CONVERGED: &str = "Not converged in H";

/// Of isolas whose ends stay where they are.
const SAME_WIDTHS: &str = "Widths of isolas change by less than 0.01 % with twice the harmonics.";

/// Of isolas none of whose ends is known with twice the harmonics.
const UNKNOWN_ENDS: &str = "What twice the harmonics change of the ends of isolas is not known.";

/// Most branches that are named.
const NAMED: usize = 3;

/// The lowest harmonic beyond that of the force which motions can have that last as long as the force, or where main branches are not
/// followed as long as the balance: motions of odd laws have odd ones alone.
pub fn least_added(model: &Model, is_without_mains: bool) -> usize {
    let is_odd = model.is_odd();
    let own = if is_without_mains { 1 } else { model.forcing().harmonic };
    if is_odd { 3 * own } else { 2 * own }
}

/// What is known of the truncation to H harmonics: by what twice as many change the peaks, or which one is not converged and what to
/// set; the same for the widths of isolas, and for other points if they are not converged. What still more would change is not known.
/// `None` as long as nothing is known of it.
///
/// `least`: see [`least_added`]; `monitor`: whose amplitudes they are, where there are several; `frequency` writes one, of rad/s.
pub fn truncation(
    levels: &[Level],
    harmonics: usize,
    least: usize,
    monitor: Option<&str>,
    frequency: impl Fn(f64) -> String,
) -> Option<String> {
    let rows = || levels.iter().flat_map(|level| level.branches.iter().map(move |row| (level, row)));
    let (twice, wanted) = (2 * harmonics, (2 * harmonics).max(least));
    let mut said: Vec<String> = Vec::new();
    // What to set is said once.
    let remedy = |said: &[String]| match said.iter().any(|sentence| asks_for_harmonics(sentence)) {
        true => String::new(),
        false => format!("; set harmonics.count = {wanted}"),
    };
    let peaks = of_peaks(&rows, (harmonics, monitor), &remedy(&said));
    if twice < least {
        return match peaks? {
            peaks if peaks.starts_with(NOT_CONVERGED) => Some(format!(
                "{peaks} Ordinary responses have none of the harmonics that twice as many (H = {twice}) add: what more would change of them \
                 is not known."
            )),
            _ => Some(format!(
                "What more harmonics would change of ordinary responses is not known: twice as many (H = {twice}) add none that \
                 they have; set harmonics.count = {wanted}."
            )),
        };
    }
    said.extend(peaks);
    let of_peaks = rows().filter_map(|(_, row)| change(row)).map(largest).fold(CONVERGED, f64::max);
    said.extend(elsewhere(rows(), of_peaks, &remedy(&said), frequency));
    said.extend(not_found(rows().filter(|(_, row)| !has_maximum(row)), &remedy(&said)));
    let widths = of_widths(&rows, &remedy(&said));
    let peaks = peaks_of(monitor, rows().map(|(_, row)| row));
    if said == [unchanged(&peaks, harmonics)] && widths.as_deref() == Some(SAME_WIDTHS) {
        return Some(unchanged(&format!("{peaks} and widths of isolas"), harmonics));
    }
    said.extend(widths);
    if said.iter().any(|sentence| asks_for_harmonics(sentence)) {
        said.extend(deepest(rows(), &said));
    }
    (!said.is_empty()).then(|| said.join(" "))
}

/// The same of a run, as far as its model and settings are known; `is_further`: of a further order of motions.
pub fn truncation_of(
    model: Option<&Model>,
    levels: &[Level],
    settings: Option<&Settings>,
    is_further: bool,
    frequency: impl Fn(f64) -> String,
) -> Option<String> {
    let least = model.map_or(1, |model| least_added(model, is_further));
    let monitors = model.map_or(&[][..], |model| model.monitors());
    let first = monitors.first().filter(|_| monitors.len() > 1);
    let monitor = first.and_then(|&dof| Some(model?.dofs()[dof].as_str()));
    truncation(levels, settings?.harmonics.count, least, monitor, frequency)
}

fn of_widths<'l, I: Iterator<Item = (&'l Level, &'l BranchRow)>>(
    rows: &impl Fn() -> I,
    remedy: &str,
) -> Option<String> {
    let width = |(low, high): (f64, f64)| high - low;
    let change = |row: &BranchRow| {
        let change = width(doubled(row)?.range?) / width(row.omega) - 1.0;
        (row.is_isola() && change.is_finite()).then_some(change)
    };
    let is_lost = |row: &BranchRow| row.is_isola() && doubled(row).is_some_and(|doubled| doubled.range.is_none());
    let lost = match rows().filter(|(_, row)| is_lost(row)).count() {
        0 => "",
        1 => " With twice the harmonics the ends of one isola were not found.",
        _ => " With twice the harmonics the ends of some isolas were not found.",
    };
    let changes = rows().filter_map(|(level, row)| Some((level, row, change(row)?)));
    let Some((level, row, largest)) = changes.max_by(|a, b| a.2.abs().total_cmp(&b.2.abs())) else {
        // They were not found, or the run is one of a program that did not look for them.
        return (!lost.is_empty()).then(|| UNKNOWN_ENDS.into());
    };
    let percent = digits(100.0 * largest.abs(), 2);
    if largest.abs() < NEGLIGIBLE {
        return Some(format!("{SAME_WIDTHS}{lost}"));
    }
    if largest.abs() <= SAME_WIDTH {
        return Some(format!("Widths of isolas change by {percent} % at most with twice the harmonics.{lost}"));
    }
    let becomes = if largest < 0.0 { "narrower" } else { "wider" };
    let at = &level.amplitude;
    Some(format!(
        "With twice the harmonics {} at A = {at} is {percent} % {becomes}{remedy}.{lost}",
        super::in_words(row)
    ))
}

fn of_peaks<'l, I: Iterator<Item = (&'l Level, &'l BranchRow)>>(
    rows: &impl Fn() -> I,
    (harmonics, monitor): (usize, Option<&str>),
    remedy: &str,
) -> Option<String> {
    let is_known = rows().any(|(_, row)| change(row).is_some());
    // Not computed where the peak is no maximum, nor by the first programs; otherwise nothing like it is confirmed with more harmonics.
    let is_lost = |row: &BranchRow| is_peak_lost(row) || (is_known && has_maximum(row) && doubled(row).is_none());
    let lost = rows().filter(|(_, row)| is_lost(row));
    let lost: Vec<String> =
        lost.map(|(level, row)| format!("{} at A = {}", super::in_words(row), level.amplitude)).collect();
    if !lost.is_empty() {
        let more = match lost.len().saturating_sub(NAMED) {
            0 => String::new(),
            1 => " and 1 more branch".into(),
            more => format!(" and {more} more branches"),
        };
        let those = if lost.len() == 1 { "that" } else { "those" };
        let named = lost[..lost.len().min(NAMED)].join(", ");
        return Some(format!(
            "{NOT_CONVERGED}: with twice the harmonics no peak is confirmed near {those} of {named}{more}{remedy}."
        ));
    }
    let changes = rows().filter_map(|(level, row)| Some((level, row, change(row)?)));
    let (level, row, [change, shift]) = changes.max_by(|a, b| largest(a.2).total_cmp(&largest(b.2)))?;
    if largest([change, shift]) <= CONVERGED {
        let most = largest([change, shift]);
        let peaks = peaks_of(monitor, rows().map(|(_, row)| row));
        if most < NEGLIGIBLE {
            return Some(unchanged(&peaks, harmonics));
        }
        let percent = digits(100.0 * most, 1);
        return Some(format!(
            "{peaks} change by {percent} % at most with twice the harmonics (H = {}).",
            2 * harmonics
        ));
    }
    let moves = if shift.abs() > CONVERGED {
        format!(" and its frequency by {} %", digits(100.0 * shift, 2))
    } else {
        String::new()
    };
    let depth = row.certificate.penetration.filter(|depth| *depth > 0.0);
    let depth = depth.map(|depth| format!(", and its contact penetrates by {} % of the gap", digits(100.0 * depth, 2)));
    Some(format!(
        "{NOT_CONVERGED}: with twice the harmonics the peak of {} at A = {} changes by {} %{moves}{}{}{remedy}.",
        super::in_words(row),
        level.amplitude,
        digits(100.0 * change, 2),
        depth.unwrap_or_default(),
        of_more(rows, change)
    ))
}

/// The peak whose amplitude changes most, if that is more than the `told` one does and not converged.
fn of_more<'l, I: Iterator<Item = (&'l Level, &'l BranchRow)>>(rows: &impl Fn() -> I, told: f64) -> String {
    let changes = rows().filter_map(|(level, row)| Some((level, row, change(row)?[0])));
    let most = changes.max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()));
    let more = most.filter(|(.., change)| change.abs() > CONVERGED.max(1.1 * told.abs()));
    more.map_or_else(String::new, |(level, row, change)| {
        format!(", that of {} at A = {} by {} %", super::in_words(row), level.amplitude, digits(100.0 * change, 2))
    })
}

/// What peaks are called, of this dof: where a branch leaves through a bound, or goes on beyond where it is known, none may be.
fn peaks_of<'l>(monitor: Option<&str>, rows: impl Iterator<Item = &'l BranchRow>) -> String {
    let peaks = monitor.map_or_else(|| "Largest peaks".into(), |monitor| format!("Largest peaks of {monitor}"));
    // Where branches meet others their largest response is no peak.
    let is_counted = |row: &&BranchRow| change(row).is_some() || (!row.is_branched() && !row.is_joined());
    let rows: Vec<&BranchRow> = rows.filter(is_counted).collect();
    let (known, all) = (rows.iter().filter(|row| change(row).is_some()).count(), rows.len());
    if known < all {
        return format!("{peaks} that were compared, of {known} of {all} branches,");
    }
    peaks
}

/// What is told of quantities that stay as they are.
fn unchanged(what: &str, harmonics: usize) -> String {
    format!("{what} change by less than 0.01 % with twice the harmonics (H = {}).", 2 * harmonics)
}

/// Whether a sentence of [`truncation`] asks for more harmonics.
pub fn asks_for_harmonics(sentence: &str) -> bool {
    sentence.contains("set harmonics.count")
}

/// Whether no peak of a branch is confirmed with twice the harmonics, which only the first programs did not try.
pub fn is_peak_lost(row: &BranchRow) -> bool {
    has_maximum(row) && doubled(row).is_none() && row.peak_standing.is_some()
}

/// Whether the peak of a branch changes with twice the harmonics, or none is confirmed near it.
pub(super) fn has_moved(row: &BranchRow) -> bool {
    has_maximum(row) && change(row).is_none_or(|change| largest(change) > CONVERGED)
}

/// Whether the largest amplitude of a branch is that of a maximum. Of one that branches off another, or runs on to a known one, it may be
/// where they meet.
fn has_maximum(row: &BranchRow) -> bool {
    row.is_isola() || (row.peak_standing == Some(Standing::At) && !row.is_branched() && !row.is_joined())
}

/// Relative changes of the amplitude and of the frequency of a peak with twice the harmonics.
fn change(row: &BranchRow) -> Option<[f64; 2]> {
    let doubled = doubled(row)?;
    let change = doubled.amplitude / row.amplitude_max - 1.0;
    let shift = if change.abs() < SAME_AMPLITUDE { 0.0 } else { doubled.shift };
    (change.is_finite() && shift.is_finite()).then_some([change, shift])
}

fn largest(changes: [f64; 2]) -> f64 {
    changes[0].abs().max(changes[1].abs())
}
