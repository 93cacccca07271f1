//! What is listed of a run besides its branches and windows. Names of columns are an interface.

use super::list::{List, Lister};
use crate::curves::BackboneCurve;
use crate::overview::{CurveEvent, MERGE, Omissions, Overview, curve_events, merge_verb};
use crate::store::{BifurcationRow, CurveRow, MotionRow, PushRow, Reader};
use protocol::backbone::BackboneMessage;
use protocol::curve::Size;
use solver::response::windows::{Event, EventKind};
use solver::stability::endings::Ending;

/// All lists of a run: fold curves, births and merges, bifurcations, what unstable motions turn into, and pushes. Notes what cannot
/// be read; `backbones`: those that there are, `monitors`: names of the monitored dofs.
pub(super) fn all(
    reader: &Reader,
    overview: &Overview,
    backbones: &[&BackboneMessage],
    monitors: &[String],
    omissions: &mut Omissions,
) -> [List; 5] {
    let curves = omissions.read("The list of fold curves is", reader.curves()).unwrap_or_default();
    let predicted: Vec<_> = backbones.iter().flat_map(|backbone| predicted(overview, backbone)).collect();
    let rows = omissions.read("The list of bifurcations is", reader.bifurcations()).unwrap_or_default();
    let motion_rows = omissions.read("The list of motions is", reader.motions()).unwrap_or_default();
    let push_rows = omissions.read("The list of pushes is", reader.pushes()).unwrap_or_default();
    let level = |forcing: &str| value_of(overview, forcing);
    [
        folds(&curves),
        events(&curves, &predicted),
        bifurcations(&rows, level),
        motions(&motion_rows, level),
        pushes(&push_rows, level, monitors),
    ]
}

/// A forcing amplitude as a number.
fn value_of(overview: &Overview, forcing: &str) -> f64 {
    let level = overview.levels.iter().find(|level| level.amplitude == forcing);
    level.map_or(f64::NAN, |level| level.value)
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

/// The points of fold curves; `kind` is `fold` or what happens there.
pub(super) fn folds(curves: &[CurveRow]) -> List {
    let rows: Vec<_> =
        curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve.number, point))).collect();
    Lister::new(&rows)
        .counts("curve", |(curve, _)| *curve)
        .numbers("forcing", |(_, point)| point.forcing)
        .numbers("omega", |(_, point)| point.omega)
        .numbers("amplitude", |(_, point)| point.amplitude)
        .texts("kind", |(_, point)| point.event.as_deref().unwrap_or("fold"))
        .list("folds")
}

/// A birth, death, merge or cusp.
struct EventRow<'c> {
    kind: &'c str,
    source: &'static str,
    at: [f64; 3],
    mode: Option<usize>,
    curve: Option<usize>,
    backbone: Option<usize>,
    doubled: Option<(f64, f64)>,
    outcome: &'static str,
}

impl<'c> EventRow<'c> {
    /// What was computed along a fold curve.
    fn computed(curves: &[CurveRow], CurveEvent { curve, kind, point }: &CurveEvent<'c>) -> Self {
        let verb = if *kind == MERGE.kind.name() { merge_verb(curves, point) } else { "" };
        Self {
            kind,
            source: "computed",
            at: [point.forcing, point.omega, point.amplitude],
            mode: None,
            curve: Some(*curve),
            backbone: None,
            doubled: point.doubled,
            outcome: if verb == MERGE.verb { "" } else { verb },
        }
    }

    /// What the energy balance predicts along the backbone of a mode.
    fn predicted((backbone, event): &(usize, Event)) -> Self {
        Self {
            kind: match event.kind {
                EventKind::Birth => "birth",
                EventKind::Merge => "merge",
            },
            source: "predicted",
            at: [event.threshold, event.omega, event.amplitude],
            mode: event.mode,
            curve: None,
            backbone: Some(*backbone),
            doubled: None,
            outcome: "",
        }
    }
}

/// Births and merges, those that were computed, each once, and those that the energy balance predicts.
pub(super) fn events(curves: &[CurveRow], predicted: &[(usize, Event)]) -> List {
    let computed = curve_events(curves);
    let computed = computed.iter().map(|event| EventRow::computed(curves, event));
    let rows: Vec<EventRow<'_>> = computed.chain(predicted.iter().map(EventRow::predicted)).collect();
    Lister::new(&rows)
        .texts("kind", |row| row.kind)
        .texts("source", |row| row.source)
        .numbers("forcing", |row| row.at[0])
        .numbers("omega", |row| row.at[1])
        .numbers("amplitude", |row| row.at[2])
        .optional_modes("mode", |row| row.mode)
        .optional_counts("curve", |row| row.curve)
        .optional_modes("backbone", |row| row.backbone)
        .optional_numbers("forcing_2h", |row| row.doubled.map(|(forcing, _)| forcing))
        .optional_numbers("omega_2h", |row| row.doubled.map(|(_, omega)| omega))
        .texts("outcome", |row| row.outcome)
        .list("events")
}

/// Where multipliers of marched orbits cross the unit circle; `level`: the number that a forcing stands for.
pub(super) fn bifurcations(rows: &[BifurcationRow], level: impl Fn(&str) -> f64) -> List {
    Lister::new(rows)
        .texts("forcing", |row| &row.forcing)
        .texts("branch", |row| &row.branch)
        .texts("kind", |row| &row.kind)
        .numbers("omega", |row| row.omega)
        .numbers("amplitude", |row| row.amplitude)
        .numbers("value", |row| level(&row.forcing))
        .without_text()
        .list("bifurcations")
}

/// What unstable motions turn into.
pub(super) fn motions(rows: &[MotionRow], level: impl Fn(&str) -> f64) -> List {
    Lister::new(rows)
        .texts("forcing", |row| &row.forcing)
        .texts("branch", |row| &row.branch)
        .counts("point", |row| row.point)
        .numbers("omega", |row| row.omega)
        .texts("motion", |row| &row.motion)
        .optional_counts("repeats", |row| row.repeats)
        .texts("onto", |row| row.onto.as_deref().unwrap_or_default())
        .optional_numbers("amplitude_min", |row| row.amplitude.map(|range| range.0))
        .optional_numbers("amplitude_max", |row| row.amplitude.map(|range| range.1))
        .optional_numbers("growth", |row| row.growth)
        .numbers("value", |row| level(&row.forcing))
        .without_text()
        .counts("periods", |row| row.periods)
        .without_text()
        .list("motions")
}

/// The smallest pushes found that end on branches; impulses act at the named dof, N s.
pub(super) fn pushes(rows: &[PushRow], level: impl Fn(&str) -> f64, monitors: &[String]) -> List {
    Lister::new(rows)
        .texts("forcing", |row| &row.forcing)
        .texts("branch", |row| &row.branch)
        .modes("mode", |row| row.mode.saturating_sub(1))
        .numbers("omega", |row| row.omega)
        .texts("monitor", |row| monitors.get(row.monitor).map_or("", String::as_str))
        .counts("motions", |row| row.motions)
        .optional_numbers("largest", |row| row.largest)
        .optional_numbers("impulse", |row| row.impulse)
        .optional_numbers("below", |row| row.below)
        .optional_numbers("velocity", |row| row.velocity)
        .optional_numbers("phase", |row| row.phase)
        .flags("confirmed", |row| row.confirmed)
        .optional_numbers("energy", PushRow::energy)
        .texts("from_rest", |row| row.from_rest.map_or("", Ending::name))
        .numbers("value", |row| level(&row.forcing))
        .without_text()
        .texts("reason", |row| row.reason.as_deref().unwrap_or_default())
        .without_text()
        .list("pushes")
}
