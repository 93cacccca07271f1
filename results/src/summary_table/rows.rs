//! The rows of the table, with the footnotes that they need.

#[cfg(test)]
mod tests;

use super::footnotes::{Footnotes, with_mark};
use super::known::{Known, PeaksOf};
use super::listed::{Listed, listed};
use super::units::{FrequencyUnit, Units};
use crate::overview::{
    BESIDE, BIRTH, Lesser, Level, WindowOutcome, beginning, forcing_label, is_at_bound, is_begun, is_peak_lost,
    is_unconfirmed, is_unmatched, later_birth, told_threshold, truncation_doubt, windows,
};
use crate::store::{BranchRow, CurveRow, WindowRow};
use crate::words::count;
use solver::response::backbone::{Backbone, BackbonePoint};
use solver::response::branch::{BranchKind, Outcome};
use solver::settings::FrequencySettings;

/// What is said of peaks that twice the harmonics do not confirm.
const UNCONFIRMED: &str = "with twice the harmonics no such peak is confirmed";

/// Further peaks of a main branch that are listed.
const FURTHER: usize = 4;

/// Relative difference of frequencies and amplitudes of peaks that are one as far as the table tells.
const SAME_PEAK: f64 = 1e-5;

/// Relative difference of the ranges of frequency of branches that may be copies of each other.
const SAME: f64 = 1e-6;

/// What is said of them in a structure with equal parts.
const COPY: &str = "of the same frequencies as one above: as the structure stays the same when equal parts are exchanged, the one may be the \
                    other with these exchanged";

/// Where all windows are.
const WINDOWS: &str = "windows.csv";

/// A threshold of so many times a level is the quotient of a loss and rounding: the force does no work there.
const NO_WORK: f64 = 1e9;

/// What is said of isolas of the lowest level.
const GOES_ON: &str = "is there below the lowest level as well";

/// What is said of a piece of a main branch where there are others that do not meet it.
const PIECE: &str = "runs on to a main branch that is told as well: a piece of that";

/// Makes the rows.
pub(super) struct Rows<'r> {
    units: Units,
    /// How main branches end, with their amplitudes as typed.
    mains: &'r [(String, Outcome)],
    /// Further peaks of main branches, with their keys: frequency (rad/s) and amplitude (m).
    peaks: &'r [PeaksOf],
    /// Fold curves.
    curves: &'r [CurveRow],
    /// What motions that branch off others have lost.
    lesser: Lesser,
    /// Whether the structure stays the same when equal parts are exchanged.
    has_exchanges: bool,
    /// Bounds of the frequency that were given.
    given: FrequencySettings,
    /// Those that were looked at, once they are known.
    reached: Option<(f64, f64)>,
    /// The smallest threshold of the backbones; `None` if one of them is not known.
    smallest: Option<f64>,
    /// The lowest level.
    lowest: Option<&'r str>,
    /// Reasons, in the order in which rows are made.
    pub(super) notes: Footnotes,
}

impl<'r> Rows<'r> {
    pub(super) fn new(known: &'r Known, units: Units) -> Self {
        let lesser = known.model.as_ref().map(Lesser::of).unwrap_or_default();
        let has_exchanges = known.model.as_ref().is_some_and(|model| !model.exchanges().is_empty());
        Self {
            units,
            mains: &known.mains,
            peaks: &known.further_peaks,
            curves: &known.curves,
            lesser,
            has_exchanges,
            given: known.given,
            reached: known.reached,
            smallest: smallest_threshold(&known.backbones),
            lowest: known.levels().first().map(|level| level.amplitude.as_str()),
            notes: Footnotes::default(),
        }
    }

    /// The cells of a level: its forcing amplitude, main branches, others, windows.
    pub(super) fn of(&mut self, level: &Level) -> [String; 4] {
        // From left to right: footnotes are numbered as they are met.
        let main = self.main(level);
        let mut others: Vec<String> = Vec::new();
        let mut before: Vec<&BranchRow> = Vec::new();
        for listed in listed(level) {
            let row = match listed {
                Listed::Branch(row) => row,
                Listed::More(count, kind) => {
                    others.push(format!("{kind}: {count} more, see summary.csv"));
                    continue;
                }
            };
            let mut text = self.other(row);
            if self.has_exchanges && before.iter().any(|earlier| is_copy(earlier, row)) {
                text = with_mark(&text, &self.notes.mark(COPY.into()));
            }
            if row.is_isola() && self.lowest == Some(level.amplitude.as_str()) {
                text = with_mark(&text, &self.below(level, row));
            }
            others.push(text);
            before.push(row);
        }
        [level.amplitude.clone(), main, others.join("\n"), self.windows(level)]
    }

    fn peak(&self, row: &BranchRow) -> String {
        let Units { length, frequency } = self.units;
        let omega = row.omega_at_max;
        let FrequencySettings { min, max } = self.given;
        let is_cut = !row.at_least().is_empty() && (is_at_bound(omega, min) || is_at_bound(omega, max));
        let bound = if is_cut { " (bound)" } else { "" };
        format!("{}{} at {}{bound}", row.at_least(), length.digits(row.amplitude_max), frequency.digits(omega))
    }

    /// The peaks of main branches at their other resonances, a line each.
    fn further<'l>(&self, rows: impl Iterator<Item = &'l BranchRow>) -> String {
        let Units { length, frequency } = self.units;
        let line =
            |(omega, size): &(f64, f64)| format!("\nand {} at {}", length.digits(*size), frequency.digits(*omega));
        let rows: Vec<&BranchRow> = rows.collect();
        let is_own = |key: &i64| rows.iter().any(|row| row.id == *key);
        let own = self.peaks.iter().filter(|(key, _)| is_own(key));
        // Points that nearly coincide may both stand out of their neighbours.
        let are_same =
            |a: &(f64, f64), b: &(f64, f64)| (a.0 / b.0 - 1.0).abs() < SAME_PEAK && (a.1 / b.1 - 1.0).abs() < SAME_PEAK;
        let is_told = |peak: &(f64, f64)| rows.iter().any(|row| are_same(&(row.omega_at_max, row.amplitude_max), peak));
        let mut peaks: Vec<&(f64, f64)> = own.flat_map(|(_, peaks)| peaks).filter(|peak| !is_told(peak)).collect();
        peaks.sort_by(|a, b| a.0.total_cmp(&b.0));
        peaks.dedup_by(|a, b| are_same(a, b));
        let mut lines: Vec<String> = peaks.iter().copied().take(FURTHER).map(line).collect();
        if let Some(more) = peaks.len().checked_sub(FURTHER + 1) {
            lines.push(format!("\nand {} more", more + 1));
        }
        lines.concat()
    }

    fn main(&mut self, level: &Level) -> String {
        if level.main().is_none() {
            if level.is_without_mains {
                return String::new();
            }
            return match &level.main_failure {
                Some(failure) => format!("none{}", self.notes.mark(format!("no main branch: {failure}"))),
                None if level.is_damaged => "damaged".into(),
                None => "to come".into(),
            };
        }
        let marks = self.doubts_about_mains(level);
        // One curve has one largest response, in however many pieces it was found.
        if let Some(row) = level.main().filter(|_| level.main_curves() == 1) {
            let peak = marks.iter().fold(self.peak(row), |text, mark| with_mark(&text, mark));
            return with_mark(&peak, &self.outside(row)) + &self.further(level.mains());
        }
        let peaks = level.mains().zip(marks).map(|(row, mark)| {
            let piece = if row.joints() > 0 { self.notes.mark(PIECE.into()) } else { String::new() };
            let marks = [mark, piece, self.outside(row)];
            let peak = marks.iter().fold(self.peak(row), |text, mark| with_mark(&text, mark));
            peak + &self.further(std::iter::once(row))
        });
        peaks.collect::<Vec<_>>().join("\n")
    }

    /// Marks of the main branches of a level, one after the other: of what is known in part, and of peaks that are not confirmed.
    fn doubts_about_mains(&mut self, level: &Level) -> Vec<String> {
        let ends: Vec<Outcome> =
            self.mains.iter().filter(|(amplitude, _)| *amplitude == level.amplitude).map(|(_, end)| *end).collect();
        // Another one may have gone on where a walk ended.
        let how =
            if level.mains().any(|row| row.joints() > 0) { "a walk along it ended" } else { "known only in part" };
        let (is_apart, largest) = (level.main_curves() > 1, level.main());
        let mark = |(i, row): (usize, &BranchRow)| {
            let end = ends.get(i).filter(|end| end.is_unfinished());
            let mark = end.map(|end| self.notes.mark(format!("{how}: {end}"))).unwrap_or_default();
            // Of one curve in pieces the peak of the largest is told.
            let is_told = is_apart || largest.is_some_and(|largest| std::ptr::eq(largest, row));
            match is_told && is_peak_lost(row) {
                true => with_mark(&mark, &self.notes.mark(UNCONFIRMED.into())),
                false => mark,
            }
        };
        level.mains().enumerate().map(mark).collect()
    }

    /// A mark at a peak outside of the bounds that were given.
    fn outside(&mut self, row: &BranchRow) -> String {
        let FrequencySettings { min, max, .. } = self.given;
        let below = min.filter(|min| row.omega_at_max < min * (1.0 - BESIDE)).map(|_| "below frequency.min");
        let above = max.filter(|max| row.omega_at_max > max * (1.0 + BESIDE)).map(|_| "above frequency.max");
        let comes_back = if row.at_least().is_empty() { ": the branch goes there and comes back" } else { "" };
        let note = |bound: &str| self.notes.mark(format!("{bound}{comes_back}"));
        below.or(above).map(note).unwrap_or_default()
    }

    fn other(&mut self, row: &BranchRow) -> String {
        let unit = self.units.frequency;
        let range = format!("{}–{}", unit.digits(row.omega.0), unit.digits(row.omega.1));
        let peak = self.peak(row);
        if row.is_isola() {
            let doubt = "perhaps an artefact of too few harmonics: with twice as many no such peak is confirmed, nor a motion near it by time \
                         marching";
            let untold = "with twice the harmonics no such peak is confirmed, and time marching has no motion near it or cannot tell";
            let unasked = "with twice the harmonics no such peak is confirmed; whether there is a motion near it was not asked of time marching";
            let is_marched = row.stability.as_ref().is_some_and(|known| known.peak.is_some());
            let mark = match (is_unconfirmed(row), is_unmatched(row)) {
                (true, _) => self.notes.mark(doubt.into()),
                (_, true) => self.notes.mark(if is_marched { untold } else { unasked }.into()),
                _ => String::new(),
            };
            return format!("{range}, {peak}{mark}");
        }
        let meaning = match row.kind.as_str() {
            kind if kind == BranchKind::Open.name() => "; detached, but not closed",
            kind if kind == BranchKind::Branched.name() => &format!("; {}", self.lesser.than("what it branches off")),
            _ => "; whether it is detached is not known",
        };
        if let Some(cut) = self.cut_at(row) {
            let mark = self.notes.mark(format!("{cut}: whether it is closed is seen with wider bounds"));
            return format!("{}: {range}, {peak}{mark}", row.kind);
        }
        // `open` is the name of a kind as well.
        let ends = row.status.strip_prefix("open: ").and_then(|ends| ends.split_once(" to "));
        let ends = ends.map_or_else(|| row.status.clone(), |(first, last)| format!("ends: {first}, {last}"));
        let mark = self.notes.mark(format!("{ends}{meaning}"));
        format!("{}: {range}, {peak}{mark}", row.kind)
    }

    /// The mark that tells from where on an isola of the lowest level is there, where no story does.
    fn below(&mut self, level: &Level, row: &BranchRow) -> String {
        let Some(begins) = beginning(self.curves, &level.amplitude, &row.name()) else {
            // Of what may not be there, or where nobody followed folds, nothing is known.
            if self.curves.is_empty() || is_unmatched(row) {
                return String::new();
            }
            return self.notes.mark(format!("{GOES_ON}; where it begins is not known"));
        };
        if is_begun(self.curves, begins) {
            return String::new();
        }
        let what =
            if begins.event.as_deref() == Some(BIRTH.kind.name()) { "a birth" } else { "where branches merge or part" };
        let place = format!("{}: A = {}{}", row.name(), forcing_label(begins, 5), truncation_doubt(&[begins]));
        self.notes.mark_at(format!("{GOES_ON}; a fold curve of it comes from {what}"), place, "events.csv")
    }

    /// By which bounds of the frequency that were given a branch is cut off at both ends, if it is.
    fn cut_at(&self, row: &BranchRow) -> Option<String> {
        let FrequencySettings { min, max } = self.given;
        let low = is_at_bound(row.omega.0, min).then_some("frequency.min");
        let high = is_at_bound(row.omega.1, max).then_some("frequency.max");
        // At the other bound, given or not, it would be seen to be there.
        let lowest = min.or(self.reached.map(|(low, _)| low));
        let highest = max.or(self.reached.map(|(_, high)| high));
        let both_through = |bound: &str, is_inside: Option<bool>| match is_inside {
            Some(true) => format!("leaves through {bound} at both ends"),
            _ => format!("leaves through bounds at both ends, {bound} among them"),
        };
        let how = match (low, high) {
            (Some(low), Some(high)) => Some(format!("leaves through {low} and {high}")),
            (Some(low), None) => Some(both_through(low, highest.map(|highest| row.omega.1 < highest * (1.0 - BESIDE)))),
            (None, Some(high)) => Some(both_through(high, lowest.map(|lowest| row.omega.0 > lowest * (1.0 + BESIDE)))),
            (None, None) => None,
        };
        how.filter(|_| row.kind == BranchKind::Cut.name() && row.status.matches("frequency bound").count() == 2)
    }

    /// The mark that tells why a level has no window, once the backbones are known.
    fn without_window(&mut self, level: &Level) -> String {
        let Some(smallest) = self.smallest else { return String::new() };
        let why = match self.given {
            _ if smallest > NO_WORK * level.value => {
                "no A is a threshold of the backbones (the energy balance, an estimate): the force does no work along them".into()
            }
            _ if level.value < smallest => {
                format!(
                    "windows of the energy balance, an estimate, begin at A = {}, where thresholds of the backbones do: what is found below it \
                     is found otherwise",
                    told_threshold(smallest, std::iter::once(level.value))
                )
            }
            FrequencySettings { min: None, max: None } => "no point of a backbone has this A as its threshold".into(),
            _ => "no point of a backbone within frequency.min and frequency.max has this A as its threshold".into(),
        };
        self.notes.mark(why)
    }

    /// In how many windows their seeds led to a branch, or one passes by, of how many, and what is missing of the level.
    fn windows(&mut self, level: &Level) -> String {
        let unit = self.units.frequency;
        let missed = level.not_found().map(|(window, reason)| {
            let why = match later_birth(self.curves, level, window) {
                Some(birth) => {
                    let doubt = truncation_doubt(&[birth]);
                    format!("an isola is born there at A = {} only{doubt}", forcing_label(birth, 5))
                }
                None => reason,
            };
            let place = format!("A = {}: {} {unit}", level.amplitude, range_of(window, unit));
            self.notes.mark_at(format!("window not found: {why}"), place, WINDOWS)
        });
        let missed: Vec<String> = missed.collect();
        let passed = level.passed().map(|(window, told)| {
            let place = format!("A = {}: {} {unit}", level.amplitude, range_of(window, unit));
            self.notes.mark_at(told, place, WINDOWS)
        });
        let mut marks: Vec<String> = Vec::new();
        for mark in missed.into_iter().chain(passed) {
            if !marks.contains(&mark) {
                marks.push(mark);
            }
        }
        let is_found =
            |window: &&WindowRow| matches!(window.outcome, WindowOutcome::Found(_) | WindowOutcome::Passed { .. });
        let found = level.windows.iter().filter(is_found).count();
        let windows = match level.windows.len() {
            0 if level.is_damaged => None,
            0 => Some(format!("no window{}", self.without_window(level))),
            all => Some(format!("{found} of {all}{}", marks.join(" "))),
        };
        let mut lines: Vec<String> = windows.into_iter().collect();
        if level.is_damaged {
            lines.push(format!("damaged{}", self.notes.mark("not all of the level can be read".into())));
        }
        lines.extend((level.pending > 0).then(|| format!("{} to come", count(level.pending, "task"))));
        let given_up = || {
            format!(
                "A = {}: tasks given up: isola retry-dead RUN, then isola resume RUN, tries them again",
                level.amplitude
            )
        };
        lines.extend(
            (level.dead > 0).then(|| format!("{} given up{}", count(level.dead, "task"), self.notes.mark(given_up()))),
        );
        let contradicted = || format!("A = {}: other workers came to something else", level.amplitude);
        let results = level.refuted + level.disputed;
        lines.extend((results > 0).then(|| format!("{results} doubtful{}", self.notes.mark(contradicted()))));
        lines.join("\n")
    }
}

/// Whether what was found in the windows of a level is the main branch alone.
pub(super) fn is_on_main(level: &Level) -> bool {
    let found: Vec<bool> =
        level.windows.iter().filter_map(|window| windows::is_on_main(window, &level.branches)).collect();
    !found.is_empty() && found.iter().all(|is_main| *is_main)
}

/// The smallest threshold of all backbones, if all of them are known.
fn smallest_threshold(backbones: &[(usize, Option<Backbone>)]) -> Option<f64> {
    let all: Vec<&Backbone> = backbones.iter().map(|(_, backbone)| backbone.as_ref()).collect::<Option<_>>()?;
    all.into_iter().flat_map(|backbone| &backbone.points).map(BackbonePoint::threshold).reduce(f64::min)
}

/// The frequencies of a window, or the one that it has.
fn range_of(window: &WindowRow, unit: FrequencyUnit) -> String {
    let (low, high) = (unit.digits(window.omega.0), unit.digits(window.omega.1));
    if low == high { low } else { format!("{low}–{high}") }
}

/// Whether two branches have the same frequencies.
fn is_copy(one: &BranchRow, other: &BranchRow) -> bool {
    let is_near = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs();
    one.kind == other.kind && is_near(one.omega.0, other.omega.0) && is_near(one.omega.1, other.omega.1)
}
