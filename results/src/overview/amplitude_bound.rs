//! Responses that a bound of the amplitude leaves out.

use super::level::Level;
use crate::store::WindowOutcome;
use crate::words::listed;
use solver::response::branch::{Outcome, Stop};
use solver::response::task::SeedOutcome;

/// Levels that are named.
const NAMED: usize = 6;

/// That responses beyond the bound of the amplitude were not followed, if main branches go on there, or what the energy balance
/// predicts lies there. `mains`: how main branches end, with their forcing amplitudes as typed; `given`: the bound, m, if it was given;
/// `length` writes one.
pub fn amplitude_bound(
    levels: &[Level],
    mains: &[(String, Outcome)],
    given: Option<f64>,
    length: impl Fn(f64) -> String,
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
    let reasons: Vec<String> = reasons.map(|(levels, what)| format!("{what} at A = {}", shortened(levels))).collect();
    let bound = match given {
        Some(size) => format!("{} (branch.max_amplitude)", length(size)),
        None => "the bound of the amplitude (branch.max_amplitude gives another)".into(),
    };
    (!reasons.is_empty())
        .then(|| format!("Responses larger than {bound} were not followed: {}.", reasons.join(", and ")))
}

fn shortened(mut levels: Vec<String>) -> String {
    if levels.len() > NAMED {
        let more = levels.len() - NAMED;
        levels.truncate(NAMED);
        levels.push(format!("{more} more"));
    }
    listed(&levels)
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
        let said = |levels: &[Level], given| amplitude_bound(levels, &mains, given, |size| format!("{size} m"));
        assert_eq!(
            said(&levels, Some(0.5)).unwrap(),
            "Responses larger than 0.5 m (branch.max_amplitude) were not followed: a main branch goes on there at A = 3, and the energy balance \
             predicts responses outside the bounds of frequency or amplitude at A = 1 and 2."
        );
        // What nobody gave leaves out no window.
        let own = "the bound of the amplitude (branch.max_amplitude gives another) were not followed: a main branch goes on there at A = 3.";
        assert!(said(&levels, None).unwrap().ends_with(own));
        assert_eq!(amplitude_bound(&levels[2..], &mains[..1], Some(0.5), |size| size.to_string()), None);
    }
}
