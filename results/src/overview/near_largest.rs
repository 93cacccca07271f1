//! What time marching has near the largest response.

use crate::store::PeakOrbit;

/// What is known of the stability of the largest response: of the motion that marching has near it, which may be a little lower and
/// at another frequency. `place` writes its frequency (rad/s) and amplitude (m).
pub fn near_largest(peak: &PeakOrbit, place: impl Fn(f64, f64) -> String) -> String {
    let motion = peak.at.map_or_else(String::new, |(omega, amplitude)| {
        format!("The periodic motion that time marching has near the largest response, {},", place(omega, amplitude))
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
