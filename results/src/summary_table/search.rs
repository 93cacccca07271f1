//! What was looked for, and that nothing was found: how much the table may be trusted to be complete.

use super::known::Known;
use super::units::{FrequencyUnit, Units};
use crate::overview::{
    Bounds, BranchRow, Excitation, Level, LookedFor, Predicted, Unforced, between_levels, born_above, born_below,
    born_between, has_joints, level_between, levels_after, overlooked, parted_between, told_threshold,
    truncation_doubt, undecided, why_no_folds,
};
use crate::store::{CurvePoint, CurveRow};
use crate::words::{digits, listed, more_ranges};
use solver::response::backbone::Backbone;
use solver::response::branch::BranchKind;
use solver::response::forced::SearchRange;
use solver::response::orders::orders;
use solver::settings::{Effort, FrequencySettings, Settings};

/// Digits of the forcing amplitude of a birth that levels miss.
const BIRTH_DIGITS: i32 = 4;

/// Windows between levels that are named.
const NAMED: usize = 3;

/// What was looked for, in short.
pub(super) fn looked_for(known: &Known) -> Option<String> {
    let (model, settings) = (known.model.as_ref()?, known.settings.as_ref()?);
    let why = why_no_folds(model, settings);
    let end = |(mode, backbone): &(usize, Option<Backbone>)| (*mode, backbone.as_ref().and_then(Backbone::end));
    let is_crowded = |(_, backbone): &&(usize, Option<Backbone>)| backbone.as_ref().is_some_and(Backbone::is_crowded);
    let highest = known.levels().iter().map(|level| level.value).fold(0.0, f64::max);
    let is_short = |(_, backbone): &&(usize, Option<Backbone>)| {
        backbone.as_ref().is_some_and(|backbone| backbone.falls_short(model, settings, highest))
    };
    let looked_for = LookedFor {
        levels: known.levels(),
        backbones: known.backbones.iter().map(end).collect(),
        short: known.backbones.iter().filter(is_short).map(|(mode, _)| *mode).collect(),
        crowded: known.backbones.iter().filter(is_crowded).map(|(mode, _)| *mode).collect(),
        modes: known.modes.as_ref(),
        all_modes: model.size(),
        harmonic: model.forcing().harmonic,
        asked: &orders(model, &settings.search),
        curves: known.curves.len(),
        search: known.search,
        why_no_folds: why.as_deref(),
        has_joints: has_joints(model),
    };
    let has_isola = known.levels().iter().any(|level| level.highest_isola().is_some());
    let next = other_orders(looked_for.asked, settings.harmonics.count).filter(|_| !has_isola);
    Some(looked_for.brief(next))
}

/// What the structure does of itself.
pub(super) fn excitation(known: &Known, units: Units) -> Option<String> {
    let decoded = known.backbones.iter().filter_map(|(_, backbone)| backbone.as_ref());
    let unforced: Vec<Unforced> = decoded.filter_map(Unforced::of).collect();
    let length = |x| format!("{} {}", units.length.digits(x), units.length);
    let excitation = Excitation::of(known.model.as_ref()?);
    // It is the structure's, whatever the order.
    excitation.sentence(&unforced, length, |omega| units.frequency.told(omega)).filter(|_| !known.is_further)
}

/// That no level has an isola, once all of them are complete.
pub(super) fn no_isola(known: &Known, units: Units) -> Option<String> {
    let (settings, levels) = (known.settings.as_ref()?, known.levels());
    let has_none = |level: &Level| level.is_complete() && level.highest_isola().is_none();
    if levels.is_empty() || !levels.iter().all(has_none) {
        return None;
    }
    let backbones: Vec<&Backbone> = known.backbones.iter().filter_map(|(_, backbone)| backbone.as_ref()).collect();
    if let Some(there) = overlooked_isola(known, units) {
        return Some(format!("No isola was found{}, though along fold curves {there}.", undecided(levels)));
    }
    let elsewhere = match born(levels, &known.curves, known.bounds()) {
        // What was computed tells more than an estimate.
        born if born.is_empty() => match parted(levels, &known.curves) {
            parted if parted.is_empty() => {
                predicted(&between_levels(&backbones, levels, known.bounds()), levels, units.frequency)
            }
            parted => parted,
        },
        born => born,
    };
    let only = only_windows(settings);
    Some(format!("No isola was found{only}{elsewhere}{}.", undecided(levels)))
}

/// An isola that fold curves have at levels at which none was found.
pub(super) fn overlooked_isola(known: &Known, units: Units) -> Option<String> {
    let amplitude = known.settings.as_ref().and_then(|settings| settings.branch.max_amplitude);
    let bounds = Bounds { frequency: known.bounds(), amplitude };
    let length = |size| format!("{} {}", units.length.digits(size), units.length);
    overlooked(&known.curves, known.levels(), bounds, |omega| units.frequency.told(omega), length)
}

/// That isolas were looked for in windows alone, if so: what follows where they are.
pub(super) fn only_windows(settings: &Settings) -> &'static str {
    match settings.search.effort {
        Effort::None => " in windows of the energy balance, where alone they were looked for (search.effort)",
        _ => "",
    }
}

/// How motions of further periods, for which nobody looked, are looked for, and which are the next.
fn other_orders(asked: &[usize], harmonics: usize) -> Option<String> {
    let [own] = *asked else { return None };
    let orders = 1..=harmonics.min(3.max(own + 1));
    let others: Vec<usize> = orders.clone().filter(|order| *order != own).collect();
    let all: Vec<String> = orders.map(|order| order.to_string()).collect();
    let periods: Vec<String> = others.iter().map(usize::to_string).collect();
    let unit = if others == [1] { "period" } else { "periods" };
    (!others.is_empty()).then(|| {
        format!(
            "search.harmonics = [{}] looks for those that last {} {unit} of the force as well",
            all.join(", "),
            listed(&periods)
        )
    })
}

/// What is born between levels that have no isola, or else below or above them, and how to look at it: what follows "no isola was found".
fn born(levels: &[Level], curves: &[CurveRow], bounds: FrequencySettings) -> String {
    let between = born_between(levels, curves, bounds);
    let (below, above) = (born_below(levels, curves, bounds), born_above(levels, curves, bounds));
    let several = |births: &[&CurvePoint], where_: &str| match births.len() {
        1 => format!("one is born {where_} them, at A = {}", digits(births[0].forcing, BIRTH_DIGITS)),
        count => format!("{count} are born {where_} them"),
    };
    let (births, what) = match (&between[..], &below[..], above) {
        ([], [], None) => return String::new(),
        ([], [], Some(birth)) => (vec![birth], several(&[birth], "above")),
        ([], births, None) => (below.clone(), several(births, "below")),
        ([], births, Some(birth)) => {
            let what = format!("{}, {}", several(births, "below"), several(&[birth], "above"));
            (below.iter().copied().chain([birth]).collect(), what)
        }
        (births, ..) => (between.clone(), several(births, "between")),
    };
    let (cut, open): (Vec<&CurvePoint>, Vec<&CurvePoint>) =
        births.iter().partition(|birth| is_cut_above(levels, birth));
    let how = match &levels_after(&open, levels, curves)[..] {
        [] if !cut.is_empty() => ": what is cut off by a bound may be it, which wider bounds show".into(),
        [] => String::new(),
        [level] => format!(": isola extend RUN --amplitudes {level} computes a level there"),
        list => format!(": isola extend RUN --amplitudes {} computes levels there", list.join(",")),
    };
    format!(" at {} ({what}{}{how})", these(levels), truncation_doubt(&births))
}

/// Isolas that are there between levels alone and begin where branches part, and how to look at them: what follows "no isola was found".
fn parted(levels: &[Level], curves: &[CurveRow]) -> String {
    let lives = parted_between(curves, levels);
    let Some(first) = lives.first() else { return String::new() };
    let [from, to] = [first.from.forcing, first.to.forcing];
    let more = if lives.len() > 1 { format!(", and {} more elsewhere", lives.len() - 1) } else { String::new() };
    let level = level_between(from, to)
        .map_or_else(String::new, |level| format!(": isola extend RUN --amplitudes {level} computes a level there"));
    format!(
        " at {} (along fold curves one is there from A = {} to {}{more}{}{level})",
        these(levels),
        digits(from, BIRTH_DIGITS),
        digits(to, BIRTH_DIGITS),
        truncation_doubt(&[first.from, first.to])
    )
}

/// What is predicted where there is no level, and how to look at it: what follows "no isola was found".
fn predicted(windows: &[Predicted], levels: &[Level], unit: FrequencyUnit) -> String {
    let place = |window: &Predicted| {
        let told = |threshold| told_threshold(threshold, levels.iter().map(|level| level.value));
        let to = if window.to.is_finite() { format!("to {}", told(window.to)) } else { "on".into() };
        let near = format!("near {} {unit}", unit.digits(window.omega));
        format!("from A = {} {to} ({near})", told(window.from))
    };
    let level = |window: &Predicted| {
        let others = levels.iter().map(|level| level.value).chain([window.to, SearchRange::BEYOND * window.from]);
        level_between(window.from, others.filter(|other| *other > window.from).fold(f64::INFINITY, f64::min))
    };
    let mut named: Vec<String> = windows.iter().take(NAMED).filter_map(level).collect();
    named.dedup();
    let mut places: Vec<String> = windows.iter().take(NAMED).map(place).collect();
    let more = windows.len().saturating_sub(NAMED);
    places.extend(more_ranges(more));
    match named.len() {
        0 => String::new(),
        count => format!(
            " at {} (the energy balance, an estimate, predicts further responses {}: isola extend RUN --amplitudes {} computes \
             {})",
            these(levels),
            listed(&places),
            named.join(","),
            if count == 1 { "a level there" } else { "levels there" }
        ),
    }
}

/// All levels, in words.
fn these(levels: &[Level]) -> &'static str {
    if levels.len() == 1 { "this level" } else { "these levels" }
}

/// Whether at the level next above a birth a branch that a bound cuts off is at its frequency.
fn is_cut_above(levels: &[Level], birth: &CurvePoint) -> bool {
    let above = levels.iter().filter(|level| level.value > birth.forcing);
    let next = above.min_by(|a, b| a.value.total_cmp(&b.value));
    let is_at = |row: &BranchRow| {
        row.kind == BranchKind::Cut.name() && row.omega.0 <= birth.omega && birth.omega <= row.omega.1
    };
    next.is_some_and(|level| level.others().any(is_at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_bound_cuts_off_is_not_found_at_other_levels() {
        let birth = CurvePoint { forcing: 1.0, omega: 2.0, event: Some("birth".into()), ..CurvePoint::default() };
        let curves = [CurveRow { points: vec![birth], ..CurveRow::default() }];
        let told = |kind: &str, omega| {
            let row = BranchRow { kind: kind.into(), omega, ..BranchRow::default() };
            let level = Level { amplitude: "2".into(), value: 2.0, branches: vec![row], ..Level::default() };
            born(&[level], &curves, FrequencySettings::default())
        };
        assert!(told("cut", (1.5, 2.5)).ends_with("(one is born below them, at A = 1, not confirmed with twice the harmonics: what is cut off by a bound may be it, which wider bounds show)"), "{}", told("cut", (1.5, 2.5)));
        for other in [told("cut", (2.5, 3.0)), told("branched", (1.5, 2.5))] {
            assert!(other.contains(": isola extend RUN --amplitudes "), "{other}");
        }
    }

    #[test]
    fn what_parts_between_levels_is_told() {
        let point = |(forcing, event): (f64, &str)| CurvePoint {
            forcing,
            omega: 1.0 + forcing,
            event: (!event.is_empty()).then(|| event.into()),
            ..CurvePoint::default()
        };
        let points = [(9.0, ""), (1.0, "merge"), (2.0, "death"), (0.5, "")].map(point).to_vec();
        let curves = [CurveRow { points, ..CurveRow::default() }];
        let told = |values: &[f64]| {
            let level = |value: &f64| Level { amplitude: value.to_string(), value: *value, ..Level::default() };
            parted(&values.iter().map(level).collect::<Vec<_>>(), &curves)
        };
        assert_eq!(
            told(&[0.7, 3.0]),
            " at these levels (along fold curves one is there from A = 1 to 2, not confirmed with twice the harmonics: isola extend RUN \
             --amplitudes 1.5 computes a level there)"
        );
        assert_eq!(told(&[0.7, 1.5]), "");
    }

    #[test]
    fn what_is_predicted_where_there_is_no_level() {
        let told = |windows: &[Predicted], levels: &[f64]| {
            let level = |value: &f64| Level { value: *value, ..Level::default() };
            predicted(windows, &levels.iter().map(level).collect::<Vec<_>>(), FrequencyUnit::default())
        };
        let window = Predicted { from: 2.0, to: 3.0, omega: 5.0 };
        assert_eq!(
            told(&[window], &[1.0]),
            " at this level (the energy balance, an estimate, predicts further responses from A = 2 to 3 (near 5.00000 rad/s): \
             isola extend RUN --amplitudes 2.5 computes a level there)"
        );
        let last = Predicted { from: 7.0, to: f64::INFINITY, omega: 6.0 };
        let both = told(&[window, last], &[1.0, 4.0]);
        assert!(
            both.contains(
                " and from A = 7 on (near 6.00000 rad/s): isola extend RUN --amplitudes 2.5,10 computes levels"
            ),
            "{both}"
        );
        assert_eq!(told(&[], &[1.0]), "");
    }

    #[test]
    fn orders_that_were_not_looked_for() {
        for (asked, harmonics, expected) in [
            (&[1][..], 10, Some("[1, 2, 3] looks for those that last 2 and 3 periods")),
            (&[2], 10, Some("[1, 2, 3] looks for those that last 1 and 3 periods")),
            (&[3], 10, Some("[1, 2, 3, 4] looks for those that last 1, 2 and 4 periods")),
            (&[1], 2, Some("[1, 2] looks for those that last 2 periods")),
            (&[1], 1, None),
            (&[1, 3], 10, None),
        ] {
            let told = other_orders(asked, harmonics);
            assert_eq!(told.is_some(), expected.is_some(), "{told:?}");
            assert!(told.unwrap_or_default().contains(expected.unwrap_or_default()), "{asked:?}");
        }
    }
}
