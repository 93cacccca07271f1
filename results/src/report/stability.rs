//! What time marching says of isolas and of the largest response.

use super::evidence::Evidence;
use crate::overview::{
    BranchRow, Level, StabilityOf, StableResponse, largest_stable, largest_stable_sentence, near_largest, stability_of,
    unstable_peak_sentence,
};
use crate::store::least_energy;
use crate::summary_table::{motions, pushes};
use solver::response::branch::BranchKind;

/// Whether all of an isola was looked at, and none of it found stable: nothing that is thrown onto it stays there.
fn has_no_stable_part(isola: &BranchRow) -> bool {
    isola.stability.as_ref().is_some_and(|known| known.is_whole && known.stable == 0.0)
}

/// Relative difference of amplitudes from which it is told.
const TOLD: f64 = 0.005;

impl Evidence<'_> {
    /// Whether isolas can be settled on, of one of them and all of them, and what leads there.
    pub(super) fn stability_of_isolas(&self) -> Vec<String> {
        let isolas: Vec<(&str, &BranchRow)> = self
            .levels
            .iter()
            .flat_map(|level| level.isolas().map(move |row| (level.amplitude.as_str(), row)))
            .collect();
        let Some(StabilityOf { told, stable, known }) = stability_of(&isolas, ["isola", "isolas"], "") else {
            return vec!["Whether isolas are stable and what leads there was not verified.".into()];
        };
        let settling = match (stable, known) {
            (0, 0) => String::new(),
            (0, _) => "; nothing was seen to settle there".into(),
            _ => format!(": there the structure can settle{}", self.up_to()),
        };
        let found = format!("By time marching, {told}{settling}");
        match self.what_leads_there() {
            None if isolas.iter().all(|(_, isola)| has_no_stable_part(isola)) => {
                vec![format!(
                    "{found}; isola disturb pushes onto what is known to be stable of isolas, and there is none."
                )]
            }
            None => vec![format!("{found}; what leads there was not looked for (isola disturb does).")],
            Some(push) => {
                let from_rest = pushes::switched_on(self.pushes, self.units);
                [Some(format!("{found}.")), Some(push), from_rest].into_iter().flatten().collect()
            }
        }
    }

    /// Of an isola whose largest response is unstable, on which nothing stays: how far what is stable of it goes, in brackets.
    pub(super) fn stable_part(&self, isola: &BranchRow) -> String {
        let Some(known) = &isola.stability else { return String::new() };
        if known.peak.as_ref().is_none_or(|peak| peak.verdict != "unstable") {
            return String::new();
        }
        match known.largest {
            Some((omega, size))
                if size > (1.0 - TOLD) * isola.amplitude_max && (omega / isola.omega_at_max - 1.0).abs() < TOLD =>
            {
                format!(" (unstable there; found stable beside it, at {})", self.frequency(omega))
            }
            Some((omega, size)) => {
                format!(" (unstable there; found stable up to {} at {})", self.length(size), self.frequency(omega))
            }
            None if known.stable > 0.0 => " (unstable there)".into(),
            None => " (unstable there, and that isola was found stable nowhere)".into(),
        }
    }

    /// The largest response of isolas that was found stable, as an addition to what is said of where the structure can settle.
    fn up_to(&self) -> String {
        let largest = largest_stable(self.levels, BranchRow::is_isola);
        largest.map_or_else(String::new, |StableResponse { level, branch, omega, amplitude }| {
            let (size, at) = (self.length(amplitude), self.frequency(omega));
            match self.levels.iter().flat_map(Level::isolas).count() {
                1 => format!(", found stable up to {size} at {at}"),
                _ => format!(
                    ", on isolas found stable up to {size} ({} at A = {}) at {at}",
                    branch.name(),
                    level.amplitude
                ),
            }
        })
    }

    /// The push of least energy that leads to an isola, if pushes were marched: which isola that is, and at which frequency.
    fn what_leads_there(&self) -> Option<String> {
        let Some(push) = least_energy(self.pushes) else {
            let mut untried: Vec<&str> = self.pushes.iter().filter_map(|push| push.reason.as_deref()).collect();
            untried.sort_unstable();
            untried.dedup();
            let is_any_tried = self.pushes.iter().any(|push| push.reason.is_none());
            return match is_any_tried {
                true => Some("No push that leads to an isola was found among those tried; others may.".into()),
                false if untried.is_empty() => None,
                false => Some(format!("No push onto an isola was tried: {}.", untried.join("; "))),
            };
        };
        Some(format!(
            "Of the pushes looked for, one frequency an isola, the one found with least energy to lead to an \
             isola leads to {} of A = {} at {}: {}.",
            push.branch,
            push.forcing,
            self.frequency(push.omega),
            pushes::strength(push, &self.structure.monitors)
        ))
    }

    /// What unstable motions of main branches turn into where that is larger than anything on these, at the level where it is most so:
    /// ordinary continuation does not tell how far the structure swings there.
    pub(super) fn outgrown(&self) -> Option<String> {
        let larger = self.motions.iter().filter_map(|motion| {
            let is_main = motion.branch.split(' ').next() == Some(BranchKind::Main.name());
            let level = self.levels.iter().find(|level| is_main && level.amplitude == motion.forcing)?;
            let ratio = motion.amplitude?.1 / level.main()?.amplitude_max;
            (ratio > 1.0 + TOLD).then_some((motion, ratio))
        });
        let (motion, ratio) = larger.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(format!(
            "Unstable motions of main branches turn into larger ones: by time marching, at A = {} into {} of up to {} at {}, {:.0} % more \
             than the main branch has.",
            motion.forcing,
            motions::kind(motion, self.is_further),
            self.length(motion.amplitude?.1),
            self.frequency(motion.omega),
            100.0 * (ratio - 1.0)
        ))
    }

    /// The largest response that was found stable, where that is not told by what is said of isolas and of the largest response.
    pub(super) fn largest_stable(&self) -> Option<String> {
        largest_stable_sentence(self.levels, |x| self.length(x), |omega| self.frequency(omega))
    }

    /// What lasts where the largest response does not.
    pub(super) fn unstable_peak(&self) -> Option<String> {
        unstable_peak_sentence(self.levels, !self.motions.is_empty())
    }

    /// What is known of the stability of the largest response.
    pub(super) fn stability_of_peak(&self, largest: &BranchRow) -> String {
        let peak = largest.stability.as_ref().and_then(|stability| stability.peak.as_ref());
        let unknown = || "Whether the largest response is stable was not verified.".into();
        peak.map_or_else(unknown, |peak| {
            near_largest(peak, largest.amplitude_max, |x| self.length(x), |omega| self.frequency(omega))
        })
    }
}
