//! Where the special points of branches are.

use crate::support::balance::Matrices;
use crate::support::fold_curves::{Study, folds};
use crate::support::linear::{maximum, response};
use crate::support::study::{Kind, Study as Levels, of_kind, shipped, with_harmonics};
use solver::laws::{Contact, Friction, PenaltySpring};
use solver::response::folds::Extent;
use solver::{Model, Settings};

/// Next to where a stop begins to act the frequency turns in a corner, nearly, and a parabola through points beside it may have its vertex at
/// one of them by chance: each fold of a branch is where the equations of folds have it.
#[test]
fn folds_of_branches_solve_the_equations_of_folds() {
    let spring = PenaltySpring { stiffness: 877.59, gap: 0.001951 };
    let model = Model::builder("stop")
        .mass([[2.665_790_781_895_031_7, 0.0], [0.0, 1.562_871_585_398_059_7]])
        .stiffness([[2097.645226690038, -776.192427869435], [-776.192427869435, 1759.4373925397726]])
        .damping_ratio(0.0011037)
        .force(1, 1.0)
        .monitor(1)
        .element("stop", spring, [vec![(1, 1.0)]])
        .build()
        .unwrap();
    let mut settings = Settings::default();
    settings.harmonics.count = 7;
    let study = Study::new(model, settings);
    let main = study.main(0.02625);
    let extent = Extent { forcing: (2e-3, 0.05), frequency: (10.0, 100.0), points: 5000 };
    let mut critical = study.folds(extent);
    let folds = folds(&main);
    assert_eq!(folds.len(), 2);
    for fold in folds {
        let located = critical.locate(&fold).unwrap();
        assert!((fold.omega / located.omega - 1.0).abs() < 1e-8, "{} {}", fold.omega, located.omega);
    }
}

/// A linear structure has closed forms of its peaks: of the first monitored dof at both resonances, of the others at the larger one.
#[test]
fn every_resonance_and_every_monitored_dof_has_its_peak() {
    const RATIO: f64 = 5e-3;
    let model = Model::builder("chain")
        .mass([[1.0, 0.0], [0.0, 0.2]])
        .stiffness([[3.0, -1.0], [-1.0, 1.2]])
        .damping_ratio(RATIO)
        .force("x1", 1.0)
        .element("stop", PenaltySpring { stiffness: 10.0, gap: 1e6 }, ["x2"])
        .monitor("x1")
        .monitor("x2")
        .build()
        .unwrap();
    let matrices = Matrices::of(&model);
    let level = Levels::of_modes(model.clone(), with_harmonics(3)).level(1.0);
    let [main] = &of_kind(&level, Kind::Main)[..] else { panic!("{level:#?}") };
    for (mode, omega) in model.modes().frequencies.iter().enumerate() {
        for dof in 0..2 {
            let at = |omega: f64| response(&matrices, &model.forcing().shape, omega)[dof].norm();
            let (_, peak) = maximum(*omega, 4.0 * RATIO * omega, at);
            let near = main.branch.points.iter().filter(|point| (point.omega() / omega - 1.0).abs() < 2.0 * RATIO);
            let found = near.map(|point| point.amplitudes()[dof]).fold(0.0, f64::max);
            // Of the second dof, the larger one.
            if dof == 0 || mode == 0 {
                assert!((found / peak - 1.0).abs() < 1e-8, "mode {mode}, dof {dof}: {found} {peak}");
            }
        }
    }
}

/// Where contact begins a mass just reaches its stop in the linear response, which has a closed form, whatever the steps; where the branch
/// turns back it touches as well.
#[test]
fn contact_begins_where_the_linear_response_reaches_the_stop() {
    const RATIO: f64 = 0.01;
    const GAP: f64 = 2e-3;
    const FORCE: f64 = 1e-4;
    let model = Model::builder("mass")
        .mass([[1.0]])
        .stiffness([[1.0]])
        .damping_ratio(RATIO)
        .force("x1", 1.0)
        .element("wall", Contact { gap: GAP, epsilon: 2.0, friction: None }, ["x1"])
        .build()
        .unwrap();
    // (1 − ω²)² + (2 ζ ω)² = (A / c)²
    let half = 1.0 - 2.0 * RATIO * RATIO;
    let reached = (half - (half * half - 1.0 + (FORCE / GAP).powi(2)).sqrt()).sqrt();
    for factor in [0.3, 0.5, 2.0] {
        let mut settings = with_harmonics(8);
        settings.continuation.max_step *= factor;
        let level = Levels::new(model.clone(), settings).level(FORCE);
        let [main] = &of_kind(&level, Kind::Main)[..] else { panic!("{level:#?}") };
        let (low, high) = main.branch.certificate.contact_omega.unwrap();
        assert!((low / reached - 1.0).abs() < 1e-8, "{low} {reached}");
        let turn = folds(&main.branch).iter().map(|fold| fold.omega).fold(0.0, f64::max);
        assert_eq!(high, turn);
    }
}

/// Half-way of a long step into contact Newton's method may fail: the place where it begins is found from nearer points.
#[test]
fn contact_begins_at_one_place_however_long_the_step_into_it_is() {
    let low = |factor: f64| {
        let mut settings = with_harmonics(10);
        settings.continuation.initial_step *= factor;
        let level = Levels::new(shipped("cantilever_stop", &[]), settings).level(0.015);
        let [main] = &of_kind(&level, Kind::Main)[..] else { panic!("{level:#?}") };
        main.branch.certificate.contact_omega.unwrap().0
    };
    let [one, half, double] = [1.0, 0.5, 2.0].map(low);
    assert!((half / one - 1.0).abs() < 1e-8 && (double / one - 1.0).abs() < 1e-8, "{one} {half} {double}");
}

/// A tip on a wide circle slides on; on one hardly wider than its motion it turns round while it presses.
#[test]
fn sliding_that_turns_round_is_known() {
    let slowest = |radius: f64| {
        let friction = Some(Friction { coefficient: 0.1, radius, sense: 1.0 });
        let model = Model::builder("tip")
            .mass([[1.0, 0.0], [0.0, 1.0]])
            .stiffness([[1.1, -0.3], [-0.3, 1.0]])
            .damping_ratio(0.01)
            .force("x1", 1.0)
            .element(
                "tip",
                Contact { gap: 2e-3, epsilon: 2.0, friction },
                [vec![("x1", 1.0)], vec![("x2", 1.0)], vec![]],
            )
            .build()
            .unwrap();
        let level = Levels::new(model, with_harmonics(8)).level(1e-4);
        let [main] = &of_kind(&level, Kind::Main)[..] else { panic!("{level:#?}") };
        main.branch.certificate.slowest_sliding
    };
    assert!(slowest(1.0).is_some_and(|slowest| slowest > 0.9 && slowest < 1.0));
    let least = slowest(7e-4);
    assert!(least.is_some_and(|least| least < 0.0), "{least:?}");
}
