//! What a sweep finds does not depend on how it is carried out.

use crate::{DAMPER, FEW, LEVELS};
use tests::results::{SummaryRow, assert_same, events, folds, summary};
use tests::{System, complaint, isola, repository};

/// 1, 2 and 4 workers: the same branches, ranges and peaks.
#[test]
fn the_number_of_workers_does_not_matter() {
    let study = "models/rotor67/study.toml";
    let rows = ["1", "2", "4"].map(|workers| {
        let mut system = System::sweep_with(study, &["--amplitudes", "20", "--workers", workers]);
        system.expect_complete();
        summary(&system.directory())
    });
    assert!(rows[0].iter().any(|row| row.name.1 == "isola"));
    assert_same(&rows[0], &rows[1]);
    assert_same(&rows[0], &rows[2]);
}

/// The absorber's isola is on the backbone of no linear mode: folds of main branches lead to it. Ranges and events are those
/// that two other programs and an independent harmonic balance found.
#[test]
fn an_isola_that_only_folds_lead_to() {
    let study = "models/nltva/study.toml";
    let found = ["1", "3"].map(|workers| {
        let mut system = System::sweep_with(study, &[&["--workers", workers, "--verify", "none"], FEW].concat());
        system.expect_complete();
        let directory = system.directory();
        (summary(&directory), events(&directory), folds(&directory))
    });
    let (rows, events, _) = &found[0];
    let isolas = |amplitude: &str| -> Vec<&Vec<f64>> {
        let of_level = |row: &&SummaryRow| row.name.0 == amplitude && row.name.1 != "main";
        rows.iter().filter(of_level).map(|row| &row.numbers).collect()
    };
    for (amplitude, low, high) in [("0.15", 1.58329571, 2.30378026), ("0.18", 1.4926721, 2.6374968)] {
        let [isola] = isolas(amplitude)[..] else { panic!("A = {amplitude}: {rows:?}") };
        assert!((isola[0] / low - 1.0).abs() < 1e-6 && (isola[1] / high - 1.0).abs() < 1e-6, "{isola:?}");
    }
    assert_eq!(isolas("0.13").len(), 1);
    for amplitude in ["0.11", "0.12", "0.19", "0.20"] {
        assert!(isolas(amplitude).is_empty(), "A = {amplitude}: {rows:?}");
    }
    for (kind, forcing) in [("birth", 0.1246595), ("merge", 0.1856230)] {
        let of_kind: Vec<f64> = events.iter().filter(|(k, _)| k == kind).map(|(_, forcing)| *forcing).collect();
        assert!(of_kind.len() == 1 && (of_kind[0] / forcing - 1.0).abs() < 1e-6, "{kind}: {events:?}");
    }
    assert_eq!(found[0], found[1], "the number of workers does not matter");
}

/// Without the search there is what windows lead to.
#[test]
fn no_search_no_folds() {
    let mut system = System::sweep_with("models/nltva/study.toml", &["--amplitudes", "0.15", "--search", "none"]);
    system.expect_complete();
    assert!(!summary(&system.directory()).is_empty());
    assert!(events(&system.directory()).is_empty() && folds(&system.directory()) == 0);
}

/// The distributed sweep finds what the solver finds in one piece.
#[test]
fn the_same_as_the_solver_alone() {
    let quick = ["--workers", "2", "--search", "none", "--verify", "none"];
    let mut system = System::sweep_with(DAMPER, &[LEVELS, &quick].concat());
    system.expect_complete();
    let study = coordinator::study::Study::load(&tests::repository(DAMPER), &[], Some(LEVELS[1])).unwrap();
    let backbone = solver::response::backbone::Backbone::compute(&study.model, &study.settings).unwrap();
    let mut expected = Vec::new();
    for amplitude in &study.amplitudes {
        let level =
            solver::response::level::Level::compute(&study.model, &study.settings, &backbone, amplitude.value).unwrap();
        for (_, branch) in level.branches() {
            let (low, high) = branch.frequency_range();
            expected.push([low, high, branch.peak().amplitude(), branch.peak().omega()]);
        }
    }
    let found: Vec<Vec<f64>> = summary(&system.directory()).into_iter().map(|row| row.numbers).collect();
    assert_eq!(found, expected);
}

/// Complete, but the main branch or the backbone goes on where it ends: said first, with an exit code of its own, each
/// time.
#[test]
fn curves_that_stop_before_their_ends() {
    let folder = tempfile::tempdir().unwrap();
    let study = repository(DAMPER).display().to_string();
    for (name, key, curve) in [
        ("main", "branch.max_points=12", "the main branch at A = 0.004 (point budget used up)"),
        ("backbone", "backbone.max_points=10", "the backbone of mode 1 (point budget used up)"),
    ] {
        let run = folder.path().join(name).display().to_string();
        let workers = ["--workers", "2"];
        let quick = ["--search", "none", "--verify", "none"];
        let sweep = [&["sweep", &study, "--out", &run, "--amplitudes", "0.004", "--set", key][..], &quick].concat();
        let sweep = [&sweep[..], &workers].concat();
        for arguments in [sweep, [&["resume", &run][..], &workers].concat()] {
            let output = isola(&arguments);
            let said = complaint(&output);
            assert_eq!(output.status.code(), Some(4), "{arguments:?}: {said}");
            let doubts: Vec<&str> = said.lines().filter(|line| line.starts_with("not known to its end: ")).collect();
            assert!(doubts.len() == 1 && doubts[0].contains(curve), "{arguments:?}: {said}");
        }
    }
}
