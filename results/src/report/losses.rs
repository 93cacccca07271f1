//! What a run has lost: why what was found may not be all that its search would have found.

use super::evidence::Evidence;
use crate::overview::Level;
use crate::words::count;
use protocol::to_everyone::Stage;

/// Levels that a sentence names.
const NAMED: usize = 6;

/// Something that is not known.
pub(super) struct Loss {
    /// In a few words.
    pub brief: String,
    /// In a sentence.
    pub sentence: String,
}

impl Loss {
    fn new(brief: impl Into<String>, sentence: impl Into<String>) -> Self {
        Self { brief: brief.into(), sentence: sentence.into() }
    }
}

/// All that is not known, the gravest first.
pub(super) fn losses(evidence: &Evidence<'_>) -> Vec<Loss> {
    let levels = evidence.levels;
    let mut list = Vec::new();
    match evidence.stage {
        Some(Stage::Cancelled) => list.push(Loss::new("cancelled", "The run was cancelled.")),
        Some(Stage::Finished) => {}
        _ => list.push(Loss::new("not finished", "The run is not finished.")),
    }
    if evidence.backbone.is_none() {
        list.push(Loss::new("no backbone", "The backbone is not known, nor what its energy balance predicts."));
    }
    if let Some(of) = Of::levels(levels, |level| level.pending) {
        let brief = format!("{} unfinished", count(of.levels, "level"));
        list.push(Loss::new(brief, format!("{} still to come, at {}.", count(of.sum, "task"), of.named)));
    }
    if let Some(of) = Of::levels(levels, |level| level.dead) {
        let tasks = count(of.sum, "task");
        list.push(Loss::new(format!("{tasks} given up"), format!("{tasks} given up, at {}.", of.named)));
    }
    for level in levels.iter().filter(|level| level.main().is_none() && level.main_failure.is_some()) {
        let reason = level.main_failure.as_deref().unwrap_or_default();
        let what = format!("no main branch at A = {}", level.amplitude);
        list.push(Loss::new(what, format!("There is no main branch at A = {}: {reason}.", level.amplitude)));
    }
    for (amplitude, outcome) in evidence.mains.iter().filter(|(_, outcome)| outcome.is_unfinished()) {
        let main = format!("main branch at A = {amplitude}");
        let sentence = format!("The {main} is known only in part ({outcome}): larger responses may lie beyond.");
        list.push(Loss::new(format!("{main} unfinished"), sentence));
    }
    if let Some(backbone) = evidence.backbone.filter(|backbone| backbone.is_unfinished) {
        let (mode, status) = (backbone.mode + 1, &backbone.status);
        let sentence = format!("The backbone of mode {mode} stopped early ({status}): nothing was looked for beyond.");
        list.push(Loss::new("backbone stopped early", sentence));
    }
    if let Some(of) = Of::levels(levels, |level| level.not_found().count()) {
        let windows = count(of.sum, "predicted response");
        list.push(Loss::new(format!("{windows} not found"), format!("{windows} not found, at {}.", of.named)));
    }
    list
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

/// `A = 1, 2 and 3 more`.
pub(super) fn named(levels: &[&Level]) -> String {
    let list: Vec<&str> = levels.iter().take(NAMED).map(|level| level.amplitude.as_str()).collect();
    let more = levels.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("A = {}{more}", list.join(", "))
}
