//! Two oscillators alike: where their motion in phase turns back, and where motions out of phase branch off.

use super::common::{assert_close, fundamental, main_branch};
use super::models::spring;
use solver::formulation::harmonics::evaluate;
use solver::stability::along::{AlongSettings, along};
use solver::stability::bifurcation::BifurcationKind;
use solver::{Model, Settings, SpecialKind};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// Both x'' + c x' + k x + x³ = A cos ωt, with k = 1 in phase and k = 0.9 out of phase.
const C: f64 = 0.05;
const OUT_OF_PHASE: f64 = 0.9;

/// (1 − μ₁)(1 − μ₂) of small deviations δ out of phase from a motion x in phase, δ'' + c δ' + (k + 3x²) δ = 0, by the classical
/// Runge–Kutta method.
fn distance_from_one(series: &[f64], omega: f64) -> f64 {
    let stiffness = |t: f64| OUT_OF_PHASE + 3.0 * evaluate(series, omega * t)[0].powi(2);
    let columns = fundamental(C, stiffness, TAU / omega, 2000);
    1.0 - columns[0][0] - columns[1][1] + columns[0][0] * columns[1][1] - columns[0][1] * columns[1][0]
}

#[test]
fn branch_points_of_a_symmetric_structure_are_no_folds() {
    let coupling = 0.5 * (1.0 - OUT_OF_PHASE);
    let model = Model::builder("two alike")
        .mass([[1.0, 0.0], [0.0, 1.0]])
        .stiffness([[1.0 - coupling, coupling], [coupling, 1.0 - coupling]])
        .rayleigh(C, 0.0)
        .force_shape([1.0, 1.0])
        .element("spring 1", spring(1.0), ["x1"])
        .element("spring 2", spring(1.0), ["x2"])
        .monitor("x1")
        .build()
        .unwrap();
    let mut settings = Settings::default();
    settings.harmonics.count = 12;
    (settings.frequency.min, settings.frequency.max) = (Some(0.7), Some(2.5));
    let branch = main_branch(&model, &settings, 0.1);
    let mut settings = AlongSettings::default();
    settings.polish.marching.min_steps_per_period = Some(2048);
    let found = along(&model, &settings, &branch, &mut |_| ControlFlow::Continue(()));

    // Where the balance says that deviations out of phase pass 1, and where it turns back.
    let at = |index: usize| (branch.points[index].omega(), branch.points[index].amplitude());
    let distance = |i: usize| distance_from_one(&branch.points[i].state.displacement(&model, 0), at(i).0);
    let distances: Vec<f64> = (0..branch.points.len()).map(distance).collect();
    let crossings = (1..distances.len()).filter(|&i| distances[i - 1] * distances[i] < 0.0).map(|i| i - 1);
    let crossings: Vec<usize> = crossings.collect();
    let special = |kind: SpecialKind| branch.special.iter().filter(move |special| special.kind == kind);
    let of = |kind: SpecialKind| special(kind).map(|special| special.index);
    assert_eq!(of(SpecialKind::BranchPoint).collect::<Vec<_>>(), crossings);
    let mut expected: Vec<(usize, BifurcationKind)> =
        crossings.into_iter().map(|i| (i, BifurcationKind::BranchPoint)).collect();
    expected.extend(of(SpecialKind::Fold).map(|index| (index, BifurcationKind::Fold)));
    expected.sort_unstable();
    let kinds: Vec<_> = found.bifurcations.iter().map(|b| b.kind).collect();
    assert_eq!(kinds, expected.iter().map(|(_, kind)| *kind).collect::<Vec<_>>());
    assert_eq!(kinds.iter().filter(|&&kind| kind == BifurcationKind::BranchPoint).count(), 2);
    assert_eq!(found.unresolved, []);
    for (found, (index, _)) in found.bifurcations.iter().zip(&expected) {
        let (omega, amplitude) = at(*index);
        // The marcher errs by (ωh)²/24 of the frequency, 4e-7, and what the cubic adds; points are 1e-3 m apart.
        assert_close(found.omega, omega, 5e-6, "frequency, rad/s");
        assert_close(found.amplitudes[0], amplitude, 1e-3, "amplitude, m");
    }
}
