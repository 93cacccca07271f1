//! What one run found and another one did not, in words.

use super::born::forcing;
use super::{ComparedLevel, born};
use crate::overview::{EVENTS, Level};
use crate::report::Report;
use crate::store::{BranchRow, CurvePoint};
use crate::told::Told;
use crate::words;
use std::collections::{BTreeSet, HashMap};

/// How many things a sentence names.
const NAMED: usize = 8;

/// That nothing is said of motions of further orders, if any run looks for such.
pub(super) fn not_compared(reports: &[Report]) -> Option<Told> {
    let further = reports.iter().flat_map(|report| report.asked.iter().filter(|order| **order != report.harmonic));
    let further: BTreeSet<usize> = further.copied().collect();
    (!further.is_empty()).then(|| {
        format!(
            "Motions that last {} periods of the force are not compared here: isola report with --order compares those of one of them.",
            words::listed(&further.iter().map(usize::to_string).collect::<Vec<_>>())
        )
        .into()
    })
}

/// Of each run the levels of others that it does not have. Sentences.
pub(super) fn lacking(names: &[String], reports: &[Report], levels: &[ComparedLevel]) -> Vec<Told> {
    let of_run = |(name, report): (&String, &Report)| {
        let has = |level: &&ComparedLevel| report.overview.levels.iter().any(|known| known.value == level.value);
        let missing: Vec<Told> =
            levels.iter().filter(|level| !has(level)).map(|level| level.amplitude.as_str().into()).collect();
        listed(&missing, &format!("Forcing amplitudes that are no levels of `{name}`"))
    };
    names.iter().zip(reports).filter_map(of_run).collect()
}

/// Of the first run and each other one: isolas, births, deaths and merges that only one of both has. Sentences.
pub(super) fn alone(names: &[String], reports: &[Report]) -> Vec<Told> {
    let mut runs = names.iter().zip(reports);
    let Some(first) = runs.next() else { return Vec::new() };
    runs.flat_map(|other| [of_one(first, other), of_one(other, first)].concat()).collect()
}

/// What the first of two runs has alone.
fn of_one((own, report): (&String, &Report), (name, other): (&String, &Report)) -> Vec<Told> {
    let mut isolas = Vec::new();
    let theirs: HashMap<u64, &Level> =
        other.overview.levels.iter().map(|level| (level.value.to_bits(), level)).collect();
    for level in &report.overview.levels {
        // Of what is still to be computed nothing is lacking.
        let there = theirs.get(&level.value.to_bits()).filter(|there| there.is_complete());
        let Some(there) = there else { continue };
        for isola in level.isolas().filter(|isola| !there.isolas().any(|known| known.meets(isola))) {
            // It may be known there by another name.
            let instead: Vec<String> = there.others().filter(|row| row.meets(isola)).map(BranchRow::name).collect();
            let instead = if instead.is_empty() {
                String::new()
            } else {
                format!(", where the other has {}", instead.join(", "))
            };
            let begin = Told::from(format!("{} at A = {} (", isola.name(), level.amplitude));
            let range = begin.frequency(isola.omega.0, 5).text("–").frequency(isola.omega.1, 5).unit();
            isolas.push(range.text(format!("{instead})")));
        }
    }
    // Of what is still to be computed nothing is lacking.
    let is_complete = other.overview.levels.iter().all(Level::is_complete);
    let events = EVENTS.into_iter().filter(|_| is_complete).filter_map(|words| {
        let lacking = born::without_partner(report, other, words.kind);
        let of_each = lacking.into_iter().map(|event| {
            let place = Told::from(format!("A = {} (", forcing(event))).frequency(event.omega, 5).unit();
            place.text(if is_beyond(event, other) { ", beyond its levels)" } else { ")" })
        });
        let followed = if other.curves.is_empty() { ", which has no fold curves" } else { "" };
        let what = words::capitalised(words.many);
        listed(
            &of_each.collect::<Vec<_>>(),
            &format!(
                "{what} along fold curves of `{own}` that are not found in `{name}`{followed} ({})",
                born::nearness()
            ),
        )
    });
    listed(&isolas, &format!("Isolas of `{own}` at whose frequencies `{name}` has none"))
        .into_iter()
        .chain(events)
        .collect()
}

/// Whether the forcing of an event is not among the levels of a run.
fn is_beyond(event: &CurvePoint, run: &Report) -> bool {
    let levels = || run.overview.levels.iter().map(|level| level.value);
    levels().all(|level| level < event.forcing) || levels().all(|level| level > event.forcing)
}

fn listed(things: &[Told], what: &str) -> Option<Told> {
    let more = match things.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let (first, further) = things.split_first()?;
    let begin = Told::from(format!("{what}: ")).then(first.clone());
    let named = further.iter().take(NAMED - 1).fold(begin, |told, thing| told.text(", ").then(thing.clone()));
    Some(named.text(format!("{more}.")))
}
