//! A report says what the store says, at every stage, and what is missing.

use super::*;
use crate::curves::{ResonanceComparison, Touch};
use crate::fixture::Study;
use crate::store::{Reader, Store, WindowOutcome};
use protocol::to_everyone::Stage;
use rusqlite::Connection;
use solver::response::windows::EventKind;
use std::fs;
use std::path::Path;
use tempfile::tempdir;

fn read(store: &Reader) -> Report {
    Report::read(store, &Selection::Fitting).unwrap()
}

/// Does something to the file of a finished run that no program of ours does.
fn damaged(run: &Path, sql: &str) -> Report {
    drop(Study::damper().finished(run));
    Connection::open(run.join(crate::store::FILE)).unwrap().execute_batch(sql).unwrap();
    read(&Reader::open(run).unwrap())
}

#[test]
fn figures_turn_to_the_mode_that_led_to_an_isola() {
    let dir = tempdir().unwrap();
    let (store, _) = Study::of_modes("two_masses_stop", 3, &["0.01", "0.02"], 2).finished(dir.path());
    let mut report = read(&store);
    let mode = |report: &Report| report.backbone.as_ref().unwrap().mode + 1;
    let [primary, other] = [mode(&report), report.further[0].mode + 1];
    report.turn_to_isola(Some(0));
    assert_eq!(mode(&report), primary);
    let window = &mut report.overview.levels[1].windows[0];
    (window.mode, window.outcome) = (other, WindowOutcome::Found("isola 1".into()));
    assert_eq!(report.overview.levels[1].mode_of_isola(), Some(other));
    // None led to one at the first level: that of the lowest level where one did.
    report.turn_to_isola(Some(0));
    assert_eq!(mode(&report), other);
    report.turn_to(primary).unwrap();
    report.turn_to_isola(Some(1));
    assert_eq!([mode(&report), report.further[0].mode + 1], [other, primary]);
}

#[test]
fn a_finished_run() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (store, results) = study.finished(dir.path());
    let report = read(&store);
    assert!(report.run.missing.is_empty(), "{:?}", report.run.missing);

    let names: Vec<(usize, &str)> = report.branches.iter().map(|curve| (curve.level, curve.name.as_str())).collect();
    assert_eq!(names, [(0, "main"), (1, "main"), (1, "isola 1")]);
    for curve in &report.branches {
        let result = results.iter().find(|result| result.task.to_string() == curve.task).unwrap();
        let points = &result.branch.as_ref().unwrap().points;
        assert_eq!(curve.omega.values, points.motions.omega.values("omega", &[curve.size]).unwrap());
        assert_eq!(curve.amplitude.len(), study.model.monitors().len());
        assert!(curve.other("contact").unwrap().values[0].values.iter().all(|share| share.is_nan()));
    }

    assert_eq!(report.figures.nothing.keys().collect::<Vec<_>>(), [&"folds", &"modes"]);
    let backbone = report.backbone.unwrap();
    assert_eq!(backbone.threshold.values.len(), study.backbone.points.len());
    let kinds: Vec<EventKind> = backbone.events.iter().map(|event| event.kind).collect();
    assert_eq!(
        kinds,
        solver::response::windows::events(&study.backbone).iter().map(|event| event.kind).collect::<Vec<_>>()
    );
    assert_eq!(backbone.modes[0].mode, study.backbone.mode);
    assert_eq!(report.account.tasks.len(), study.plans.iter().map(|plan| plan.tasks.len()).sum::<usize>());
    assert_eq!(report.account.settings, [("model".to_string(), "\"damper\"".to_string())]);
}

#[test]
fn three_ways() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (store, _) = study.finished(dir.path());
    let report = read(&store);
    let ResonanceComparison { continuation, balance, isolas } = &report.resonance;
    assert_eq!((&continuation.value, &isolas.value), (&vec![0.003, 0.006], &vec![0.003, 0.006]));
    assert_eq!(continuation.amplitude[0], isolas.amplitude[0]);
    assert!(isolas.amplitude[1] > continuation.amplitude[1]);
    // The balance alone: the largest amplitude of the backbone that the forcing reaches.
    for (value, amplitude) in balance.value.iter().zip(&balance.amplitude) {
        let reached = study.backbone.points.iter().filter(|point| point.threshold() <= *value);
        let largest = reached.map(|point| point.point.amplitude()).fold(0.0, f64::max);
        // At a birth the curve has the value before as well.
        let is_step = balance.value.iter().filter(|other| *other == value).count() == 2;
        // At the last level it is between two points.
        let is_last = *value == 0.006;
        let is_there = *amplitude == largest || is_step && *amplitude < largest || is_last && *amplitude > largest;
        assert!(is_there, "{amplitude} and {largest} at A = {value}");
    }
    assert!(balance.value.is_sorted() && balance.amplitude.is_sorted());
    assert_eq!(*balance.value.last().unwrap(), 0.006);
}

/// A series over the period.
fn samples(series: &[f64]) -> impl Iterator<Item = f64> {
    (0..2000).map(|i| solver::formulation::harmonics::evaluate(series, i as f64 * std::f64::consts::TAU / 2000.0)[0])
}

#[test]
fn motions_are_those_of_the_branches() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (store, _) = study.finished(dir.path());
    let report = read(&store);
    let motions = report.motions;
    let width = 2 * motions.harmonics + 1;
    assert_eq!(motions.nodes.len(), report.monitors.len());
    assert!(
        report
            .branches
            .iter()
            .enumerate()
            .all(|(b, curve)| { motions.points.iter().any(|motion| (motion.branch, motion.index) == (b, curve.peak)) })
    );
    for motion in &motions.points {
        for (node, series) in motion.coefficients.values.chunks(2 * width).enumerate() {
            let largest = samples(&series[..width]).map(f64::abs).fold(0.0, f64::max);
            let stored = report.branches[motion.branch].amplitude[node].values[motion.index];
            assert!((largest / stored - 1.0).abs() < 1e-4, "{largest} and {stored}");
        }
    }
}

#[test]
fn pressures_are_positive_while_nodes_touch() {
    let (study, dir) = (Study::new("two_masses_stop", 3, &["0.02"]), tempdir().unwrap());
    let (store, _) = study.finished(dir.path());
    let report = read(&store);
    let motions = report.motions;
    let is_node: Vec<bool> = motions.nodes.iter().map(|node| node.gap.is_some()).collect();
    assert_eq!(is_node, [true, false, false]);
    let mut touching = 0;
    for motion in &motions.points {
        let count = 2 * motions.harmonics + 1;
        let pressure = &motion.coefficients.values[count..2 * count];
        let share = samples(pressure).filter(|pressure| *pressure > 0.0).count() as f64 / 2000.0;
        let stored = report.branches[motion.branch].other("contact").unwrap().values[0].values[motion.index];
        assert!((share - stored).abs() < 2e-3, "{share} and {stored}");
        touching += usize::from(stored > 0.0);
    }
    assert!(touching > 3 && touching < motions.points.len(), "{touching} of {}", motions.points.len());
}

#[test]
fn a_monitored_dof_normal_to_the_casing_has_a_gap() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/rotor67");
    let model = solver::files::load(&folder).unwrap();
    assert_eq!(monitors(&model), [Monitor { name: "b0.r".into(), touch: Some(Touch { at: 4e-4, is_gap: true }) }]);
}

#[test]
fn at_every_stage() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let store = Store::create(&dir.path().join("empty"), &study.header()).unwrap();
    let report = read(&store);
    assert!(report.backbone.is_none() && report.branches.is_empty() && report.motions.points.is_empty());
    assert_eq!(report.run.missing, ["There is no backbone yet, and so there are no windows and no branches."]);
    assert_eq!(report.verdict[0].text, "No branch has been computed yet.");
    let lost =
        "Not all is known. The run is not finished. The backbone is not known, nor what its energy balance predicts.";
    assert_eq!(report.verdict[0].lead.as_deref(), Some(lost));

    let (mut store, mut sweep) = study.begin(&dir.path().join("run"));
    assert!(sweep.step(&mut store));
    let report = read(&store);
    assert_eq!((report.run.stage, report.branches.len()), (Some(Stage::Sweep), 1));
    assert!(report.run.missing[0].contains("still to be done, at A = 3e-3, 0.006"), "{:?}", report.run.missing);
    let text = &report.verdict[2].text;
    assert!(text.starts_with("No isola has been found so far where it was looked for"), "{text}");
    let lost = "Not all is known (not finished; 2 levels unfinished).";
    assert_eq!(report.verdict[2].lead.as_deref(), Some(lost));
    let reach = report.verdict[0].reach.as_deref().unwrap();
    assert!(reach.starts_with("Looked at: 0.88184 rad/s"), "{reach}");
    assert!(reach.contains("others may lie there. Looked for: the windows of mode 1"), "{reach}");
}

#[test]
fn of_a_damaged_run_what_is_left() {
    let dir = tempdir().unwrap();
    let isola = "(SELECT task FROM branches WHERE kind = 'isola')";
    let sql = format!("UPDATE arrays SET data = zeroblob(length(data)) WHERE name = 'modal' AND owner = {isola}");
    let report = damaged(&dir.path().join("a"), &sql);
    assert_eq!(report.branches.iter().map(|curve| &*curve.name).collect::<Vec<_>>(), ["main", "main"]);
    assert_eq!(report.run.missing.len(), 1);
    assert!(report.run.missing[0].starts_with("The branch of task 0.006-"), "{}", report.run.missing[0]);
    // What the store's tables say of it is still there.
    assert!(report.verdict[2].text.starts_with("Yes. At A = 0.006 "), "{}", report.verdict[2].text);
    let lost = "Not all is known. The file of the run is damaged: 1 part of it is left out, and what was found may be missing.";
    assert!(report.verdict[0].lead.as_deref().is_some_and(|lead| lead.starts_with(lost)), "{:?}", report.verdict[0]);

    // Numbers that do not agree with each other are not shown.
    let report = damaged(&dir.path().join("c"), "UPDATE branches SET amplitude_max = 99 WHERE kind = 'isola'");
    assert_eq!(report.branches.len(), 2);
    assert!(report.run.missing[0].contains("in the table of branches are others"), "{:?}", report.run.missing);
    let report = damaged(&dir.path().join("d"), "UPDATE windows SET last = 100000 WHERE level = 1");
    assert!(report.overview.levels[0].windows.is_empty() && !report.overview.levels[1].windows.is_empty());
    assert!(report.run.missing[0].ends_with("left out: they are none of the backbone."), "{:?}", report.run.missing);
    let report = damaged(&dir.path().join("e"), "UPDATE tasks SET attempts = 'x'");
    assert!(report.account.tasks.is_empty() && !report.account.settings.is_empty());

    let report = damaged(&dir.path().join("f"), "UPDATE backbone SET omega = NULL WHERE i = 3");
    assert!(report.backbone.is_none());
    assert!(
        report.run.missing.iter().any(|sentence| sentence.ends_with("has entries that are not finite.")),
        "{:?}",
        report.run.missing
    );

    let sql = "DELETE FROM arrays WHERE owner = 'backbone' AND name = 'argument'";
    let report = damaged(&dir.path().join("b"), sql);
    assert!(report.backbone.is_none());
    assert_eq!(report.branches.len(), 3);
    assert!(report.run.missing[0].starts_with("The backbone is left out"), "{:?}", report.run.missing);
}

#[test]
fn of_a_file_cut_short_what_is_left() {
    let dir = tempdir().unwrap();
    drop(Study::damper().finished(dir.path()));
    let file = fs::OpenOptions::new().write(true).open(dir.path().join(crate::store::FILE)).unwrap();
    file.set_len(file.metadata().unwrap().len() * 3 / 4).unwrap();
    let report = read(&Reader::open(dir.path()).unwrap());
    assert!(report.branches.len() < 3 && !report.omissions.damaged.is_empty());
    assert_eq!((report.run.name.as_str(), report.overview.levels.len()), ("test", 2));
}

#[test]
fn levels_are_chosen() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (store, _) = study.finished(dir.path());
    let report = Report::read(&store, &Selection::Amplitudes(vec![0.003])).unwrap();
    assert_eq!((report.branches.len(), report.overview.levels.len()), (1, 1));
    assert!(report.account.tasks.iter().all(|task| task.level == 0 && task.task.starts_with("3e-3-")));
    assert!(report.run.missing.is_empty(), "{:?}", report.run.missing);
    let report = Report::read(&store, &Selection::NoBranches).unwrap();
    assert_eq!((report.branches.len(), report.overview.levels.len()), (0, 2));
}

/// On a terminal, what else is known stands in points below the answer.
#[test]
fn an_answer_on_a_terminal() {
    let answer = Sentence {
        title: "Where?",
        lead: Some("Not all is known.".into()),
        text: "Here and there.".into(),
        lost: None,
        details: vec!["It is stable.".into()],
        reach: Some("Looked at: all of it.".into()),
    };
    let lines = "Where?\nNot all is known.\nHere and there.\n- It is stable.\n- Looked at: all\n  of it.";
    assert_eq!(answer.lines(17), lines);
    assert_eq!(answer.whole(), "Not all is known. Here and there. It is stable. Looked at: all of it.");
}
