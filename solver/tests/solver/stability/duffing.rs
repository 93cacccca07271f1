//! Duffing's oscillator: folds and stable range, Liouville's formula.

use super::common::{assert_close, main_branch};
use solver::stability::along::{AlongSettings, along};
use solver::stability::bifurcation::BifurcationKind;
use solver::stability::multipliers::Verdict;
use solver::{Model, Settings, SpecialKind};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// x'' + c x' + x + x³ = A cos ωt.
const C: f64 = 0.05;

pub fn duffing() -> Model {
    Model::builder("Duffing")
        .mass([[1.0]])
        .stiffness([[1.0]])
        .damping_ratio(0.5 * C)
        .force("x1", 1.0)
        .element("spring", super::models::spring(1.0), ["x1"])
        .build()
        .unwrap()
}

#[test]
fn a_duffing_oscillator_is_unstable_between_its_folds_and_only_there() {
    let model = duffing();
    let mut settings = Settings::default();
    settings.harmonics.count = 20;
    (settings.frequency.min, settings.frequency.max) = (Some(0.6), Some(3.0));
    let branch = main_branch(&model, &settings, 0.2);
    let folds: Vec<usize> = branch.special.iter().filter(|s| s.kind == SpecialKind::Fold).map(|s| s.index).collect();
    assert_eq!(folds.len(), 2);
    let mut settings = AlongSettings::default();
    settings.polish.marching.min_steps_per_period = Some(2048);
    let found = along(&model, &settings, &branch, &mut |_| ControlFlow::Continue(()));

    let kinds: Vec<_> = found.bifurcations.iter().map(|b| b.kind).collect();
    assert_eq!(kinds, [BifurcationKind::Fold; 2]);
    for (bifurcation, &fold) in found.bifurcations.iter().zip(&folds) {
        // Twenty harmonics are the exact response; the marcher errs by (ωh)²/24 of the frequency and what the cubic adds.
        assert_close(bifurcation.omega, branch.points[fold].omega(), 2e-5, "marched fold, rad/s");
        assert_close(bifurcation.amplitudes[0], branch.points[fold].amplitude(), 1e-3, "its amplitude, m");
    }
    for point in &found.points {
        let polished = point.polish.polished.as_ref().unwrap_or_else(|| panic!("no orbit at point {}", point.index));
        let between = folds[0] < point.index && point.index < folds[1];
        let at_fold = folds.iter().any(|&fold| point.index.abs_diff(fold) <= 1);
        let expected = if between { Verdict::Unstable } else { Verdict::Stable };
        assert!(point.polish.verdict == expected || at_fold, "point {}: {:?}", point.index, polished.multipliers);
        assert!(polished.distance < 1e-3 && polished.impacts == 0.0, "{}", polished.distance);
        // Liouville: volumes in the phase plane shrink by e^{−cT}.
        let product = polished
            .multipliers
            .iter()
            .fold((1.0, 0.0), |(re, im), mu| (re * mu.re - im * mu.im, re * mu.im + im * mu.re));
        assert_close(product.0, (-C * TAU / polished.orbit.omega).exp(), 1e-5, "determinant");
    }
}
