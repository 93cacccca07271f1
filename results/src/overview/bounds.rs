//! Frequencies beyond which branches are not followed.

use solver::settings::FrequencySettings;

/// Marks what happens beyond them.
const BEYOND: &str = ", beyond the frequencies of the study";

/// Relative distance from a bound up to which a response counts as at it.
pub const BESIDE: f64 = 1e-6;

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

/// Whether a frequency is that of a bound, if there is one.
pub fn is_at_bound(omega: f64, bound: Option<f64>) -> bool {
    bound.is_some_and(|bound| (omega - bound).abs() <= BESIDE * bound)
}

/// Which frequencies were looked at, where that is known: a sentence.
pub fn reach_sentence(
    given: FrequencySettings,
    reach: Option<(f64, f64)>,
    frequency: impl Fn(f64) -> String,
) -> Option<String> {
    let (low, high) = given.min.zip(given.max).or(reach)?;
    let (low, high) = (frequency(low), frequency(high));
    Some(match (given.min, given.max) {
        (None, None) => format!(
            "Looked at: {low} to {high}, as backbones and resonances suggest (frequency.min and frequency.max give other bounds); branches and curves \
             that lead out of there are followed, and isolas may be found beyond; others may lie there."
        ),
        (None, Some(_)) => format!(
            "Looked at: {low}, as backbones and resonances suggest (frequency.min gives another lower bound), to {high}, as given; below branches may go \
             on, above main branches alone, and others may lie there."
        ),
        (Some(_), None) => format!(
            "Looked at: {low}, as given, to {high}, as backbones and resonances suggest (frequency.max gives another upper bound); above branches may go \
             on, below main branches alone, and others may lie there."
        ),
        (Some(_), Some(_)) => {
            format!(
                "Looked at: {low} to {high}, as given (frequency.min and frequency.max); main branches may be followed on \
                 beyond, and others may lie there."
            )
        }
    })
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
        assert_eq!(
            said(None, None).unwrap(),
            "Looked at: 0.9 rad/s to 1.1 rad/s, as backbones and resonances suggest (frequency.min and frequency.max give other bounds); branches and \
             curves that lead out of there are followed, and isolas may be found beyond; others may lie there."
        );
        // At a bound that was given everything ends.
        assert_eq!(
            said(Some(0.8), None).unwrap(),
            "Looked at: 0.9 rad/s, as given, to 1.1 rad/s, as backbones and resonances suggest (frequency.max gives another upper bound); above branches \
             may go on, below main branches alone, and others may lie there."
        );
        let below = "Looked at: 0.9 rad/s, as backbones and resonances suggest (frequency.min gives another lower bound), to 1.1 rad/s, as given; below \
                     branches may go on,";
        assert!(said(None, Some(1.1)).unwrap().starts_with(below));
        let given = said(Some(0.8), Some(1.3)).unwrap();
        assert!(given.starts_with("Looked at: 0.8 rad/s to 1.3 rad/s, as given (frequency.min"), "{given}");
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
