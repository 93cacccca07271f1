//! Random starts, on models whose isolas are known.

use crate::support::balance::Balance;
use crate::support::study::{Kind, Study, shipped, with_harmonics};
use solver::response::branch::BranchPoint;
use solver::response::critical::CriticalKind;
use solver::response::scout::ScoutPlace;
use solver::response::seeds::Landing;
use solver::response::starts::{BATCH, StartPlace, batches, land, share};
use solver::response::task::{FoldPlace, Task, TaskResult};
use solver::response::trace::{Given, execute};
use solver::settings::Effort;
use solver::{Forced, SearchRange, Settings, State};
use std::ops::ControlFlow;

fn quiet(_: &BranchPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn forced(study: &Study, forcing: f64) -> Forced<'_> {
    let reach = SearchRange::new(&study.settings, &study.backbones[0]).unwrap();
    Forced::new(&study.model, &study.settings, reach, forcing)
}

/// What the first batches land on.
fn landed(study: &Study, forcing: f64, batches: usize) -> Vec<State> {
    let mut forced = forced(study, forcing);
    let of_batch = |batch| land(&mut forced, &StartPlace::random(batch)).unwrap_or_default();
    (0..batches).flat_map(of_batch).map(|landing| landing.state).collect()
}

#[test]
fn starts_find_the_isola_of_an_absorber_that_no_window_leads_to() {
    let study = Study::new(shipped("nltva", &[]), Settings::default());
    let level = study.level(0.15);
    assert!(level.iter().all(|listed| listed.kind == Kind::Main), "{level:#?}");
    let mut forced = forced(&study, 0.15);
    let states = landed(&study, 0.15, 16);
    assert!(states.len() > 4 * BATCH, "{} of {} landed", states.len(), 16 * BATCH);
    let balance = Balance::new(&study.model);
    let worst = states.iter().map(|state| balance.residual(state).relative()).fold(0.0, f64::max);
    assert!(worst < 1e-9, "{worst:e}");
    // 1.58329571 to 2.30378026 rad/s: two other programs and an independent harmonic balance.
    let isola = states.iter().find_map(|state| {
        if level.iter().any(|listed| forced.lies_on(state, &listed.branch)) {
            return None;
        }
        let branch = forced.branch_through(state, &mut quiet).ok()?;
        branch.is_closed().then(|| branch.frequency_range())
    });
    let (low, high) = isola.expect("an isola");
    assert!((low / 1.58329571 - 1.0).abs() < 1e-6 && (high / 2.30378026 - 1.0).abs() < 1e-6, "{low}, {high}");
}

#[test]
fn batches_depend_on_nothing_but_their_number_and_level() {
    let study = Study::new(shipped("duffing", &[]), Settings::default());
    let all = landed(&study, 0.2, 3);
    let mut forced = forced(&study, 0.2);
    let last = land(&mut forced, &StartPlace { round: 5, ..StartPlace::random(2) }).unwrap();
    let last: Vec<State> = last.into_iter().map(|landing| landing.state).collect();
    assert!(last.len() > 1 && all.ends_with(&last));
    assert_ne!(all[0], landed(&study, 0.21, 1)[0]);
}

/// The motion of three periods of the force is born at A = 1.4174 (shooting, in the model's file): below, nothing leads there, and a
/// scout beyond meets it.
#[test]
fn a_scout_leads_back_to_where_an_isola_is_born() {
    let study = Study::new(shipped("duffing_subharmonic", &[]), Settings::default());
    let mut forced = forced(&study, 1.5);
    let scout = ScoutPlace { number: 0, batches: 8 };
    let mut task = |task, landings: &[Landing]| {
        let given = Given { landings, ..Given::default() };
        execute(&mut forced, &task, &given, &mut quiet).expect("it is not cancelled")
    };
    let TaskResult::Landings(folds) = task(Task::Scout(scout), &[]) else { panic!("there are folds") };
    assert_eq!(task(Task::Scout(scout), &[]), TaskResult::Landings(folds.clone()));
    let balance = Balance::new(&study.model);
    for Landing { state, .. } in &folds {
        assert_eq!(state.forcing, 1.25 * 1.5);
        let residual = balance.residual(state).relative();
        assert!(residual < 1e-8, "{residual:e}");
    }
    let births = (0..folds.len()).filter_map(|fold| {
        let TaskResult::Curve(curve) = task(Task::Fold(FoldPlace::Scout { scout, fold }), &folds) else { return None };
        let born = curve.events.iter().find(|event| event.kind == CriticalKind::Birth)?;
        Some(curve.points[born.index].state.forcing)
    });
    let births: Vec<f64> = births.collect();
    assert!(births.iter().any(|birth| (birth / 1.4174 - 1.0).abs() < 1e-4), "{births:?}");
}

/// Isolas as `subharmonics.rs` has them, of a smooth spring and of a stop, from motions that a force on their fundamental drives.
#[test]
fn homotopies_lead_to_motions_of_several_periods_of_the_force() {
    for (name, harmonics, forcing, (low, high)) in [
        ("duffing_subharmonic", 21, 1.5, (1.157_770_851, 1.408_625_575)),
        ("duffing_subharmonic", 21, 2.0, (1.088_198_745, 1.780_832_447)),
        ("stop_subharmonic", 20, 0.7, (1.087_020_752, 1.164_294_307)),
        ("stop_subharmonic", 20, 1.0, (1.043_542_781, 1.230_087_607)),
    ] {
        let study = Study::new(shipped(name, &[]), with_harmonics(harmonics));
        let mut forced = forced(&study, forcing);
        let balance = Balance::new(&study.model);
        let is_known = |found: (f64, f64)| (found.0 / low - 1.0).abs() < 1e-5 && (found.1 / high - 1.0).abs() < 1e-5;
        let leads_there = |batch| {
            let landings = land(&mut forced, &StartPlace::homotopy(batch)).unwrap();
            landings.iter().map(|landing| &landing.state).any(|state| {
                let residual = balance.residual(state).relative();
                assert!(residual < 1e-8, "{name}, A = {forcing}: {residual:e}");
                let branch = forced.branch_through(state, &mut quiet);
                branch.is_ok_and(|branch| branch.is_closed() && is_known(branch.frequency_range()))
            })
        };
        assert!((0..4).any(leads_there), "{name}, A = {forcing}");
    }
}

#[test]
fn a_run_affords_as_many_starts_as_its_model_is_small() {
    let (small, blade) = (shipped("duffing", &[]), shipped("rotor67", &[]));
    let mut settings = Settings::default();
    let (few, many) = (batches(&blade, &settings), batches(&small, &settings));
    assert!((1..8).contains(&few) && BATCH * many == 16384, "{few}, {many}");
    settings.search.effort = Effort::Thorough;
    assert_eq!(batches(&blade, &settings), 16 * few);
    settings.search.starts = Some(100);
    assert_eq!([&small, &blade].map(|model| batches(model, &settings)), [100_usize.div_ceil(BATCH); 2]);
    settings.search.effort = Effort::None;
    assert_eq!(batches(&blade, &settings), 0);
    for (batches, levels) in [(64, 7), (2, 7), (64, 1), (0, 3)] {
        let shares: Vec<usize> = (0..levels).map(|level| share(batches, level, levels)).collect();
        assert_eq!(shares.iter().sum::<usize>(), batches);
        assert!(shares.iter().max().unwrap() - shares.iter().min().unwrap() <= 1, "{shares:?}");
    }
}
