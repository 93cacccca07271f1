//! Backbones that are followed as far as the forcing needs.

use crate::support::study::{Kind, Study, assert_main_only, main_peak, of_kind, with_harmonics};
use solver::laws::{PenaltySpring, PolynomialSpring, TanhFriction, Term};
use solver::response::modes::Backbones;
use solver::{Backbone, Model, Settings};
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
    // Where levels are added to a run, it is known that its backbones do not reach so far.
    let short = |list: &[Backbone]| list[0].falls_short(&model, &settings, 2.55);
    assert!(short(&by_itself) && !short(&backbones));
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

/// A double well, whose motions of both wells begin at the lower bound of the frequency, where their threshold is below the forcing: that is
/// no reason to follow them to higher frequencies than those up to which it is.
#[test]
fn a_backbone_that_begins_at_low_frequencies() {
    let spring =
        PolynomialSpring { terms: vec![Term { power: 1, coefficient: -2.0 }, Term { power: 3, coefficient: 1.0 }] };
    let model = Model::builder("double well").mass([[1.0]]).stiffness([[1.0]]).damping_matrix([[0.05]]).force(0, 1.0);
    let model = model.element("spring", spring, [vec![(0, 1.0)]]).build().unwrap();
    let settings = with_harmonics(5);
    let backbone = Backbone::reaching(&model, &settings, 0.2, &mut |_| ControlFlow::Continue(())).unwrap();
    assert!(backbone.frequency_range().1 < 16.0, "{:?}", backbone.frequency_range());
    assert!(backbone.points[0].threshold() < 0.2, "{}", backbone.points[0].threshold());
}

/// A stiffening spring that the forcing drives to more than four times the linear frequency.
#[test]
fn a_backbone_is_followed_to_the_frequencies_of_the_forcing() {
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 1.0 }] };
    let model = Model::builder("stiffening").mass([[1.0]]).stiffness([[1.0]]).damping_ratio(0.002).force(0, 1.0);
    let model = model.element("spring", spring, [vec![(0, 1.0)]]).build().unwrap();
    let mut settings = with_harmonics(5);
    let highest = |settings: &Settings| {
        let backbone = Backbone::reaching(&model, settings, 1.5, &mut |_| ControlFlow::Continue(())).unwrap();
        (backbone.frequency_range().1, backbone.points.last().unwrap().threshold())
    };
    let (omega, threshold) = highest(&settings);
    assert!((4.5..70.0).contains(&omega) && threshold > 1.5, "{omega} {threshold}");
    (settings.frequency.max, settings.backbone.max_amplitude) = (Some(1.6), Some(100.0));
    assert!((1.6..4.2).contains(&highest(&settings).0), "{:?}", highest(&settings));
    settings.frequency.max = None;
    settings.backbone.max_frequency = Some(3.0);
    assert!(highest(&settings).0 < 3.2, "{:?}", highest(&settings));
}

/// A dashpot that holds one of two masses leaves a motion of the other that hardly decays, though each mode alone is damped much. The backbone
/// begins with it, and the response has its resonance there; the pole is by an eigenvalue routine of another program.
#[test]
fn a_backbone_begins_with_the_damped_motion() {
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 0.6 }] };
    let model = Model::builder("dashpot")
        .dofs(["held", "free"])
        .mass([[1.0, 0.0], [0.0, 1.0]])
        .stiffness([[1.5, -0.5], [-0.5, 1.5]])
        .damping_matrix([[4.0, 0.0], [0.0, 0.05]])
        .force("held", 1.0)
        .force("free", 0.5)
        .monitor("free")
        .element("spring", spring, [[("free", 1.0)]])
        .build()
        .unwrap();
    let settings = with_harmonics(7);
    let study = Study::new(model, settings);
    let first = &study.backbones[0].points[0].point;
    assert!((first.omega() - 1.225_495_4).abs() < 1e-5, "{}", first.omega());
    assert!((first.state.decay - 0.046_268_9).abs() < 1e-5, "{}", first.state.decay);
    // So small a forcing hardly bends the resonance: the linear response is largest, 4.545659 times the forcing, at 1.224305 rad/s.
    let level = study.level(1e-3);
    let (omega, amplitude) = main_peak(&level);
    assert!(
        (omega / 1.224_305 - 1.0).abs() < 1e-5 && (amplitude / 4.545_659e-3 - 1.0).abs() < 1e-5,
        "{omega} {amplitude}"
    );
    assert_main_only(&level, "two masses");
}
