//! What was looked for, and that nothing was found: how much the table may be trusted to be complete.

use super::known::Known;
use crate::overview::{
    BranchRow, Excitation, Level, LookedFor, SmallestMotion, born_above, born_between, levels_after, modes,
    truncation_doubt, why_no_folds,
};
use crate::store::CurveRow;
use protocol::backbone::BackboneMessage;
use protocol::curve::Size;
use solver::response::branch::BranchKind;
use solver::response::orders::orders;
use solver::settings::{Effort, FrequencySettings, Settings};
use solver::structure::Model;

/// What was looked for and what was not; modes that were left out, with the reasons.
pub(super) fn looked_for(known: &Known) -> Vec<String> {
    let (Some(model), Some(settings)) = (&known.model, &known.settings) else { return Vec::new() };
    let (levels, choice) = (known.levels(), known.modes.as_ref());
    let why = why_no_folds(model, settings);
    let looked_for = LookedFor {
        levels,
        backbones: known.backbones.iter().map(|message| (message.mode, last_threshold(message, model))).collect(),
        modes: choice,
        all_modes: model.size(),
        harmonic: model.forcing().harmonic,
        asked: &orders(model, &settings.search),
        curves: known.curves.len(),
        search: known.search,
        why_no_folds: why.as_deref(),
    };
    let is_done = levels.iter().all(|level| level.pending == 0);
    let with_others = choice.filter(|choice| !modes::left_out(choice).is_empty());
    let left_out = with_others.and_then(|choice| modes::sentence(choice, is_done));
    left_out.into_iter().chain([looked_for.sentence()]).collect()
}

/// What the structure does of itself.
pub(super) fn excitation(backbones: &[BackboneMessage], model: &Model) -> Option<String> {
    let decoded = backbones.iter().filter_map(|message| message.backbone(&Size::of(model)).ok());
    let smallest: Vec<SmallestMotion> = decoded.filter_map(|backbone| SmallestMotion::of(&backbone)).collect();
    Excitation::of(model).sentence(&smallest)
}

/// The threshold A* where a backbone ends.
fn last_threshold(message: &BackboneMessage, model: &Model) -> Option<f64> {
    let backbone = message.backbone(&Size::of(model)).ok()?;
    Some(backbone.points.last()?.threshold())
}

/// That no level has an isola, once all of them are complete.
pub(super) fn no_isola(known: &Known) -> Option<String> {
    let (model, settings, levels) = (known.model.as_ref()?, known.settings.as_ref()?, known.levels());
    let has_none = |level: &Level| level.is_complete() && level.highest_isola().is_none();
    if levels.is_empty() || !levels.iter().all(has_none) {
        return None;
    }
    let born = born(levels, &known.curves, known.bounds());
    let only = match settings.search.effort {
        Effort::None => " in windows of the energy balance, where alone they were looked for (search.effort)",
        _ => "",
    };
    let other = other_orders(model, settings).unwrap_or_default();
    let is_undecided =
        |row: &BranchRow| [BranchKind::Cut, BranchKind::Unfinished].iter().any(|kind| row.kind == kind.name());
    let unknown = match levels.iter().flat_map(Level::others).any(is_undecided) {
        true => "; what is cut or unfinished may be one",
        false => "",
    };
    Some(format!("No isola was found{born}{only}{unknown}.{other}"))
}

/// That nobody looked for motions of further periods, and which are the next that are worth it: where all laws are odd the resonances of
/// the free structure have odd harmonics alone, to which a force on an even one supplies nothing.
fn other_orders(model: &Model, settings: &Settings) -> Option<String> {
    let [own] = orders(model, &settings.search)[..] else { return None };
    let next = (own + 1..=settings.harmonics.count.min(own + 2)).filter(|m| m % 2 == 1 || !model.is_odd());
    let next: Vec<String> = next.map(|m| m.to_string()).collect();
    (!next.is_empty()).then(|| {
        format!(
            " Responses of other periods were not looked for: search.harmonics = [{own}, {}] looks for those as well that last {} \
             periods of the force.",
            next.join(", "),
            next.join(" and ")
        )
    })
}

/// What is born between or above levels that have no isola, and how to look at it: what follows "no isola was found".
fn born(levels: &[Level], curves: &[CurveRow], bounds: FrequencySettings) -> String {
    let between = born_between(levels, curves, bounds);
    let above = born_above(levels, curves, bounds);
    let (births, what) = match (&between[..], above) {
        ([], None) => return String::new(),
        ([], Some(birth)) => (vec![birth], "one is born above them".to_string()),
        ([_], _) => (between, "one is born between them".to_string()),
        (several, _) => (several.to_vec(), format!("{} are born between them", several.len())),
    };
    let how = match &levels_after(&births, levels, curves)[..] {
        [] => String::new(),
        [level] => format!(": isola extend RUN --amplitudes {level} computes a level there"),
        list => format!(": isola extend RUN --amplitudes {} computes levels there", list.join(",")),
    };
    format!(" at these levels ({what}{}{how})", truncation_doubt(&births))
}
