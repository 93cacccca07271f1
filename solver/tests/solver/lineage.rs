//! What branches off what, whichever is come upon first: of three arms about a hub, all pushed alike, whose isolas are of motions in which
//! two arms move alike, and are left by others in which no two do.

use crate::support::ring::{quiet, within};
use solver::laws::{PolynomialSpring, Term};
use solver::response::branch::{BranchKind, Side};
use solver::response::name::BranchId;
use solver::response::seeds::Landing;
use solver::response::starts::{StartPlace, land};
use solver::response::task::{SwitchPlace, Task, TaskResult};
use solver::response::trace::{Given, execute};
use solver::{Branch, Forced, Matrix, Model, SearchRange, SpecialKind, State};

const FORCING: f64 = 0.008;
const HARMONICS: usize = 5;
const COUPLING: f64 = 0.02;
/// Relative difference of the ends of a curve that is followed twice.
const CLOSE: f64 = 1e-6;
/// A batch of random starts of which one leads to an isola.
const BATCH: usize = 1;
const ARMS: [&str; 3] = ["a1", "a2", "a3"];

/// Arms and hub of 1 kg on springs of 1 N/m, those of the arms stiffening, coupled softly.
fn arms() -> Model {
    let entry = |i: usize, j: usize| match (i, j) {
        (0, 0) => 1.0 + 3.0 * COUPLING,
        (i, j) if i == j => 1.0 + COUPLING,
        (0, _) | (_, 0) => -COUPLING,
        _ => 0.0,
    };
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 1.0 }] };
    let model = Model::builder("arms")
        .dofs(["hub", "a1", "a2", "a3"])
        .mass(Matrix::diagonal(&[1.0; 4]))
        .stiffness(Matrix::from_fn(4, 4, entry))
        .damping_ratio(0.005)
        .monitor("a1");
    let model = ARMS.into_iter().fold(model, |model, arm| model.force(arm, 1.0));
    ARMS.into_iter().fold(model, |model, arm| model.element(arm, spring.clone(), [[(arm, 1.0)]])).build().unwrap()
}

/// How far the arms that move most alike are from moving alike, as a share of the largest amplitude of an arm.
fn apart(forced: &Forced<'_>, state: &State) -> f64 {
    let motion =
        |dof: usize| -> Vec<f64> { state.over_period(forced.model(), dof, 64).iter().map(|at| at[0]).collect() };
    let motions = [1, 2, 3].map(motion);
    let largest = motions.iter().flatten().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let difference = |i: usize, j: usize| {
        let pairs = motions[i].iter().zip(&motions[j]);
        pairs.fold(0.0_f64, |largest, (a, b)| largest.max((a - b).abs())) / largest
    };
    difference(0, 1).min(difference(1, 2)).min(difference(2, 0))
}

/// What starts that lead to this response begin.
fn begin(forced: &mut Forced<'_>, state: &State, known: &[(BranchId, &Branch)]) -> Option<Branch> {
    let landings = [Landing { state: state.clone(), distance: 0.0 }];
    let given = Given { landings: &landings, known, ..Given::default() };
    match execute(forced, &Task::Begin(StartPlace::random(0)), &given, &mut quiet) {
        Some(TaskResult::Branch(branch)) => Some(branch),
        _ => None,
    }
}

/// What the branch points of a branch lead to that is not known.
fn switched(forced: &mut Forced<'_>, id: BranchId, known: &[(BranchId, &Branch)]) -> Vec<Branch> {
    let branch = known.iter().find(|(other, _)| *other == id).unwrap().1;
    let count = branch.special(SpecialKind::BranchPoint).count();
    let mut list = Vec::new();
    for point in 0..count {
        let given = Given { known, ..Given::default() };
        let task = Task::Switch(SwitchPlace { branch: id, point });
        if let Some(TaskResult::Branch(branch)) = execute(forced, &task, &given, &mut quiet) {
            list.push(branch);
        }
    }
    list
}

#[test]
fn what_leaves_an_isola_and_is_come_upon_first_branches_off_it() {
    let (model, settings) = (arms(), within(HARMONICS));
    let reach = SearchRange { frequency: (0.9, 1.4), amplitude: 10.0, natural: None, forcing: None };
    let mut forced = Forced::new(&model, &settings, reach, FORCING);
    let main = forced.main_branch(Side::Below, &mut quiet).unwrap();
    let landings = land(&mut forced, &StartPlace::random(BATCH)).unwrap();
    let leads_to_an_isola = |landing: &Landing| {
        let is_left = |branch: &Branch| branch.special(SpecialKind::BranchPoint).next().is_some();
        let found = begin(&mut forced, &landing.state, &[(BranchId::MAIN, &main)])?;
        (found.kind == BranchKind::Isola && is_left(&found)).then_some(found)
    };
    let isola = landings.iter().find_map(leads_to_an_isola).expect("one of them leads to an isola");
    assert!(apart(&forced, &isola.peak().state) < 1e-6);
    let id = BranchId::isola(0);
    let children = switched(&mut forced, id, &[(BranchId::MAIN, &main), (id, &isola)]);
    let [child, ..] = &children[..] else { panic!("something leaves it") };
    assert_eq!((child.kind, child.is_closed()), (BranchKind::Branched, true));
    let middle = child.points[child.points.len() / 3].state.clone();
    assert!(apart(&forced, &middle) > 1e-3);

    // Of the two the isola comes first again, and the other one from there.
    let first = begin(&mut forced, &middle, &[(BranchId::MAIN, &main)]).unwrap();
    assert_eq!((first.kind, first.is_closed()), (BranchKind::Isola, true));
    assert!(apart(&forced, &first.peak().state) < 1e-6);
    let (range, again) = (isola.frequency_range(), first.frequency_range());
    assert!((again.0 / range.0 - 1.0).abs() < CLOSE && (again.1 / range.1 - 1.0).abs() < CLOSE, "{range:?}, {again:?}");
    let next = switched(&mut forced, id, &[(BranchId::MAIN, &main), (id, &first)]);
    assert!(next.iter().all(|branch| branch.kind == BranchKind::Branched));
    assert!(next.iter().any(|branch| forced.lies_on(&middle, branch)));
}
