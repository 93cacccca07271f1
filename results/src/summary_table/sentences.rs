//! What is said below the table, sentence by sentence: what its reader has to know first, what was found, what happens over the forcing,
//! and how far all of it reaches.

use super::known::Known;
use super::units::Units;
use super::{LEVELS, motions, pushes, search, stability};
use crate::overview::{
    Level, Overview, Shift, UNTOUCHED, beyond, events_sentence, is_untouched, least_added, not_followed_sentence,
    reach_sentence, truncation, undetermined, unfinished,
};
use crate::words::capitalised;
use protocol::model::ModelMessage;

/// All of them.
pub(super) fn all(known: &Known, units: Units) -> Vec<String> {
    [first(known), found(known, units), over_the_forcing(known, units), reach(known, units)].concat()
}

/// What the structure does of itself, and what is missing.
fn first(known: &Known) -> Vec<String> {
    let (levels, model) = (known.levels(), known.model.as_ref());
    let is_at_least = known.shown().flat_map(|level| &level.branches).any(|row| !row.at_least().is_empty());
    let more = levels.len().saturating_sub(LEVELS);
    let is_untouched = model.is_some_and(|model| model.contacts().count() > 0) && is_untouched(levels);
    let meaning = "At least (≥): the branch is known up to there only, and may go on to larger responses.";
    (search::excitation(known).into_iter())
        .chain(is_at_least.then(|| meaning.into()))
        .chain((more > 0).then(|| format!("... and {more} more levels: see summary.csv")))
        .chain(model.and_then(undetermined).map(|place| format!("Note: {place}.")))
        .chain(known.doubts.as_deref().map(|doubts| format!("{}.", capitalised(doubts))))
        .chain(unfinished(levels, !known.awaits_backbones))
        .chain(is_untouched.then(|| UNTOUCHED.into()))
        .collect()
}

/// Whether there is an isola, how sure the numbers are, and what is stable.
fn found(known: &Known, units: Units) -> Vec<String> {
    let levels = known.levels();
    let least = known.model.as_ref().map_or(1, |model| least_added(model, known.is_further));
    let harmonics = known.settings.map(|settings| settings.harmonics.count);
    (search::no_isola(known).into_iter())
        .chain(harmonics.and_then(|count| truncation(levels, count, least)))
        .chain(stability::sentences(levels, units))
        .collect()
}

/// Births, merges, and how the largest response moves; what unstable motions turn into, and what pushes lead to.
fn over_the_forcing(known: &Known, units: Units) -> Vec<String> {
    let (bounds, unit) = (known.bounds(), units.frequency);
    let place = |omega: f64| format!("{} {unit}{}", unit.digits(omega), beyond(bounds, omega));
    let events = events_sentence(&known.curves, place);
    let missing = not_followed_sentence(known.search.hanging).filter(|_| events.is_some());
    let names = |model: &ModelMessage| model.monitors.iter().filter_map(|&dof| model.dofs.get(dof)).cloned().collect();
    let monitors: Vec<String> = known.overview.model.as_ref().map(names).unwrap_or_default();
    ([events, missing, shift(&known.overview, units)].into_iter().flatten())
        .chain(motions::sentences(&known.motions, units, known.is_further))
        .chain(pushes::sentences(&known.pushes, &monitors, units))
        .collect()
}

/// Which frequencies were looked at, and what was looked for.
fn reach(known: &Known, units: Units) -> Vec<String> {
    let unit = units.frequency;
    let frequencies = reach_sentence(known.given, known.reached, |omega| format!("{} {unit}", unit.digits(omega)));
    // Main branches are of the first order's motions.
    frequencies.filter(|_| !known.is_further).into_iter().chain(search::looked_for(known)).collect()
}

/// A relative change of a frequency that is not worth numbers.
const NEGLIGIBLE: f64 = 1e-3;

/// How the frequency of the largest response goes, as far as levels of which all is known tell.
fn shift(overview: &Overview, units: Units) -> Option<String> {
    let (unit, shift) = (units.frequency, overview.shift()?);
    let Shift { amplitudes: (from, to), omega: (before, after), branches } = &shift;
    // Where a level is not known to its end the frequency there may be another one.
    let of = if overview.levels.iter().all(Level::is_known) { "" } else { ", of levels that are known to their ends," };
    if shift.size() < NEGLIGIBLE * after {
        // Of some of the levels that says nothing.
        if !of.is_empty() {
            return None;
        }
        let percent = 100.0 * NEGLIGIBLE;
        return Some(format!(
            "From one level to the next the frequency of the largest computed response{of} changes by less than {percent} %."
        ));
    }
    let goes = if after > before { "rises" } else { "falls" };
    let size = unit.digits(shift.size());
    let at = format!("to {} {unit}", unit.digits(*after));
    let how = match branches {
        None => format!("it {goes} by {size} {unit}, {at}"),
        Some((one, other)) => {
            format!(
                "from {one} to {other}{}, by {size} {unit}, {at}",
                if one == other { ", not known to be the same one" } else { "" }
            )
        }
    };
    Some(format!("The frequency of the largest computed response{of} changes most from A = {from} to {to}: {how}."))
}
