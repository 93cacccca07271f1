//! What one run found and another one did not, in words.

use super::ComparedLevel;
use crate::overview::{Level, events_of};
use crate::report::Report;
use crate::store::{BranchRow, CurvePoint};
use crate::told::Told;
use crate::words::{self, digits};
use solver::response::critical::CriticalKind;
use std::collections::{BTreeSet, HashMap};

/// Relative distances of forcing and frequency up to which births of two runs are taken to be one.
const NEAR: (f64, f64) = (0.1, 0.03);

/// How many things a sentence names.
const NAMED: usize = 8;

/// That nothing is said of motions of further orders, if any run looks for such.
pub(super) fn not_compared(reports: &[Report]) -> Option<Told> {
    let further = reports.iter().flat_map(|report| report.asked.iter().filter(|order| **order != report.harmonic));
    let further: BTreeSet<usize> = further.copied().collect();
    let told = |write: fn(&usize) -> String| words::listed(&further.iter().map(write).collect::<Vec<_>>());
    (!further.is_empty()).then(|| {
        format!(
            "Motions that last {} periods of the force are not compared: what was found of them is in {} of the runs that look for them.",
            told(usize::to_string),
            told(|order| format!("m{order}/"))
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

/// Of the first run and each other one: isolas and births that only one of both has. Sentences.
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
        for isola in level.isolas().filter(|isola| !there.isolas().any(|known| meets(known, isola))) {
            // It may be known there by another name.
            let instead: Vec<String> = there.others().filter(|row| meets(row, isola)).map(BranchRow::name).collect();
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
    let born = |report: &'_ Report| -> Vec<CurvePoint> {
        events_of(&report.curves, CriticalKind::Birth.name()).into_iter().cloned().collect()
    };
    let known = born(other);
    // Where the other has not looked, or not yet, nothing is lacking.
    let levels: Vec<f64> = other.overview.levels.iter().map(|level| level.value).collect();
    let (lowest, highest) = (levels.iter().copied().reduce(f64::min), levels.iter().copied().reduce(f64::max));
    let is_complete = other.overview.levels.iter().all(Level::is_complete);
    let is_looked_at = |birth: &CurvePoint| {
        is_complete
            && lowest.is_some_and(|low| low <= birth.forcing)
            && highest.is_some_and(|high| birth.forcing <= high)
    };
    let is_known = |birth: &CurvePoint| known.iter().any(|other| is_near(birth, other));
    let births = born(report).into_iter().filter(|birth| is_looked_at(birth) && !is_known(birth));
    let births: Vec<Told> = births
        .map(|birth| {
            Told::from(format!("A = {} (", digits(birth.forcing, 4))).frequency(birth.omega, 5).unit().text(")")
        })
        .collect();
    let followed = if other.curves.is_empty() { ", which has no fold curves" } else { "" };
    let percent = |share: f64| digits(100.0 * share, 2);
    [
        listed(&isolas, &format!("Isolas of `{own}` at whose frequencies `{name}` has none")),
        listed(
            &births,
            &format!(
                "Births along fold curves of `{own}` that are not found in `{name}`{followed} (within {} % of A and {} % of the frequency)",
                percent(NEAR.0),
                percent(NEAR.1)
            ),
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Whether branches share frequencies.
fn meets(a: &BranchRow, b: &BranchRow) -> bool {
    a.omega.0 <= b.omega.1 && b.omega.0 <= a.omega.1
}

fn is_near(a: &CurvePoint, b: &CurvePoint) -> bool {
    let within = |a: f64, b: f64, share: f64| (a - b).abs() <= share * a.abs().max(b.abs());
    within(a.forcing, b.forcing, NEAR.0) && within(a.omega, b.omega, NEAR.1)
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
