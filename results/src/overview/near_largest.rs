//! What time marching has near the largest response.

use super::stability_words::{VerdictWords, verdict_words};
use crate::store::PeakOrbit;

/// Relative difference of amplitudes from which it is told.
const TOLD: f64 = 1e-3;

/// What is known of the stability of the largest response, of amplitude `largest` (m): of the motion that marching has near it, which
/// may be another one in amplitude and frequency. `length` and `frequency` write these, of m and rad/s.
pub fn near_largest(
    peak: &PeakOrbit,
    largest: f64,
    length: impl Fn(f64) -> String,
    frequency: impl Fn(f64) -> String,
) -> String {
    let motion = peak.at.map_or_else(String::new, |(omega, amplitude)| {
        let (size, place) = (length(amplitude) + &beside(amplitude / largest - 1.0), frequency(omega));
        format!("The periodic motion that time marching has near the largest response, {size} at {place},")
    });
    let VerdictWords { name, word, meaning } = verdict_words(&peak.verdict);
    match name {
        "stable" | "unstable" => {
            let is_other = peak.at.is_some_and(|(_, amplitude)| !beside(amplitude / largest - 1.0).is_empty());
            let other = if is_other { ", which the largest response itself need not be" } else { "" };
            format!("{motion} is {word}{other}.")
        }
        "marginal" => format!("{motion} is {word} ({meaning})."),
        "not_comparable" => {
            format!("Whether the largest response is stable is not known: time marching is {word} there ({meaning}).")
        }
        _ => format!(
            "Whether the largest response is stable is not known: time marching came to {} it.",
            verdict_words("none").word
        ),
    }
}

/// By how much a marched amplitude is another one, if that matters.
fn beside(change: f64) -> String {
    let than = if change < 0.0 { "less" } else { "more" };
    match 100.0 * change.abs() {
        percent if percent < 100.0 * TOLD || !percent.is_finite() => String::new(),
        percent if percent < 10.0 => format!(" ({percent:.1} % {than})"),
        percent => format!(" ({percent:.0} % {than})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_amplitude_is_told_where_it_matters() {
        let told = |amplitude| {
            let peak = PeakOrbit { verdict: "stable".into(), at: Some((2.0, amplitude)) };
            near_largest(&peak, 2.0, |amplitude| format!("{amplitude} m"), |omega| format!("{omega} rad/s"))
        };
        assert!(told(2.001).ends_with("largest response, 2.001 m at 2 rad/s, is stable."), "{}", told(2.001));
        assert!(
            told(1.98).ends_with(
                ", 1.98 m (1.0 % less) at 2 rad/s, is stable, which the largest response itself need not be."
            ),
            "{}",
            told(1.98)
        );
        assert!(told(2.4).contains(", 2.4 m (20 % more) at 2 rad/s, is stable, which"), "{}", told(2.4));
    }
}
