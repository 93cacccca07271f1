//! The same structure in other units has the same responses.

use crate::support::study::{Kind, Study, of_kind, with_harmonics};
use solver::Model;
use solver::laws::{PenaltySpring, PolynomialSpring, Term};
use solver::response::branch::Outcome;

/// Two masses, one before a stop and one on a cubic spring, in lengths of `unit` m. Stiffnesses are the same in all of them.
fn masses(unit: f64) -> Model {
    let cubic = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 1.0 / (unit * unit) }] };
    Model::builder("masses")
        .mass([[2.0, 0.0], [0.0, 3.0]])
        .stiffness([[40.0, -20.0], [-20.0, 35.0]])
        .damping_ratio(0.002)
        .force("x2", unit)
        .element("stop", PenaltySpring { stiffness: 300.0, gap: 2.0 * unit }, ["x1"])
        .element("cubic", cubic, ["x2"])
        .build()
        .unwrap()
}

/// In micrometres and less forces are small beside stiffnesses, which are transformed together with them.
#[test]
fn lengths_of_a_millionth() {
    let told = |unit: f64| {
        let level = Study::of_modes(masses(unit), with_harmonics(10)).level(1.0);
        let mains = of_kind(&level, Kind::Main);
        let [main] = &mains[..] else { panic!("unit {unit}: {} main branches", mains.len()) };
        let Outcome::Open(first, last) = main.branch.outcome else { panic!("{:?}", main.branch.outcome) };
        assert!(!main.branch.outcome.is_unfinished(), "unit {unit}: {first} to {last}");
        let peak = main.branch.peak();
        (peak.omega(), peak.amplitude() / unit)
    };
    let (omega, amplitude) = told(1.0);
    // By an independent balance: 3.6149 at 3.99972 rad/s.
    assert!((omega - 3.99972).abs() < 1e-5 && (amplitude - 3.6149).abs() < 1e-4, "{amplitude} at {omega}");
    for unit in [2f64.powi(-10), 2f64.powi(-20), 1e-7] {
        let (other, size) = told(unit);
        assert!((size / amplitude - 1.0).abs() < 1e-8, "unit {unit}: {size} {amplitude}");
        assert!((other / omega - 1.0).abs() < 1e-6, "unit {unit}: {other} {omega}");
    }
}
