//! What time marching has near the largest response.

use crate::store::PeakOrbit;

/// Relative difference of amplitudes from which it is told.
const TOLD: f64 = 1e-3;

/// What is known of the stability of the largest response, of amplitude `largest` (m): of the motion that marching has near it, which
/// may be a little lower and at another frequency. `place` writes its frequency (rad/s) and amplitude (m).
pub fn near_largest(peak: &PeakOrbit, largest: f64, place: impl Fn(f64, f64) -> String) -> String {
    let motion = peak.at.map_or_else(String::new, |(omega, amplitude)| {
        let motion = "The periodic motion that time marching has near the largest response";
        format!("{motion}, {}{},", place(omega, amplitude), beside(amplitude / largest - 1.0))
    });
    match peak.verdict.as_str() {
        "stable" => motion + " is stable.",
        "unstable" => motion + " is unstable.",
        "marginal" => motion + " is at the edge of stability.",
        "not_comparable" => {
            "Whether the largest response is stable is not known: marching loses impact energy that the balance keeps."
                .into()
        }
        _ => "Time marching found no periodic motion near the largest response.".into(),
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
            near_largest(&peak, 2.0, |omega, amplitude| format!("{amplitude} m at {omega} rad/s"))
        };
        assert!(told(2.001).ends_with("largest response, 2.001 m at 2 rad/s, is stable."), "{}", told(2.001));
        assert!(told(1.98).ends_with(", 1.98 m at 2 rad/s (1.0 % less), is stable."), "{}", told(1.98));
        assert!(told(2.4).ends_with(", 2.4 m at 2 rad/s (20 % more), is stable."), "{}", told(2.4));
    }
}
