//! Three sentences that the store supports: where it is dangerous, from which forcing on, and what ordinary continuation
//! would have missed.

use super::backbone::BackboneCurve;
use super::words::{count, digits, frequency, length, range};
use crate::survey::{BranchRow, Level};
use serde::Serialize;
use solver::windows::{Event, EventKind};

/// One of the sentences.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Sentence {
    /// The question it answers.
    pub title: &'static str,
    /// The answer.
    pub text: String,
}

/// What the sentences are about.
pub struct Evidence<'r> {
    /// Levels by forcing amplitude.
    pub levels: &'r [Level],
    /// The backbone, if it is known.
    pub backbone: Option<&'r BackboneCurve>,
    /// The dof whose amplitudes are given.
    pub monitor: &'r str,
    /// Its clearance to the casing, m.
    pub gap: Option<f64>,
}

/// The three sentences.
pub fn verdict(evidence: &Evidence<'_>) -> [Sentence; 3] {
    [
        Sentence { title: "Where is it dangerous?", text: evidence.danger() },
        Sentence { title: "From which forcing on?", text: evidence.onset() },
        Sentence { title: "Would ordinary continuation have missed it?", text: evidence.missed() },
    ]
}

/// A level with its highest isola and its main branch.
struct Gain<'r> {
    level: &'r Level,
    isola: &'r BranchRow,
    main: &'r BranchRow,
}

impl Gain<'_> {
    fn ratio(&self) -> f64 {
        self.isola.amplitude_max / self.main.amplitude_max
    }
}

impl<'r> Evidence<'r> {
    fn with_isolas(&self) -> impl DoubleEndedIterator<Item = &'r Level> + Clone {
        self.levels.iter().filter(|level| level.isolas().next().is_some())
    }

    fn is_empty(&self) -> bool {
        self.levels.iter().all(|level| level.is_bare())
    }

    /// The highest point over all branches of all levels.
    fn largest(&self) -> Option<(&'r Level, &'r BranchRow)> {
        let peaks = self.levels.iter().filter_map(|level| Some((level, level.peak()?)));
        peaks.max_by(|a, b| a.1.amplitude_max.total_cmp(&b.1.amplitude_max))
    }

    fn danger(&self) -> String {
        let Some((level, largest)) = self.largest() else { return "No branch has been computed yet.".into() };
        let casing = self.gap.map(|gap| format!(" ({} to the casing)", length(gap))).unwrap_or_default();
        let size = |row: &BranchRow| format!("{} at {}", length(row.amplitude_max), self.monitor);
        let place = format!("at {} and A = {}", frequency(largest.omega_at_max), level.amplitude);
        let overall = format!("the largest response of all, {}{casing}, is on the main branch, {place}", size(largest));
        let isolas = self.with_isolas().flat_map(Level::isolas);
        let Some(highest) = isolas.clone().max_by(|a, b| a.amplitude_max.total_cmp(&b.amplitude_max)) else {
            return format!("No isola was found{}; {overall}.", self.reservation());
        };
        let bounds = isolas.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), isola| {
            (low.min(isola.omega.0), high.max(isola.omega.1))
        });
        let there = format!(
            "Between {}: there an impact or a gust can throw the structure onto an isolated branch (isola)",
            range(bounds)
        );
        if largest.kind == "main" {
            format!("{there} with up to {}; {overall}.", size(highest))
        } else {
            format!("{there} with up to {}{casing}, the largest response of all, {place}.", size(largest))
        }
    }

    fn onset(&self) -> String {
        if self.is_empty() {
            return format!("Nothing is known yet: {} to come.", count(self.levels.len(), "forcing level"));
        }
        let (first, last) = (&self.levels[0].amplitude, &self.levels[self.levels.len() - 1].amplitude);
        let computed = match self.levels.len() {
            1 => format!("the level computed, A = {first}"),
            n => format!("the {n} levels computed, A = {first} to {last}"),
        };
        let mut levels = self.with_isolas();
        let prediction = self.prediction();
        let Some(lowest) = levels.next() else {
            return format!("There is no isola at {computed}{}{prediction}.", self.reservation());
        };
        let highest = levels.next_back().unwrap_or(lowest);
        let above = self.levels.iter().find(|level| level.value > highest.value && level.main().is_some());
        let end = above.map(|level| {
            format!(
                " At A = {} none is left: the main branch itself goes up to {} at {} there.",
                level.amplitude,
                level.main().map(|main| length(main.amplitude_max)).unwrap_or_default(),
                level.main().map(|main| frequency(main.omega_at_max)).unwrap_or_default()
            )
        });
        let range = if lowest.value == highest.value {
            format!("Isolas were found at A = {} alone", lowest.amplitude)
        } else {
            format!("Isolas were found from A = {} to A = {}", lowest.amplitude, highest.amplitude)
        };
        format!("{range}, of {computed}{}{prediction}.{}", self.reservation(), end.unwrap_or_default())
    }

    /// From where on the energy balance alone says that there is more than the main response. A window that is born and
    /// merges between two levels is no news.
    fn prediction(&self) -> String {
        let Some(backbone) = self.backbone else { return String::new() };
        let (threshold, omega) = (&backbone.threshold.values, &backbone.omega.values);
        let births = backbone.events.iter().filter(|event| event.kind == EventKind::Birth);
        let is_separate = |birth: &&Event| {
            let barrier = threshold[..birth.index].iter().copied().fold(0.0, f64::max);
            self.levels.iter().any(|level| (birth.threshold..barrier).contains(&level.value))
        };
        match births.filter(is_separate).min_by(|a, b| a.threshold.total_cmp(&b.threshold)) {
            Some(birth) => format!(
                "; the energy balance predicts separate responses from A = {} on, near {}",
                digits(birth.threshold, 3),
                frequency(omega[birth.index])
            ),
            None => "; the energy balance predicts no separate response at any of them".into(),
        }
    }

    fn missed(&self) -> String {
        if self.is_empty() {
            return "Nothing is known yet.".into();
        }
        let gains = self
            .with_isolas()
            .filter_map(|level| Some(Gain { level, isola: level.highest_isola()?, main: level.main()? }));
        let Some(gain) = gains.max_by(|a, b| a.ratio().total_cmp(&b.ratio())) else {
            if self.with_isolas().next().is_some() {
                return "Ordinary continuation has no main branch to compare the isolas with: see the account.".into();
            }
            return format!("No: nothing was found beside the main branch{}.", self.reservation());
        };
        let Gain { level, isola, main } = &gain;
        let comparison = match gain.ratio() {
            ratio if ratio >= 2.0 => format!("{} times what ordinary continuation sees", digits(ratio, 2)),
            ratio if ratio >= 1.0 => format!("{:.0} % more than ordinary continuation sees", (ratio - 1.0) * 100.0),
            ratio => format!("{:.0} % less than the peak of the main branch", (1.0 - ratio) * 100.0),
        };
        format!(
            "Yes. At A = {} it stops at {} at {}, but an isola goes up to {} at {}, {comparison}.",
            level.amplitude,
            length(main.amplitude_max),
            frequency(main.omega_at_max),
            length(isola.amplitude_max),
            frequency(isola.omega_at_max),
        )
    }

    /// What may be missing from a sentence.
    fn reservation(&self) -> String {
        let pending: usize = self.levels.iter().map(|level| level.pending).sum();
        let dead: usize = self.levels.iter().map(|level| level.dead).sum();
        let not_found: usize = self.levels.iter().map(|level| level.not_found().count()).sum();
        let mut parts = Vec::new();
        if pending > 0 {
            parts.push(format!("{} still to come", count(pending, "task")));
        }
        if dead > 0 {
            parts.push(format!("{} given up", count(dead, "task")));
        }
        if not_found > 0 {
            parts.push(format!("{} predicted but not found", count(not_found, "response")));
        }
        if parts.is_empty() { String::new() } else { format!(" ({})", parts.join(", ")) }
    }
}
