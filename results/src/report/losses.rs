//! What a run has lost: why what was found may not be all that its search would have found.

use super::evidence::Evidence;
use crate::curves::{Column, Piece};
use crate::overview::modes::not_started;
use crate::overview::{
    Level, amplitude_bound, cut_mains, damage_sentence, ends_far_beyond, ends_near, named, stopped, undecided_kinds,
    unknown_events, unknown_sentence,
};
use crate::words::{count, in_both_units};
use protocol::to_everyone::Stage;

/// Something that is not known.
pub(super) struct Loss {
    /// In a few words.
    pub brief: String,
    /// In a sentence.
    pub sentence: String,
    /// Whether what is found may be far from all there is: this is said before it.
    pub is_grave: bool,
}

impl Loss {
    fn new(brief: impl Into<String>, sentence: impl Into<String>) -> Self {
        Self { brief: brief.into(), sentence: sentence.into(), is_grave: false }
    }

    fn grave(brief: impl Into<String>, sentence: impl Into<String>) -> Self {
        Self { is_grave: true, ..Self::new(brief, sentence) }
    }
}

/// All that is not known, the gravest first.
pub(super) fn losses(evidence: &Evidence<'_>) -> Vec<Loss> {
    let levels = evidence.levels;
    let mut list = Vec::new();
    list.extend(damage_sentence(evidence.damaged).map(|sentence| Loss::grave("the file is damaged", sentence)));
    match evidence.stage {
        Some(Stage::Cancelled) => list.push(Loss::grave("cancelled", "The run was cancelled.")),
        Some(Stage::Finished) => {}
        _ if evidence.backbone.is_some() && levels.iter().all(|level| level.pending == 0) => {
            let what = "The run is not finished: verifications are still to come, or what follows from its results.";
            list.push(Loss::grave("not finished", what));
        }
        _ => list.push(Loss::grave("not finished", "The run is not finished.")),
    }
    if evidence.backbone.is_none() {
        list.push(Loss::grave("no backbone", "The backbone is not known, nor what its energy balance predicts."));
    }
    if let Some(of) = Of::levels(levels, |level| level.pending) {
        let brief = format!("{} unfinished", count(of.levels, "level"));
        list.push(Loss::grave(brief, format!("{} still to come, at {}.", count(of.sum, "task"), of.named)));
    }
    if let Some(of) = Of::levels(levels, |level| level.dead) {
        let tasks = count(of.sum, "task");
        list.push(Loss::grave(format!("{tasks} given up"), format!("{tasks} given up, at {}.", of.named)));
    }
    if let Some(of) = Of::levels(levels, |level| level.refuted + level.disputed) {
        let results = count(of.sum, "result");
        let sentence = format!("{results} contradicted by other workers, at {}.", of.named);
        list.push(Loss::new(format!("{results} contradicted"), sentence));
    }
    list.extend(without_mains(levels));
    for (why, levels) in unfinished_mains(evidence) {
        let (mains, are) = if levels.len() == 1 { ("main branch", "is") } else { ("main branches", "are") };
        let mains = format!("{mains} at {}", named(&levels));
        let sentence = format!("The {mains} {are} known only in part ({why}): larger responses may lie beyond.");
        list.push(Loss::grave(format!("{mains} unfinished"), sentence));
    }
    let bound = amplitude_bound(
        evidence.levels,
        evidence.mains,
        evidence.curves,
        evidence.max_amplitude,
        |size| evidence.length(size),
        |omega| evidence.frequency(omega),
    );
    list.extend(bound.map(|sentence| Loss::grave("larger responses not followed", sentence)));
    let undecided = undecided_kinds(levels, |size| evidence.length(size));
    list.extend(undecided.into_iter().map(|(brief, sentence)| Loss::grave(brief, sentence)));
    let cut = cut_mains(levels, evidence.given);
    list.extend(cut.map(|(brief, sentence)| Loss::grave(brief, sentence)));
    let highest = levels.iter().map(|level| level.value).fold(f64::NEG_INFINITY, f64::max);
    for backbone in evidence.backbones() {
        let matters = |piece: &&Piece| {
            let last = |column: &Column| column.values.get(piece.points.end - 1).copied().unwrap_or(f64::NAN);
            let share = backbone.modes.first().map_or(f64::NAN, |own| last(&own.share));
            piece.is_unfinished && !ends_far_beyond(last(&backbone.threshold), share, highest)
        };
        let mode = backbone.mode + 1;
        let is_primary = evidence.backbone.is_some_and(|primary| primary.mode == backbone.mode);
        let of = if is_primary { String::new() } else { format!(" of mode {mode}") };
        for piece in backbone.pieces.iter().filter(matters) {
            let (what, status) = (if piece.points.start == 0 { "" } else { "curve beside the " }, &piece.status);
            let sentence = format!(
                "The {what}backbone of mode {mode} stopped early ({status}): the energy balance beyond is not known."
            );
            list.push(Loss::grave(format!("{what}backbone{of} stopped early"), sentence));
        }
    }
    for (mode, reason) in evidence.modes.into_iter().flat_map(not_started) {
        let brief = format!("no backbone of mode {}", mode + 1);
        list.push(Loss::grave(
            brief,
            format!("There is no backbone of mode {}, nor are there windows of it: {reason}.", mode + 1),
        ));
    }
    let values: Vec<f64> = levels.iter().map(|level| level.value).collect();
    let stopped = evidence.curves.iter().filter(|curve| curve.is_unfinished && ends_near(curve, &values)).count();
    if stopped > 0 {
        let curves = count(stopped, "fold curve");
        let sentence = format!("{curves} stopped early: births, merges and isolas beyond are not known.");
        list.push(Loss::grave(format!("{curves} stopped early"), sentence));
    }
    let (among, _) = unknown_events(evidence.curves, levels);
    if !among.is_empty() {
        let brief = format!("{} of unknown kind", count(among.len(), "event"));
        list.push(Loss::new(brief, unknown_sentence(&among, in_both_units)));
    }
    let search = &evidence.search;
    if search.unfollowed > 0 {
        let brief = format!("{} not followed", count(search.unfollowed, "fold"));
        let sentence = format!("{brief} over the forcing: what isolas {} is not known.", led_to(search.unfollowed));
        list.push(Loss::grave(brief, sentence));
    }
    if search.lost > 0 {
        let brief = format!("{} of curves over the forcing led nowhere", count(search.lost, "crossing"));
        let sentence = format!("{brief}: the branches there are missing.");
        list.push(Loss::grave(brief, sentence));
    }
    if search.uncrossed > 0 {
        let brief = format!("nothing found at {}", count(search.uncrossed, "possible branch point"));
        let sentence = format!("{brief}: other branches may cross there, or a law changes its slope.");
        list.push(Loss::new(brief, sentence));
    }
    if search.uncarried > 0 && evidence.stage == Some(Stage::Finished) {
        let brief = format!("{} of open branches not followed over all levels", count(search.uncarried, "response"));
        let sentence = format!("{brief}: where such branches are at other levels is not known.");
        list.push(Loss::grave(brief, sentence));
    }
    if search.left_out > 0 && evidence.stage == Some(Stage::Finished) {
        let folds = count(search.left_out, "fold");
        let sentence = format!(
            "The search ended at its limit (search.effort), {folds} not followed: what isolas {} is not known.",
            led_to(search.left_out)
        );
        list.push(Loss::grave("search ended at its limit", sentence));
    }
    if search.unverified > 0 {
        let brief = format!("{} given up", count(search.unverified, "verification"));
        list.push(Loss::new(brief.clone(), format!("{brief}: whether these branches are stable is not known.")));
    }
    list
}

/// Where main branches do not start, and why.
fn without_mains(levels: &[Level]) -> Vec<Loss> {
    let failed =
        levels.iter().filter_map(|level| Some(((level.main().is_some(), level.main_failure.as_deref()?), level)));
    let loss = |((has_main, reason), levels): ((bool, &str), Vec<&Level>)| {
        let at = named(&levels);
        match has_main {
            false => {
                Loss::grave(format!("no main branch at {at}"), format!("There is no main branch at {at}: {reason}."))
            }
            true => Loss::grave(
                format!("one side without a start at {at}"),
                format!("At {at} no main branch starts at one of the two sides: {reason}."),
            ),
        }
    };
    by_reason(failed).into_iter().map(loss).collect()
}

/// Why main branches are not followed to their ends, with the levels of which that is so.
fn unfinished_mains<'r>(evidence: &Evidence<'r>) -> Vec<(String, Vec<&'r Level>)> {
    let unfinished = evidence.mains.iter().filter(|(_, outcome)| outcome.is_unfinished());
    by_reason(unfinished.filter_map(|(amplitude, outcome)| {
        let level = evidence.levels.iter().find(|level| level.amplitude == *amplitude)?;
        Some((stopped(outcome).unwrap_or_else(|| outcome.to_string()), level))
    }))
}

/// Levels of one reason together, each once: one may have two main branches that end alike.
fn by_reason<'r, R: PartialEq>(all: impl Iterator<Item = (R, &'r Level)>) -> Vec<(R, Vec<&'r Level>)> {
    let mut groups: Vec<(R, Vec<&Level>)> = Vec::new();
    for (reason, level) in all {
        match groups.iter_mut().find(|(other, _)| *other == reason) {
            Some((_, levels)) if levels.iter().any(|other| std::ptr::eq(*other, level)) => {}
            Some((_, levels)) => levels.push(level),
            None => groups.push((reason, vec![level])),
        }
    }
    groups
}

/// What happens beyond the levels, and what it is is not known, in a sentence.
pub(super) fn unknown_beyond(evidence: &Evidence<'_>) -> Option<String> {
    let (_, beyond) = unknown_events(evidence.curves, evidence.levels);
    (!beyond.is_empty()).then(|| format!("Beyond the levels: {}", unknown_sentence(&beyond, in_both_units)))
}

/// Something that levels have.
struct Of {
    sum: usize,
    levels: usize,
    named: String,
}

impl Of {
    /// `None` if no level has it.
    fn levels(levels: &[Level], number: impl Fn(&Level) -> usize) -> Option<Self> {
        let some: Vec<&Level> = levels.iter().filter(|level| number(level) > 0).collect();
        (!some.is_empty()).then(|| Self {
            sum: some.iter().map(|level| number(level)).sum(),
            levels: some.len(),
            named: named(&some),
        })
    }
}

/// Whose isolas: of so many folds.
fn led_to(folds: usize) -> &'static str {
    if folds == 1 { "it leads to" } else { "they lead to" }
}
