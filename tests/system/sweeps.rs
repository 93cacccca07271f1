//! What a sweep finds does not depend on how it is carried out.

use crate::{DAMPER, LEVELS};
use tests::System;
use tests::results::{assert_same, summary};

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
