//! Main branches that pass points at which asymmetric motions branch off.

use crate::support::hill::hill;
use crate::support::study::{Kind, Study, of_kind, with_harmonics};
use solver::laws::{PolynomialSpring, Term};
use solver::response::branch::{BranchPoint, SpecialKind};
use solver::response::modes::Backbones;
use solver::response::name::BranchId;
use solver::response::task::{SwitchPlace, Task, TaskResult};
use solver::response::trace::{Given, execute};
use solver::{Branch, Forced, Model, SearchRange};
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

/// Points over a period.
const SAMPLES: usize = 8000;
/// Damping ratio of both modes of two equal masses.
const RATIO: f64 = 0.01;

/// Two equal masses pushed alike. Their motions against each other obey an equation of their own, about the main branch, and cross it where
/// that has a solution that repeats itself: by Runge–Kutta integration. Each step lands so near to one of these that the Jacobian of the last
/// iteration is of the other side.
#[test]
fn branch_points_are_told_from_one_side_and_the_other() {
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 1.0 }] };
    let model = Model::builder("two alike")
        .mass([[1.0, 0.0], [0.0, 1.0]])
        .stiffness([[1.02, -0.02], [-0.02, 1.02]])
        .damping_ratio(RATIO)
        .force_shape(vec![1.0; 2])
        .monitor(0)
        .element("a", spring.clone(), [vec![(0, 1.0)]])
        .element("b", spring, [vec![(1, 1.0)]])
        .build()
        .unwrap();
    let study = Study::of_modes(model, with_harmonics(5));
    let level = study.level(0.02);
    let [main] = &of_kind(&level, Kind::Main)[..] else { panic!("{level:#?}") };
    let frequency = study.model.modes().frequencies[1];
    let characteristic = |point: &BranchPoint| {
        let motion: Vec<f64> = point.state.over_period(&study.model, 0, SAMPLES).iter().map(|at| at[0]).collect();
        let stiffness = |x: f64| frequency.powi(2) + 3.0 * x * x;
        hill(&motion, point.omega(), SAMPLES, 2.0 * RATIO * frequency, stiffness, 1.0)
    };
    let values: Vec<f64> = main.branch.points.iter().map(characteristic).collect();
    let zeros = values.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
    let told: Vec<f64> = main.branch.special(SpecialKind::BranchPoint).map(characteristic).collect();
    let told_at: Vec<f64> = main.branch.special(SpecialKind::BranchPoint).map(BranchPoint::omega).collect();
    assert!(zeros == 2 && told.len() == 2 && told.iter().all(|value| value.abs() < 1e-5), "{zeros} zeros: {told:?}");
    // What crosses there passes both, and is one closed curve.
    let reach = SearchRange::new(&study.settings, &study.backbones[0]).unwrap();
    let mut forced = Forced::new(&study.model, &study.settings, reach, main.branch.forcing);
    let known = [(BranchId::MAIN, &main.branch)];
    for point in 0..2 {
        let task = Task::Switch(SwitchPlace { branch: BranchId::MAIN, point });
        let given = Given { known: &known, ..Given::default() };
        let found = execute(&mut forced, &task, &given, &mut |_| ControlFlow::Continue(()));
        let Some(TaskResult::Branch(branch)) = found else { panic!("{found:?}") };
        assert!(branch.is_closed() && branch.kind == Kind::Branched, "{:?}, {}", branch.kind, branch.outcome);
        let (low, high) = branch.frequency_range();
        assert!(
            told_at.iter().all(|omega| (low * (1.0 - 1e-6)..=high).contains(omega)),
            "{low} to {high}: {told_at:?}"
        );
    }
}
