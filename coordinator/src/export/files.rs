//! The CSV files. Names of columns are an interface.

use super::ExportError;
use super::table::{Table, failed, optional, text};
use crate::store::{Reader, number};
use crate::survey::{BranchRow, LevelRow, WindowOutcome, branches, levels, main_failure, windows};
use protocol::array::Array;
use std::fs;
use std::path::Path;

const SUMMARY: [&str; 11] = [
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
];
const WINDOWS: [&str; 9] =
    ["amplitude", "window", "omega_min", "omega_max", "omega_best", "threshold", "outcome", "branch", "reason"];
const BACKBONE: [&str; 7] = ["omega", "zeta", "amplitude", "r_lin", "r_nl", "work_per_amplitude", "threshold"];
const BRANCH: [&str; 6] = ["omega", "amplitude", "rms", "contact", "residual", "high_harmonics"];

/// Writes `summary.csv`, `backbone.csv`, `windows.csv` and `branches/*.csv` into folder `dir`, at any stage of a run.
///
/// Frequencies are in rad/s, lengths in m, each number in the shortest form that reads back the same.
///
/// # Errors
/// If the run cannot be read or a file cannot be written; files are complete or not there.
pub fn csv(reader: &Reader, dir: &Path) -> Result<(), ExportError> {
    let folder = dir.join("branches");
    fs::create_dir_all(&folder).map_err(|source| failed(&folder, source))?;
    let _snapshot = reader.snapshot()?;
    let levels = levels(reader)?;
    backbone(reader, dir)?;
    write_windows(reader, dir, &levels)?;
    let monitors: Vec<String> = {
        let model = reader.model()?;
        model.monitors.iter().map(|&dof| model.dofs[dof].clone()).collect()
    };
    for level in &levels {
        for row in branches(reader, level.level)? {
            branch(reader, &folder, level, &row, &monitors)?;
        }
    }
    summary(reader, dir, &levels)
}

fn names(columns: &[&str]) -> Vec<String> {
    columns.iter().map(ToString::to_string).collect()
}

fn summary(reader: &Reader, dir: &Path, levels: &[LevelRow]) -> Result<(), ExportError> {
    let mut table = Table::create(dir, "summary.csv", &names(&SUMMARY))?;
    for level in levels {
        if let Some(status) = main_failure(reader, level.level)? {
            let mut row = vec![level.amplitude.clone(), "1".into(), "main".into(), status];
            row.resize(SUMMARY.len(), String::new());
            table.row(row)?;
        }
        for branch in branches(reader, level.level)? {
            table.row(summary_row(level, &branch))?;
        }
    }
    table.finish()
}

fn summary_row(level: &LevelRow, branch: &BranchRow) -> [String; 11] {
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
        optional(branch.contact_omega.map(|(low, _)| low)),
        optional(branch.contact_omega.map(|(_, high)| high)),
    ]
}

fn write_windows(reader: &Reader, dir: &Path, levels: &[LevelRow]) -> Result<(), ExportError> {
    let mut table = Table::create(dir, "windows.csv", &names(&WINDOWS))?;
    for level in levels {
        for window in windows(reader, level.level)? {
            let (outcome, branch, reason) = match window.outcome {
                WindowOutcome::Found(branches) => ("found", branches, String::new()),
                WindowOutcome::NotFound(reasons) => ("not_found", String::new(), reasons),
                WindowOutcome::Pending(reasons) => ("pending", String::new(), reasons),
            };
            table.row([
                level.amplitude.clone(),
                window.number.to_string(),
                text(window.omega.0),
                text(window.omega.1),
                text(window.omega_best),
                text(window.threshold),
                outcome.into(),
                branch,
                reason,
            ])?;
        }
    }
    table.finish()
}

fn backbone(reader: &Reader, dir: &Path) -> Result<(), ExportError> {
    let contributions = Rows::of(reader.array("backbone", "contributions")?);
    let mut columns = names(&BACKBONE);
    columns.extend((1..=contributions.width).map(|mode| format!("contribution_{mode}")));
    let mut table = Table::create(dir, "backbone.csv", &columns)?;
    let sql = "SELECT omega, zeta, amplitude, r_lin, r_nl, work_per_amplitude, threshold FROM backbone ORDER BY i";
    let mut rows = contributions.iter();
    let read = |row: &rusqlite::Row<'_>| (0..BACKBONE.len()).map(|column| number(row, column)).collect();
    reader.each(sql, [], read, |values: Vec<f64>| {
        let rest = rows.next().unwrap_or_default();
        table.row(values.iter().chain(rest).copied().map(text))
    })?;
    table.finish()
}

fn branch(
    reader: &Reader,
    dir: &Path,
    level: &LevelRow,
    branch: &BranchRow,
    monitors: &[String],
) -> Result<(), ExportError> {
    let further = monitors.get(1..).unwrap_or_default();
    let amplitudes = match further {
        [] => Rows::of(None),
        _ => Rows::of(reader.array(&branch.task, "amplitude")?),
    };
    let mut columns = names(&BRANCH);
    columns.extend(further.iter().map(|dof| format!("amplitude_{dof}")));
    let name = format!("{}-{}-{}.csv", level.amplitude, branch.kind, branch.number);
    let mut table = Table::create(dir, &name, &columns)?;
    let sql =
        "SELECT omega, amplitude, rms, contact, residual, high_harmonics FROM points WHERE branch = ?1 ORDER BY i";
    let mut rows = amplitudes.iter();
    let read = |row: &rusqlite::Row<'_>| (0..BRANCH.len()).map(|column| row.get(column)).collect();
    reader.each(sql, [branch.id], read, |values: Vec<Option<f64>>| {
        let rest = rows.next().and_then(|row| row.get(1..)).unwrap_or_default();
        table.row(values.into_iter().chain(rest.iter().copied().map(Some)).map(optional))
    })?;
    table.finish()
}

/// Rows of an array of two axes.
struct Rows {
    values: Vec<f64>,
    width: usize,
}

impl Rows {
    /// Of an array, if there is one.
    fn of(array: Option<Array>) -> Self {
        let width = array.as_ref().and_then(|array| array.shape.get(1)).copied().unwrap_or(0);
        let values = array.and_then(|array| array.values("rows", &[array.len(), width]).ok()).unwrap_or_default();
        Self { values, width }
    }

    fn iter(&self) -> impl Iterator<Item = &[f64]> {
        self.values.chunks(self.width.max(1))
    }
}
