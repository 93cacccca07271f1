//! Backbones that are followed as far as the forcing needs.

use crate::support::study::{Kind, Study, of_kind, with_harmonics};
use solver::formulation::state::State;
use solver::laws::{PenaltySpring, PolynomialSpring, TanhFriction, Term};
use solver::response::backbone::BackbonePoint;
use solver::response::modes::Backbones;
use solver::settings::BackboneEquation;
use solver::{Backbone, Model};
use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

/// Two masses with a cubic spring between them, whose isola lies beyond eight reference lengths: the backbone has to go on for the
/// forcing. Runge–Kutta and a shooting on it have a stable orbit of 0.29152 m at 29.259 rad/s, another one than the main response.
#[test]
fn an_isola_beyond_where_backbones_end_by_themselves() {
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 2e6 }] };
    let model = Model::builder("softening pair")
        .dofs(["base", "tip"])
        .mass([[2.0, 0.0], [0.0, 0.3]])
        .stiffness([[2600.0, -600.0], [-600.0, 600.0]])
        .damping_matrix([[0.5, -0.2], [-0.2, 0.22]])
        .force("base", 1.0)
        .monitor("tip")
        .element("spring", spring, [[("tip", 1.0), ("base", -1.0)]])
        .build()
        .unwrap();
    let settings = with_harmonics(10);
    let reaching = |forcing: f64| {
        let all = Backbones::reaching(
            &model,
            &settings,
            forcing,
            &mut |_| ControlFlow::Continue(()),
            &AtomicBool::new(false),
        );
        all.unwrap().list
    };
    let highest = |list: &[Backbone]| list[0].points.iter().map(|point| point.threshold()).fold(0.0, f64::max);
    let (by_itself, backbones) = (reaching(0.0), reaching(2.55));
    assert!(highest(&by_itself) < 2.5 && highest(&backbones) > 5.1, "{} {}", highest(&by_itself), highest(&backbones));
    let study = Study { model, settings, backbones };
    let level = study.level(2.55);
    let isolas = of_kind(&level, Kind::Isola);
    let [isola] = isolas[..] else { panic!("{level:#?}") };
    let (low, high) = isola.branch.frequency_range();
    assert!((low - 29.2418).abs() < 1e-3 && (high - 29.2800).abs() < 1e-3, "{low} {high}");
    // Between its points, linearly; twice the harmonics change its peak by 1e-3.
    let pairs = isola.branch.points.windows(2).filter(|pair| (pair[0].omega() < 29.259) != (pair[1].omega() < 29.259));
    let amplitudes = pairs.map(|pair| {
        let share = (29.259 - pair[0].omega()) / (pair[1].omega() - pair[0].omega());
        pair[0].amplitude() + share * (pair[1].amplitude() - pair[0].amplitude())
    });
    let nearest = amplitudes.map(|amplitude| (amplitude / 0.29152 - 1.0).abs()).fold(f64::INFINITY, f64::min);
    assert!(nearest < 2e-3, "{nearest:.1e}");
}

/// A frame whose arm friction holds at rest: no backbone begins there, and the one that is found among larger motions ends there, instead
/// of going on along the same motions half a period later.
#[test]
fn a_backbone_ends_where_it_comes_to_rest() {
    let (frame, arm) = (8.0 * (TAU * 12.0).powi(2), 0.4 * (TAU * 11.0).powi(2));
    let model = Model::builder("frame and arm")
        .dofs(["frame", "arm"])
        .mass([[8.0, 0.0], [0.0, 0.4]])
        .stiffness([[frame + arm, -arm], [-arm, arm]])
        .damping_matrix([[2.5, -1.0], [-1.0, 1.0]])
        .force("frame", 1.0)
        .monitor("arm")
        .element("stop", PenaltySpring { stiffness: 2e4, gap: 0.003 }, [[("arm", -1.0), ("frame", 1.0)]])
        .element("friction", TanhFriction { limit: 0.8, velocity: 0.01 }, [[("arm", 1.0), ("frame", -1.0)]])
        .build()
        .unwrap();
    let mut settings = with_harmonics(5);
    settings.backbone.max_amplitude = Some(0.02);
    let backbone = Backbone::compute(&model, &settings).unwrap();
    let amplitudes: Vec<f64> = backbone.points.iter().map(|point| point.point.amplitude()).collect();
    let smallest = amplitudes.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = amplitudes.iter().copied().fold(0.0, f64::max);
    assert!(largest > 0.01 && smallest < 1e-3 * largest, "{smallest:e} to {largest:e}");
    let small = amplitudes.iter().position(|amplitude| *amplitude == smallest).unwrap();
    assert!(small == 0 || small + 1 == amplitudes.len(), "it goes on beyond rest: {small} of {}", amplitudes.len());
}

/// Springs and damping of [`pair`].
const SPRING: f64 = 1.0;
const COUPLING: f64 = 0.1;
const CUBIC: f64 = 0.5;
const DAMPING: f64 = 0.002;

/// Two masses of 1 kg, each on a hardening spring of its own, with a weak spring between them, that are pushed alike.
fn pair() -> Model {
    let spring = || PolynomialSpring { terms: vec![Term { power: 3, coefficient: CUBIC }] };
    Model::builder("pair")
        .dofs(["left", "right"])
        .mass([[1.0, 0.0], [0.0, 1.0]])
        .stiffness([[SPRING + COUPLING, -COUPLING], [-COUPLING, SPRING + COUPLING]])
        .damping_matrix([[DAMPING, 0.0], [0.0, DAMPING]])
        .force_shape([1.0, 1.0])
        .monitor("left")
        .element("left spring", spring(), [[("left", 1.0)]])
        .element("right spring", spring(), [[("right", 1.0)]])
        .build()
        .unwrap()
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
    let mut quiet = |_: &_| ControlFlow::Continue(());
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
    let mut quiet = |_: &_| ControlFlow::Continue(());
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
