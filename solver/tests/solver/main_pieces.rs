//! Main branches that were followed up to bounds which follow from the modes of a study, and what of them lies beyond.

use crate::support::geometry::complaints;
use crate::support::study::{Kind, Listed, Study, shipped, with_harmonics};
use solver::curve::outcome::Stop;
use solver::formulation::pressure::PressureForm;
use solver::laws::PenaltySpring;
use solver::response::branch::Side;
use solver::response::forced::{Forced, SearchRange};
use solver::response::seeds::{Landing, LandingMethod, Phase};
use solver::response::task::{BranchId, SeedPlace, Task, TaskResult};
use solver::response::trace::{Given, execute};
use solver::response::windows::Window;
use solver::settings::ModeChoice;
use solver::{Backbone, BranchPoint, Matrix, Model, Outcome, Settings};
use std::ops::ControlFlow;

/// Three masses, the last two with a stop between them.
fn chain() -> Model {
    Model::builder("three masses")
        .mass(Matrix::diagonal(&[2.0, 1.0, 0.7]))
        .stiffness([[300.0, -100.0, 0.0], [-100.0, 260.0, -110.0], [0.0, -110.0, 140.0]])
        .damping_ratio(4e-4)
        .force("x3", 1.0)
        .element("stop", PenaltySpring { stiffness: 120.0, gap: 0.004 }, [vec![(2, 1.0), (1, -1.0)]])
        .monitor("x2")
        .build()
        .unwrap()
}

/// The second mode alone is followed; the resonance of the third one, beyond the range, is a piece of the same curve. Its peak was checked with
/// a harmonic balance of another program (15 harmonics, exact integrals over the contact): 0.053178 m at 21.8272 rad/s.
#[test]
fn what_lies_beyond_is_a_piece_that_meets_the_main_branch_at_one_end() {
    let (model, forcing) = (chain(), 0.03);
    let mut settings = Settings::default();
    settings.backbone.modes = ModeChoice::one(2);
    settings.frequency.min = Some(13.0);
    let backbone = Backbone::compute(&model, &settings).unwrap();
    let reach = SearchRange::new(&settings, &backbone).unwrap();
    let mut forced: Forced<'_, PressureForm<'_>> = Forced::build(&model, &settings, reach, forcing).unwrap();
    let mut quiet = |_: &BranchPoint| ControlFlow::Continue(());
    let TaskResult::Branch(main) =
        execute(&mut forced, &Task::Main(Side::Below), &Given::default(), &mut quiet).unwrap()
    else {
        panic!("a main branch")
    };
    let known = [(BranchId::MAIN, &main)];
    // The linear response below the resonance of the third mode.
    let start = solver::formulation::linear::forced_response(forced.problem(), forcing, 17.0).unwrap();
    let landings = [Landing { state: forced.converge(&start).unwrap(), distance: 0.0 }];
    let well = Window { mode: 1, first: 1, last: 2, best: 1, threshold: 0.1, omega: (13.0, 14.0) };
    let place = SeedPlace { window: 0, well, phase: Phase::First, method: LandingMethod::FullForcing };
    let given = Given { landings: &landings, known: &known, ..Given::default() };
    let TaskResult::Branch(piece) = execute(&mut forced, &Task::Seed(place), &given, &mut quiet).unwrap() else {
        panic!("a piece of it")
    };
    assert_eq!(piece.kind, Kind::Main);
    let Outcome::Open(first, last) = piece.outcome else { panic!("{}", piece.outcome) };
    assert_eq!([first, last].iter().filter(|stop| **stop == Stop::Joined).count(), 1, "{}", piece.outcome);
    let peak = piece.peak();
    assert!((peak.amplitude() / 0.053_178 - 1.0).abs() < 1e-3, "{}", peak.amplitude());
    assert!((peak.omega() / 21.8272 - 1.0).abs() < 1e-4, "{}", peak.omega());
    let listed =
        |name: &str, branch: &solver::Branch| Listed { kind: branch.kind, name: name.into(), branch: branch.clone() };
    let wrong = complaints(&model, &[listed("main", &main), listed("piece", &piece)]);
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// A main branch that begins in contact, at a bound that was given, begins there, and not in the linear range.
#[test]
fn a_main_branch_that_begins_in_contact() {
    let model = shipped("cantilever_stop", &[]);
    let begin = |min: Option<f64>| {
        let mut settings = with_harmonics(10);
        settings.frequency.min = min;
        let level = Study::new(model.clone(), settings).level(0.015);
        let Outcome::Open(begin, _) = level[0].branch.outcome else { panic!("closed") };
        (begin, level[0].branch.certificate.contact_omega.unwrap())
    };
    let (first, (from, to)) = begin(None);
    assert_eq!(first, Stop::Start);
    let inside = from + 0.02 * (to - from);
    let (first, (from, _)) = begin(Some(inside));
    assert_eq!(first, Stop::FrequencyBound);
    assert!((from / inside - 1.0).abs() < 1e-9, "contact begins at {from}, the bound is {inside}");
}
