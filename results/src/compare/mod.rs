//! Several runs beside each other: what of their studies differs, what each found, level by level, and by how much that is
//! another.

mod answer;
mod born;
mod found;
mod matrices;
mod numbers;
#[cfg(test)]
mod tests;

pub use numbers::{NumberRow, table};

use crate::figure::{Compared, ComparedFigures};
use crate::report::Report;
use crate::resolved_study::{differences, settings as settings_of, with_amplitudes};
use crate::told::Told;
use serde::Serialize;

/// Keys of studies whose differences say nothing of the structure or its computation.
const NAMES: [&str; 2] = ["name", "model"];

/// The key of the forcing amplitudes.
const AMPLITUDES: &str = "amplitudes";

/// Runs that are compared, the first one being what others are measured by.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// What each run is called: as its study, or as its folder where studies share a name, with its number where folders do too; where
    /// amplitudes are those of different dofs, with its own.
    pub names: Vec<String>,
    /// The runs.
    pub reports: Vec<Report>,
    /// Forcing amplitudes that any of them has, in ascending order.
    pub levels: Vec<ComparedLevel>,
    /// Keys of the studies that differ.
    pub settings: Vec<SettingRow>,
    /// By how much the largest responses of each later run differ from those of the first, and at how many levels it has isolas: sentences.
    pub answer: Vec<String>,
    /// What was found at every level that several runs have, in numbers.
    pub numbers: Vec<NumberRow>,
    /// Levels that only some of the runs have, isolas and births that only one of the first run and another one has, and what is not compared.
    pub sentences: Vec<Told>,
    /// Figures with the curves of all runs.
    pub figures: ComparedFigures,
}

/// A forcing level of any run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedLevel {
    /// Forcing amplitude, as typed for the first run that has it.
    pub amplitude: String,
    /// Forcing amplitude A.
    pub value: f64,
}

/// A key of the studies, and its value in each run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SettingRow {
    /// Dotted key.
    pub key: String,
    /// Values as TOML, one a run.
    pub values: Vec<String>,
}

impl Comparison {
    /// Of runs, each with the name of its folder.
    pub fn new(runs: Vec<(String, Report)>) -> Self {
        let names = names(&runs);
        let reports: Vec<Report> = runs.into_iter().map(|(_, report)| report).collect();
        let levels = levels(&reports);
        let sides: Vec<Compared<'_>> =
            names.iter().zip(&reports).map(|(name, report)| Compared { name, subject: report.subject() }).collect();
        let values: Vec<f64> = levels.iter().map(|level| level.value).collect();
        let figures = ComparedFigures::new(&sides, &values);
        let (settings, numbers) = (settings(&reports), numbers::rows(&reports, &levels));
        let answer = answer::sentences(&names, &reports, &settings);
        let numbers: Vec<NumberRow> = born::rows(&reports).into_iter().chain(numbers).collect();
        let sentences = (found::lacking(&names, &reports, &levels).into_iter())
            .chain(found::alone(&names, &reports))
            .chain(found::not_compared(&reports))
            .collect();
        Self { settings, answer, numbers, sentences, figures, names, levels, reports }
    }
}

/// What runs are called: see [`Comparison::names`].
fn names(runs: &[(String, Report)]) -> Vec<String> {
    let once = |names: &[String], name: &String| names.iter().filter(|other| *other == name).count() == 1;
    let studies: Vec<String> = runs.iter().map(|(_, report)| report.run.name.clone()).collect();
    let called = |(study, (folder, _)): (&String, &(String, Report))| {
        if once(&studies, study) { study.clone() } else { folder.clone() }
    };
    let names: Vec<String> = studies.iter().zip(runs).map(called).collect();
    let number =
        |(k, name): (usize, &String)| if once(&names, name) { name.clone() } else { format!("{name} ({})", k + 1) };
    let names: Vec<String> = names.iter().enumerate().map(number).collect();
    let monitors: Vec<&str> = runs.iter().map(|(_, report)| monitor(report)).collect();
    if is_one(&monitors) {
        return names;
    }
    names.iter().zip(monitors).map(|(name, monitor)| format!("{name} ({monitor})")).collect()
}

/// The dof whose amplitudes a run tells.
fn monitor(report: &Report) -> &str {
    report.monitors.first().map_or("", |monitor| &monitor.name)
}

/// Whether amplitudes of runs are those of one dof.
fn is_one(monitors: &[&str]) -> bool {
    monitors.windows(2).all(|pair| pair[0] == pair[1])
}

fn levels(reports: &[Report]) -> Vec<ComparedLevel> {
    let mut all: Vec<ComparedLevel> = Vec::new();
    for level in reports.iter().flat_map(|report| &report.overview.levels) {
        if !all.iter().any(|known| known.value == level.value) {
            all.push(ComparedLevel { amplitude: level.amplitude.clone(), value: level.value });
        }
    }
    all.sort_by(|a, b| a.value.total_cmp(&b.value));
    all
}

/// The study of a run, its forcing amplitudes ascending: levels that were added later stand behind the others there.
fn study(report: &Report) -> String {
    let study = &report.account.study;
    let has_levels = settings_of(study).iter().any(|(key, _)| key == AMPLITUDES);
    let levels: Vec<&str> = report.overview.levels.iter().map(|level| level.amplitude.as_str()).collect();
    let sorted = has_levels.then(|| with_amplitudes(study, &levels).ok()).flatten();
    sorted.unwrap_or_else(|| study.clone())
}

/// Keys that differ between the first run and any other; of the programs that made the runs, their versions.
fn settings(reports: &[Report]) -> Vec<SettingRow> {
    let Some((first, others)) = reports.split_first() else { return Vec::new() };
    let mut rows: Vec<SettingRow> = Vec::new();
    for (place, other) in (1..).zip(others) {
        let changes = differences(&study(first), &study(other));
        for change in matrices::by_numbers(changes, [first, other]) {
            if NAMES.contains(&change.key.as_str()) {
                continue;
            }
            let row = match rows.iter().position(|row| row.key == change.key) {
                Some(row) => &mut rows[row],
                None => {
                    rows.push(SettingRow { key: change.key, values: vec![change.old; reports.len()] });
                    rows.last_mut().expect("it was pushed")
                }
            };
            row.values[place] = change.new;
        }
    }
    rows.sort_by(|a, b| a.key.cmp(&b.key));
    let programs: Vec<String> = reports.iter().map(|report| report.run.program.clone()).collect();
    if programs.iter().any(|program| *program != programs[0]) {
        rows.push(SettingRow { key: "program".into(), values: programs });
    }
    rows
}
