//! Responses that a bound of the amplitude leaves out.

use super::level::Level;
use crate::store::{CurvePoint, CurveRow, WindowOutcome};
use crate::words::{digits, listed_first};
use solver::response::branch::{Outcome, Stop};
use solver::response::task::SeedOutcome;

/// Digits of forcing amplitudes.
const DIGITS: i32 = 4;

/// Levels that are named.
const NAMED: usize = 6;

/// That responses beyond the bound of the amplitude were not followed, if main branches go on there, or what the energy balance
/// predicts lies there, and how far fold curves go, which it does not bound. `mains`: how main branches end, with their forcing
/// amplitudes as typed; `given`: the bound, m, if it was given; `length` and `frequency` write these, of m and rad/s.
pub fn amplitude_bound(
    levels: &[Level],
    mains: &[(String, Outcome)],
    curves: &[CurveRow],
    given: Option<f64>,
    length: impl Fn(f64) -> String,
    frequency: impl Fn(f64) -> String,
) -> Option<String> {
    let leaves = |outcome: &Outcome| match outcome {
        Outcome::Open(first, last) => [first, last].contains(&&Stop::AmplitudeBound),
        _ => false,
    };
    let mut cut: Vec<String> = mains.iter().filter(|(_, end)| leaves(end)).map(|(at, _)| at.clone()).collect();
    cut.dedup();
    let out = SeedOutcome::OutOfBounds.to_string();
    let is_out = |outcome: &WindowOutcome| matches!(outcome, WindowOutcome::NotFound(why) if why.contains(&out));
    let predicted = |level: &&Level| level.windows.iter().any(|window| is_out(&window.outcome));
    // Bounds that nobody gave are wide enough for what is predicted.
    let predicted: Vec<String> =
        levels.iter().filter(|_| given.is_some()).filter(predicted).map(|level| level.amplitude.clone()).collect();
    let main = format!("{} there", if cut.len() == 1 { "a main branch goes on" } else { "main branches go on" });
    let windows = "the energy balance predicts responses outside the bounds of frequency or amplitude".to_string();
    let reasons = [(cut, main), (predicted, windows)].into_iter().filter(|(levels, _)| !levels.is_empty());
    let mut reasons: Vec<String> =
        reasons.map(|(levels, what)| format!("{what} at A = {}", listed_first(levels, NAMED))).collect();
    let bound = match given {
        Some(size) => format!("{} (branch.max_amplitude)", length(size)),
        None => "the bound of the amplitude (branch.max_amplitude gives another)".into(),
    };
    let farther = given.and_then(|given| highest_fold(levels, curves).filter(|fold| fold.amplitude > given));
    let farther = farther.map_or_else(String::new, |fold| {
        let (size, at) = (length(fold.amplitude), frequency(fold.omega));
        format!(
            " Along fold curves, which go on, there are responses of up to {size}, at A = {} and {at}.",
            digits(fold.forcing, DIGITS)
        )
    });
    if reasons.is_empty() && !farther.is_empty() {
        reasons.push("what is cut there may go on".into());
    }
    (!reasons.is_empty())
        .then(|| format!("Responses larger than {bound} were not followed: {}.{farther}", reasons.join(", and ")))
}

/// The point of fold curves among the levels with the largest amplitude.
fn highest_fold<'c>(levels: &[Level], curves: &'c [CurveRow]) -> Option<&'c CurvePoint> {
    let values = || levels.iter().map(|level| level.value);
    let range = values().fold(f64::INFINITY, f64::min)..=values().fold(0.0, f64::max);
    let points = curves.iter().flat_map(|curve| &curve.points).filter(|point| range.contains(&point.forcing));
    points.max_by(|a, b| a.amplitude.total_cmp(&b.amplitude))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::WindowRow;

    #[test]
    fn what_goes_on_beyond_the_bound_is_said_to() {
        let windows = vec![WindowRow::of(WindowOutcome::NotFound(SeedOutcome::OutOfBounds.to_string()))];
        let level = |name: &str, windows: &[WindowRow]| Level {
            amplitude: name.into(),
            windows: windows.to_vec(),
            ..Level::default()
        };
        let levels = [level("1", &windows), level("2", &windows), level("3", &[])];
        let end = |name: &str, stop| (name.to_string(), Outcome::Open(Stop::Start, stop));
        let mains = [end("1", Stop::FrequencyBound), end("3", Stop::AmplitudeBound)];
        let (length, frequency) = (|size: f64| format!("{size} m"), |omega: f64| format!("{omega} rad/s"));
        let said = |levels: &[Level], given| amplitude_bound(levels, &mains, &[], given, length, frequency);
        assert_eq!(
            said(&levels, Some(0.5)).unwrap(),
            "Responses larger than 0.5 m (branch.max_amplitude) were not followed: a main branch goes on there at A = 3, and the energy balance \
             predicts responses outside the bounds of frequency or amplitude at A = 1 and 2."
        );
        // What nobody gave leaves out no window.
        let own = "the bound of the amplitude (branch.max_amplitude gives another) were not followed: a main branch goes on there at A = 3.";
        assert!(said(&levels, None).unwrap().ends_with(own));
        assert_eq!(amplitude_bound(&levels[2..], &mains[..1], &[], Some(0.5), length, frequency), None);
        // Fold curves go on, and what they have among the levels is told.
        let point = |forcing, amplitude| CurvePoint { forcing, omega: 2.0, amplitude, ..CurvePoint::default() };
        let curves = [CurveRow { points: vec![point(1.5, 0.75), point(9.0, 3.0)], ..CurveRow::default() }];
        let level = |value| Level { value, ..Level::default() };
        let folds = |given| {
            let levels = [level(1.0), level(2.0)];
            amplitude_bound(&levels, &mains[..1], &curves, Some(given), length, frequency)
        };
        assert_eq!(
            folds(0.5).unwrap(),
            "Responses larger than 0.5 m (branch.max_amplitude) were not followed: what is cut there may go on. Along fold curves, which go on, \
             there are responses of up to 0.75 m, at A = 1.5 and 2 rad/s."
        );
        assert_eq!(folds(0.8), None);
    }
}
