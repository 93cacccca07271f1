//! What was not found: isolas, and what the energy balance predicts, as an estimate.

use super::evidence::Evidence;
use super::losses::named;
use crate::overview::{Level, born_between, events_of, forcing_label, is_within, later_birth, overlaps};
use crate::store::CurvePoint;
use crate::words::{count, digits};
use solver::response::critical::CriticalKind;

/// Largest forcing, in highest levels, at which an isola is born just above them.
const JUST_ABOVE: f64 = 1.25;

impl Evidence<'_> {
    /// That there is no isola at the levels, and the first birth between them or else just above them, if fold curves have one.
    pub(super) fn no_isola(&self) -> String {
        let highest = self.levels.iter().map(|level| level.value).fold(0.0, f64::max);
        let births = events_of(self.curves, CriticalKind::Birth.name());
        let is_above = |birth: &&&CurvePoint| {
            (highest..=JUST_ABOVE * highest).contains(&birth.forcing) && is_within(self.frequencies, birth.omega)
        };
        let none = "No isola was found where it was looked for";
        let at = |birth: &CurvePoint| {
            let (forcing, omega) = (forcing_label(birth, 4), digits(birth.omega, 4));
            format!("at A = {forcing} ({omega} rad/s)")
        };
        match &born_between(self.levels, self.curves, self.frequencies)[..] {
            [only] => format!("{none}, but along fold curves one is born between two of the levels, {}.", at(only)),
            [first, .., last] => format!(
                "{none}, but along fold curves isolas are born between levels, the first {}, the last {}.",
                at(first),
                at(last)
            ),
            [] => match births.iter().find(is_above) {
                Some(birth) => {
                    format!("{none}, but along fold curves one is born just above the highest level, {}.", at(birth))
                }
                None => format!("{none}."),
            },
        }
    }

    /// Windows that led to no branch: those where fold curves have an isola born at a larger forcing, birth by birth, those in whose
    /// range something was found otherwise, and the others.
    pub(super) fn not_found(&self) -> Vec<String> {
        let mut births: Vec<(&CurvePoint, Vec<&Level>)> = Vec::new();
        let (mut met, mut others): (Vec<&Level>, Vec<&Level>) = (Vec::new(), Vec::new());
        for level in self.levels {
            for (window, _) in level.not_found() {
                match later_birth(self.curves, level, window) {
                    Some(birth) => match births.iter_mut().find(|(other, _)| std::ptr::eq(*other, birth)) {
                        Some((_, levels)) => levels.push(level),
                        None => births.push((birth, vec![level])),
                    },
                    None if level.others().any(|row| overlaps(row, window)) => met.push(level),
                    None => others.push(level),
                }
            }
        }
        let early = births.into_iter().map(|(birth, levels)| {
            let forcing = forcing_label(birth, 5);
            format!(
                "At {} the energy balance predicts a response in a range of frequencies in which, along fold curves, an isola \
                 is born at A = {forcing} only: none was found there.",
                named(&once(levels))
            )
        });
        let mut sentences: Vec<String> = early.collect();
        for (levels, more) in [(met, ", though branches found otherwise lie in its range of frequencies"), (others, "")]
        {
            if levels.is_empty() {
                continue;
            }
            let responses = count(levels.len(), "response");
            let (whose, more) = if levels.len() == 1 {
                ("its", more.to_string())
            } else {
                ("their", more.replace("its range", "their ranges"))
            };
            sentences.push(format!(
                "{responses} that the energy balance predicts, which is an estimate, not found at {}: none of {whose} seeds led to a \
                 branch near{more}.",
                named(&once(levels))
            ));
        }
        sentences
    }
}

/// Levels by forcing, each once.
fn once(mut levels: Vec<&Level>) -> Vec<&Level> {
    levels.dedup_by(|a, b| a.amplitude == b.amplitude);
    levels
}
