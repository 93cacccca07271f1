//! Masses before stops: an elastic one with known bifurcations, and a rigid one whose impacts the marcher cannot follow.

use super::common::{assert_close, main_branch};
use super::models::{penalty, stop};
use num_complex::Complex64;
use solver::stability::along::{AlongSettings, along};
use solver::stability::bifurcation::{Bifurcation, BifurcationKind};
use solver::stability::multipliers::Verdict;
use solver::stability::polish::Reason;
use solver::{Model, Settings};
use std::ops::ControlFlow;

/// Two masses of 1 kg, the first before a spring of 100 N/m beyond 1 m, the second one forced.
pub fn two_masses() -> Model {
    Model::builder("two masses")
        .mass([[1.0, 0.0], [0.0, 1.0]])
        .stiffness([[1.0, -1.0], [-1.0, 2.0]])
        .rayleigh(0.0, 0.03)
        .force("x2", 1.0)
        .element("stop", penalty(100.0, 1.0), ["x1"])
        .monitor("x1")
        .build()
        .unwrap()
}

#[test]
pub fn two_masses_double_their_period_and_turn_quasi_periodic_where_direct_integration_says() {
    let model = two_masses();
    let mut settings = Settings::default();
    settings.harmonics.count = 30;
    (settings.frequency.min, settings.frequency.max) = (Some(0.4), Some(1.0));
    let branch = main_branch(&model, &settings, 0.1);
    let settings = AlongSettings { points: 60, ..AlongSettings::default() };
    let found = along(&model, &settings, &branch, &mut |_| ControlFlow::Continue(()));
    let kinds: Vec<_> = found.bifurcations.iter().map(|b| (b.kind, b.outside)).collect();
    // Behind a touch of an elastic stop multipliers change like a square root; here the crossing itself is found.
    let expected = [
        (BifurcationKind::NeimarkSacker, [0, 2]),
        (BifurcationKind::NeimarkSacker, [2, 0]),
        (BifurcationKind::PeriodDoubling, [0, 1]),
        (BifurcationKind::PeriodDoubling, [1, 0]),
        (BifurcationKind::Fold, [0, 1]),
        (BifurcationKind::Grazing, [1, 0]),
    ];
    assert_eq!(kinds, expected);
    assert_eq!(found.unresolved, []);
    for grazing in [0, 5].map(|i| &found.bifurcations[i]) {
        // The linear motion just reaches the stop: (K + 0.03 iωK − ω²) x = (0, 0.1).
        let (w, c) = (grazing.omega, Complex64::new(1.0, 0.03 * grazing.omega));
        let x1 = 0.1 * c / ((c - w * w) * (2.0 * c - w * w) - c * c);
        assert_close(x1.norm(), 1.0, 1e-3, "linear x1 where it grazes, m");
    }
    let nearest = |kind, omega: f64| -> &Bifurcation {
        let all = found.bifurcations.iter().filter(|b| b.kind == kind);
        let apart = |b: &&Bifurcation| (b.omega - omega).abs();
        all.min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or_else(|| panic!("no {kind}"))
    };
    // By an independent program: events of the piecewise linear motion located, saltation exact.
    for (kind, omega, amplitude) in [
        (BifurcationKind::PeriodDoubling, 0.738_783_0, 1.071_457),
        (BifurcationKind::NeimarkSacker, 0.618_606_9, 1.017_412),
    ] {
        let found = nearest(kind, omega);
        assert_close(found.omega, omega, 2e-5, "frequency, rad/s");
        let mut marching = found.orbit.marching(&model).unwrap();
        let mut largest = f64::NEG_INFINITY;
        for _ in 0..marching.steps_per_period() {
            largest = largest.max(marching.displacements()[0]);
            marching.step().unwrap();
        }
        assert_close(largest, amplitude, 1e-3, "largest x1, m");
    }
}

#[test]
fn impacts_of_a_single_mass_are_not_comparable() {
    let model = Model::builder("impact oscillator")
        .mass([[1.0]])
        .stiffness([[1.0]])
        .damping_ratio(0.05)
        .force("x1", 1.0)
        .element("stop", stop(1.0), ["x1"])
        .build()
        .unwrap();
    let mut settings = Settings::default();
    settings.harmonics.count = 20;
    let branch = main_branch(&model, &settings, 0.3);
    let found = along(&model, &AlongSettings::default(), &branch, &mut |_| ControlFlow::Continue(()));
    let (mut touching, mut free) = (0, 0);
    for point in &found.points {
        let share = branch.points[point.index].contact()[0];
        if share == 0.0 {
            assert_eq!(point.polish.verdict, Verdict::Stable, "point {}", point.index);
            free += 1;
        } else if share > 0.05 {
            assert_eq!(point.polish.verdict, Verdict::NotComparable, "point {}: {:?}", point.index, point.polish);
            assert_eq!(point.polish.reason, Some(Reason::Impacts));
            touching += 1;
        } else {
            // What is left of the impacts' energy is next to nothing, not what a push makes of them.
            assert_ne!(point.polish.verdict, Verdict::Stable, "point {}", point.index);
        }
    }
    println!("{touching} touching, {free} free");
    assert!(touching > 5 && free > 3, "{touching} {free}");
    // Where it only just touches, impacts cost next to nothing, and the orbit is left at once.
    let kinds: Vec<_> = found.bifurcations.iter().map(|b| b.kind).collect();
    assert_eq!(kinds, [BifurcationKind::Grazing]);
    let w = found.bifurcations[0].omega;
    assert_close(0.3 / (1.0 - w * w).hypot(0.1 * w), 1.0, 1e-3, "linear x1 where it grazes, m");
}
