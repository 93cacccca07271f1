//! The account of every window, and branches that are what they claim to be.

use super::common::{AMPLITUDES, BACKWARD, FORWARD, FRICTIONLESS, Scenario, TUNED};
use solver::response::backbone::Backbone;
use solver::response::branch::{Branch, Outcome, SpecialKind, Stop};
use solver::response::level::{BranchId, Level, SeedOutcome};
use solver::response::seeds::LandingMethod;
use solver::response::windows::windows;
use solver::settings::Settings;

/// Number of windows of the level, and of those that led nowhere.
fn check_windows(level: &Level, backbone: &Backbone, what: &str) -> (usize, usize) {
    let predicted = windows(backbone, level.forcing);
    let accounted: Vec<_> = level.windows.iter().map(|account| account.window).collect();
    assert_eq!(accounted, predicted, "{what}: every window once, in the order of the backbone");
    let mut named: Vec<BranchId> = Vec::new();
    for account in &level.windows {
        // The balance is an estimate.
        let about = account.window.about();
        for (id, branch) in level.branches().filter(|(id, _)| account.branches().contains(id)) {
            let range = branch.frequency_range();
            let overlaps = range.0 <= *about.end() && *about.start() <= range.1;
            assert!(overlaps, "{what}: {id:?} at {range:?} rad/s found from {about:?} rad/s");
        }
        for seed in &account.seeds {
            match seed.outcome {
                SeedOutcome::Found(id) => {
                    assert!(level.branch(id).is_some(), "{what}: there is no {id}");
                    named.push(id);
                }
                SeedOutcome::Passing(id, distance) => {
                    assert!(id.is_main() && distance < 0.3, "{what}: {id} passes by at {distance}");
                }
                SeedOutcome::NotLanded(reason) => assert!(!reason.to_string().is_empty(), "{what}: no reason"),
                SeedOutcome::NotTraced(reason) => assert!(!reason.to_string().is_empty(), "{what}: no reason"),
                SeedOutcome::OutOfBounds => panic!("{what}: the default bounds hold the whole backbone"),
                SeedOutcome::Attached => panic!("{what}: contact has no symmetry"),
                SeedOutcome::Landed(_) => panic!("{what}: what was landed on is a branch or not"),
                SeedOutcome::OnCurve(_) | SeedOutcome::NotFollowed(_) | SeedOutcome::NoFold => {
                    panic!("{what}: a seed is no fold")
                }
                SeedOutcome::Verified(_) | SeedOutcome::Disturbed(_) | SeedOutcome::Marched(_) => {
                    panic!("{what}: a seed is no branch")
                }
            }
        }
    }
    for (id, _) in level.branches().filter(|(id, _)| !id.is_main()) {
        assert!(named.contains(&id), "{what}: no window led to {id}");
    }
    (level.windows.len(), level.windows.iter().filter(|account| account.branches().is_empty()).count())
}

fn check_branch(branch: &Branch, what: &str) {
    match branch.outcome {
        Outcome::Closed => {}
        Outcome::Open(first, last) => {
            for end in [first, last] {
                assert!(!matches!(end, Stop::Closed | Stop::Cancelled), "{what}: {end}");
                assert!(!end.to_string().is_empty());
            }
        }
    }
    for point in &branch.points {
        assert!(point.residual() <= 1e-8, "{what}: residual {} at {}", point.residual(), point.omega());
        assert_eq!(point.state.forcing, branch.forcing, "{what}");
        assert_eq!(point.state.decay, 0.0, "{what}");
    }
    assert_eq!(branch.special(SpecialKind::Start).count(), 1, "{what}");
    assert_eq!(branch.special(SpecialKind::Peak).count(), 1, "{what}");
    assert!(branch.special.iter().all(|s| s.index < branch.points.len()), "{what}");
}

/// Range and peak of two branches agree to 1e-6: the same curve traced twice.
fn coincide(a: &Branch, b: &Branch) -> bool {
    let close = |x: f64, y: f64| (x - y).abs() <= 1e-6 * y.abs();
    let ((a_low, a_high), (b_low, b_high)) = (a.frequency_range(), b.frequency_range());
    close(a_low, b_low) && close(a_high, b_high) && close(a.peak().amplitude(), b.peak().amplitude())
}

fn check(scenario: &Scenario) {
    let (mut total, mut empty) = (0, 0);
    for amplitude in AMPLITUDES {
        let level = scenario.level(amplitude);
        let what = format!("{}, A = {amplitude}", scenario.name);
        let (windows, lost) = check_windows(level, scenario.backbone(), &what);
        total += windows;
        empty += lost;
        let branches: Vec<_> = level.branches().collect();
        for (i, &(id, branch)) in branches.iter().enumerate() {
            check_branch(branch, &format!("{what}, {id:?}"));
            for &(other, known) in &branches[..i] {
                assert!(!coincide(branch, known), "{what}: {id:?} is {other:?} again");
            }
        }
    }
    assert!(10 * empty <= total, "{}: nothing found from {empty} of {total} windows", scenario.name);
}

#[test]
fn frictionless() {
    check(&FRICTIONLESS);
}

#[test]
fn friction_backward() {
    check(&BACKWARD);
}

#[test]
fn friction_forward() {
    check(&FORWARD);
}

#[test]
fn tuned() {
    check(&TUNED);
}

#[test]
fn every_seed_lands_with_the_full_forcing() {
    for scenario in [&FRICTIONLESS, &BACKWARD] {
        for amplitude in AMPLITUDES {
            let level = scenario.level(amplitude);
            for seed in level.windows.iter().flat_map(|account| &account.seeds) {
                let has_landed =
                    seed.method == LandingMethod::FullForcing && matches!(seed.outcome, SeedOutcome::Found(_));
                assert!(has_landed, "{}, A = {amplitude}: {seed:?}", scenario.name);
            }
        }
    }
}

#[test]
fn the_peak_is_the_highest_point() {
    for scenario in [&FRICTIONLESS, &BACKWARD, &FORWARD, &TUNED] {
        for amplitude in AMPLITUDES {
            for (id, branch) in scenario.level(amplitude).branches() {
                let peaks: Vec<_> = branch.special(SpecialKind::Peak).map(|p| p.amplitude()).collect();
                assert_eq!(peaks, [branch.peak().amplitude()], "{}, A = {amplitude}, {id:?}", scenario.name);
            }
        }
    }
}

#[test]
fn the_same_level_twice_is_identical() {
    let backbone = Backbone::compute(BACKWARD.model(), &Settings::default()).unwrap();
    assert!(&backbone == BACKWARD.backbone(), "the backbone differs");
    assert!(&BACKWARD.compute_level(20) == BACKWARD.level(20), "the level differs");
}
