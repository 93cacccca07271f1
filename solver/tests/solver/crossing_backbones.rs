//! Curves that cross backbones at branch points: their motions, and the isolas about them.

use crate::support::study::{Kind, Study, of_kind, with_harmonics};
use solver::formulation::state::State;
use solver::laws::{PenaltySpring, PolynomialSpring, Term};
use solver::response::backbone::BackbonePoint;
use solver::response::branch::{BranchPoint, Outcome, SpecialKind, Stop};
use solver::response::modes::Backbones;
use solver::response::recheck::Recheck;
use solver::settings::{BackboneEquation, ModeChoice};
use solver::{Backbone, Matrix, Model, ModelBuilder};
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

fn quiet(_: &BranchPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// So many masses of 1 kg in a chain or, more than two, in a ring, each on a spring of 1 N/m, with these springs between neighbours, all
/// pushed alike.
fn masses(count: usize, coupling: f64, damping: f64) -> ModelBuilder {
    let neighbours = if count > 2 { 2.0 } else { 1.0 };
    let entry = |i: usize, j: usize| match i.abs_diff(j) {
        0 => 1.0 + neighbours * coupling,
        d if d == 1 || d == count - 1 => -coupling,
        _ => 0.0,
    };
    Model::builder("masses")
        .mass(Matrix::diagonal(&vec![1.0; count]))
        .stiffness(Matrix::from_fn(count, count, entry))
        .damping_matrix(Matrix::diagonal(&vec![damping; count]))
        .force_shape(vec![1.0; count])
        .monitor(0)
}

/// The same, their springs to the ground stiffening.
fn stiffening(count: usize, coupling: f64, cubic: f64) -> Model {
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: cubic }] };
    let model = masses(count, coupling, 0.002);
    (0..count).fold(model, |model, i| model.element(format!("s{i}"), spring.clone(), [vec![(i, 1.0)]])).build().unwrap()
}

/// Springs and damping of [`pair`].
const SPRING: f64 = 1.0;
const COUPLING: f64 = 0.1;
const CUBIC: f64 = 0.5;
const DAMPING: f64 = 0.002;

/// Two masses on stiffening springs.
fn pair() -> Model {
    stiffening(2, COUPLING, CUBIC)
}

/// Frequency of the free motions of a [`pair`] in which the left mass moves by `left` and the right one by less, against it, and how far that
/// moves. With one harmonic they leave those in which both move alike at a² = 4 k_c/(3 γ): a_1 a_2 = −4 k_c/(3 γ) and
/// ω² = k + k_c + ¾ γ (a_1² + a_2²) (A. F. Vakakis et al., Normal Modes and Localization in Nonlinear Systems, 1996).
fn localised(left: f64) -> (f64, f64) {
    let right = 4.0 * COUPLING / (3.0 * CUBIC) / left;
    ((SPRING + COUPLING + 0.75 * CUBIC * (left * left + right * right)).sqrt(), right)
}

/// A force that pushes both masses alike does no work on motions of these against each other, but on those that leave them.
#[test]
fn localised_motions_leave_a_mode_on_which_the_force_does_no_work() {
    let model = pair();
    let mut settings = with_harmonics(1);
    settings.backbone.equation = BackboneEquation::ConservativeMode;
    let backbone = Backbone::reaching(&model, &settings.tracking(1), 0.05, &mut quiet).unwrap();
    let pieces: Vec<_> = backbone.pieces().collect();
    assert_eq!(pieces.len(), 3, "one for each mass that moves more: {:?}", backbone.crossing);
    assert!(pieces[0].iter().all(|point| point.threshold() > 1e9));
    let amplitude =
        |state: &State, dof: usize| state.displacement(&model, dof)[1..].iter().map(|x| x * x).sum::<f64>().sqrt();
    for piece in &pieces[1..] {
        for (i, point) in piece.iter().enumerate() {
            let [larger, less] = {
                let [left, right] = [0, 1].map(|dof| amplitude(&point.point.state, dof));
                [left.max(right), left.min(right)]
            };
            let (omega, right) = localised(larger);
            // The branch point itself is located to 2e-5.
            let tolerance = if i == 0 { 1e-4 } else { 1e-8 };
            let errors = [less / right - 1.0, point.point.omega() / omega - 1.0];
            assert!(errors.iter().all(|error| error.abs() < tolerance), "{i}: {larger} {less} {errors:?}");
        }
        assert!(piece.iter().any(|point| point.threshold() < 0.05));
    }
    let ratio = |piece: &[BackbonePoint]| {
        let last = &piece[piece.len() - 1].point.state;
        amplitude(last, 0) / amplitude(last, 1)
    };
    let [one, other] = [ratio(pieces[1]), ratio(pieces[2])];
    assert!((one.max(other) > 10.0) && (one * other - 1.0).abs() < 1e-6, "{one} {other}");
}

/// The isolas of such motions, of either mass: they reach to where what the force supplies, π A (a_1 − a_2), is what the dampers take,
/// π ω c (a_1² + a_2²).
#[test]
fn isolas_of_localised_motions() {
    let (model, settings, forcing) = (pair(), with_harmonics(5), 0.006);
    let backbones = Backbones::reaching(&model, &settings, forcing, &mut quiet, &AtomicBool::new(false)).unwrap().list;
    let study = Study { model, settings, backbones };
    let level = study.level(forcing);
    let isolas = of_kind(&level, Kind::Isola);
    let needed = |left: f64| {
        let (omega, right) = localised(left);
        omega * DAMPING * (left * left + right * right) / (left - right)
    };
    let highest = (1000..3000).map(|i| 1e-3 * f64::from(i)).take_while(|left| needed(*left) < forcing).last().unwrap();
    let expected = localised(highest).0;
    assert_eq!(isolas.len(), 2, "{level:#?}");
    for isola in isolas {
        let (_, high) = isola.branch.frequency_range();
        assert!((high / expected - 1.0).abs() < 5e-3, "{high}, expected {expected}");
    }
}

/// Two masses before elastic stops of 2 N/m at 0.5 m: those motions leave just above the first touch. A harmonic balance with arc length
/// of its own, its points 1e-3 rad/s apart, has them down to A* = 0.00619, at 1.1075 rad/s.
#[test]
fn localised_motions_before_stops() {
    let stop = PenaltySpring { stiffness: 2.0, gap: 0.5 };
    let model = masses(2, 0.05, 0.005);
    let model = (0..2).fold(model, |model, i| model.element(format!("s{i}"), stop.clone(), [vec![(i, 1.0)]])).build();
    let (model, settings) = (model.unwrap(), with_harmonics(9));
    let backbone = Backbone::reaching(&model, &settings.tracking(1), 0.03, &mut quiet).unwrap();
    let lowest = backbone.points.iter().min_by(|a, b| a.threshold().total_cmp(&b.threshold())).unwrap();
    assert!(lowest.piece() > 0 && (lowest.threshold() / 0.00619 - 1.0).abs() < 1e-3, "{}", lowest.threshold());
    assert!((lowest.point.omega() - 1.1075).abs() < 1e-3, "{}", lowest.point.omega());
}

/// All small motions of a double mode lie on curves: nothing branches off there.
#[test]
fn a_double_mode_is_crossed_by_nothing_where_it_begins() {
    let (model, settings) = (stiffening(3, 0.05, 0.5), with_harmonics(5));
    for mode in [1, 2] {
        let backbone = Backbone::reaching(&model, &settings.tracking(mode), 0.006, &mut quiet).unwrap();
        assert!(backbone.crossing.is_empty(), "mode {}: {:?}", mode + 1, backbone.crossing);
    }
}

/// Two modes at 1:2, with a quadratic spring: the backbone goes to a motion of the higher mode alone, of half the period. Beyond are the
/// same motions, half a period later, back to rest: none is counted twice.
#[test]
fn a_backbone_ends_where_its_motion_is_its_own_image() {
    let terms = vec![Term { power: 2, coefficient: 0.3 }, Term { power: 3, coefficient: 0.3 }];
    let model = Model::builder("one to two")
        .mass([[1.0, 0.0], [0.0, 1.0]])
        .stiffness([[1.0, 0.0], [0.0, 4.1]])
        .damping_matrix([[0.005, 0.0], [0.0, 0.01]])
        .force(0, 1.0)
        .monitor(0)
        .element("spring", PolynomialSpring { terms }, [[(0, 1.0), (1, 0.5)]])
        .build()
        .unwrap();
    let backbone = Backbone::compute(&model, &with_harmonics(5)).unwrap();
    assert_eq!(backbone.outcome, Outcome::Open(Stop::Start, Stop::Branching));
    let largest = backbone.max_amplitude();
    assert!((largest - 0.663).abs() < 1e-2 && backbone.points.len() < 100, "{largest} {}", backbone.points.len());
    let harmonic = |point: &BackbonePoint, n: usize| {
        let motion = [0, 1].map(|dof| point.point.state.displacement(&model, dof)[2 * n - 1..=2 * n].to_vec()).concat();
        motion.iter().map(|x| x * x).sum::<f64>().sqrt()
    };
    let last = backbone.points.last().unwrap();
    assert!(harmonic(last, 1) < 1e-2 * harmonic(last, 2), "{} {}", harmonic(last, 1), harmonic(last, 2));
}

/// Of four masses in a ring, closed curves of motions in which two opposite ones move alike, and of others that leave these at branch points
/// and come back to them: only the former are isolas.
#[test]
fn what_leaves_an_isola_branches_off() {
    let (model, settings) = (stiffening(4, 0.02, 0.5), with_harmonics(5));
    for forcing in [0.006, 0.02] {
        let all = Backbones::reaching(&model, &settings, forcing, &mut quiet, &AtomicBool::new(false)).unwrap();
        let study = Study { model: model.clone(), settings, backbones: all.list };
        let level = study.level(forcing);
        // Nothing of it is refused.
        for listed in &level {
            assert_eq!(
                Recheck::new(&model, &settings, 1).branch(&listed.branch, forcing),
                Ok(()),
                "{} at A = {forcing}",
                listed.name
            );
        }
        let is_alike = |state: &State| {
            let motion = |dof: usize| state.displacement(&model, dof);
            let apart = |i: usize, j: usize| {
                let (one, other) = (motion(i), motion(j));
                one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            apart(0, 2) < 1e-6 && apart(1, 3) < 1e-6
        };
        let isolas = of_kind(&level, Kind::Isola);
        if forcing == 0.006 {
            assert_eq!((isolas.len(), of_kind(&level, Kind::Branched).len()), (2, 2), "{level:#?}");
            assert!(isolas.iter().all(|isola| is_alike(&isola.branch.peak().state)), "{level:#?}");
        }
    }
}

/// Two masses before stops: motions in which one moves more than the other leave the main branch at one branch point and come back to it at
/// another. They end there, whatever follows on the main branch, which nobody gave bounds.
#[test]
fn what_branches_off_ends_on_the_main_branch() {
    let stop = PenaltySpring { stiffness: 0.5, gap: 0.2 };
    let model = masses(2, 0.02, 0.002);
    let model = (0..2).fold(model, |model, i| model.element(format!("s{i}"), stop.clone(), [vec![(i, 1.0)]])).build();
    let (model, settings, forcing) = (model.unwrap(), with_harmonics(9), 0.01);
    let all = Backbones::reaching(&model, &settings, forcing, &mut quiet, &AtomicBool::new(false)).unwrap();
    let study = Study { model: model.clone(), settings, backbones: all.list };
    let level = study.level(forcing);
    let branched = of_kind(&level, Kind::Branched);
    let [branched] = branched[..] else { panic!("{level:#?}") };
    let points = &branched.branch.points;
    let apart = |point: &BranchPoint| {
        let [one, other] = [0, 1].map(|dof| point.state.displacement(&model, dof));
        one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / point.amplitude()
    };
    // A closed one crosses the main branch where it does not end there.
    let crossings = branched.branch.special.iter().filter(|special| special.kind == SpecialKind::BranchPoint);
    let crossings: Vec<usize> = crossings.map(|special| special.index).collect();
    let is_crossing = |index: usize| crossings.iter().any(|crossing| crossing.abs_diff(index) <= 1);
    let inner = (2..points.len() - 2).filter(|&index| !is_crossing(index));
    let alike = inner.filter(|&index| apart(&points[index]) < 1e-6).count();
    assert_eq!(alike, 0, "of {} points, {level:#?}", points.len());
}

/// Frame, rotor and pipe, with a stop between the latter two: the second harmonic of the first mode meets the third one. There the backbone
/// ends in motions of that mode, at half of their frequency, and it begins anew on them elsewhere.
#[test]
fn a_backbone_goes_on_beyond_a_tongue() {
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 4e7 }] };
    let model = Model::builder("frame, rotor, pipe")
        .dofs(["frame", "rotor", "pipe"])
        .mass([[12.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 0.7]])
        .stiffness([[60000.0, -12000.0, 0.0], [-12000.0, 21000.0, -3000.0], [0.0, -3000.0, 7000.0]])
        .damping_ratio(0.006)
        .force("rotor", 1.0)
        .monitor("pipe")
        .element("stop", PenaltySpring { stiffness: 25e3, gap: 1.5e-3 }, [[("rotor", 1.0), ("pipe", -1.0)]])
        .element("cubic", spring, [[("frame", 1.0)]])
        .build()
        .unwrap();
    let backbone = |mode: usize, harmonics: usize| {
        let mut settings = with_harmonics(harmonics);
        settings.backbone.modes = ModeChoice::one(mode);
        Backbone::reaching(&model, &settings, 40.0, &mut |_| ControlFlow::Continue(())).unwrap()
    };
    let (first, third) = (backbone(1, 8), backbone(3, 4));
    let pieces: Vec<&[BackbonePoint]> = first.pieces().collect();
    let [begin, beyond, ..] = pieces[..] else { panic!("{:?}", first.outcome) };
    assert_eq!(first.outcome, Outcome::Open(Stop::Start, Stop::Branching));
    assert!(matches!(first.crossing[0], Outcome::Open(Stop::Branching, _)), "{:?}", first.crossing);
    // At both ends of the tongue the motions are those of the third mode at twice the frequency, with half as many harmonics.
    let alone = |omega: f64| {
        let pair =
            third.points.windows(2).find(|pair| (pair[0].point.omega() < omega) != (pair[1].point.omega() < omega));
        let [a, b] = pair.unwrap() else { unreachable!() };
        let share = (omega - a.point.omega()) / (b.point.omega() - a.point.omega());
        a.point.amplitude() + share * (b.point.amplitude() - a.point.amplitude())
    };
    for end in [begin.last().unwrap(), &beyond[0]] {
        let expected = alone(2.0 * end.point.omega());
        // Interpolated between points, linearly.
        assert!((end.point.amplitude() / expected - 1.0).abs() < 5e-3, "{} {expected}", end.point.amplitude());
    }
    // The largest response of the level is where the threshold is its forcing.
    let settings = with_harmonics(8);
    let level = Study { model: model.clone(), settings, backbones: vec![first.clone()] }.level(40.0);
    let peak = of_kind(&level, Kind::Main).iter().map(|main| main.branch.peak().amplitude()).fold(0.0, f64::max);
    let crossing = beyond.windows(2).find(|pair| pair[0].threshold() < 40.0 && pair[1].threshold() >= 40.0);
    assert!(crossing.is_some_and(|pair| (pair[1].point.amplitude() / peak - 1.0).abs() < 0.05), "{peak}");
    // Without forcing nothing is looked for beyond, and its balance is known up to the tongue.
    let end = Backbone::compute(&model, &settings).unwrap().end().unwrap();
    let before = begin.iter().filter(|point| point.contributions()[0] > 0.9).map(BackbonePoint::threshold);
    assert!((end.threshold / before.fold(0.0, f64::max) - 1.0).abs() < 0.2, "{end:?}");
    assert!(
        end.branch_point.is_some_and(|omega| (omega - begin.last().unwrap().point.omega()).abs() < 1e-3),
        "{end:?}"
    );
    assert!(first.end().unwrap().threshold > 80.0, "{:?}", first.end());
}

/// Of four equal masses on stiffening springs many motions in which they move differently leave the mode in which they do not. The curves of
/// all of these together have no more points than the first one may have.
#[test]
fn curves_across_share_their_points() {
    let model = stiffening(4, 0.02, 0.5);
    let pieces = |most: usize| {
        let mut settings = with_harmonics(5);
        settings.backbone.max_points = most;
        let all = Backbones::reaching(&model, &settings, 0.02, &mut quiet, &AtomicBool::new(false)).unwrap();
        let backbone = all.list.iter().max_by_key(|backbone| backbone.crossing.len()).unwrap();
        let counts: Vec<usize> = backbone.pieces().map(<[BackbonePoint]>::len).collect();
        (counts, backbone.crossing.clone())
    };
    let (counts, _) = pieces(6000);
    let (first, across) = (counts[0], counts[1..].iter().sum::<usize>());
    let most = first.max(across / 2);
    let (counts, ends) = pieces(most);
    // Extrema and branch points are put in besides.
    assert!(counts[1..].iter().sum::<usize>() < most + most / 4, "{counts:?}");
    assert!(ends.iter().any(|end| matches!(end, Outcome::Open(_, Stop::PointBudget))), "{ends:?}");
}
