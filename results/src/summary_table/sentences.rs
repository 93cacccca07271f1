//! What is said below the table, sentence by sentence: what its numbers mean, what happens over the forcing, and how far all of it
//! reaches. What is explanation alone is left to the report.

use super::known::Known;
use super::rows::is_on_main;
use super::units::Units;
use super::{LEVELS, monitors, motions, pushes, search};
use crate::overview::{
    UNTOUCHED, asks_for_harmonics, beyond, events, is_untouched, not_followed_sentence, reach_sentence, truncation_of,
    undetermined, unknown_events, unknown_sentence,
};

/// What windows say in rows that list nothing beside the main branch.
const OF_MAIN: &str = "Windows found in a row that lists a main peak alone are on its main branch, which the energy balance predicts as well.";

/// All of them.
pub(super) fn all(known: &Known, units: Units) -> Vec<String> {
    [numbers(known, units), over_the_forcing(known, units), reach(known, units)].concat()
}

/// What the numbers of the table mean, and how sure they are.
fn numbers(known: &Known, units: Units) -> Vec<String> {
    let (levels, model) = (known.levels(), known.model.as_ref());
    let is_at_least = known.shown().flat_map(|level| &level.branches).any(|row| !row.at_least().is_empty());
    let more = levels.len().saturating_sub(LEVELS);
    let is_untouched = model.is_some_and(|model| model.contacts().count() > 0) && is_untouched(levels);
    let meaning = "≥: the branch goes on beyond where it is known, maybe to larger responses.";
    let truncation =
        truncation_of(model, levels, known.settings.as_ref(), known.is_further, |omega| units.frequency.told(omega));
    (is_at_least.then(|| meaning.into()).into_iter())
        .chain(known.shown().any(|level| level.others().next().is_none() && is_on_main(level)).then(|| OF_MAIN.into()))
        .chain((more > 0).then(|| format!("... and {more} more levels: see summary.csv")))
        .chain(monitors::sentence(&known.others, units))
        .chain(model.and_then(undetermined).map(|place| format!("Note: {place}.")))
        .chain(is_untouched.then(|| UNTOUCHED.into()))
        .chain(truncation.filter(|said| !asks_for_harmonics(said)))
        .collect()
}

/// Births and merges; what unstable motions turn into, and what pushes lead to.
fn over_the_forcing(known: &Known, units: Units) -> Vec<String> {
    let (bounds, unit) = (known.bounds(), units.frequency);
    let place = |omega: f64| format!("{}{}", unit.told(omega), beyond(bounds, omega));
    // What was lost may count.
    let events = events(&known.curves, known.levels(), known.search.is_whole(), place).map(|events| events.sentence());
    let missing = not_followed_sentence(known.search.hanging).filter(|_| events.is_some());
    let (among, _) = unknown_events(&known.curves, known.levels());
    let unknown = (!among.is_empty()).then(|| unknown_sentence(&among, |omega| unit.told(omega)));
    ([events, unknown, missing].into_iter().flatten())
        .chain(motions::brief(&known.motions, units, known.is_further))
        .chain(pushes::sentences(&known.pushes, &known.monitors, units))
        .chain(pushes::not_pushed_onto(known.levels()).filter(|_| !known.pushes.is_empty()))
        .collect()
}

/// Which frequencies were looked at, and what was looked for.
fn reach(known: &Known, units: Units) -> Vec<String> {
    let frequencies = reach_sentence(known.given, known.reached, |omega| units.frequency.told(omega));
    frequencies.into_iter().chain(search::looked_for(known)).collect()
}
