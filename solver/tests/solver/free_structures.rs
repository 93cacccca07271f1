//! Structures that nothing but their laws holds in place.

use crate::support::study::{Study, main_peak, with_harmonics};
use solver::Model;
use solver::laws::{PolynomialSpring, Term};

/// Two masses, the first one with a hardening spring to the ground, whose linear part is in K or, for the same structure with a
/// rigid-body mode, in its law.
fn masses(is_in_law: bool) -> Model {
    let linear = 0.5;
    let grounded = if is_in_law { 0.0 } else { linear };
    let mut terms = vec![Term { power: 3, coefficient: 0.5 }];
    if is_in_law {
        terms.push(Term { power: 1, coefficient: linear });
    }
    Model::builder("masses")
        .mass([[1.0, 0.0], [0.0, 1.0]])
        .stiffness([[1.0 + grounded, -1.0], [-1.0, 1.0]])
        .damping_matrix([[0.02, 0.0], [0.0, 0.02]])
        .dofs(["near", "far"])
        .force("near", 1.0)
        .element("spring", PolynomialSpring { terms }, [[("near", 1.0)]])
        .build()
        .unwrap()
}

#[test]
fn what_a_law_holds_responds_as_what_the_stiffness_holds() {
    let peaks = [false, true].map(|is_in_law| {
        let mut settings = with_harmonics(5);
        settings.frequency.min = Some(0.3);
        settings.frequency.max = Some(2.2);
        let model = masses(is_in_law);
        // The lowest mode that deforms the structure, of its own accord.
        assert_eq!(settings.tracked(&model), usize::from(is_in_law));
        main_peak(&Study::new(model, settings).level(0.05))
    });
    let [(omega, amplitude), (other_omega, other_amplitude)] = peaks;
    assert!((amplitude / other_amplitude - 1.0).abs() < 1e-8, "{peaks:?}");
    assert!((omega / other_omega - 1.0).abs() < 1e-5, "{peaks:?}");
}
