//! Names, model and overview of a run.

use crate::export::value::{Group, Value};
use crate::overview::Omissions;
use crate::overview::{BranchRow, Level, Overview, WindowRow};
use crate::store::{Reader, verdict_name};
use protocol::array::Array;
use protocol::model::{ElementMessage, ModelMessage};
use solver::response::branch::{Certificate, Standing};
use solver::response::modes::ModesFollowed;
use solver::stability::verification::Verification;

/// What does not change, and the stage.
pub(super) fn header(group: &mut Group<'_>, reader: &Reader, overview: &Overview, omissions: &mut Omissions) {
    if let Some(header) = &overview.header {
        let overrides = header.overrides.iter().map(|(key, value)| format!("{key}={value}"));
        group.add("id", header.run.as_str());
        group.add("name", header.name.as_str());
        group.add("study_file", header.study_file.to_string_lossy().into_owned());
        group.add("overrides", overrides.collect::<Vec<String>>());
        group.add("study", header.study.as_str());
        group.add("model_sha256", header.model_sha256.as_str());
        group.add("program", header.program.as_str());
        group.add("created", header.created.as_str());
        group.add("namespace", header.namespace.as_str());
    }
    if let Some(stage) = omissions.read("The stage of the run is", reader.stage()) {
        group.add("stage", stage.name());
    }
}

/// The structure.
pub(super) fn model(group: &mut Group<'_>, model: &ModelMessage) {
    group.add("name", model.name.as_str());
    group.add("dofs", model.dofs.clone());
    group.add("mass", model.mass.clone());
    group.add("stiffness", model.stiffness.clone());
    group.add("frequencies", model.frequencies.clone());
    group.add("shapes", model.shapes.clone());
    group.add("damping", model.damping.clone());
    group.add("forcing_shape", model.forcing.clone());
    group.add("forcing_harmonic", model.forcing_harmonic);
    group.add("elements", model.elements.iter().map(|element| element.name.clone()).collect::<Vec<String>>());
    let law = |element: &ElementMessage| serde_json::to_string(&element.law).expect("numbers and names");
    group.add("laws", model.elements.iter().map(law).collect::<Vec<String>>());
    group.add("coefficients", coefficients(model));
}

/// What the arguments of the laws are of the displacements: arguments × dofs.
fn coefficients(model: &ModelMessage) -> Value {
    let (width, channels) = (model.dofs.len(), model.elements.iter().flat_map(|element| &element.channels));
    let row = |channel: &Vec<(usize, f64)>| {
        let mut row = vec![0.0; width];
        for &(dof, coefficient) in channel {
            row[dof] += coefficient;
        }
        row
    };
    let rows: Vec<f64> = channels.clone().flat_map(row).collect();
    Array::new([channels.count(), width], rows).into()
}

/// Levels, by amplitude.
pub(super) fn levels(group: &mut Group<'_>, overview: &Overview) {
    let levels = &overview.levels;
    column(group, "amplitude", levels, |level| level.amplitude.clone());
    column(group, "value", levels, |level| level.value);
    column(group, "pending", levels, |level| level.pending);
    column(group, "dead", levels, |level| level.dead);
    column(group, "main_failure", levels, |level| level.main_failure.clone().unwrap_or_default());
}

/// Which modes were followed, from 0, and why others were not.
pub(super) fn modes(group: &mut Group<'_>, modes: &ModesFollowed) {
    group.add("followed", modes.followed.clone());
    column(group, "left_out", &modes.left_out, |(mode, _)| *mode);
    column(group, "reason", &modes.left_out, |(_, why)| why.to_string());
}

/// Windows of all levels, as in `windows.csv`.
pub(super) fn windows<'t>(group: &mut Group<'_>, overview: &'t Overview) {
    let of_level = |level: &'t Level| level.windows.iter().map(move |window| (level, window));
    let rows: Vec<(&Level, &WindowRow)> = overview.levels.iter().flat_map(of_level).collect();
    column(group, "amplitude", &rows, |(level, _)| level.amplitude.clone());
    column(group, "value", &rows, |(level, _)| level.value);
    column(group, "number", &rows, |(_, window)| window.number);
    column(group, "omega_min", &rows, |(_, window)| window.omega.0);
    column(group, "omega_max", &rows, |(_, window)| window.omega.1);
    column(group, "omega_best", &rows, |(_, window)| window.omega_best);
    column(group, "threshold", &rows, |(_, window)| window.threshold);
    column(group, "first", &rows, |(_, window)| window.points[0]);
    column(group, "last", &rows, |(_, window)| window.points[1]);
    column(group, "best", &rows, |(_, window)| window.points[2]);
    column(group, "outcome", &rows, |(_, window)| window.outcome.words()[0].to_string());
    column(group, "branch", &rows, |(_, window)| window.outcome.words()[1].to_string());
    column(group, "reason", &rows, |(_, window)| window.outcome.words()[2].to_string());
    column(group, "mode", &rows, |(_, window)| window.mode.saturating_sub(1));
}

/// Branches of all levels, as in `summary.csv`.
pub(super) fn branches(group: &mut Group<'_>, overview: &Overview) {
    let rows: Vec<(&Level, &BranchRow)> = overview.branches().collect();
    column(group, "file", &rows, |(level, branch)| level.file_name(branch));
    column(group, "amplitude", &rows, |(level, _)| level.amplitude.clone());
    column(group, "value", &rows, |(level, _)| level.value);
    column(group, "kind", &rows, |(_, branch)| branch.kind.clone());
    column(group, "number", &rows, |(_, branch)| branch.number);
    column(group, "status", &rows, |(_, branch)| branch.status.clone());
    column(group, "closed", &rows, |(_, branch)| branch.closed);
    column(group, "points", &rows, |(_, branch)| branch.points);
    column(group, "omega_min", &rows, |(_, branch)| branch.omega.0);
    column(group, "omega_max", &rows, |(_, branch)| branch.omega.1);
    column(group, "amplitude_max", &rows, |(_, branch)| branch.amplitude_max);
    column(group, "omega_at_max", &rows, |(_, branch)| branch.omega_at_max);
    let contact = |branch: &BranchRow| branch.certificate.contact_omega.unwrap_or((f64::NAN, f64::NAN));
    column(group, "contact_omega_min", &rows, |(_, branch)| contact(branch).0);
    column(group, "contact_omega_max", &rows, |(_, branch)| contact(branch).1);
    column(group, "task", &rows, |(_, branch)| branch.task.clone());
    column(group, "peak_standing", &rows, |(_, branch)| standing(branch.peak_standing));
    column(group, "family", &rows, |(_, branch)| branch.family.unwrap_or_default());
    for (name, of) in CERTIFICATE {
        column(group, name, &rows, |(_, branch)| of(&branch.certificate).unwrap_or(f64::NAN));
    }
    column(group, "stable", &rows, |(_, branch)| {
        branch.stability.as_ref().map_or(f64::NAN, |stability| stability.stable)
    });
}

/// What marching says of the `count` points of a branch, empty or not a number where they were not verified, and the
/// bifurcations.
pub(super) fn stability(group: &mut Group<'_>, count: usize, verified: Option<&Verification>) {
    let verified = verified.filter(|verified| verified.count == count);
    let verdicts = verified.map_or_else(|| vec![None; count], Verification::verdicts);
    let moduli = verified.map_or_else(|| vec![None; count], Verification::moduli);
    column(group, "stable", &verdicts, |verdict| verdict.map_or("", verdict_name).to_string());
    column(group, "multiplier", &moduli, |modulus| modulus.unwrap_or(f64::NAN));
    let found = verified.map_or(&[][..], |verified| &verified.bifurcations);
    column(group, "bifurcation_kind", found, |bifurcation| bifurcation.kind.name().to_string());
    column(group, "bifurcation_omega", found, |bifurcation| bifurcation.omega);
    column(group, "bifurcation_index", found, |bifurcation| bifurcation.at);
}

/// A number of a certificate, if it is known.
type Figure = fn(&Certificate) -> Option<f64>;

/// Numbers of a certificate by their names.
pub(super) const CERTIFICATE: [(&str, Figure); 9] = [
    ("penetration", |certificate| certificate.penetration),
    ("pressure_beyond", |certificate| certificate.pressure_beyond),
    ("amplitude_2h", |certificate| certificate.doubled.map(|doubled| doubled.amplitude)),
    ("shift_2h", |certificate| certificate.doubled.map(|doubled| doubled.shift)),
    ("omega_min_2h", |certificate| Some(certificate.doubled?.range?.0)),
    ("omega_max_2h", |certificate| Some(certificate.doubled?.range?.1)),
    ("change_2h", |certificate| certificate.elsewhere?.share),
    ("change_omega_2h", |certificate| Some(certificate.elsewhere?.omega)),
    ("slowest_sliding", |certificate| certificate.slowest_sliding),
];

/// The standing of a peak, empty if it is not known.
pub(super) fn standing(standing: Option<Standing>) -> String {
    standing.map_or_else(String::new, |standing| standing.name().into())
}

/// A column of a table.
fn column<R, T>(group: &mut Group<'_>, name: &str, rows: &[R], of: impl Fn(&R) -> T)
where
    Vec<T>: Into<Value>,
{
    group.add(name, rows.iter().map(of).collect::<Vec<T>>());
}
