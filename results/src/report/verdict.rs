//! Three answers that the store supports: where it is dangerous, from which forcing on, and what ordinary continuation
//! would have missed. A run that is not done, stalled or has not converged says so before each, then what was found, then what else is lost;
//! in the first answer one by one; what was and what was not looked for stands once, there.

#[cfg(test)]
mod tests;

use super::evidence::{Evidence, OrderFound};
use super::folded::folded_sentence;
use super::losses::{losses, unknown_beyond};
use super::predictions::{NOTHING, WINDOWS_ALONE};
use super::ranges::{in_words, joined, over, runs};
use super::sentence::Sentence;
use crate::curves::Touch;
use crate::overview::{
    BranchRow, Doubts, Events, Level, UNTOUCHED, Unforced, around_largest, asks_for_harmonics, beyond, events, highest,
    is_untouched, modes, named, not_followed_sentence, of_kind, passed_over_sentence, reach_sentence, sampled,
    shift_sentence, truncation, turned_sliding,
};
use crate::summary_table::{motions, stability};
use crate::told::length_in;
use crate::words::{self, count};
use protocol::to_everyone::Stage;
use solver::response::branch::BranchKind;

/// A main branch whose peak lies within this factor of the frequencies of isolas may be what they have become part of.
const ABOUT: f64 = 1.25;

/// The three answers.
pub fn verdict(evidence: &Evidence<'_>) -> [Sentence; 3] {
    let losses = losses(evidence);
    let is_grave = losses.iter().any(|loss| loss.is_grave);
    let mut briefly: Vec<&str> = losses.iter().map(|loss| loss.brief.as_str()).collect();
    briefly.dedup();
    let sentences: Vec<String> = losses.iter().map(|loss| words::capitalised(&loss.sentence)).collect();
    let is_any = !losses.is_empty();
    let whole = is_any.then(|| format!("Not all is known. {}", sentences.join(" ")));
    let brief = is_any.then(|| format!("Not all is known ({}).", briefly.join("; ")));
    let first = evidence.not_converged();
    let others = first.as_ref().map(|_| NOT_CONVERGED.to_string());
    let lead = |lost: &Option<String>, truncated: Option<String>| {
        let lost = lost.iter().filter(|_| is_grave).cloned();
        let all: Vec<String> = match evidence.stage {
            // What is not converged may be all wrong; what is not done, or damaged, is worse.
            Some(Stage::Finished) if evidence.damaged == 0 => truncated.into_iter().chain(lost).collect(),
            _ => lost.chain(truncated).collect(),
        };
        (!all.is_empty()).then(|| all.join(" "))
    };
    let lost = |lost: &Option<String>| lost.clone().filter(|_| !is_grave);
    let is_known = evidence.largest().is_some() || evidence.has_nothing();
    let events = evidence.events();
    let further = |details: Vec<String>| if is_known { details } else { Vec::new() };
    [
        Sentence {
            title: "Where is it dangerous?",
            lead: lead(&whole, first),
            text: evidence.danger(),
            lost: lost(&whole),
            details: further(evidence.details()),
            reach: is_known.then(|| evidence.reach()),
        },
        Sentence {
            title: "From which forcing on?",
            lead: lead(&brief, others.clone()),
            text: evidence.onset(events.as_ref()),
            lost: lost(&brief),
            details: further(evidence.over_the_forcing(events.as_ref())),
            reach: None,
        },
        Sentence {
            title: "Would ordinary continuation have missed it?",
            lead: lead(&brief, others),
            text: evidence.missed(),
            lost: lost(&brief),
            details: further(evidence.beside_ordinary_continuation()),
            reach: None,
        },
    ]
}

impl<'r> Evidence<'r> {
    /// `2 mm`, or `at least 2 mm`.
    pub(super) fn size(&self, row: &BranchRow) -> String {
        let [before, behind] = around_largest(row);
        format!("{before}{}{behind}", self.length(row.amplitude_max))
    }

    /// A length, m, in the unit that was chosen, else in that of the largest response.
    pub(super) fn length(&self, metres: f64) -> String {
        let largest = self.largest().map_or(metres, |(_, largest)| largest.amplitude_max);
        match self.length_unit {
            Some(_) => length_in(metres, self.length_unit),
            None => words::length_among(metres, largest),
        }
    }

    pub(super) fn with_isolas(&self) -> impl DoubleEndedIterator<Item = &'r Level> + Clone {
        self.levels.iter().filter(|level| level.highest_isola().is_some())
    }

    pub(super) fn is_empty(&self) -> bool {
        self.levels.iter().all(|level| level.peak().is_none())
    }

    /// Whether nothing is left to be done.
    pub(super) fn is_over(&self) -> bool {
        self.stage == Some(Stage::Finished) && self.levels.iter().all(|level| level.pending == 0)
    }

    /// Whether there is one isola in all.
    pub(super) fn is_one_isola(&self) -> bool {
        self.levels.iter().flat_map(Level::isolas).count() == 1
    }

    /// Whether isolas were looked for in windows alone.
    pub(super) fn is_of_windows_alone(&self) -> bool {
        self.stage == Some(Stage::Finished)
            && self.curves.is_empty()
            && self.search.starts + self.search.homotopies == 0
            && self.levels.iter().any(|level| !level.windows.is_empty())
    }

    /// How it is said that there is no isola.
    pub(super) fn none(&self) -> &'static str {
        match self.is_over() {
            true if self.levels.iter().any(|level| level.is_damaged) => "In what can be read no isola was found",
            true => "No isola was found",
            false => "No isola has been found so far",
        }
    }

    /// Whether the main branches of a level are known to their ends.
    pub(super) fn has_whole_main(&self, level: &Level) -> bool {
        level.has_whole_mains(self.mains)
    }

    /// The highest point over all branches of all levels.
    fn largest(&self) -> Option<(&'r Level, &'r BranchRow)> {
        let peaks = self.levels.iter().filter_map(|level| Some((level, level.peak()?)));
        peaks.max_by(|a, b| a.1.amplitude_max.total_cmp(&b.1.amplitude_max))
    }

    fn danger(&self) -> String {
        let mut parts: Vec<String> = Vec::new();
        let unforced: Vec<Unforced> = self.backbones().filter_map(|backbone| backbone.unforced).collect();
        let excited = self.structure.excitation.sentence(&unforced, |x| self.length(x), |omega| self.frequency(omega));
        parts.extend(excited);
        parts.extend(self.whose());
        if self.has_nothing() {
            parts.push(self.no_isola());
            return parts.join(" ");
        }
        let Some((level, largest)) = self.largest() else {
            let nothing = if self.is_over() { "No branch was found." } else { "No branch has been computed yet." };
            parts.push(nothing.into());
            return parts.join(" ");
        };
        let touch = |touch: Touch| match self.length(touch.at) {
            gap if touch.is_gap => format!(" (gap {gap})"),
            place => format!(" (contact begins at {place})"),
        };
        let touch = self.structure.touch.map(touch).unwrap_or_default();
        let at_monitor = |row: &BranchRow| format!("{} at {}", self.size(row), self.structure.monitor);
        let on = if largest.is_main() { "the main branch".to_string() } else { largest.name() };
        let place = format!("at {} and A = {}", self.frequency(largest.omega_at_max), level.amplitude);
        let mut largest_first = false;
        match highest(self.with_isolas().flat_map(Level::isolas)) {
            Some(highest) => {
                let ranges = joined(self.with_isolas().flat_map(Level::isolas));
                let doubt = Doubts::about(self.with_isolas().flat_map(Level::isolas)).sentence();
                let alone = self
                    .is_of_windows_alone()
                    .then_some("Isolas were looked for in windows of the energy balance alone.");
                let beside = self.overlooked().map(|there| format!("Along fold curves {there}, where none was found."));
                // Isolas of other ranges do not go up so far.
                let place = match ranges.len() {
                    1 => String::new(),
                    _ => format!(", at {}", self.frequency(highest.omega_at_max)),
                };
                let more = doubt.into_iter().chain(alone).map(String::from).chain(beside).collect::<Vec<_>>().join(" ");
                parts.push(format!(
                    "Between {}{}: there an isola, a closed branch apart from the main one, is another periodic response at \
                     the same forcing, with up to {}{place}{}.{}",
                    in_words(&ranges, self.units.frequency),
                    over(&self.with_isolas().collect::<Vec<_>>()),
                    at_monitor(highest),
                    self.stable_part(highest),
                    if more.is_empty() { more } else { format!(" {more}") }
                ));
                // Where the main branch goes up farther than the highest isola beside it, that is the greater danger.
                let level = self.with_isolas().find(|level| level.isolas().any(|isola| std::ptr::eq(isola, highest)));
                largest_first = largest.is_main()
                    && level.and_then(Level::main).is_some_and(|main| main.amplitude_max > highest.amplitude_max);
            }
            None => parts.push(self.no_isola()),
        }
        let at = parts.len() - usize::from(largest_first);
        parts
            .insert(at, format!("The largest computed response, {}{touch}, is on {on}, {place}.", at_monitor(largest)));
        parts.extend(passed_over_sentence(self.levels, |x| self.length(x)));
        parts.join(" ")
    }

    /// Whether of a further order, which may well have no motion at all, none was found though nothing is left to be done.
    pub(super) fn has_nothing(&self) -> bool {
        self.is_further && self.is_over() && self.is_empty() && self.levels.iter().all(Level::is_complete)
    }

    /// Which motions are meant, where the run looks for several orders; of the first with what was found of others.
    fn whose(&self) -> Vec<String> {
        if self.asked.len() < 2 {
            return Vec::new();
        }
        let own = match self.structure.harmonic {
            1 => "This is of motions of the force's own period.".to_string(),
            order => format!(
                "This is of motions that last {order} periods of the force; frequencies are theirs, the force has {} as much.",
                words::times(order)
            ),
        };
        std::iter::once(own).chain(self.orders.iter().map(OrderFound::sentence)).collect()
    }

    /// What else is known.
    fn details(&self) -> Vec<String> {
        let mut list: Vec<String> = Vec::new();
        if self.structure.harmonic > 1 && self.asked.len() < 2 {
            list.push(format!(
                "Frequencies are those of the response: the force has {} as much.",
                words::times(self.structure.harmonic)
            ));
        }
        list.extend(self.structure.undetermined.iter().map(|place| format!("Note: {place}.")));
        list.extend(self.with_isolas().next().into_iter().flat_map(|_| self.stability_of_isolas()));
        list.extend(stability::of_others(self.levels));
        list.extend(sampled(self.levels));
        list.extend(self.largest().map(|(_, largest)| self.stability_of_peak(largest)));
        list.extend(self.largest_stable());
        list.extend(self.unstable_peak());
        list.extend(folded_sentence(&self.folded, self.units.frequency));
        list.extend(motions::brief(self.motions, self.units, self.is_further));
        let is_untouched = self.structure.stops > 0 && is_untouched(self.levels);
        list.extend(is_untouched.then(|| UNTOUCHED.into()));
        list.extend(self.others());
        list.extend(self.not_found());
        list.extend(unknown_beyond(self));
        list.extend(turned_sliding(self.levels));
        list.extend(self.truncation().filter(|sentence| !asks_for_harmonics(sentence)));
        list
    }

    /// Whether enough harmonics were kept.
    fn truncation(&self) -> Option<String> {
        let frequency = |omega| self.frequency(omega);
        truncation(self.levels, self.harmonics, self.least_added, self.structure.of_several(), frequency)
    }

    /// That they were not.
    fn not_converged(&self) -> Option<String> {
        self.truncation().filter(|sentence| asks_for_harmonics(sentence))
    }

    /// What many isolas do along fold curves, how the frequency of the largest response goes, and what the energy balance predicts between the levels.
    fn over_the_forcing(&self, events: Option<&Events>) -> Vec<String> {
        let computed = events.and_then(|events| Some(events.sentences()?.1)).unwrap_or_default();
        let shift = shift_sentence(self.levels, |omega| self.frequency(omega));
        computed.into_iter().chain(shift).chain(self.predicted_events()).collect()
    }

    /// What happens along fold curves.
    fn events(&self) -> Option<Events> {
        let place = |omega: f64| format!("{}{}", self.in_both_units(omega), beyond(self.bounds, omega));
        // What was lost may count.
        events(self.curves, self.levels, self.search.is_whole(), place)
    }

    /// What ordinary continuation leaves out beside isolas; other branches where there are no isolas to tell them with.
    fn beside_ordinary_continuation(&self) -> Vec<String> {
        let others = if self.with_isolas().next().is_none() { self.others() } else { Vec::new() };
        self.outgrown().into_iter().chain(others).collect()
    }

    /// Branches that are neither main ones nor isolas, for what they are; of those of which that is not known [`losses`] tell.
    fn others(&self) -> Vec<String> {
        let branched = format!("branch off other responses, {}", self.structure.lesser.than("those"));
        let kinds = [
            (BranchKind::Open, "leave through the widest bounds at both ends: detached, but not closed"),
            (BranchKind::Branched, branched.as_str()),
        ];
        kinds
            .into_iter()
            .filter_map(|(kind, what)| Some(of_kind(self.levels, kind, what, |size| self.length(size))?.1))
            .collect()
    }

    fn onset(&self, events: Option<&Events>) -> String {
        let computed = events.map_or_else(String::new, |events| match events.sentences() {
            Some((below, _)) => format!(" {below}"),
            None => format!(" {}", events.sentence()),
        });
        if self.has_nothing() {
            // What it predicts at the levels and was not found is among the details.
            let is_missed = self.levels.iter().any(|level| level.not_found().chain(level.passed()).next().is_some());
            let above = self.predicted_above().filter(|_| !is_missed);
            let above = above.map_or_else(String::new, |above| format!("; the energy balance predicts {above}"));
            return format!("{NOTHING} (see the first answer){above}.{computed}");
        }
        if self.is_empty() && self.is_over() {
            return "Not known: no branch was found.".into();
        }
        if self.is_empty() {
            return format!("Nothing is known yet: {} to come.", count(self.levels.len(), "forcing level"));
        }
        let prediction = self.prediction();
        let missing = not_followed_sentence(self.search.hanging).filter(|_| !computed.is_empty());
        let computed = computed + &missing.map_or_else(String::new, |sentence| format!(" {sentence}"));
        let runs = runs(self.levels);
        let partly: Vec<&Level> = self.with_isolas().filter(|level| !level.is_complete()).collect();
        if runs.is_empty() && partly.is_empty() {
            let others: Vec<&Level> = self.levels.iter().filter(|level| level.others().next().is_some()).collect();
            let (none, others) = match self.is_further && !others.is_empty() {
                true => ("No isola", format!(", but such motions that are no isolas, at {}", named(&others))),
                false => ("None", String::new()),
            };
            return format!(
                "{none} was found where it was looked for{others} (see the first answer){prediction}.{computed}"
            );
        }
        let mut found: Vec<String> = Vec::new();
        if !runs.is_empty() {
            let runs = runs.iter().map(
                |(first, last)| {
                    if first == last { first.clone() } else { format!("{first} to {last}") }
                },
            );
            found.push(format!("at A = {}", runs.collect::<Vec<_>>().join(", ")));
        }
        if !partly.is_empty() {
            found.push(format!("at {}, of which not all is known", named(&partly)));
        }
        let highest = self.with_isolas().next_back().map_or(f64::INFINITY, |level| level.value);
        let above = self.levels.iter().find(|level| level.value > highest);
        let end = above.filter(|level| level.is_settled() && self.has_whole_main(level) && level.others().count() == 0);
        let end = end.and_then(|level| Some((level, level.main()?))).map(|(level, main)| {
            // The peak of another resonance has nothing to do with them.
            let is_near =
                |isola: &BranchRow| (isola.omega.0 / ABOUT..=isola.omega.1 * ABOUT).contains(&main.omega_at_max);
            let goes_up = if self.with_isolas().next_back().is_some_and(|last| last.isolas().any(is_near)) {
                format!(": the main branch goes up to {} at {}", self.size(main), self.frequency(main.omega_at_max))
            } else {
                String::new()
            };
            format!(" At A = {} none was found any more where it was looked for{goes_up}.", level.amplitude)
        });
        let isolas = if self.is_one_isola() { "An isola was" } else { "Isolas were" };
        let alone = if self.is_of_windows_alone() { format!(" {WINDOWS_ALONE},") } else { String::new() };
        format!("{isolas} found{alone} {}{prediction}.{computed}{}", found.join(", and "), end.unwrap_or_default())
    }

    /// Which frequencies and modes were looked at, what was looked for, and what was not.
    fn reach(&self) -> String {
        let frequencies = reach_sentence(self.given, self.reached, |omega| self.frequency(omega));
        let is_done = self.levels.iter().all(|level| level.pending == 0);
        let with_others = self.modes.filter(|choice| !modes::left_out(choice).is_empty());
        let modes = with_others.and_then(|choice| modes::sentence(choice, is_done));
        let all: Vec<String> = frequencies.into_iter().chain(modes).chain([self.looked_for().sentence()]).collect();
        all.join(" ")
    }
}

/// What stands before the other answers where the first begins with the truncation.
const NOT_CONVERGED: &str = "Not all is converged in H (see the first answer).";
