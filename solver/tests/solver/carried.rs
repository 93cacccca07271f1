//! Open branches, carried over the forcing amplitude at fixed frequency: no fold leads from one level to another.

use solver::response::branch::{Branch, BranchKind, BranchPoint, SpecialKind};
use solver::response::critical::{CriticalCurve, crossed};
use solver::response::recheck::{Recheck, Refutation};
use solver::response::task::{BranchEnd, BranchId, CarryPlace, CrossingPlace, SeedOutcome, Task, TaskResult};
use solver::response::trace::{Given, execute};
use solver::structure::laws::{PolynomialSpring, Term};
use solver::{Forced, Model, SearchRange, Settings, State};
use std::ops::ControlFlow;

/// Natural frequency about the second well, squared: f'(3) of f(x) = x (x − 1)(x − 3).
const SQUARED: f64 = 6.0;
const DAMPING: f64 = 0.6;

/// A mass in two wells, at 0 and at 3 m. Small motions in the second one are those of a linear oscillator, without a fold.
fn two_wells() -> Model {
    let terms = vec![Term { power: 2, coefficient: -4.0 }, Term { power: 3, coefficient: 1.0 }];
    Model::builder("two wells")
        .mass([[1.0]])
        .stiffness([[3.0]])
        .damping_ratio(0.5 * DAMPING / 3.0f64.sqrt())
        .force("x1", 1.0)
        .element("spring", PolynomialSpring { terms }, ["x1"])
        .build()
        .unwrap()
}

fn quiet(_: &BranchPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn forced<'m>(model: &'m Model, settings: &Settings, forcing: f64) -> Forced<'m> {
    let reach = SearchRange { frequency: (1.0, 4.0), amplitude: 10.0, natural: None, forcing: Some((0.01, 0.2)) };
    Forced::new(model, settings, reach, forcing)
}

/// The branch of the motions in the second well.
fn in_second_well(forced: &mut Forced<'_>) -> Branch {
    let harmonics = forced.settings().harmonics.count;
    let mut modal = vec![0.0; 2 * harmonics + 1];
    modal[0] = 3.0;
    let arguments = forced.modal().open_arguments(&modal);
    let rest = State { harmonics, omega: 2.0, decay: 0.0, forcing: forced.forcing(), arguments, modal };
    let state = forced.converge(&rest).unwrap();
    forced.branch_through(&state, &mut quiet).unwrap()
}

fn carry(forced: &mut Forced<'_>, branch: &Branch, end: BranchEnd, curves: &[(usize, &CriticalCurve)]) -> TaskResult {
    let id = BranchId::new(BranchKind::Open, 0);
    let given = Given { known: &[(id, branch)], curves, ..Given::default() };
    execute(forced, &Task::Carry(CarryPlace { branch: id, end }), &given, &mut quiet).unwrap()
}

#[test]
fn what_is_carried_leads_to_the_open_branch_of_every_level() {
    let (model, settings) = (two_wells(), Settings::default());
    let mut at_first = forced(&model, &settings, 0.02);
    let branch = in_second_well(&mut at_first);
    assert_eq!((branch.kind, branch.special(SpecialKind::Fold).count()), (BranchKind::Open, 0));
    let curves = [BranchEnd::First, BranchEnd::Last].map(|end| match carry(&mut at_first, &branch, end, &[]) {
        TaskResult::Curve(curve) => curve,
        other => panic!("{other:?}"),
    });
    for curve in &curves {
        assert!(curve.quantity.is_none() && curve.events.is_empty());
        let (low, high) = curve.forcing_range();
        assert!((low / 0.01 - 1.0).abs() < 1e-9 && (high / 0.2 - 1.0).abs() < 1e-9, "{low} to {high}");
        for draw in 0..20 {
            assert_eq!(Recheck::new(&model, &settings, draw).curve(curve), Ok(()));
        }
        // About the well a linear oscillator, and so far from its resonance nearly as much at ten times the forcing.
        let omega = curve.points[0].omega();
        let compliance = (SQUARED - omega * omega).hypot(DAMPING * omega).recip();
        let lowest = curve.points.iter().min_by(|a, b| a.state.forcing.total_cmp(&b.state.forcing)).unwrap();
        let first = lowest.state.modal[1].hypot(lowest.state.modal[2]);
        assert!((first / (compliance * 0.01) - 1.0).abs() < 1e-3, "{first} at {omega}");
    }
    let [low, high] = [&curves[0], &curves[1]].map(|curve| curve.points[0].omega());
    assert!((low.min(high) - 1.003).abs() < 1e-12 && (low.max(high) - 3.997).abs() < 1e-12, "{low}, {high}");

    // At another level it is met where the curve crosses it, and is on the same curve.
    for level in [0.012, 0.05, 0.15] {
        let mut there = forced(&model, &settings, level);
        let amplitudes: Vec<f64> = curves[0].forcing().collect();
        let segment = crossed(&amplitudes, level).next().unwrap();
        let task = Task::Crossing(CrossingPlace { curve: 0, segment });
        let given = Given { curves: &[(0, &curves[0])], ..Given::default() };
        let TaskResult::Branch(found) = execute(&mut there, &task, &given, &mut quiet).unwrap() else {
            panic!("no branch at {level}")
        };
        assert_eq!(found.kind, BranchKind::Open);
        let largest = found.points.iter().map(|point| point.amplitude()).fold(0.0, f64::max);
        let direct = in_second_well(&mut there);
        let expected = direct.points.iter().map(|point| point.amplitude()).fold(0.0, f64::max);
        assert!(largest > 3.0 && (largest / expected - 1.0).abs() < 1e-6, "{largest} and {expected} at {level}");
        let known: Vec<(usize, &CriticalCurve)> = curves.iter().enumerate().collect();
        for end in [BranchEnd::First, BranchEnd::Last] {
            let ends = [found.points.first(), found.points.last()].map(|end| end.unwrap().omega());
            let is_low = (ends[0] < ends[1]) == (end == BranchEnd::First);
            let own = known.iter().position(|(_, curve)| (curve.points[0].omega() < 2.0) == is_low).unwrap();
            // Whatever else is known: nothing at another frequency is the same.
            for known in [&known[..], &[known[1], known[0]]] {
                let again = carry(&mut there, &found, end, known);
                assert_eq!(again, TaskResult::Nothing(SeedOutcome::OnCurve(own)), "{end:?}");
            }
        }
    }

    // What somebody else says of such a curve is checked.
    let mut other = curves[0].clone();
    other.points[3].state.omega *= 1.0 + 1e-9;
    let refuted = Recheck::new(&model, &settings, 1).curve(&other);
    assert!(matches!(refuted, Err(Refutation::Whole(_))), "{refuted:?}");
}
