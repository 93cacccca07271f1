//! Backbones that are followed as far as the forcing needs.

use crate::support::study::{Kind, Study, of_kind, with_harmonics};
use solver::laws::{PolynomialSpring, Term};
use solver::response::modes::Backbones;
use solver::{Backbone, Model};
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
