//! What is kept and told of the stability of a branch.

use super::common::main_branch;
use super::duffing::duffing;
use crate::support::study::{Kind, Study, of_kind, own, with_harmonics};
use solver::stability::bifurcation::BifurcationKind;
use solver::stability::recheck::{NoOrbit, recheck};
use solver::stability::shooting::Orbit;
use solver::stability::verification::{
    BifurcationPoint, MarchedOrbit, Verification, VerifiedPoint, verify, verify_with_orbits,
};
use solver::{Branch, End, Multiplier, Obstacle, Settings, SpecialKind, Stretch, Unresolved, Verdict};
use std::ops::ControlFlow;

fn branch() -> Branch {
    let mut settings = Settings::default();
    settings.harmonics.count = 20;
    (settings.frequency.min, settings.frequency.max) = (Some(0.6), Some(3.0));
    main_branch(&duffing(), &settings, 0.2)
}

fn verified(branch: &Branch, stretch: Stretch) -> Verification {
    verify(&duffing(), branch, stretch, &mut |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn every_point_of_a_branch_has_the_verdict_of_its_side_of_the_folds() {
    let branch = branch();
    let folds: Vec<usize> = branch.special.iter().filter(|s| s.kind == SpecialKind::Fold).map(|s| s.index).collect();
    let found = verified(&branch, Stretch::Whole);
    assert!(found.is_sound(1) && !found.is_sound(2));
    assert_eq!((found.count, found.end), (branch.points.len(), End::Complete));
    let at: Vec<(BifurcationKind, bool)> =
        found.bifurcations.iter().zip(&folds).map(|(b, &fold)| (b.kind, b.at.abs_diff(fold) <= 2)).collect();
    assert_eq!(at, [(BifurcationKind::Fold, true); 2]);
    let verdicts = found.verdicts();
    for (i, verdict) in verdicts.iter().enumerate() {
        let expected = if folds[0] < i && i < folds[1] { Verdict::Unstable } else { Verdict::Stable };
        let near = folds.iter().any(|fold| fold.abs_diff(i) <= 3);
        assert!(*verdict == Some(expected) || near, "point {i} of {}: {verdict:?}", verdicts.len());
    }
    let known = found.share(Verdict::Stable) + found.share(Verdict::Unstable);
    assert!(known > 0.9 && known <= 1.0, "{known}");
    assert!(found.moduli().iter().flatten().count() >= 8);
}

#[test]
fn around_a_peak_nothing_is_told_of_what_is_far_from_it() {
    let branch = branch();
    let found = verified(&branch, Stretch::Peak);
    let (peak, far) = (branch.peak_index(), found.spacing);
    assert!(found.points.iter().all(|point| point.index.abs_diff(peak) <= far), "{:?}", found.points);
    assert_eq!(found.at_peak().unwrap().verdict, Verdict::Stable);
    // Orbits are told of where the branch passes their frequency.
    let told = found.verdicts();
    assert!(told.iter().enumerate().all(|(i, verdict)| verdict.is_none() || i.abs_diff(peak) <= far + 3));
    assert!(told.iter().flatten().count() >= 2);
    assert!(found.bifurcations.iter().all(|change| change.at.abs_diff(peak) <= far + 3));
}

/// By marching every point with twice the time steps; a motion pushed by 1e-3 falls back.
#[test]
fn around_a_peak_more_points_are_looked_at_where_periods_are_cheap() {
    let mut settings = with_harmonics(20);
    (settings.frequency.min, settings.frequency.max) = (Some(0.2), Some(2.8));
    let study = Study::new(own("chain_stop"), settings);
    let level = study.level(0.2);
    let main = &of_kind(&level, Kind::Main)[0].branch;
    let found = verify(&study.model, main, Stretch::Peak, &mut |_| ControlFlow::Continue(())).unwrap();
    let apart = found.points.windows(2).map(|pair| pair[1].index - pair[0].index).max().unwrap();
    assert!(4 * apart <= found.spacing, "{apart} of {}", found.spacing);
    let verdicts = found.verdicts();
    let is_meant = |i: &usize| {
        let point = &main.points[*i];
        (0.5805..0.5850).contains(&point.omega()) && (7.2..8.4).contains(&point.amplitude())
    };
    let stable: Vec<usize> = (0..verdicts.len()).filter(is_meant).collect();
    assert!(
        stable.len() > 5 && stable.iter().all(|&i| verdicts[i] == Some(Verdict::Stable)),
        "{stable:?}: {verdicts:?}"
    );
}

#[test]
fn what_is_broken_off_tells_nothing() {
    let mut left = 3;
    let found = verify(&duffing(), &branch(), Stretch::Whole, &mut |_| {
        left -= 1;
        if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!((found, left), (None, 0));
}

fn point(index: usize, at: usize, verdict: Verdict) -> VerifiedPoint {
    let modulus = if verdict == Verdict::Stable { 0.5 } else { 2.0 };
    let orbit = MarchedOrbit {
        omega: 1.0,
        amplitudes: vec![1.0],
        distance: 0.0,
        multipliers: vec![Multiplier { re: modulus, im: 0.0 }],
        margin: 1e-3,
        impacts: 0.0,
    };
    VerifiedPoint { index, at, verdict, reason: None, orbit: Some(orbit) }
}

fn of(points: Vec<VerifiedPoint>) -> Verification {
    Verification {
        count: 20,
        is_closed: true,
        stretch: Stretch::Whole,
        spacing: 4,
        folds: Vec::new(),
        peak: 2,
        points,
        bifurcations: Vec::new(),
        unresolved: Vec::new(),
        end: End::Complete,
    }
}

/// One letter a point.
fn told(verification: &Verification) -> String {
    let letter = |verdict: Option<Verdict>| match verdict {
        Some(Verdict::Stable) => 's',
        Some(Verdict::Unstable) => 'u',
        Some(_) => '?',
        None => '.',
    };
    verification.verdicts().into_iter().map(letter).collect()
}

#[test]
fn neighbours_that_agree_tell_of_what_is_between_them() {
    use Verdict::{Stable, Unstable};
    // Around the end of a closed curve, not over gaps much wider than the spacing, not between different verdicts.
    let found = of(vec![
        point(2, 2, Stable),
        point(5, 5, Stable),
        point(8, 8, Unstable),
        point(15, 15, Unstable),
        point(18, 18, Stable),
    ]);
    assert_eq!(told(&found), "ssssss..u......u..ss");
    // What crosses between two that agree, or may, is not told of.
    let bifurcation = BifurcationPoint {
        kind: BifurcationKind::Fold,
        omega: 1.0,
        amplitudes: vec![1.0],
        after: 2,
        at: 3,
        multiplier: Multiplier { re: 1.0, im: 0.0 },
        outside: [0, 1],
    };
    let crossed = Verification { bifurcations: vec![bifurcation.clone()], ..found.clone() };
    assert_eq!(told(&crossed), "sss..s..u......u..ss");
    // What is unstable remains so while a multiplier is left outside.
    let of_unstable = of(vec![point(8, 8, Unstable), point(11, 11, Unstable)]);
    for (outside, expected) in [([1, 2], "uuuu"), ([1, 0], "u..u")] {
        let bifurcations = vec![BifurcationPoint { after: 9, at: 9, outside, ..bifurcation.clone() }];
        assert_eq!(told(&Verification { bifurcations, ..of_unstable.clone() })[8..12], *expected);
    }
    let unresolved = Unresolved { first: 18, last: 2, outside: [0, 1], reason: Obstacle::Budget };
    let crossed = Verification { unresolved: vec![unresolved], ..found };
    assert_eq!(told(&crossed), "..ssss..u......u..s.");
}

#[test]
fn orbits_are_told_of_at_their_own_frequency_and_not_where_they_disagree() {
    use Verdict::{Stable, Unstable};
    // The orbits near points 4 to 6 all have the frequency of point 9 or 10: beyond, nothing is known.
    let found = of(vec![
        point(2, 2, Unstable),
        point(4, 9, Unstable),
        point(5, 10, Unstable),
        point(6, 10, Stable),
        point(12, 12, Stable),
    ]);
    assert_eq!(told(&found), "..u......u..s.......");
    assert_eq!(found.moduli().iter().flatten().count(), 3);
}

#[test]
fn verifications_that_cannot_be_are_not_sound() {
    let sound = of(vec![point(2, 2, Verdict::Stable), point(5, 5, Verdict::Stable)]);
    assert!(sound.is_sound(1));
    let with = |change: &dyn Fn(&mut Verification)| {
        let mut changed = sound.clone();
        change(&mut changed);
        changed.is_sound(1)
    };
    assert!(!with(&|found| found.points.swap(0, 1)));
    assert!(!with(&|found| found.points[1].at = 20));
    assert!(!with(&|found| found.points[1].orbit = None));
    assert!(!with(&|found| found.points.clear()));
    assert!(!with(&|found| found.points[0].orbit.as_mut().unwrap().multipliers[0].im = f64::NAN));
    assert!(!with(&|found| found.unresolved.push(Unresolved {
        first: 1,
        last: 20,
        outside: [0, 1],
        reason: Obstacle::Budget
    })));
}

/// What is told of an orbit is told of by a period that anybody can march.
#[test]
fn what_is_told_of_orbits_is_checked_by_a_period() {
    let (model, branch) = (duffing(), branch());
    let quiet = &mut |_: &_| ControlFlow::Continue(());
    let (found, orbits) = verify_with_orbits(&model, &branch, Stretch::Whole, quiet).unwrap();
    let told: Vec<&VerifiedPoint> = found.points.iter().filter(|point| point.orbit.is_some()).collect();
    assert_eq!(told.len(), orbits.len());
    assert!(told.len() >= 8);
    for (point, orbit) in told.iter().zip(&orbits) {
        for with_tangent in [false, true] {
            assert_eq!(recheck(&model, orbit, point, with_tangent), Ok(()), "point {}", point.index);
        }
    }
    let (point, orbit) = (told[0], &orbits[0]);
    let differently = |change: fn(&mut VerifiedPoint)| {
        let mut point = point.clone();
        change(&mut point);
        recheck(&model, orbit, &point, true).unwrap_err()
    };
    let amplitude = differently(|point| point.orbit.as_mut().unwrap().amplitudes[0] *= 1.0 + 1e-4);
    assert!(matches!(amplitude, NoOrbit::Told { what: "amplitude", .. }), "{amplitude}");
    let multiplier = differently(|point| point.orbit.as_mut().unwrap().multipliers[0].re += 0.01);
    assert!(matches!(multiplier, NoOrbit::Told { what: "multiplier", .. }), "{multiplier}");
    let impacts = differently(|point| point.orbit.as_mut().unwrap().impacts = 0.01);
    assert!(matches!(impacts, NoOrbit::Told { .. }), "{impacts}");
    let verdict = differently(|point| point.verdict = Verdict::Unstable);
    assert!(matches!(verdict, NoOrbit::Verdict { own: Verdict::Stable, told: Verdict::Unstable }), "{verdict}");

    let elsewhere = |change: fn(&mut Orbit)| {
        let mut orbit = orbit.clone();
        change(&mut orbit);
        recheck(&model, &orbit, point, false).unwrap_err()
    };
    let open = elsewhere(|orbit| orbit.state[0] *= 1.0 + 1e-4);
    assert!(matches!(open, NoOrbit::Open(_)), "{open}");
    let detuned = elsewhere(|orbit| orbit.omega *= 1.0 + 1e-4);
    assert!(matches!(detuned, NoOrbit::Open(_)), "{detuned}");
    let rest = elsewhere(|orbit| orbit.state.fill(0.0));
    assert!(matches!(rest, NoOrbit::Open(_)), "{rest}");
    let short = elsewhere(|orbit| orbit.state.truncate(1));
    assert!(matches!(short, NoOrbit::Size { numbers: 1, expected: 2 }), "{short}");
    let coarse = elsewhere(|orbit| orbit.steps = 8);
    assert!(matches!(coarse, NoOrbit::Steps { steps: 8, .. }), "{coarse}");
}
