//! Ranges and peaks of the forced responses.
//!
//! The figures come from an independent implementation of the same equations, a prototype in an array language with its
//! own steps, read off its curves: 1 % on a peak, 0.5 % on a frequency and 2 % on the ends of an isola are its resolution.

use super::common::{
    BACKWARD, FORWARD, FRICTIONLESS, GAP, Scenario, TUNED, assert_close, found_from_window, highest_contact, touches,
};
use solver::response::branch::{Branch, BranchKind, Outcome, SpecialKind, Stop};
use solver::response::level::BranchId;

/// The first eigenfrequency, rad/s.
fn eigenfrequency(scenario: &Scenario) -> f64 {
    scenario.model().modes().frequencies[0]
}

/// Closed isolas of a level that lie wholly above `omega`.
fn closed_isolas_above(scenario: &Scenario, amplitude: u32, omega: f64) -> Vec<&Branch> {
    let isolas = scenario.level(amplitude).isolas();
    isolas.filter(|isola| isola.is_closed() && isola.frequency_range().0 > omega).collect()
}

#[test]
fn frictionless_at_60_has_a_main_branch_and_a_closed_isola() {
    let level = FRICTIONLESS.level(60);
    let peak = level.main().peak();
    assert_close(peak.amplitude(), 1.049e-3, 0.01, "main peak, m");
    assert_close(peak.omega(), 2533.5, 0.01, "main peak, rad/s");
    assert_close(highest_contact(level.main()), 2534.6, 0.005, "end of the main branch, rad/s");

    let id = found_from_window(level, 2623.0);
    assert_eq!(id.kind, BranchKind::Isola, "the window round 2623 rad/s led to {id}");
    let isola = level.branch(id).unwrap();
    assert_eq!(isola.outcome, Outcome::Closed);
    let (low, high) = isola.frequency_range();
    assert_close(low, 2545.0, 0.005, "low end of the isola, rad/s");
    assert_close(high, 2701.0, 0.005, "high end of the isola, rad/s");
    assert_close(isola.peak().amplitude(), 1.45e-3, 0.02, "top of the isola, m");
    let bottom = isola.points.iter().map(|p| p.amplitude()).fold(f64::INFINITY, f64::min);
    assert_close(bottom, 1.01e-3, 0.02, "bottom of the isola, m");
}

#[test]
fn frictionless_at_140_has_merged() {
    let level = FRICTIONLESS.level(140);
    assert_close(highest_contact(level.main()), 2728.0, 0.005, "end of the main branch, rad/s");
    assert_eq!(found_from_window(level, 2623.0), BranchId::MAIN);
    for isola in level.isolas() {
        assert!(isola.frequency_range().0 > 2728.0, "an isola is left at {:?} rad/s", isola.frequency_range());
    }
}

#[test]
fn frictionless_has_isolas_beyond_the_torsion() {
    for amplitude in [60, 100] {
        let found = closed_isolas_above(&FRICTIONLESS, amplitude, 2728.0);
        assert!(!found.is_empty(), "A = {amplitude}");
    }
}

#[test]
fn friction_backward_stiffens_and_merges_between_20_and_60() {
    for amplitude in [20, 60] {
        let peak = BACKWARD.level(amplitude).main().peak().omega();
        assert!(peak > eigenfrequency(&BACKWARD), "A = {amplitude}: the main branch peaks at {peak} rad/s");
    }
    let level = BACKWARD.level(20);
    let end = highest_contact(level.main());
    let isolas = closed_isolas_above(&BACKWARD, 20, end);
    assert_eq!(isolas.len(), 1, "isolas above {end} rad/s at A = 20");
    let (low, high) = isolas[0].frequency_range();

    let level = BACKWARD.level(60);
    assert!(highest_contact(level.main()) > high, "the main branch ends before the isola did");
    assert_eq!(found_from_window(level, 0.5 * (low + high)), BranchId::MAIN);
    assert!(closed_isolas_above(&BACKWARD, 60, low).is_empty());
}

#[test]
fn friction_forward_softens() {
    for amplitude in [20, 60] {
        let peak = FORWARD.level(amplitude).main().peak().omega();
        assert!(peak < eigenfrequency(&FORWARD), "A = {amplitude}: the main branch peaks at {peak} rad/s");
    }
}

#[test]
fn tuned_at_60_ends_where_the_second_bending_is_excited() {
    let level = TUNED.level(60);
    let end = highest_contact(level.main());
    assert_close(end, 2120.0, 0.005, "end of the main branch, rad/s");
    assert_close(end, TUNED.model().modes().frequencies[1] / 3.0, 0.005, "end of the main branch against ω_2/3");
    assert!(!closed_isolas_above(&TUNED, 60, end).is_empty());
}

#[test]
fn main_branches_start_and_end_without_contact() {
    for scenario in [&FRICTIONLESS, &BACKWARD, &FORWARD, &TUNED] {
        for amplitude in [20, 60] {
            let main = scenario.level(amplitude).main();
            let what = format!("{}, A = {amplitude}", scenario.name);
            assert_eq!(main.outcome, Outcome::Open(Stop::Start, Stop::FrequencyBound), "{what}");
            for end in [main.points.first().unwrap(), main.points.last().unwrap()] {
                assert!(!touches(end) && end.amplitude() < GAP, "{what}: contact at {} rad/s", end.omega());
            }
            assert!(main.points.iter().any(touches), "{what}: no contact at all");
            assert!(
                main.special(SpecialKind::Fold).count() >= 2,
                "{what}: a hardening or softening peak has two folds"
            );
        }
    }
}
