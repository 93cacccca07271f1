//! The CSV files. Names of columns are an interface.

use super::ExportError;
use super::atomic::branches_folder;
use super::contents::{backbone, monitors};
use super::table::{Table, optional, text};
use crate::overview::Omissions;
use crate::overview::{BranchRow, Level, Overview, unfinished};
use crate::store::{Reader, Scalars};
use protocol::array::{Array, ArrayError};
use protocol::backbone::BackboneMessage;
use protocol::branch::BranchMessage;
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
/// If nothing of the run can be read or a file cannot be written; files are complete or not there.
pub(super) fn write(reader: &Reader, dir: &Path, omissions: &mut Omissions) -> Result<(), ExportError> {
    let _snapshot = reader.snapshot()?;
    let overview = Overview::read(reader, omissions)?;
    let folder = branches_folder(dir)?;
    let backbone = omissions.take("The backbone is", backbone(reader));
    omissions.missing.extend(unfinished(&overview.levels, backbone.as_ref().is_none_or(Option::is_some)));
    if let Some(backbone) = backbone {
        write_backbone(dir, backbone.as_ref(), omissions)?;
    }
    write_windows(dir, &overview.levels)?;
    let monitors = overview.model.as_ref().map(monitors);
    overview.each_branch(reader, omissions, |omissions, name, result| {
        let columns = result.branch.as_ref().map(|branch| branch_columns(branch, monitors.as_deref()));
        let columns = columns.and_then(|columns| omissions.take(format_args!("Branch {name} is"), columns));
        columns.map_or(Ok(()), |columns| columns.write(&folder, &format!("{name}.csv")))
    })?;
    write_summary(dir, &overview.levels)
}

fn names(columns: &[&str]) -> Vec<String> {
    columns.iter().map(ToString::to_string).collect()
}

fn write_summary(dir: &Path, levels: &[Level]) -> Result<(), ExportError> {
    let mut table = Table::create(dir, "summary.csv", &names(&SUMMARY))?;
    for level in levels {
        if let Some(status) = &level.main_failure {
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

fn summary_row(level: &Level, branch: &BranchRow) -> [String; 11] {
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

fn write_windows(dir: &Path, levels: &[Level]) -> Result<(), ExportError> {
    let mut table = Table::create(dir, "windows.csv", &names(&WINDOWS))?;
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
            ])?;
        }
    }
    table.finish()
}

fn write_backbone(
    dir: &Path,
    backbone: Option<&BackboneMessage>,
    omissions: &mut Omissions,
) -> Result<(), ExportError> {
    let columns = backbone.map_or_else(|| Ok(Columns::new(&BACKBONE)), backbone_columns);
    let columns = omissions.take("backbone.csv is", columns);
    columns.map_or(Ok(()), |columns| columns.write(dir, "backbone.csv"))
}

fn backbone_columns(backbone: &BackboneMessage) -> Result<Columns, ArrayError> {
    let (mut columns, count) = (Columns::new(&BACKBONE), backbone.points.len());
    let scalars = Scalars::new(&backbone.points)?;
    let contributions = Rows::of("contributions", &backbone.contributions)?;
    let column = |name, array: &Array| array.values(name, &[count]);
    let rows = [
        scalars.omega,
        column("decay", &backbone.points.motions.decay)?,
        scalars.amplitude,
        column("r_lin", &backbone.r_lin)?,
        column("r_nl", &backbone.r_nl)?,
        column("work_per_amplitude", &backbone.work_per_amplitude)?,
        column("threshold", &backbone.threshold)?,
    ];
    columns.names.extend((1..=contributions.width).map(|mode| format!("contribution_{mode}")));
    let row = |i: usize| {
        let values = rows.iter().map(move |column| column[i]).chain(contributions.row(i).iter().copied());
        values.map(text).collect()
    };
    columns.rows = (0..count).map(row).collect();
    Ok(columns)
}

/// Columns of a branch; dofs that are monitored, after the first, have one each.
fn branch_columns(branch: &BranchMessage, monitors: Option<&[String]>) -> Result<Columns, ArrayError> {
    let mut columns = Columns::new(&BRANCH);
    let scalars = Scalars::new(&branch.points)?;
    let amplitude = Rows::of("amplitude", &branch.points.amplitude)?;
    let name = |i: usize| monitors.and_then(|names| names.get(i)).map_or_else(|| (i + 1).to_string(), String::clone);
    columns.names.extend((1..amplitude.width).map(|i| format!("amplitude_{}", name(i))));
    let number = |value: f64| optional(Some(value).filter(|value| !value.is_nan()));
    let row = |i: usize| {
        let first = [
            number(scalars.omega[i]),
            number(scalars.amplitude[i]),
            number(scalars.rms[i]),
            scalars.contact[i].map_or_else(String::new, number),
            number(scalars.residual[i]),
            number(scalars.high_harmonics[i]),
        ];
        first.into_iter().chain(amplitude.row(i).iter().skip(1).copied().map(text)).collect()
    };
    columns.rows = (0..branch.points.len()).map(row).collect();
    Ok(columns)
}

/// A table in memory.
struct Columns {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Columns {
    fn new(columns: &[&str]) -> Self {
        Self { names: names(columns), rows: Vec::new() }
    }

    fn write(self, dir: &Path, name: &str) -> Result<(), ExportError> {
        let mut table = Table::create(dir, name, &self.names)?;
        self.rows.into_iter().try_for_each(|row| table.row(row))?;
        table.finish()
    }
}

/// Rows of an array of two axes.
struct Rows {
    values: Vec<f64>,
    width: usize,
}

impl Rows {
    fn of(name: &'static str, array: &Array) -> Result<Self, ArrayError> {
        let width = array.shape.get(1).copied().unwrap_or(0);
        Ok(Self { values: array.values(name, &[array.len(), width])?, width })
    }

    fn row(&self, i: usize) -> &[f64] {
        &self.values[i * self.width..(i + 1) * self.width]
    }
}
