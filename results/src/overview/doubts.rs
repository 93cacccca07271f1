//! Curves that stopped before their ends, so that what lies beyond is not known.

use super::modes::not_started;
use crate::store::{Reader, Result};
use solver::response::branch::{Outcome, Stop};

/// How many curves the sentence names.
const NAMED: usize = 4;

/// Says which main branches and backbones stopped before their ends, or did not start: branches may hang on what lies beyond.
/// `None` if none did.
///
/// # Errors
/// If the store cannot be read.
pub fn doubts(reader: &Reader) -> Result<Option<String>> {
    let mut curves = Vec::new();
    if let Some(stop) = reader.backbone()?.and_then(|backbone| unfinished(&backbone.outcome)) {
        curves.push(format!("the backbone ({stop})"));
    }
    for backbone in reader.further_backbones()? {
        let stop = unfinished(&backbone.outcome);
        curves.extend(stop.map(|stop| format!("the backbone of mode {} ({stop})", backbone.mode + 1)));
    }
    if let Some(choice) = reader.modes()? {
        curves.extend(not_started(&choice).map(|(mode, _)| format!("the backbone of mode {} (no start)", mode + 1)));
    }
    for (amplitude, outcome) in reader.main_outcomes()? {
        curves.extend(unfinished(&outcome).map(|stop| format!("the main branch at A = {amplitude} ({stop})")));
    }
    if curves.is_empty() {
        return Ok(None);
    }
    let more = curves.len().saturating_sub(NAMED);
    curves.truncate(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let list = curves.join(", ");
    Ok(Some(format!("not known to its end: {list}{more}; responses beyond may be larger, and others may begin there")))
}

/// Why a curve goes on where it ends, if it does: neither closed nor at a bound.
fn unfinished(outcome: &Outcome) -> Option<Stop> {
    let Outcome::Open(first, last) = outcome else { return None };
    let is_unfinished = |stop: &&Stop| matches!(stop, Stop::PointBudget | Stop::Stalled(_) | Stop::Reversed);
    [last, first].into_iter().find(is_unfinished).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_known_up_to_bounds() {
        for end in [Stop::FrequencyBound, Stop::AmplitudeBound] {
            assert_eq!(unfinished(&Outcome::Open(Stop::Start, end)), None);
        }
        assert_eq!(unfinished(&Outcome::Closed), None);
        for end in [Stop::PointBudget, Stop::Reversed] {
            assert_eq!(unfinished(&Outcome::Open(Stop::Start, end)), Some(end));
            assert_eq!(unfinished(&Outcome::Open(end, Stop::FrequencyBound)), Some(end));
        }
    }
}
