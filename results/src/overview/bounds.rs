//! Frequencies beyond which branches are not followed.

use solver::settings::FrequencySettings;

/// Marks what happens beyond them.
const BEYOND: &str = ", beyond the frequencies of the study";

/// The bounds at which branches apart from the main ones end: those that were given, for where nobody gave one they are followed as
/// far as they go. A further order of motions has both if it has one: the other one is that of the first order, `reach` tells.
pub fn bounds(given: FrequencySettings, reach: Option<(f64, f64)>, is_further: bool) -> FrequencySettings {
    let FrequencySettings { min, max } = given;
    match reach {
        Some((low, high)) if is_further && min.is_some() != max.is_some() => {
            FrequencySettings { min: Some(low), max: Some(high) }
        }
        _ => given,
    }
}

/// Which frequencies were looked at, if not those between bounds that were given: a sentence.
pub fn reach_sentence(
    given: FrequencySettings,
    reach: Option<(f64, f64)>,
    frequency: impl Fn(f64) -> String,
) -> Option<String> {
    let (low, high) = reach.filter(|_| given.min.is_none() || given.max.is_none())?;
    let key = match (given.min, given.max) {
        (None, None) => "frequency.min and frequency.max give other bounds",
        (None, _) => "frequency.min gives another lower bound",
        _ => "frequency.max gives another upper bound",
    };
    let beyond = match (given.min, given.max) {
        (None, None) => {
            "branches and curves that lead out of there are followed, and isolas may be found beyond; others may lie there"
        }
        _ => "beyond that other bound branches may go on, and others may lie there",
    };
    Some(format!("Looked at: {} to {}, as the resonances suggest ({key}); {beyond}.", frequency(low), frequency(high)))
}

/// Whether branches are followed at a frequency.
pub fn is_within(bounds: FrequencySettings, omega: f64) -> bool {
    bounds.min.is_none_or(|min| omega >= min) && bounds.max.is_none_or(|max| omega <= max)
}

/// What follows a frequency in a sentence: that it lies beyond the bounds, if it does.
pub fn beyond(bounds: FrequencySettings, omega: f64) -> &'static str {
    if is_within(bounds, omega) { "" } else { BEYOND }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn which_frequencies_were_looked_at() {
        let said = |min, max| {
            reach_sentence(FrequencySettings { min, max }, Some((0.9, 1.1)), |omega| format!("{omega} rad/s"))
        };
        let told = |key: &str, beyond: &str| {
            format!("Looked at: 0.9 rad/s to 1.1 rad/s, as the resonances suggest ({key}); {beyond}.")
        };
        let both = "branches and curves that lead out of there are followed, and isolas may be found beyond; others may lie there";
        assert_eq!(said(None, None).unwrap(), told("frequency.min and frequency.max give other bounds", both));
        // At the bound that was given everything ends.
        let other = "beyond that other bound branches may go on, and others may lie there";
        assert_eq!(said(Some(0.9), None).unwrap(), told("frequency.max gives another upper bound", other));
        assert_eq!(said(None, Some(1.1)).unwrap(), told("frequency.min gives another lower bound", other));
        assert_eq!(said(Some(0.9), Some(1.1)), None);
    }

    #[test]
    fn only_what_was_given_bounds() {
        let given = |min, max| FrequencySettings { min, max };
        let reach = Some((0.8, 1.6));
        // Main branches are followed up to 1.6; an isola at 1.8 is beyond nothing that somebody asked for.
        assert_eq!(beyond(bounds(given(None, None), reach, false), 1.8), "");
        assert_eq!(beyond(bounds(given(Some(0.5), None), reach, false), 1.8), "");
        assert_eq!(beyond(bounds(given(None, Some(1.7)), reach, false), 1.8), BEYOND);
        assert_eq!(beyond(bounds(given(Some(0.5), None), reach, true), 1.8), BEYOND);
        assert_eq!(beyond(bounds(given(None, None), reach, true), 1.8), "");
        assert!(!is_within(given(Some(2.0), None), 1.8) && is_within(given(Some(1.8), Some(1.8)), 1.8));
    }
}
