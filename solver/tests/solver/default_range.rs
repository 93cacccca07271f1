//! Where nobody gives bounds, the main branch passes what the force resonates with: its peak is the largest of the linear response,
//! whatever mode the force drives and on whatever harmonic.

use crate::support::balance::Matrices;
use crate::support::linear::{maximum, response};
use crate::support::study::{Study, main_peak, with_harmonics};
use proptest::prelude::*;
use solver::Model;
use solver::laws::{PenaltySpring, PolynomialSpring, Term};
use solver::response::forced::SearchRange;

const RATIO: f64 = 5e-3;

/// Two masses between springs, the second one before a stop that is never touched.
fn chain(masses: [f64; 2], springs: [f64; 3], shape: [f64; 2], harmonic: usize) -> Model {
    let [left, between, right] = springs;
    Model::builder("chain")
        .mass([[masses[0], 0.0], [0.0, masses[1]]])
        .stiffness([[left + between, -between], [-between, between + right]])
        .damping_ratio(RATIO)
        .force_shape(shape)
        .harmonic(harmonic)
        .element("stop", PenaltySpring { stiffness: 10.0, gap: 1e6 }, ["x2"])
        .monitor("x2")
        .build()
        .unwrap()
}

/// Frequency of the response and amplitude at the largest peak of the linear response.
fn largest(model: &Model) -> (f64, f64) {
    let (matrices, m) = (Matrices::of(model), model.forcing().harmonic as f64);
    let at = |omega: f64| response(&matrices, &model.forcing().shape, m * omega)[model.monitors()[0]].norm();
    let peaks = model.modes().frequencies.iter().map(|omega| maximum(omega / m, 4.0 * RATIO * omega / m, at));
    peaks.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap()
}

fn check(model: Model) {
    let (omega, peak) = largest(&model);
    let study = Study::of_modes(model, with_harmonics(3));
    let found = main_peak(&study.level(1.0));
    assert!((found.1 / peak - 1.0).abs() < 1e-4 && (found.0 / omega - 1.0).abs() < RATIO, "{found:?}, {omega}, {peak}");
}

/// The second mode's frequency is ten times the first one's, which the force does not drive at all.
#[test]
fn the_one_mode_that_is_driven() {
    for harmonic in [1, 2] {
        let model = chain([1.0, 1.0], [1.0, 0.0, 100.0], [0.0, 1.0], harmonic);
        assert_eq!(model.driven(), [1]);
        assert_eq!(model.primary_mode(), Some(1));
        check(model);
    }
}

/// A spring that softens and then hardens: the lower bound hangs on the lowest frequency of free motions, which lies between points.
#[test]
fn where_a_backbone_turns() {
    let terms = [(3, -1.0), (5, 1.0)].map(|(power, coefficient)| Term { power, coefficient }).to_vec();
    let model = Model::builder("mass")
        .mass([[1.0]])
        .stiffness([[1.0]])
        .damping_ratio(RATIO)
        .force("x1", 1.0)
        .element("spring", PolynomialSpring { terms }, ["x1"])
        .build()
        .unwrap();
    let low = |largest_step: f64| {
        let mut settings = with_harmonics(7);
        settings.continuation.max_step = largest_step;
        let study = Study::new(model.clone(), settings);
        SearchRange::new(&settings, &study.backbones[0]).unwrap().frequency.0
    };
    let finest = low(0.01);
    assert!(finest < 0.8, "{finest}: it does turn");
    for step in [0.05, 0.1, 0.2] {
        assert!((low(step) / finest - 1.0).abs() < 1e-6, "{step}: {} {finest}", low(step));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn the_largest_peak_of_all(
        masses in prop::array::uniform2(0.5..2.0f64),
        springs in prop::array::uniform3(0.5..4.0f64),
        shape in prop::array::uniform2(-1.0..1.0f64),
        harmonic in 1..4_usize,
    ) {
        check(chain(masses, springs, shape, harmonic));
    }
}
