//! Predictors, correctors, symmetries, cancelling: every way of walking finds the same closed curve.

use crate::support::balance::Balance;
use crate::support::study::{Kind, Study, of_kind, why_unfinished, with_harmonics};
use solver::curve::continuation::{Corrector, Predictor};
use solver::files;
use solver::laws::{Jenkins, PenaltySpring};
use solver::response::backbone::Backbone;
use solver::response::branch::{Branch, BranchKind, BranchPoint, Outcome, Side, SpecialKind, Stop};
use solver::response::forced::{Forced, SearchRange};
use solver::response::level::{Level, LevelError};
use solver::settings::{FrequencySettings, Settings};
use solver::structure::Model;
use std::ops::ControlFlow;
use std::path::Path;

fn load(name: &str) -> Model {
    files::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name)).unwrap()
}

fn isola(settings: &Settings) -> Branch {
    let model = load("impact_subharmonic");
    let backbone = Backbone::compute(&model, settings).unwrap();
    let level = Level::compute(&model, settings, &backbone, 0.5).unwrap();
    assert_eq!(level.isolas().count(), 1);
    level.isolas().next().unwrap().clone()
}

#[test]
fn every_predictor_and_corrector_closes_the_same_isola() {
    let reference = isola(&Settings::default());
    assert!(reference.is_closed());
    for predictor in [Predictor::Tangent, Predictor::Secant] {
        for corrector in [Corrector::Hyperplane, Corrector::Sphere] {
            let mut settings = Settings::default();
            settings.continuation.predictor = predictor;
            settings.continuation.corrector = corrector;
            let branch = isola(&settings);
            assert!(branch.is_closed(), "{predictor:?}, {corrector:?}: {}", branch.outcome);
            let ((a, b), (c, d)) = (branch.frequency_range(), reference.frequency_range());
            let peaks = (branch.peak().amplitude(), reference.peak().amplitude());
            for (found, expected) in [(a, c), (b, d), peaks] {
                assert!((found / expected - 1.0).abs() < 1e-6, "{predictor:?}, {corrector:?}: {found} for {expected}");
            }
        }
    }
}

/// Where responses of twice the period branch off (with a forcing on harmonic 2), or asymmetric ones (of an odd law), the main
/// branch goes straight on: its motions keep the period of the forcing, and their mirror images.
#[test]
fn main_branches_keep_their_symmetry_where_others_branch_off() {
    // At the bound that is given neither response is the linear one any more.
    for (name, harmonics, forcing, first_odd) in [("chain_subharmonic", 20, 2.25, 1), ("duffing", 15, 1.0, 2)] {
        let model = load(name);
        let mut settings = Settings::default();
        settings.harmonics.count = harmonics;
        settings.frequency.min = Some(0.2);
        let backbone = Backbone::compute(&model, &settings).unwrap();
        let main = Forced::new(&model, &settings, SearchRange::new(&settings, &backbone).unwrap(), forcing)
            .main_branch(Side::Below, &mut |_| ControlFlow::Continue(()))
            .unwrap_or_else(|failure| panic!("{name}: {failure}"));
        assert_eq!(main.outcome, Outcome::Open(Stop::FrequencyBound, Stop::FrequencyBound), "{name}");
        for point in &main.points {
            for series in point.state.modal.chunks(2 * harmonics + 1) {
                let forbidden = (first_odd..=harmonics).step_by(2).flat_map(|k| [series[2 * k - 1], series[2 * k]]);
                let largest = forbidden.fold(0.0f64, |largest, x| largest.max(x.abs()));
                let size = series.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
                assert!(largest <= 1e-12 * size.max(1e-3), "{name}, {} rad/s: {largest} of {size}", point.omega());
            }
        }
    }
}

#[test]
fn a_walk_is_cancelled_between_points() {
    let model = load("duffing");
    let settings = Settings::default();
    let backbone = Backbone::compute(&model, &settings).unwrap();
    let mut seen = 0;
    let mut observer = |_: &BranchPoint| {
        seen += 1;
        if seen == 7 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let branch = Forced::new(&model, &settings, SearchRange::new(&settings, &backbone).unwrap(), 0.1)
        .main_branch(Side::Below, &mut observer)
        .unwrap();
    assert_eq!(seen, 7);
    assert_eq!(branch.outcome, Outcome::Open(Stop::FrequencyBound, Stop::Cancelled));
    // The start, then seven points; the peak among them is refined by at most one more.
    assert!((8..=9).contains(&branch.points.len()), "{} points", branch.points.len());
}

#[test]
fn branches_end_exactly_at_the_frequency_bounds() {
    let model = load("duffing");
    let mut settings = Settings::default();
    settings.frequency.min = Some(0.8);
    settings.frequency.max = Some(1.3);
    let go_on = &mut |_: &_| ControlFlow::Continue(());
    let backbone = Backbone::compute(&model, &settings).unwrap();
    let branch = Forced::new(&model, &settings, SearchRange::new(&settings, &backbone).unwrap(), 0.05)
        .main_branch(Side::Below, go_on)
        .unwrap();
    let last = branch.points.last().unwrap();
    assert!((last.omega() - 1.3).abs() < 1e-12 * 1.3, "ends at {}", last.omega());
    assert!((branch.points[0].omega() - 0.8).abs() < 1e-12);
    // At a forcing that moves next to nothing it begins in the linear range.
    assert_eq!(branch.outcome, Outcome::Open(Stop::FrequencyBound, Stop::FrequencyBound));
    let branch = Forced::new(&model, &settings, SearchRange::new(&settings, &backbone).unwrap(), 1e-4)
        .main_branch(Side::Below, go_on)
        .unwrap();
    assert_eq!(branch.outcome, Outcome::Open(Stop::Start, Stop::FrequencyBound));
}

#[test]
fn a_cancelled_level_stops_and_says_so() {
    let model = load("nonlinear_damper");
    let settings = Settings::default();
    let backbone = Backbone::compute(&model, &settings).unwrap();
    let mut seen = 0;
    let mut observer = |_: &BranchPoint| {
        seen += 1;
        if seen == 5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let cancelled = Level::compute_with(&model, &settings, &backbone, 0.01, &mut observer).unwrap_err();
    assert_eq!(cancelled, LevelError::Cancelled);
    assert_eq!(seen, 5);
}

/// The isola lies beyond the bounds: nothing is invented from the pieces that fit. Where it reaches into them it is cut.
#[test]
fn what_lies_beyond_bounds_is_left_out_and_what_reaches_into_them_is_cut() {
    let model = load("impact_subharmonic");
    let mut settings = Settings::default();
    let backbone = Backbone::compute(&model, &settings).unwrap();
    let whole = Level::compute(&model, &settings, &backbone, 0.5).unwrap();
    let (low, high) = whole.isolas().next().expect("an isola").frequency_range();
    (settings.frequency.min, settings.frequency.max) = (Some(0.5), Some(0.9));
    let level = Level::compute(&model, &settings, &backbone, 0.5).unwrap();
    assert!(level.windows.is_empty() && level.isolas().next().is_none(), "{level:#?}");
    // Some way into it, where the seeds of its window land beyond the bounds.
    settings.frequency.max = Some(low + 0.1 * (high - low));
    let level = Level::compute(&model, &settings, &backbone, 0.5).unwrap();
    let cut: Vec<&Branch> = level.isolas().collect();
    assert!(!cut.is_empty() && cut.iter().all(|branch| branch.kind == BranchKind::Cut), "{level:#?}");
    let begins = cut.iter().map(|branch| branch.frequency_range().0).fold(f64::INFINITY, f64::min);
    assert!((begins / low - 1.0).abs() < 1e-6, "{begins}, {low}");
}

/// Two masses, the first with a slider, the second forced.
pub fn damped_chain() -> Model {
    Model::builder("damped chain")
        .mass([[0.9782, 0.0], [0.0, 1.4182]])
        .stiffness([[4.4167, -2.6825], [-2.6825, 2.6825]])
        .damping_ratio(0.001665)
        .force("x2", 1.0)
        .monitor("x2")
        .element("slider", Jenkins { stiffness: 0.23212, limit: 0.98416 }, ["x1"])
        .build()
        .unwrap()
}

/// Where a smaller maximum of its motion is just high enough for a slider to slide, what follows of the period changes its slope, and
/// the branch turns by 95°. Newton's method across the tangent meets nothing there; the branch goes on.
#[test]
fn a_branch_turns_sharply_where_a_slider_begins_to_slide() {
    let study = Study::new(damped_chain(), with_harmonics(5));
    let balance = Balance::new(&study.model);
    for forcing in [0.7596, 1.0] {
        let level = study.level(forcing);
        let mains = of_kind(&level, Kind::Main);
        assert_eq!(mains.len(), 1, "{level:#?}");
        let main = &mains[0].branch;
        assert!(why_unfinished(main).is_none(), "A = {forcing}: {}", main.outcome);
        let left = main.points.iter().map(|point| balance.residual(&point.state).relative()).fold(0.0, f64::max);
        assert!(left < 1e-5, "A = {forcing}: {left:e} of the balance are left, friction sampled");
    }
}

/// Two close modes, the second mass before an elastic stop, the first on a slider that sticks in a dip of the main branch. Next to where
/// it begins to slide the branch turns back twice within a twentieth of a rad/s, once by up to 167°, and steps of any length see it.
#[test]
fn steps_see_how_a_branch_turns_where_a_slider_begins_to_slide() {
    let model = Model::builder("two masses")
        .mass([[1.0, 0.0], [0.0, 1.0]])
        .stiffness([[1.02e4, -200.0], [-200.0, 1.03e4]])
        .damping_ratio(1e-3)
        .force("x2", 1.0)
        .element("stop", PenaltySpring { stiffness: 5000.0, gap: 1e-3 }, ["x1"])
        .element("slider", Jenkins { stiffness: 500.0, limit: 0.2 }, ["x2"])
        .build()
        .unwrap();
    let folds = |forcing: f64, max_step: Option<f64>| -> Vec<f64> {
        let frequency = FrequencySettings { min: Some(103.0), max: Some(106.0) };
        let mut settings = Settings { frequency, ..Settings::default() };
        settings.continuation.max_step = max_step.unwrap_or(settings.continuation.max_step);
        let study = Study::new(model.clone(), settings);
        let level = study.level(forcing);
        let main = &of_kind(&level, Kind::Main)[0].branch;
        assert!(why_unfinished(main).is_none(), "A = {forcing}: {}", main.outcome);
        let folds = main.special(SpecialKind::Fold).map(|fold| fold.state.omega);
        let mut within: Vec<f64> = folds.filter(|omega| (104.0..105.5).contains(omega)).collect();
        within.sort_by(f64::total_cmp);
        within
    };
    for (forcing, count) in [(0.3011, 4), (0.302, 4), (0.305, 4), (0.31, 2)] {
        let (usual, small) = (folds(forcing, None), folds(forcing, Some(0.01)));
        assert_eq!((usual.len(), small.len()), (count, count), "A = {forcing}: {usual:?}, {small:?}");
        let difference = usual.iter().zip(&small).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        assert!(difference < 1e-6, "A = {forcing}: {usual:?}, {small:?}");
    }
}
