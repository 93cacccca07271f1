//! Steps of tasks under way come back in their order, and go with the task.

use super::*;
use crate::journal::{AttemptEnd, CheckpointPart, Kept};
use protocol::ids::Attempt;
use protocol::steps::Steps;
use solver::curve::continuation::CurvePoint;
use solver::curve::record::{Ahead, Step};

/// More bytes than anything here has.
const ALL: usize = 1 << 20;

fn step(i: usize) -> Step {
    let (iterations, factorisations, residual, orientation) = (2, 1, 1e-13, 1.0);
    let point = CurvePoint {
        y: vec![i as f64; 3],
        tangent: vec![0.5; 3],
        iterations,
        factorisations,
        residual,
        orientation,
        step: 0.1,
    };
    let ahead = Ahead { step: 0.1, longest: f64::INFINITY, is_narrow: false, rejections: 0, is_refreshed: true };
    Step { walk: 1, point, ahead, memory: Vec::new() }
}

fn part(task: &TaskId, attempt: u32, first: usize) -> (Steps, Change) {
    let steps = Steps::new("a".into(), first, &[step(first), step(first + 1)]);
    let (task, attempt, payload) = (task.clone(), Attempt(attempt), encode(&steps));
    (steps, Change::Checkpoint(CheckpointPart { task, attempt, first, steps: 2, payload }))
}

#[test]
fn steps_are_kept_until_they_are_of_no_use() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, mut sweep) = study.begin(dir.path());
    let granted = sweep.lease(&mut store, 0).unwrap();
    let task = granted.task;
    assert!(store.kept().unwrap().is_empty() && store.checkpoint(&task, 0, ALL).unwrap().is_none());
    let ((first, one), (second, other)) = (part(&task, 1, 0), part(&task, 2, 2));
    store.commit(&[one, other]).unwrap();
    let bytes = encode(&first).len() + encode(&second).len();
    assert_eq!(store.kept().unwrap(), [(task.clone(), Kept { steps: 4, bytes, attempt: Attempt(2) })].into());
    let parts = |store: &Store, from, most| store.checkpoint(&task, from, most).unwrap().map(|kept| kept.parts);
    assert_eq!(parts(&store, 0, ALL).unwrap(), [first.clone(), second.clone()]);
    // As many as there is room for, and at least one.
    assert_eq!(parts(&store, 0, bytes - 1).unwrap(), std::slice::from_ref(&first));
    assert_eq!(parts(&store, 0, 1).unwrap(), std::slice::from_ref(&first));
    assert_eq!(parts(&store, 2, 1).unwrap(), [second]);
    assert!(parts(&store, 4, ALL).is_none());
    // The first ones replace all.
    store.commit(&[part(&task, 3, 0).1]).unwrap();
    assert_eq!(parts(&store, 0, ALL).unwrap(), [first]);
    let attempt = granted.attempt;
    let ended = |end: AttemptEnd| Change::Ended { task: task.clone(), attempt, end };
    store.commit(&[ended(AttemptEnd::Expired), ended(AttemptEnd::Released)]).unwrap();
    assert_eq!(store.kept().unwrap()[&task].steps, 2);
    store.commit(&[ended(AttemptEnd::Failed("x".into()))]).unwrap();
    assert!(store.kept().unwrap().is_empty());
    let outcome = SeedOutcome::OutOfBounds;
    let done = Change::Done { task: task.clone(), attempt, outcome, sequence: 1 };
    store.commit(&[part(&task, 3, 0).1, done]).unwrap();
    assert!(store.kept().unwrap().is_empty());
}
