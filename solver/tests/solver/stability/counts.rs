//! Every change of the number of multipliers outside is a bifurcation of the right kind or said to be unresolved, and nothing
//! else is one.

use super::common::{assert_close, main_branch};
use super::models::{chain, jenkins, penalty, stop};
use solver::formulation::harmonics::evaluate;
use solver::laws::{LawKind, PolynomialSpring, Term};
use solver::response::branch::SpecialKind;
use solver::stability::along::{AlongSettings, along};
use solver::stability::bifurcation::{BifurcationKind, Obstacle};
use solver::stability::multipliers::Outside;
use solver::stability::polish::{Around, PolishSettings, Reason, polish};
use solver::structure::ModelData;
use solver::{Branch, BranchStability, End, Marching, MarchingSettings, Model, Settings, Verdict, files};
use std::ops::ControlFlow;
use std::path::Path;

/// Three masses that know hardly of each other, the first one before a stop; damping ratio of the other two.
fn three_masses(ratio: f64, stop: LawKind) -> Model {
    Model::builder("three masses")
        .mass([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        .stiffness([[1.0, -0.01, 0.0], [-0.01, 3.1, -0.01], [0.0, -0.01, 7.3]])
        .damping_ratios(vec![0.05, ratio, ratio])
        .force("x1", 1.0)
        .element("stop", stop, ["x1"])
        .build()
        .unwrap()
}

fn branch(model: &Model, min: f64, max: f64, forcing: f64) -> Branch {
    let mut settings = Settings::default();
    settings.harmonics.count = 20;
    (settings.frequency.min, settings.frequency.max) = (Some(min), Some(max));
    main_branch(model, &settings, forcing)
}

fn all_along(model: &Model, branch: &Branch) -> BranchStability {
    along(model, &AlongSettings::default(), branch, &mut |_| ControlFlow::Continue(()))
}

/// Between points with a clear verdict the number of multipliers outside changes by what is reported and what is unresolved.
#[track_caller]
fn assert_accounted(found: &BranchStability) {
    let count = |point: &solver::stability::along::PolishedPoint| {
        let polished = point.polish.polished.as_ref()?;
        let is_clear = matches!(point.polish.verdict, Verdict::Stable | Verdict::Unstable);
        is_clear.then(|| (point.index, Outside::of(&polished.multipliers, polished.margin).count() as isize))
    };
    let counts: Vec<(usize, isize)> = found.points.iter().filter_map(count).collect();
    for pair in counts.windows(2) {
        let [(first, before), (last, after)] = [pair[0], pair[1]];
        let reported = found.bifurcations.iter().map(|b| (b.after, b.outside));
        let steps = reported.chain(found.unresolved.iter().map(|u| (u.first, u.outside)));
        let within = steps.filter(|(at, _)| (first..last).contains(at));
        let sum: isize = within.map(|(_, [a, b])| b as isize - a as isize).sum();
        assert_eq!(after - before, sum, "{first} to {last}: {:?} {:?}", found.bifurcations, found.unresolved);
    }
}

#[test]
fn modes_with_little_damping_do_not_hide_what_crosses() {
    use BifurcationKind::{Fold, PeriodDoubling};
    let mut omegas = Vec::new();
    for ratio in [0.05, 1e-3] {
        let model = three_masses(ratio, penalty(100.0, 1.0));
        let branch = branch(&model, 0.5, 1.5, 0.3);
        let found = all_along(&model, &branch);
        let kinds: Vec<_> = found.bifurcations.iter().map(|b| (b.kind, b.outside)).collect();
        // The last one is right behind the touch of the stop: a fold, since multipliers do not jump at an elastic one.
        let expected = [(PeriodDoubling, [0, 1]), (PeriodDoubling, [1, 0]), (Fold, [0, 1]), (Fold, [1, 0])];
        assert_eq!(kinds, expected, "damping ratio {ratio}");
        let turns: Vec<f64> = branch.special(SpecialKind::Fold).map(|fold| fold.state.omega).collect();
        assert_eq!(turns.len(), 2, "{turns:?}");
        let folds = &found.bifurcations[2..];
        folds.iter().zip(&turns).for_each(|(fold, omega)| assert_close(fold.omega, *omega, 1e-3, "fold, rad/s"));
        assert_eq!((found.end, found.unresolved.len()), (End::Complete, 0), "{:?}", found.unresolved);
        assert!(found.bifurcations.iter().all(|b| b.width < 1.0), "{:?}", found.bifurcations);
        assert_accounted(&found);
        omegas.push(found.bifurcations.iter().map(|b| b.omega).collect::<Vec<f64>>());
    }
    // The other two masses take a ten-thousandth of the first one's motion.
    omegas[0].iter().zip(&omegas[1]).for_each(|(a, b)| assert_close(*a, *b, 1e-4, "bifurcation, rad/s"));
}

#[test]
fn grazing_of_a_rigid_stop_is_grazing_whatever_else_the_structure_does() {
    for ratio in [0.05, 1e-3] {
        let model = three_masses(ratio, stop(1.0));
        let branch = branch(&model, 0.5, 1.5, 0.3);
        let found = all_along(&model, &branch);
        let kinds: Vec<_> = found.bifurcations.iter().map(|b| b.kind).collect();
        assert_eq!(kinds, [BifurcationKind::Grazing], "damping ratio {ratio}");
        // The linear oscillator comes down to 1 m: 0.3 = |1 − ω² + 0.1 iω|.
        assert_close(found.bifurcations[0].omega, 1.130_8, 1e-3, "grazing, rad/s");
        // Multipliers of an orbit that grazes tend to infinity.
        assert!(found.bifurcations[0].multiplier.modulus() > 10.0, "{:?}", found.bifurcations);
        assert_accounted(&found);
        // At one point well in contact Newton's method comes to no orbit: what the balance's motion loses is no reason then.
        let deep = found.points.iter().filter(|point| branch.points[point.index].contact()[0] > 0.06);
        let reasons: Vec<_> = deep.map(|point| (point.polish.verdict, point.polish.reason)).collect();
        let failed = (Verdict::NoOrbitNearby, Some(Reason::NotConverged));
        assert!(ratio > 1e-3 || reasons.contains(&failed), "{reasons:?}");
    }
}

#[test]
fn a_linear_oscillator_is_stable_however_little_it_is_damped() {
    for (ratio, verdict) in [(1e-3, Verdict::Stable), (1e-4, Verdict::Stable), (0.0, Verdict::Marginal)] {
        let model = Model::builder("linear")
            .mass([[1.0]])
            .stiffness([[1.0]])
            .damping_ratio(ratio)
            .force("x1", 1.0)
            .build()
            .unwrap();
        let found = all_along(&model, &branch(&model, 0.6, 0.95, 1e-2));
        let verdicts: Vec<_> = found.points.iter().map(|point| point.polish.verdict).collect();
        assert!(verdicts.iter().all(|&known| known == verdict), "damping ratio {ratio}: {verdicts:?}");
        assert_eq!((found.bifurcations, found.unresolved), (vec![], vec![]), "damping ratio {ratio}");
    }
}

#[test]
fn what_a_budget_leaves_is_said() {
    let model = three_masses(1e-3, penalty(100.0, 1.0));
    let branch = branch(&model, 0.5, 1.5, 0.3);
    let first = AlongSettings::default().points + branch.special.len();
    let settings = AlongSettings { most: first + 2, ..AlongSettings::default() };
    let found = along(&model, &settings, &branch, &mut |_| ControlFlow::Continue(()));
    assert_eq!(found.end, End::Budget);
    assert!(!found.unresolved.is_empty() && found.unresolved.iter().all(|u| u.reason == Obstacle::Budget));
    assert_accounted(&found);

    let mut count = 0;
    let found = along(&model, &AlongSettings::default(), &branch, &mut |_| {
        count += 1;
        if count == 12 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!((found.end, found.points.len()), (End::Cancelled, 12));
    assert!(found.bifurcations.is_empty() && found.unresolved.iter().all(|u| u.reason == Obstacle::Cancelled));
    assert_accounted(&found);
}

#[test]
fn a_slider_that_never_slips_is_a_spring() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/friction_mass");
    let friction = files::load(&folder).unwrap();
    // Below its limit the Jenkins element is a spring of 1 N/m, and takes no part in the memory of the motion.
    let mut data = ModelData::from(friction.clone());
    data.elements[0].law =
        LawKind::PolynomialSpring(PolynomialSpring { terms: vec![Term { power: 1, coefficient: 1.0 }] });
    let spring = Model::try_from(data).unwrap();
    let branch = branch(&friction, 0.5, 3.0, 1e-4);
    let found = all_along(&friction, &branch);
    let same = all_along(&spring, &branch);
    assert_eq!((&found.bifurcations, &found.unresolved), (&vec![], &vec![]));
    for (point, other) in found.points.iter().zip(&same.points) {
        assert_eq!((point.polish.verdict, other.polish.verdict), (Verdict::Stable, Verdict::Stable), "{}", point.index);
        let [stuck, free] = [point, other].map(|point| point.polish.polished.as_ref().unwrap());
        assert_eq!(stuck.multipliers.len(), free.multipliers.len());
        // The grids of both have other numbers of steps, if any: multipliers err by the squares of the steps.
        for (a, b) in stuck.multipliers.iter().zip(&free.multipliers) {
            assert!((a.modulus() - b.modulus()).abs() < 1e-6, "{:?} {:?}", stuck.multipliers, free.multipliers);
        }
        assert!((stuck.distance - free.distance).abs() < 1e-6, "{} {}", stuck.distance, free.distance);
    }
}

#[test]
fn a_slider_starts_with_the_force_that_the_balance_gives_it() {
    let model = files::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/friction_mass")).unwrap();
    let branch = branch(&model, 0.5, 3.0, 1e-4);
    for point in &branch.points {
        let marching = Marching::new(&model, &MarchingSettings::default(), point.state.forcing, point.omega()).unwrap();
        let state = marching.state_of(&point.state);
        // 1 N/m times x1 one step before.
        let before = -std::f64::consts::TAU / marching.steps_per_period() as f64;
        let x1 = evaluate(&point.state.displacement(&model, 0), before)[0];
        let force = state[2 * model.size()];
        assert!((force - x1).abs() < 1e-12, "{force} {x1}");
    }
}

#[test]
fn margins_cover_what_the_grid_of_time_steps_leaves_uncertain() {
    for law in [jenkins(800.0, 2.0), penalty(2000.0, 0.01)] {
        let model = chain(vec![(law, vec![vec![(0, 1.0), (1, -1.0)]])]);
        let branch = branch(&model, 12.0, 30.0, 4.0);
        let at = branch.points.iter().position(|point| point == branch.peak()).unwrap();
        for index in [at, at + 6] {
            let on = |steps: usize| {
                let mut settings = PolishSettings::default();
                settings.marching.min_steps_per_period = Some(steps);
                polish(&model, &settings, &branch.points[index].state, Around::default()).polished.unwrap()
            };
            let found: Vec<_> = (0..8).map(|i| on(1200 + 8 * i)).collect();
            let largest = |sign: f64| found.iter().map(|p| sign * p.multipliers[0].modulus()).fold(f64::MIN, f64::max);
            let spread = largest(1.0) + largest(-1.0);
            println!("{spread:e} of {:e}", found[0].margin);
            assert!(found.iter().all(|p| spread < p.margin), "{spread:e} {:e}", found[0].margin);
        }
    }
}
