//! Branches that cross others at their branch points: of a ring of sectors, where these are the frequencies at which the equation of
//! motion linearised about the main branch has a solution that repeats itself, by Runge–Kutta integration.

use crate::support::fold_curves::all;
use crate::support::hill::hill;
use crate::support::ring::{COUPLING, CUBIC, DAMPING, LINEAR, driven_alike, quiet, reach, ring, within};
use solver::laws::{PolynomialSpring, Term};
use solver::response::branch::{BranchKind, Outcome, Side, Stop};
use solver::response::folds::{Critical, CriticalKind, Extent, Quantity};
use solver::response::name::BranchId;
use solver::response::recheck::Recheck;
use solver::response::task::{SeedOutcome, SwitchPlace, Task, TaskResult};
use solver::response::trace::{Given, execute};
use solver::{Backbone, Branch, Forced, Matrix, Model, SearchRange, SpecialKind, State};
use std::f64::consts::TAU;

const FORCING: f64 = 0.02;
const HARMONICS: usize = 5;
/// Points over a period.
const SAMPLES: usize = 4000;
/// Relative difference of frequencies: what 7 harmonics leave.
const CLOSE: f64 = 1e-5;

/// What the branch points of known branches lead to, until nothing new does, and how often they lead to what is known.
fn switch_all(forced: &mut Forced<'_>, found: &mut Vec<(BranchId, Branch)>) -> usize {
    let (mut next, mut again) = (0, 0);
    while let Some((id, branch)) = found.get(next) {
        let (id, count) = (*id, branch.special(SpecialKind::BranchPoint).count());
        for point in 0..count {
            let known: Vec<(BranchId, &Branch)> = found.iter().map(|(id, branch)| (*id, branch)).collect();
            let given = Given { known: &known, ..Given::default() };
            match execute(forced, &Task::Switch(SwitchPlace { branch: id, point }), &given, &mut quiet) {
                Some(TaskResult::Branch(branch)) => found.push((BranchId::new(branch.kind, found.len()), branch)),
                Some(TaskResult::Nothing(SeedOutcome::Found(_))) => again += 1,
                other => panic!("point {point} of {id}: {other:?}"),
            }
        }
        next += 1;
    }
    again
}

/// det(Φ − I) over a period, of motions in which opposite sectors move alike, about one in which two move against each other and the
/// others rest.
fn characteristic(forced: &Forced<'_>, state: &State) -> f64 {
    let motion = state.over_period(forced.model(), 0, 2 * SAMPLES);
    let h = TAU / state.omega / SAMPLES as f64;
    let rate = |u: [f64; 4], at: usize| {
        let slope = 3.0 * CUBIC * motion[at % motion.len()][0].powi(2);
        let driven = -DAMPING * u[2] - (LINEAR + slope) * u[0] - 2.0 * COUPLING * u[1];
        [u[2], u[3], driven, -DAMPING * u[3] - LINEAR * u[1] - 2.0 * COUPLING * u[0]]
    };
    let columns = [0, 1, 2, 3].map(|column| {
        let mut u = [0.0; 4];
        u[column] = 1.0;
        for at in (0..2 * SAMPLES).step_by(2) {
            let moved = |by: f64, r: [f64; 4]| [0, 1, 2, 3].map(|i| u[i] + by * r[i]);
            let r1 = rate(u, at);
            let r2 = rate(moved(0.5 * h, r1), at + 1);
            let r3 = rate(moved(0.5 * h, r2), at + 1);
            let r4 = rate(moved(h, r3), at + 2);
            u = [0, 1, 2, 3].map(|i| u[i] + h / 6.0 * (r1[i] + 2.0 * r2[i] + 2.0 * r3[i] + r4[i]));
        }
        u[column] -= 1.0;
        u
    });
    determinant(columns)
}

/// By elimination with pivots.
fn determinant(mut m: [[f64; 4]; 4]) -> f64 {
    let mut product = 1.0;
    for k in 0..4 {
        let pivot = (k..4).max_by(|&a, &b| m[a][k].abs().total_cmp(&m[b][k].abs())).unwrap();
        if pivot != k {
            m.swap(pivot, k);
            product = -product;
        }
        product *= m[k][k];
        for i in k + 1..4 {
            let share = m[i][k] / m[k][k];
            let row = m[k];
            m[i].iter_mut().zip(row).for_each(|(entry, pivot)| *entry -= share * pivot);
        }
    }
    product
}

#[test]
fn what_crosses_the_main_branch_of_a_ring_is_found() {
    let (model, settings) = (ring(), within(HARMONICS));
    let mut forced = Forced::new(&model, &settings, reach(), FORCING);
    let main = forced.main_branch(Side::Below, &mut quiet).unwrap();
    let crossed: Vec<State> = main.special(SpecialKind::BranchPoint).map(|point| point.state.clone()).collect();
    assert!(!crossed.is_empty());
    for state in &crossed {
        let beside = [1.0 - CLOSE, 1.0 + CLOSE].map(|share| {
            let near = State { omega: share * state.omega, ..state.clone() };
            let near = forced.converge(&near).unwrap();
            characteristic(&forced, &near)
        });
        assert!(beside[0] * beside[1] < 0.0, "{beside:?} beside {} rad/s", state.omega);
    }
    // Nor does it change elsewhere.
    let signs: Vec<bool> = main.points.iter().map(|point| characteristic(&forced, &point.state) > 0.0).collect();
    assert_eq!(signs.windows(2).filter(|pair| pair[0] != pair[1]).count(), crossed.len());

    let mut found = vec![(BranchId::new(BranchKind::Main, 0), main)];
    let again = switch_all(&mut forced, &mut found);
    for (id, branch) in &found {
        assert_eq!(Recheck::new(&model, &settings, 1).branch(branch, FORCING), Ok(()), "{id}");
    }
    let branched: Vec<&Branch> = found[1..].iter().map(|(_, branch)| branch).collect();
    assert!(!branched.is_empty() && again > 0);
    for branch in &branched {
        assert_eq!((branch.kind, branch.is_closed()), (BranchKind::Branched, true));
        // It is no motion of those that it crosses.
        let rests = |state: &State| state.over_period(&model, 1, 64).iter().all(|at| at[0].abs() < 1e-3);
        assert!(!rests(&branch.peak().state));
    }
    let crosses = |state: &State| {
        let nearest =
            |branch: &Branch| branch.points.iter().map(|p| forced.distance(&p.state, state)).fold(1.0, f64::min);
        branched.iter().any(|branch| nearest(branch) < 1e-2)
    };
    assert!(crossed.iter().all(crosses), "every branch point lies on one of them");
}

/// Where all sectors move alike, every deviation that does not obeys an equation of its own, and most of them have the same as another one:
/// there the determinant touches zero without changing its sign. What is told is true; of single modes all are told, of double ones those that
/// the steps come near enough to.
#[test]
fn branch_points_of_double_modes_are_told_where_they_are() {
    for (sectors, least) in [(3, 1), (4, 2), (6, 3)] {
        let model = driven_alike(sectors);
        let settings = within(HARMONICS);
        let mut forced = Forced::new(&model, &settings, reach(), FORCING);
        let main = forced.main_branch(Side::Below, &mut quiet).unwrap();
        let of_mode = |state: &State, mode: usize| {
            let motion: Vec<f64> = state.over_period(&model, 0, SAMPLES).iter().map(|at| at[0]).collect();
            let square = model.modes().frequencies[mode].powi(2);
            hill(&motion, state.omega, SAMPLES, DAMPING, |x| square + 3.0 * CUBIC * x * x, 1.0)
        };
        let found: Vec<State> = main.special(SpecialKind::BranchPoint).map(|point| point.state.clone()).collect();
        let has_zero = |forced: &mut Forced<'_>, state: &State, mode: usize| {
            let [below, above] = [1.0 - CLOSE, 1.0 + CLOSE].map(|share| {
                let near = State { omega: share * state.omega, ..state.clone() };
                of_mode(&forced.converge(&near).unwrap(), mode)
            });
            below * above < 0.0
        };
        let (mut singles, mut doubles) = (0, 0);
        for state in &found {
            let modes: Vec<usize> = (0..sectors - 1).filter(|&mode| has_zero(&mut forced, state, mode)).collect();
            match modes.len() {
                1 => singles += 1,
                2 => doubles += 1,
                _ => panic!("{sectors} sectors: {modes:?} at {} rad/s", state.omega),
            }
        }
        assert!(doubles >= least, "{sectors} sectors: {doubles}");
        // With an even number of sectors, neighbours against each other are a single mode, the lowest.
        let zeros = || {
            let values: Vec<f64> = main.points.iter().map(|point| of_mode(&point.state, 0)).collect();
            values.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count()
        };
        assert_eq!(singles, if sectors % 2 == 0 { zeros() } else { 0 });
    }
}

/// The folds of what branches off the motions in which both masses move alike end over the forcing where they fall upon branch points of
/// those, and are born nowhere.
#[test]
fn folds_of_what_branches_off_end_at_branch_points() {
    let (model, settings) = (driven_alike(2), within(HARMONICS));
    let mut forced = Forced::new(&model, &settings, reach(), FORCING);
    let main = forced.main_branch(Side::Below, &mut quiet).unwrap();
    let mut found = vec![(BranchId::new(BranchKind::Main, 0), main)];
    switch_all(&mut forced, &mut found);
    let extent = Extent { forcing: (0.1 * FORCING, 4.0 * FORCING), frequency: reach().frequency, points: 2000 };
    let mut critical = Critical::new(&model, &settings, Quantity::Frequency, extent).unwrap();
    let mut ends: Vec<State> = Vec::new();
    for fold in found[1..].iter().flat_map(|(_, branch)| branch.special(SpecialKind::Fold)) {
        let curve = critical.curve(&fold.state, &mut quiet).unwrap();
        let Outcome::Open(first, last) = curve.outcome else { panic!("closed") };
        for (stop, end) in [(first, curve.points.first()), (last, curve.points.last())] {
            match stop {
                Stop::Branching => ends.push(end.unwrap().state.clone()),
                stop => assert!(matches!(stop, Stop::ForcingBound | Stop::FrequencyBound), "{}", curve.outcome),
            }
        }
        assert!(all(&curve, CriticalKind::Unknown).is_empty());
    }
    assert!(ends.len() > 1);
    // A deviation in which the masses move against each other obeys an equation of its own.
    let square = model.modes().frequencies[0].powi(2);
    for state in &ends {
        let motion: Vec<f64> = state.over_period(&model, 0, SAMPLES).iter().map(|at| at[0]).collect();
        let [below, above] = [0.999, 1.001]
            .map(|share| hill(&motion, share * state.omega, SAMPLES, DAMPING, |x| square + 3.0 * CUBIC * x * x, 1.0));
        assert!(below * above < 0.0, "{below} and {above} beside {} rad/s at A = {}", state.omega, state.forcing);
    }
}

/// Four sectors driven alike with hardly any damping, so that a closed curve of motions of which only opposite ones are alike meets, next to
/// the tip of its resonance, the one that it branches off: within 1e-6 of the frequency.
#[test]
fn a_closed_curve_is_closed_from_wherever_it_is_followed() {
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: CUBIC }] };
    let coupling = |i: usize, j: usize| [1.04, -0.02, 0.0, -0.02][i.abs_diff(j)];
    let model = Model::builder("ring")
        .mass(Matrix::diagonal(&[1.0; 4]))
        .stiffness(Matrix::from_fn(4, 4, coupling))
        .damping_ratio(0.002)
        .force_shape(vec![1.0; 4])
        .monitor(0);
    let model = (0..4).fold(model, |model, i| model.element(format!("s{i}"), spring.clone(), [vec![(i, 1.0)]])).build();
    let (model, mut settings) = (model.unwrap(), within(HARMONICS));
    settings.frequency.max = Some(2.9);
    let reach = SearchRange { frequency: (0.9, 2.9), ..reach() };
    let mut forced = Forced::new(&model, &settings, reach, FORCING);
    let main = forced.main_branch(Side::Below, &mut quiet).unwrap();
    let mut known = vec![(BranchId::MAIN, main)];
    for _ in 0..2 {
        let (branch, parent) = (known.last().unwrap().0, known.len() - 1);
        let given: Vec<(BranchId, &Branch)> = known.iter().map(|(id, branch)| (*id, branch)).collect();
        let given = Given { known: &given, ..Given::default() };
        let task = Task::Switch(SwitchPlace { branch, point: 0 });
        let Some(TaskResult::Branch(branch)) = execute(&mut forced, &task, &given, &mut quiet) else { panic!() };
        known.push((BranchId::new(BranchKind::Branched, parent), branch));
    }
    let (_, closed) = known.pop().unwrap();
    let (low, high) = closed.frequency_range();
    assert!(closed.is_closed() && high / low > 1.5);
    // Within rounding of the crossing it may be the other curve that is followed on, which closes as well.
    for from in (0..closed.points.len()).step_by(8) {
        let again = forced.branch_through(&closed.points[from].state, &mut quiet).unwrap();
        assert!(again.is_closed(), "from point {from}: {}", again.outcome);
    }
}

/// Next to a branch point a branch may have a fold, as that of a nonlinear energy sink at 0.9706232 rad/s: beyond, it goes on to a larger peak,
/// 5.0332, which an arc-length continuation of another program has as well.
#[test]
fn a_fold_next_to_a_branch_point_is_no_end() {
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 0.5 }] };
    let model = Model::builder("energy sink")
        .mass(Matrix::diagonal(&[1.0, 0.06]))
        .stiffness(Matrix::diagonal(&[1.0, 0.0]))
        .damping_matrix([[0.012, -0.008], [-0.008, 0.008]])
        .force(0, 1.0)
        .force(1, 0.1)
        .element("sink", spring, [vec![(0, 1.0), (1, -1.0)]])
        .build()
        .unwrap();
    for max_step in [0.1, 0.05, 0.03] {
        let mut settings = within(7);
        (settings.frequency.min, settings.frequency.max) = (Some(0.6), Some(1.7));
        settings.continuation.max_step = max_step;
        let reach = SearchRange::new(&settings, &Backbone::compute(&model, &settings).unwrap()).unwrap();
        let mut forced = Forced::new(&model, &settings, reach, 0.03);
        let main = forced.main_branch(Side::Below, &mut quiet).unwrap();
        let point = main.special(SpecialKind::BranchPoint).position(|point| (point.omega() - 0.97291).abs() < 1e-5);
        let place = SwitchPlace { branch: BranchId::MAIN, point: point.unwrap() };
        let given = Given { known: &[(BranchId::MAIN, &main)], ..Given::default() };
        let Some(TaskResult::Branch(branch)) = execute(&mut forced, &Task::Switch(place), &given, &mut quiet) else {
            panic!("a branch")
        };
        assert_eq!(branch.outcome, Outcome::Open(Stop::Branching, Stop::Branching));
        let (peak, folds) = (branch.peak(), branch.special(SpecialKind::Fold));
        assert!((peak.amplitude() - 5.033279).abs() < 1e-6, "{max_step}: {}", peak.amplitude());
        assert!(folds.map(|fold| fold.omega()).any(|omega| (omega - 0.9706232).abs() < 1e-6), "{max_step}");
    }
}
