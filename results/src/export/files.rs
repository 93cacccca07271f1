//! The CSV files. Names of columns are an interface.

use super::ExportError;
use super::atomic::branches_folder;
use super::contents::{backbone, further, monitors};
use super::csv_columns::CsvColumns;
use super::table::{Table, optional, text};
use crate::curves::BackboneCurve;
use crate::overview::{BranchRow, CurveEvent, Level, MERGE, Omissions, Overview, curve_events, merge_verb, unfinished};
use crate::store::{BifurcationRow, CurveRow, MotionRow, PushRow, Reader};
use protocol::array::ArrayError;
use protocol::backbone::BackboneMessage;
use protocol::curve::Size;
use solver::response::windows::{Event, EventKind};
use std::path::Path;

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

pub(super) const FOLDS: [&str; 5] = ["curve", "forcing", "omega", "amplitude", "kind"];
pub(super) const EVENTS: [&str; 11] = [
    "kind",
    "source",
    "forcing",
    "omega",
    "amplitude",
    "mode",
    "curve",
    "backbone",
    "forcing_2h",
    "omega_2h",
    "outcome",
];

pub(super) const BIFURCATIONS: [&str; 5] = ["forcing", "branch", "kind", "omega", "amplitude"];

pub(super) const MOTIONS: [&str; 10] =
    ["forcing", "branch", "point", "omega", "motion", "repeats", "onto", "amplitude_min", "amplitude_max", "growth"];

pub(super) const PUSHES: [&str; 13] = [
    "forcing",
    "branch",
    "mode",
    "omega",
    "monitor",
    "motions",
    "largest",
    "impulse",
    "below",
    "velocity",
    "phase",
    "confirmed",
    "energy",
];

/// Writes `summary.csv`, `backbone.csv`, `windows.csv`, `folds.csv`, `events.csv`, `bifurcations.csv`, `branches/*.csv` and, of a run
/// with motions that were followed beyond instabilities or with pushes, `motions.csv` and `pushes.csv` into folder `dir`, at any
/// stage of a run.
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
    let further = omissions.take("Further backbones are", further(reader)).unwrap_or_default();
    omissions.missing.extend(unfinished(&overview.levels, backbone.as_ref().is_none_or(Option::is_some)));
    let predicted = backbone
        .iter()
        .flatten()
        .chain(&further)
        .flat_map(|backbone| predicted(&overview, backbone))
        .collect::<Vec<_>>();
    if let Some(backbone) = backbone {
        let all: Vec<&BackboneMessage> = backbone.iter().chain(&further).collect();
        let columns = if all.is_empty() { Ok(CsvColumns::without_backbone()) } else { CsvColumns::of_backbones(&all) };
        let columns = omissions.take("backbone.csv is", columns);
        columns.map_or(Ok(()), |columns| columns.write(dir, "backbone.csv"))?;
    }
    write_windows(dir, &overview.levels)?;
    let curves = omissions.read("The list of fold curves is", reader.curves()).unwrap_or_default();
    write_folds(dir, &curves)?;
    write_events(dir, &curves, &predicted)?;
    let bifurcations = omissions.read("The list of bifurcations is", reader.bifurcations()).unwrap_or_default();
    write_bifurcations(dir, &bifurcations)?;
    let motions = omissions.read("The list of motions is", reader.motions()).unwrap_or_default();
    if !motions.is_empty() {
        write_motions(dir, &motions)?;
    }
    let monitors = overview.model.as_ref().map(monitors);
    let pushes = omissions.read("The list of pushes is", reader.pushes()).unwrap_or_default();
    if !pushes.is_empty() {
        write_pushes(dir, &pushes, monitors.as_deref().unwrap_or_default())?;
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
    write_summary(dir, &overview.levels)
}

/// Births and merges that the energy balance predicts along a backbone, as far as they mean something for the levels, with the mode
/// of the backbone.
fn predicted(overview: &Overview, backbone: &BackboneMessage) -> Vec<(usize, Event)> {
    let Some(model) = overview.model.as_ref().and_then(|model| model.model().ok()) else { return Vec::new() };
    let Ok(backbone) = backbone.backbone(&Size::of(&model)) else { return Vec::new() };
    let mut curve = BackboneCurve::new(&backbone, &model);
    curve.keep_events_near(overview.levels.iter().map(|level| level.value));
    curve.events.into_iter().map(|event| (curve.mode, event)).collect()
}

/// Writes the points of fold curves; `kind` is `fold` or what happens there.
fn write_folds(dir: &Path, curves: &[CurveRow]) -> Result<(), ExportError> {
    let mut table = Table::create(dir, "folds.csv", &names(&FOLDS))?;
    for curve in curves {
        for point in &curve.points {
            let [forcing, omega, amplitude] = [point.forcing, point.omega, point.amplitude].map(text);
            let kind = point.event.as_deref().unwrap_or("fold");
            table.row([&curve.number.to_string(), &forcing, &omega, &amplitude, kind])?;
        }
    }
    table.finish()
}

/// Writes births and merges, those that were computed, each once, and those that the energy balance predicts.
pub(super) fn write_events(dir: &Path, curves: &[CurveRow], predicted: &[(usize, Event)]) -> Result<(), ExportError> {
    let mut table = Table::create(dir, "events.csv", &names(&EVENTS))?;
    for CurveEvent { curve, kind, point } in curve_events(curves) {
        let [forcing, omega, amplitude] = [point.forcing, point.omega, point.amplitude].map(text);
        let [forcing_2h, omega_2h] = point.doubled.map_or([const { String::new() }; 2], |(a, w)| [text(a), text(w)]);
        let curve = curve.to_string();
        let verb = if kind == MERGE.kind.name() { merge_verb(curves, point) } else { "" };
        let outcome = if verb == MERGE.verb { "" } else { verb };
        table.row([kind, "computed", &forcing, &omega, &amplitude, "", &curve, "", &forcing_2h, &omega_2h, outcome])?;
    }
    for (backbone, event) in predicted {
        let kind = match event.kind {
            EventKind::Birth => "birth",
            EventKind::Merge => "merge",
        };
        let [forcing, omega, amplitude] = [event.threshold, event.omega, event.amplitude].map(text);
        let mode = event.mode.map_or_else(String::new, |mode| (mode + 1).to_string());
        let backbone = (backbone + 1).to_string();
        table.row([kind, "predicted", &forcing, &omega, &amplitude, &mode, "", &backbone, "", "", ""])?;
    }
    table.finish()
}

/// Writes where multipliers of marched orbits cross the unit circle.
fn write_bifurcations(dir: &Path, rows: &[BifurcationRow]) -> Result<(), ExportError> {
    let mut table = Table::create(dir, "bifurcations.csv", &names(&BIFURCATIONS))?;
    for row in rows {
        table.row([&row.forcing, &row.branch, &row.kind, &text(row.omega), &text(row.amplitude)])?;
    }
    table.finish()
}

/// Writes what unstable motions turn into.
fn write_motions(dir: &Path, rows: &[MotionRow]) -> Result<(), ExportError> {
    let mut table = Table::create(dir, "motions.csv", &names(&MOTIONS))?;
    for row in rows {
        let [low, high] = [row.amplitude.map(|range| range.0), row.amplitude.map(|range| range.1)].map(optional);
        let repeats = row.repeats.map_or_else(String::new, |repeats| repeats.to_string());
        let (point, omega, growth) = (row.point.to_string(), text(row.omega), optional(row.growth));
        let onto = row.onto.as_deref().unwrap_or_default();
        table.row([
            row.forcing.as_str(),
            &row.branch,
            &point,
            &omega,
            &row.motion,
            &repeats,
            onto,
            &low,
            &high,
            &growth,
        ])?;
    }
    table.finish()
}

/// Writes the smallest pushes found that end on branches; impulses act at the named dof, N s.
fn write_pushes(dir: &Path, rows: &[PushRow], monitors: &[String]) -> Result<(), ExportError> {
    let mut table = Table::create(dir, "pushes.csv", &names(&PUSHES))?;
    for row in rows {
        let [largest, impulse, below, velocity, phase, energy] =
            [row.largest, row.impulse, row.below, row.velocity, row.phase, row.energy()].map(optional);
        let confirmed = row.confirmed.map_or("", |confirmed| if confirmed { "true" } else { "false" });
        let (mode, omega, motions) = (row.mode.to_string(), text(row.omega), row.motions.to_string());
        let monitor = monitors.get(row.monitor).map_or("", String::as_str);
        table.row([
            row.forcing.as_str(),
            &row.branch,
            &mode,
            &omega,
            monitor,
            &motions,
            &largest,
            &impulse,
            &below,
            &velocity,
            &phase,
            confirmed,
            &energy,
        ])?;
    }
    table.finish()
}

fn names(columns: &[&str]) -> Vec<String> {
    columns.iter().map(ToString::to_string).collect()
}

fn write_summary(dir: &Path, levels: &[Level]) -> Result<(), ExportError> {
    let mut table = Table::create(dir, "summary.csv", &names(&SUMMARY))?;
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
                &window.mode.to_string(),
            ])?;
        }
    }
    table.finish()
}
