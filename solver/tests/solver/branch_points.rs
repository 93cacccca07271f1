//! Main branches that pass points at which asymmetric motions branch off.

use crate::support::study::{Kind, Study, of_kind, with_harmonics};
use solver::laws::{PolynomialSpring, Term};
use solver::response::modes::Backbones;
use solver::{Branch, Model};
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

/// A machine table whose absorber stiffens by a hundred times: rounding is a hundred times as large there as elsewhere, and beside branch
/// points every step is one of rounding along the curve that crosses.
#[test]
fn main_branches_pass_branch_points_of_a_stiffening_absorber() {
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 2e9 }] };
    let model = Model::builder("machine table")
        .dofs(["table", "absorber"])
        .mass([[85.0, 0.0], [0.0, 4.5]])
        .stiffness([[1.138e6, -5.1e4], [-5.1e4, 5.1e4]])
        .damping_matrix([[150.0, -55.0], [-55.0, 55.0]])
        .force("table", 1.0)
        .monitor("table")
        .element("spring", spring, [[("table", 1.0), ("absorber", -1.0)]])
        .build()
        .unwrap();
    let settings = with_harmonics(10);
    let quiet = &mut |_: &_| ControlFlow::Continue(());
    let backbones = Backbones::reaching(&model, &settings, 800.0, quiet, &AtomicBool::new(false)).unwrap().list;
    let study = Study { model, settings, backbones };
    // The peaks with half the steps, and with ten times the tolerance.
    for (forcing, peak) in [(200.0, 0.016_558), (400.0, 0.034_866), (799.0, 0.068_989)] {
        let level = study.level(forcing);
        let mains = of_kind(&level, Kind::Main);
        let [main] = mains[..] else { panic!("{} main branches at A = {forcing}", mains.len()) };
        assert!(!main.branch.outcome.is_unfinished(), "A = {forcing}: {}", main.branch.outcome);
        let amplitude = main.branch.peak().amplitude();
        assert!((amplitude / peak - 1.0).abs() < 1e-4, "A = {forcing}: {amplitude}");
        // Twice the harmonics change next to nothing.
        let doubled = |branch: &Branch| Some((branch.peak().amplitude(), branch.certificate.doubled?.amplitude));
        for (amplitude, doubled) in level.iter().filter_map(|listed| doubled(&listed.branch)) {
            assert!((doubled / amplitude - 1.0).abs() < 0.01, "A = {forcing}: {amplitude}, {doubled}");
        }
    }
}
