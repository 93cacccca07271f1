//! What is a solution holds when it is checked again, what is none does not, and checking costs next to nothing.

use solver::response::columns;
use solver::response::forced::{Forced, SearchRange};
use solver::response::recheck::{Recheck, Refutation};
use solver::response::seeds::Landing;
use solver::{Backbone, Branch, BranchPoint, Model, Quantity, Settings, SpecialKind, files};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

const FORCING: f64 = 60.0;

fn load(model: &str) -> Model {
    files::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(model)).unwrap()
}

fn quiet(_: &BranchPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Main branch of the rotor blade, with friction, and the time that it took.
fn traced(model: &Model, settings: &Settings) -> (Branch, Duration) {
    let backbone = Backbone::compute(model, settings).unwrap();
    let reach = SearchRange::new(settings, &backbone).unwrap();
    let began = Instant::now();
    let branch = Forced::new(model, settings, reach, FORCING)
        .main_branch(solver::response::branch::Side::Below, &mut quiet)
        .unwrap();
    (branch, began.elapsed())
}

#[test]
fn a_branch_holds_and_what_was_changed_does_not() {
    let (model, settings) = (load("rotor67"), Settings::default());
    let (branch, computing) = traced(&model, &settings);
    let check = |branch: &Branch| Recheck::new(&model, &settings, 7).branch(branch, FORCING);
    // Every point, by different draws.
    for draw in 0..200 {
        assert_eq!(Recheck::new(&model, &settings, draw).branch(&branch, FORCING), Ok(()));
    }
    let fastest = (0..5).map(|_| {
        let began = Instant::now();
        check(&branch).unwrap();
        began.elapsed()
    });
    let checking = fastest.min().unwrap();
    assert!(checking < computing / 100, "{checking:?} to check what took {computing:?}");

    let changed = |change: &dyn Fn(&mut Branch)| {
        let mut other = branch.clone();
        change(&mut other);
        check(&other).expect_err("something else than was computed")
    };
    let peak = branch.peak_index();
    // By one part in ten thousand, an unknown and what follows from it.
    let pressed = branch.points[peak].state.arguments.iter().position(|a| a.abs() > 1.0).unwrap();
    let argument = changed(&|branch| branch.points[peak].state.arguments[pressed] *= 1.0 + 1e-4);
    assert!(matches!(argument, Refutation::Residual { point, .. } if point == peak), "{argument:?}");
    let modal = changed(&|branch| branch.points[peak].state.modal[1] *= 1.0 + 1e-4);
    assert!(matches!(modal, Refutation::Residual { point, .. } if point == peak), "{modal:?}");
    let largest = branch.points[0].state.modal.iter().fold(0.0f64, |most, y| most.max(y.abs()));
    let following = changed(&|branch| *branch.points[0].state.modal.last_mut().unwrap() += 1e-4 * largest);
    assert!(matches!(following, Refutation::Following { point: 0, .. }), "{following:?}");
    let omega = changed(&|branch| branch.points[peak].state.omega *= 1.0 + 1e-6);
    assert!(matches!(omega, Refutation::Residual { point, .. } if point == peak), "{omega:?}");
    // A larger forcing that is said to be the one asked for.
    let forcing = changed(&|branch| branch.points.iter_mut().for_each(|point| point.state.forcing = 999.0));
    assert_eq!(forcing, Refutation::Forcing { point: 0, forcing: 999.0, expected: FORCING });
    let decay = changed(&|branch| branch.points[3].state.decay = 1.0);
    assert_eq!(decay, Refutation::Motion { point: 3 });
    // Amplitudes that the motions do not have.
    let place = columns::of_points().position(|column| column.name == "amplitude").unwrap();
    let scaled = |branch: &mut Branch, point: usize, factor: f64| {
        let count = columns::of_points().count();
        let values = (0..count).map(|i| branch.points[point].values.get(i).map(<[f64]>::to_vec));
        let mut values: Vec<Option<Vec<f64>>> = values.collect();
        values[place].as_mut().unwrap()[0] *= factor;
        branch.points[point].values = columns::Row::new(values);
    };
    let higher = changed(&|branch| scaled(branch, peak, 1.001));
    assert_eq!(higher, Refutation::Column { column: "amplitude", point: peak });
    assert_eq!(changed(&|branch| scaled(branch, 5, f64::NAN)), Refutation::NotFinite { column: "amplitude", point: 5 });
    assert_eq!(changed(&|branch| scaled(branch, 5, 1e9)), Refutation::Special { point: peak, kind: "peak" });
    let fold = changed(&|branch| {
        let start = branch.special.iter_mut().find(|special| special.kind == SpecialKind::Fold).unwrap();
        start.index = 2;
    });
    assert_eq!(fold, Refutation::Special { point: 2, kind: "fold" });
    assert_eq!(changed(&|branch| branch.points.clear()), Refutation::Empty);
}

#[test]
fn landings_hold_and_what_is_near_them_does_not() {
    let (model, settings) = (load("rotor67"), Settings::default());
    let (branch, _) = traced(&model, &settings);
    let landing = |i: usize| Landing { state: branch.points[i].state.clone(), distance: 0.0 };
    let mut landings: Vec<Landing> = (0..4).map(landing).collect();
    let recheck = Recheck::new(&model, &settings, 1);
    assert_eq!(recheck.landings(&landings, FORCING), Ok(()));
    assert!(matches!(recheck.landings(&landings, 50.0), Err(Refutation::Forcing { point: 0, .. })));
    landings[2].state = branch.points[2].state.interpolate(&branch.points[4].state, 0.4);
    assert!(matches!(recheck.landings(&landings, FORCING), Err(Refutation::Residual { point: 2, .. })));
    assert_eq!(recheck.landings(&[], FORCING), Err(Refutation::Empty));
}

#[test]
fn points_of_a_fold_curve_are_folds() {
    let (model, settings) = (load("nltva"), Settings::default());
    let backbone = Backbone::compute(&model, &settings).unwrap();
    let reach = SearchRange::new(&settings, &backbone).unwrap();
    let mut forced = Forced::new(&model, &settings, reach, 0.15);
    let branch = forced.main_branch(solver::response::branch::Side::Below, &mut quiet).unwrap();
    let fold = branch.special(SpecialKind::Fold).next().unwrap();
    let curve = forced.extrema(Quantity::Frequency).unwrap().curve(&fold.state, &mut quiet).unwrap();
    for draw in 0..100 {
        assert_eq!(Recheck::new(&model, &settings, draw).curve(&curve), Ok(()));
    }
    // A forced response that is no fold.
    let mut other = curve.clone();
    other.points[0] = branch.points[branch.points.len() / 4].clone();
    let refuted = Recheck::new(&model, &settings, 0).curve(&other);
    assert!(matches!(refuted, Err(Refutation::Residual { point: 0, .. })), "{refuted:?}");
}
