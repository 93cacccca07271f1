//! What a sweep finds does not depend on how it is carried out.

use crate::{DAMPER, LEVELS};
use tests::results::{assert_same, summary};
use tests::{System, complaint, isola, repository};

/// 1, 2 and 4 workers: the same branches, ranges and peaks.
#[test]
fn the_number_of_workers_does_not_matter() {
    let study = "models/rotor67/study.toml";
    let rows = ["1", "2", "4"].map(|workers| {
        let mut system = System::sweep_with(study, &["--amplitudes", "20,60", "--workers", workers]);
        system.expect_complete();
        summary(&system.directory())
    });
    assert!(rows[0].iter().any(|row| row.name.1 == "isola"));
    assert_same(&rows[0], &rows[1]);
    assert_same(&rows[0], &rows[2]);
}

/// The distributed sweep finds what the solver finds in one piece.
#[test]
fn the_same_as_the_solver_alone() {
    let mut system = System::sweep_with(DAMPER, &[LEVELS, &["--workers", "2"]].concat());
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
        ("backbone", "backbone.max_points=10", "the backbone (point budget used up)"),
    ] {
        let run = folder.path().join(name).display().to_string();
        let workers = ["--workers", "1"];
        let sweep = [&["sweep", &study, "--out", &run, "--amplitudes", "0.004", "--set", key][..], &workers].concat();
        for arguments in [sweep, [&["resume", &run][..], &workers].concat()] {
            let output = isola(&arguments);
            let said = complaint(&output);
            assert_eq!(output.status.code(), Some(4), "{arguments:?}: {said}");
            let doubts: Vec<&str> = said.lines().filter(|line| line.starts_with("not known to its end: ")).collect();
            assert!(doubts.len() == 1 && doubts[0].contains(curve), "{arguments:?}: {said}");
        }
    }
}
