//! What runs found at every level, and by how much that differs from the first run.

use super::{ComparedLevel, Comparison, is_one, monitor};
use crate::overview::Level;
use crate::report::Report;
use crate::store::BranchRow;
use crate::summary_table::{LengthUnit, wrapped};
use crate::told::{Told, length_in, with_sign};
use crate::words::digits;
use comfy_table::{ContentArrangement, Table, presets::UTF8_FULL_CONDENSED};
use serde::Serialize;

/// A quantity of a level in every run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NumberRow {
    /// Forcing amplitude, as typed.
    pub amplitude: String,
    /// The quantity.
    pub what: &'static str,
    /// In words, one a run; behind the number of a later run, by how much it differs from that of the first.
    pub values: Vec<Told>,
}

/// Keys that differ of which a terminal shows so many.
const SETTINGS: usize = 12;

/// What stands for a level that a run does not have.
const LACKING: &str = "–";

/// A difference that is rounding: of amplitudes, %, and of a frequency, relative to it.
const ROUNDING: f64 = 1e-8;

/// Behind an isola that shares no frequency with that of the first run.
const ANOTHER: &str = " (at other frequencies: it may be another isola)";

/// Rows of all levels that several runs have.
pub(super) fn rows(reports: &[Report], levels: &[ComparedLevel]) -> Vec<NumberRow> {
    let has =
        |report: &&Report, level: &ComparedLevel| report.overview.levels.iter().any(|known| known.value == level.value);
    let is_shared = |level: &&ComparedLevel| reports.iter().filter(|report| has(report, level)).count() > 1;
    levels.iter().filter(is_shared).flat_map(|level| of_level(reports, level)).collect()
}

fn of_level(reports: &[Report], level: &ComparedLevel) -> Vec<NumberRow> {
    let found = |report: &'_ Report| report.overview.levels.iter().position(|known| known.value == level.value);
    let each: Vec<Option<&Level>> =
        reports.iter().map(|report| found(report).map(|place| &report.overview.levels[place])).collect();
    let is_measured = is_one(&reports.iter().map(monitor).collect::<Vec<_>>());
    // Those of the first run, as in figures.
    let unit = reports.first().and_then(|report| report.units().length);
    let peaks = |of: fn(&Level) -> Option<&BranchRow>, are_alike: fn(&BranchRow, &BranchRow) -> bool| -> Vec<Told> {
        let peaks: Vec<Option<&BranchRow>> = each.iter().map(|level| level.and_then(of)).collect();
        let first = peaks.first().copied().flatten();
        let word = |(place, level): (usize, &Option<&Level>)| match (level, peaks[place]) {
            (None, _) => LACKING.into(),
            (_, None) => "none".into(),
            (_, Some(peak)) => match first.filter(|_| place > 0) {
                Some(first) if !are_alike(first, peak) => of_peak(peak, None, is_measured, unit).text(ANOTHER),
                first => of_peak(peak, first, is_measured, unit),
            },
        };
        each.iter().enumerate().map(word).collect()
    };
    let row = |what, values| NumberRow { amplitude: level.amplitude.clone(), what, values };
    let isolas = each.iter().map(|level| level.map_or(LACKING.into(), of_others)).collect();
    let has_isola = each.iter().flatten().any(|level| level.highest_isola().is_some());
    let highest = has_isola.then(|| row("highest isola, peak", peaks(Level::highest_isola, BranchRow::meets)));
    let always = |_: &BranchRow, _: &BranchRow| true;
    [row("largest response", peaks(Level::peak, always)), row("main branch, peak", peaks(Level::main, always))]
        .into_iter()
        .chain(highest)
        .chain([row("isolas and others", isolas)])
        .collect()
}

/// `2.322 mm at 2701.2 rad/s (+3.1 %, -12.4 rad/s)`; amplitudes of another dof than those of the first run are not measured by these.
fn of_peak(peak: &BranchRow, first: Option<&BranchRow>, is_measured: bool, unit: Option<LengthUnit>) -> Told {
    let size = format!("{}{} at ", peak.at_least(), length_in(peak.amplitude_max, unit));
    let told = Told::from(size).frequency(peak.omega_at_max, 6).unit();
    let difference = first.map(|first| {
        let share = 100.0 * (peak.amplitude_max / first.amplitude_max - 1.0);
        let shift = peak.omega_at_max - first.omega_at_max;
        if is_measured && share.abs() < ROUNDING && shift.abs() < ROUNDING * first.omega_at_max {
            return " (the same)".into();
        }
        let share = if is_measured { format!("{} %, ", signed(share, 3)) } else { String::new() };
        Told::from(format!(" ({share}")).difference(shift, 3).unit().text(")")
    });
    told.then(difference.unwrap_or_default())
}

fn signed(value: f64, count: i32) -> String {
    with_sign(value, &digits(value, count))
}

/// `3: 2133.2–2149.8, 2178.3–2513, 2537.6–2701.3 rad/s`, others than isolas with their kinds.
fn of_others(level: &Level) -> Told {
    let range = |row: &BranchRow| {
        let kind = if row.is_isola() { String::new() } else { format!("{} ", row.kind) };
        Told::from(kind).frequency(row.omega.0, 5).text("–").frequency(row.omega.1, 5)
    };
    let mut others: Vec<&BranchRow> = level.others().collect();
    others.sort_by(|a, b| a.omega.0.total_cmp(&b.omega.0));
    let Some((first, further)) = others.split_first() else { return "none".into() };
    let begin = Told::from(format!("{}: ", others.len())).then(range(first));
    further.iter().fold(begin, |told, row| told.text(", ").then(range(row))).unit()
}

/// What differs most, the numbers as a table for a terminal, and below it what only one of two runs has.
pub fn table(comparison: &Comparison, width: u16) -> String {
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(width);
    let heads = ["A", "what"].map(String::from);
    table.set_header(heads.into_iter().chain(comparison.names.iter().cloned()));
    let settings = &comparison.settings;
    let shown = if settings.len() > SETTINGS + 1 { SETTINGS } else { settings.len() };
    for setting in &settings[..shown] {
        table.add_row(["", &setting.key].into_iter().chain(setting.values.iter().map(String::as_str)));
    }
    if shown < settings.len() {
        table.add_row([String::new(), format!("and {} more keys (all on the page)", settings.len() - shown)]);
    }
    let unit = comparison.reports.first().and_then(|report| report.units().frequency).unwrap_or_default();
    for NumberRow { amplitude, what, values } in &comparison.numbers {
        let values = values.iter().map(|value| value.read_in(unit));
        table.add_row([amplitude.clone(), what.to_string()].into_iter().chain(values));
    }
    let sentences = comparison.sentences.iter().map(|told| wrapped(&told.read_in(unit), width, "") + "\n");
    let answer = comparison.answer.iter().map(|sentence| wrapped(sentence, width, "") + "\n");
    format!("{}{table}\n{}", answer.collect::<String>(), sentences.collect::<String>())
}
