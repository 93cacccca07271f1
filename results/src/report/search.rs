//! What was looked for, what was not, and what the structure does of itself.

use super::evidence::{Evidence, Structure};
use crate::words::count;

impl Evidence<'_> {
    /// What vibrates without being forced, or without being damped.
    pub(super) fn self_excitation(&self) -> Option<String> {
        let Structure { excited, undamped, .. } = &self.structure;
        if !excited.is_empty() {
            let has = if excited.len() == 1 { "has" } else { "have" };
            return Some(format!(
                "{} {has} negative damping: the structure can vibrate by itself, from rest and without forcing.",
                modes(excited)
            ));
        }
        if let Some(backbone) = self.backbone.filter(|backbone| backbone.feeds_itself_from_rest()) {
            return Some(format!(
                "At small amplitudes the nonlinear forces feed more energy into mode {} than its damping takes: the \
                 structure can vibrate by itself, from rest and without forcing.",
                backbone.mode + 1
            ));
        }
        let is = if undamped.len() == 1 { "is" } else { "are" };
        (!undamped.is_empty())
            .then(|| format!("{} {is} not damped: nothing limits the linear resonance.", modes(undamped)))
    }

    /// `mode 1`.
    pub(super) fn mode(&self) -> String {
        self.backbone.map_or_else(|| "a mode".into(), |backbone| format!("mode {}", backbone.mode + 1))
    }

    /// Where isolas were looked for: `the windows of mode 1 at 7 levels (12 seeds tried, 2 led nowhere)`.
    pub(super) fn searched(&self) -> String {
        let levels = self.levels.iter().filter(|level| level.is_complete()).count();
        let tried: usize = self.levels.iter().map(|level| level.seeds.tried).sum();
        let failed: usize = self.levels.iter().map(|level| level.seeds.failed).sum();
        let harmonic = match self.structure.harmonic {
            0 | 1 => String::new(),
            m => format!(", the forcing acting on harmonic {m}"),
        };
        let nowhere = if failed > 0 { format!(", {failed} led nowhere") } else { String::new() };
        let complete = if levels == self.levels.len() { "level" } else { "complete level" };
        let (mode, levels) = (self.mode(), count(levels, complete));
        format!("the windows of {mode} at {levels} ({} tried{nowhere}{harmonic})", count(tried, "seed"))
    }

    /// What was not looked for.
    pub(super) fn not_searched(&self) -> String {
        let modes = if self.structure.modes > 1 { "of other modes, " } else { "" };
        let harmonics =
            if self.structure.harmonic > 1 { "other sub- and super-harmonics" } else { "sub- and super-harmonics" };
        let mode = self.mode();
        format!("isolas {modes}of {harmonics} and those that no energy balance of {mode} leads to were not looked for")
    }

    /// Says so if there are stops and no branch of any level touches one.
    pub(super) fn untouched(&self) -> Option<&'static str> {
        let is_untouched = crate::overview::is_untouched(self.levels);
        (self.structure.stops > 0 && is_untouched).then_some("Nothing touched its stop at any level.")
    }
}

fn modes(list: &[usize]) -> String {
    let numbers: Vec<String> = list.iter().map(ToString::to_string).collect();
    format!("{} {}", if list.len() == 1 { "Mode" } else { "Modes" }, numbers.join(", "))
}
