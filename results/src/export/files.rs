//! The CSV files. Names of columns are an interface.

use super::ExportError;
use super::atomic::{BRANCHES, branches_folder};
use super::contents::{backbone, further, monitors};
use super::csv_columns::CsvColumns;
use super::listed;
use super::table::{Table, optional, text};
use crate::overview::{BranchRow, Level, Omissions, Overview, unfinished};
use crate::store::Reader;
use protocol::array::ArrayError;
use protocol::backbone::BackboneMessage;
use std::path::Path;

const SUMMARY_FILE: &str = "summary.csv";
const BACKBONE_FILE: &str = "backbone.csv";
const WINDOWS_FILE: &str = "windows.csv";

pub(super) const SUMMARY: [&str; 23] = [
    "amplitude",
    "branch",
    "kind",
    "status",
    "points",
    "omega_min",
    "omega_max",
    "amplitude_max",
    "omega_at_max",
    "contact_omega_min",
    "contact_omega_max",
    "peak_standing",
    "family",
    "penetration",
    "pressure_beyond",
    "amplitude_2h",
    "shift_2h",
    "stable",
    "omega_min_2h",
    "omega_max_2h",
    "change_2h",
    "change_omega_2h",
    "slowest_sliding",
];
pub(super) const WINDOWS: [&str; 10] =
    ["amplitude", "window", "omega_min", "omega_max", "omega_best", "threshold", "outcome", "branch", "reason", "mode"];

/// Writes `summary.csv`, `backbone.csv`, `windows.csv`, `folds.csv`, `events.csv`, `bifurcations.csv`, `branches/*.csv` and, of a run
/// with motions that were followed beyond instabilities or with pushes, `motions.csv` and `pushes.csv` into folder `dir`, at any
/// stage of a run; says which of them.
///
/// Frequencies are in rad/s, lengths in m, each number in the shortest form that reads back the same.
///
/// # Errors
/// If nothing of the run can be read or a file cannot be written; files are complete or not there.
pub(super) fn write(reader: &Reader, dir: &Path, omissions: &mut Omissions) -> Result<Vec<String>, ExportError> {
    let _snapshot = reader.snapshot()?;
    let overview = Overview::read(reader, omissions)?;
    let folder = branches_folder(dir)?;
    let backbone = omissions.take("The backbone is", backbone(reader));
    let further = omissions.take("Further backbones are", further(reader)).unwrap_or_default();
    omissions.missing.extend(unfinished(&overview.levels, backbone.as_ref().is_none_or(Option::is_some)));
    let mut written = vec![SUMMARY_FILE.to_string()];
    let is_read = backbone.is_some();
    let all: Vec<&BackboneMessage> = backbone.iter().flatten().chain(&further).collect();
    if is_read {
        let columns = if all.is_empty() { Ok(CsvColumns::without_backbone()) } else { CsvColumns::of_backbones(&all) };
        if let Some(columns) = omissions.take("backbone.csv is", columns) {
            columns.write(dir, BACKBONE_FILE)?;
            written.push(BACKBONE_FILE.into());
        }
    }
    write_windows(dir, &overview.levels)?;
    written.push(WINDOWS_FILE.into());
    let monitors = overview.model.as_ref().map(monitors);
    for list in listed::all(reader, &overview, &all, monitors.as_deref().unwrap_or_default(), omissions) {
        // Most runs have neither motions beyond instabilities nor pushes.
        if !list.is_empty() || !["motions", "pushes"].contains(&list.name) {
            written.push(list.write(dir)?);
        }
    }
    overview.each_branch(reader, omissions, |omissions, name, result| {
        let verified = reader.verification(result.task.as_str());
        let verified = omissions.read(format_args!("The stability of {name} is"), verified).flatten();
        let columns = result.branch.as_ref().map(|branch| {
            let columns = CsvColumns::of_branch(branch, monitors.as_deref())?;
            Ok::<_, ArrayError>(columns.with_stability(verified.as_ref()))
        });
        let columns = columns.and_then(|columns| omissions.take(format_args!("Branch {name} is"), columns));
        columns.map_or(Ok(()), |columns| columns.write(&folder, &format!("{name}.csv")))
    })?;
    write_summary(dir, &overview.levels)?;
    written.push(BRANCHES.into());
    Ok(written)
}

fn names(columns: &[&str]) -> Vec<String> {
    columns.iter().map(ToString::to_string).collect()
}

fn write_summary(dir: &Path, levels: &[Level]) -> Result<(), ExportError> {
    let mut table = Table::create(dir, SUMMARY_FILE, &names(&SUMMARY))?;
    for level in levels {
        if let (None, Some(status)) = (level.main(), &level.main_failure) {
            let mut row = vec![level.amplitude.clone(), "1".into(), "main".into(), status.clone()];
            row.resize(SUMMARY.len(), String::new());
            table.row(row)?;
        }
        for branch in &level.branches {
            table.row(summary_row(level, branch))?;
        }
    }
    table.finish()
}

fn summary_row(level: &Level, branch: &BranchRow) -> [String; 23] {
    let certificate = &branch.certificate;
    let range = certificate.doubled.and_then(|doubled| doubled.range);
    [
        level.amplitude.clone(),
        branch.number.to_string(),
        branch.kind.clone(),
        branch.status.clone(),
        branch.points.to_string(),
        text(branch.omega.0),
        text(branch.omega.1),
        text(branch.amplitude_max),
        text(branch.omega_at_max),
        optional(certificate.contact_omega.map(|(low, _)| low)),
        optional(certificate.contact_omega.map(|(_, high)| high)),
        branch.peak_standing.map_or_else(String::new, |standing| standing.name().into()),
        branch.family.map_or_else(String::new, |family| family.to_string()),
        optional(certificate.penetration),
        optional(certificate.pressure_beyond),
        optional(certificate.doubled.map(|doubled| doubled.amplitude)),
        optional(certificate.doubled.map(|doubled| doubled.shift)),
        // Of what is around a peak no share of the branch follows.
        optional(branch.stability.as_ref().filter(|stability| stability.is_whole).map(|stability| stability.stable)),
        optional(range.map(|(low, _)| low)),
        optional(range.map(|(_, high)| high)),
        optional(certificate.elsewhere.and_then(|change| change.share)),
        optional(certificate.elsewhere.map(|change| change.omega)),
        optional(certificate.slowest_sliding),
    ]
}

fn write_windows(dir: &Path, levels: &[Level]) -> Result<(), ExportError> {
    let mut table = Table::create(dir, WINDOWS_FILE, &names(&WINDOWS))?;
    for level in levels {
        for window in &level.windows {
            let [outcome, branch, reason] = window.outcome.words();
            table.row([
                level.amplitude.as_str(),
                &window.number.to_string(),
                &text(window.omega.0),
                &text(window.omega.1),
                &text(window.omega_best),
                &text(window.threshold),
                outcome,
                branch,
                reason,
                &window.mode.to_string(),
            ])?;
        }
    }
    table.finish()
}
