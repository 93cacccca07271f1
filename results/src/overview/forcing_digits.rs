//! How forcing amplitudes of what happens along fold curves are told: with what twice the harmonics make of them.

use crate::store::CurvePoint;
use crate::words::digits;

/// Most digits of a forcing amplitude.
pub(super) const DIGITS: i32 = 5;

/// Fewest digits to which a forcing amplitude and that with twice the harmonics have to agree: fewer are told with both.
pub(super) const AGREED: i32 = 3;

/// The forcing amplitude of what happens at a point, with `most` digits at most, and no more than those that twice the harmonics
/// leave as they are; where these are too few, that with twice the harmonics as well.
pub(super) fn forcing_digits(point: &CurvePoint, most: i32) -> (String, Option<String>) {
    let own = |count| digits(point.forcing, count);
    // No more is claimed of what nothing was compared with.
    let Some((doubled, _)) = point.doubled else { return (own(most.min(AGREED + 1)), None) };
    let agreed = (AGREED..=most).rev().map(|count| (own(count), digits(doubled, count))).find(|(a, b)| a == b);
    agreed.map_or_else(|| (own(AGREED + 1), Some(digits(doubled, AGREED + 1))), |(text, _)| (text, None))
}

/// The same for the label of a figure.
pub fn forcing_label(point: &CurvePoint, most: i32) -> String {
    let (own, doubled) = forcing_digits(point, most);
    doubled.map_or_else(|| own.clone(), |doubled| format!("{own} (2H: {doubled})"))
}

/// The doubt about what happens at points, if at any it was not found with twice the harmonics.
pub fn truncation_doubt(points: &[&CurvePoint]) -> &'static str {
    match points.iter().filter(|point| point.doubled.is_none()).count() {
        0 => "",
        unknown if unknown == points.len() => ", not confirmed with twice the harmonics",
        _ => ", not all confirmed with twice the harmonics",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn how_many_are_known_with_twice_the_harmonics() {
        let known = CurvePoint { doubled: Some((1.0, 2.0)), ..CurvePoint::default() };
        let unknown = CurvePoint::default();
        assert_eq!(truncation_doubt(&[&known, &known]), "");
        assert_eq!(truncation_doubt(&[&unknown, &unknown]), ", not confirmed with twice the harmonics");
        assert_eq!(truncation_doubt(&[&known, &unknown]), ", not all confirmed with twice the harmonics");
    }

    #[test]
    fn a_forcing_has_the_digits_that_twice_the_harmonics_leave() {
        let text = |forcing, doubled: Option<f64>| {
            let doubled = doubled.map(|doubled| (doubled, 1.0));
            forcing_label(&CurvePoint { forcing, doubled, ..CurvePoint::default() }, 5)
        };
        // What nothing was compared with is told with no more than what was compared and does not agree.
        assert_eq!(text(5.13781, None), "5.138");
        assert_eq!(text(5.13781, Some(5.13779)), "5.1378");
        assert_eq!(text(5.13781, Some(5.1362)), "5.14");
        assert_eq!(text(5.13781, Some(4.85491)), "5.138 (2H: 4.855)");
    }
}
