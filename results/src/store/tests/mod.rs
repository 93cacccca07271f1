//! What is stored comes back; what is not a run is told.

mod checkpoints;
mod columns;
mod files;
mod repeats;
mod verifications;
mod writing;

use super::*;
use crate::fixture::{Study, accepted};
use crate::journal::{AcceptedResult, Change};
use protocol::array::Array;
use protocol::branch::BranchMessage;
use protocol::codec::{encode, sha256};
use protocol::curve::Points;
use protocol::digest::Digest;
use protocol::ids::{TaskId, WorkerId};
use protocol::to_everyone::{Stage, StoredResult};
use solver::response::task::{BranchId, SeedOutcome, Task};
use solver::settings::VerifyEffort;
use std::sync::Arc;
use tempfile::tempdir;

#[test]
fn header_backbone_and_plans_come_back() {
    let (study, dir) = (Study::new("two_masses_stop", 3, &["0.05", "2e-2"]), tempdir().unwrap());
    let header = study.header();
    let mut store = Store::create(dir.path(), &header).unwrap();
    assert_eq!(store.header().unwrap(), header);
    assert_eq!(store.stage().unwrap(), Stage::Backbone);
    assert!(store.backbone().unwrap().is_none() && store.reach().unwrap().is_none());
    assert!(store.plans().unwrap().is_empty() && store.tasks().unwrap().is_empty());

    let plan = Arc::new(study.plan());
    store.commit(&[Change::Planned(plan.clone()), Change::Stage(Stage::Cancelled)]).unwrap();
    drop(store);
    let store = Store::open(dir.path()).unwrap();
    assert_eq!(store.stage().unwrap(), Stage::Cancelled);
    assert_eq!(encode(&store.backbone().unwrap().unwrap()), encode(&plan.backbone));
    assert_eq!(store.reach().unwrap(), Some(study.reach));
    for (stored, plan) in store.plans().unwrap().iter().zip(&study.plans) {
        assert_eq!(stored.amplitude, plan.amplitude);
        assert_eq!(stored.windows, plan.windows);
        assert_eq!(stored.tasks, plan.tasks);
    }
    assert_eq!(store.tasks().unwrap().len(), study.plans.iter().map(|plan| plan.tasks.len()).sum::<usize>());
}

#[test]
fn results_come_back_bit_for_bit() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (store, results) = study.finished(dir.path());
    let (done, extents) = (store.done().unwrap(), store.extents().unwrap());
    assert_eq!(done.len(), results.len());
    assert!(results.iter().any(|result| result.name == Some(BranchId::isola(0))));
    assert!(results.iter().any(|result| result.branch.is_none()));
    for ((done, result), sequence) in done.iter().zip(&results).zip(1..) {
        let bytes = encode(&store.result(&result.task).unwrap().unwrap());
        assert_eq!(bytes, encode(result));
        assert_eq!(store.encoded_result(&result.task).unwrap().unwrap(), bytes);
        assert_eq!((done.sequence, &done.task), (sequence, &result.task));
        assert_eq!((done.size, &done.sha256), (bytes.len() as u64, &sha256(&bytes)));
        assert_eq!((done.outcome, done.branch), (result.outcome, result.name));
        assert_eq!(done.amplitude, result.amplitude);
        assert_eq!(extents.get(&result.task).copied(), result.branch.as_ref().map(Extent::of));
    }
    assert_eq!(store.done_since(3).unwrap(), done[3..]);
    assert_eq!(store.done_of(&done[2].task).unwrap().as_ref(), Some(&done[2]));
    assert!(store.result(&"0.006-99".parse().unwrap()).unwrap().is_none());
    let counts = store.counts().unwrap();
    assert_eq!((counts.done, counts.branches), (results.len(), 3));
    assert_eq!((counts.waiting, counts.running, counts.dead), (0, 0, 0));
}

/// Runs of the first programs have the digest of results whose branch came after the name.
#[test]
fn results_of_the_first_runs_come_back_as_they_were_announced() {
    #[derive(serde::Serialize)]
    struct AsAtFirst<'r> {
        task: &'r TaskId,
        attempt: u32,
        amplitude: &'r Amplitude,
        work: &'r Task,
        outcome: &'r SeedOutcome,
        name: Option<BranchId>,
        branch: Option<&'r BranchMessage>,
        worker: &'r WorkerId,
        program: &'r str,
        seconds: f64,
    }
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (_, results) = study.finished(&dir.path().join("a"));
    let (mut store, mut sweep) = study.begin(&dir.path().join("b"));
    let granted = sweep.lease(&mut store, 0).unwrap();
    let result = results.iter().find(|result| result.task == granted.task).unwrap();
    let StoredResult { task, attempt, amplitude, work, outcome, name, branch, worker, program, seconds, .. } = result;
    let (attempt, branch) = (attempt.0, branch.as_ref());
    let (name, seconds) = (*name, *seconds);
    let fields = AsAtFirst { task, attempt, amplitude, work, outcome, name, branch, worker, program, seconds };
    let bytes = rmp_serde::to_vec_named(&fields).unwrap();
    let digest = Digest { size: bytes.len() as u64, sha256: sha256(&bytes) };
    let stored = AcceptedResult { digest, ..accepted(result.clone(), 1) };
    let done = Change::Done { task: task.clone(), attempt: result.attempt, outcome: *outcome, sequence: 1 };
    store.commit(&[done, Change::Result(stored)]).unwrap();
    assert_eq!(store.encoded_result(task).unwrap().unwrap(), bytes);
    assert_eq!(store.result(task).unwrap().as_ref(), Some(result));
}

#[test]
fn summaries_agree_to_a_tolerance() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (store, results) = study.finished(dir.path());
    let extent = store.extents().unwrap()[&results[0].task];
    let near = Extent { amplitude_max: extent.amplitude_max * (1.0 + 1e-7), ..extent };
    assert!(extent.agrees(&near, 1e-6) && !extent.agrees(&near, 1e-8));
    let no_points = BranchMessage { points: Points::new([].iter()), ..results[0].branch.clone().unwrap() };
    assert!(!extent.agrees(&Extent::of(&no_points), 1e-6));
}

#[test]
fn numbers_that_columns_cannot_hold_come_back() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (_, results) = study.finished(&dir.path().join("a"));
    let (mut store, mut sweep) = study.begin(&dir.path().join("b"));
    let granted = sweep.lease(&mut store, 0).unwrap();
    let mut result = results.iter().find(|result| result.task == granted.task).unwrap().clone();
    let points = &mut result.branch.as_mut().unwrap().points;
    let odd = [f64::NAN, -0.0, f64::INFINITY, f64::MIN_POSITIVE, 3.0];
    let spoil = |array: &Array| {
        let values = array.values("spoilt", &[array.len()]).unwrap();
        Array::new(array.shape.clone(), values.into_iter().enumerate().map(|(i, v)| *odd.get(i).unwrap_or(&v)))
    };
    for name in ["residual", "iterations"] {
        let array = points.columns.get_mut(name).unwrap();
        *array = spoil(array);
    }
    result.seconds = f64::NAN;
    let (task, attempt, outcome) = (result.task.clone(), result.attempt, result.outcome);
    let done = Change::Done { task: task.clone(), attempt, outcome, sequence: 1 };
    let bytes = encode(&result);
    store.commit(&[done, Change::Result(accepted(result, 1))]).unwrap();
    assert_eq!(encode(&store.result(&task).unwrap().unwrap()), bytes);
}

#[test]
fn displacements_are_modes_times_modal_amplitudes() {
    let (study, dir) = (Study::new("two_masses_stop", 3, &["0.02"]), tempdir().unwrap());
    let (mut store, mut sweep) = study.begin(dir.path());
    sweep.step(&mut store);
    let (task, branch) = sweep.branches.iter().next().unwrap();
    let array = store.array(task.as_str(), "displacement").unwrap().unwrap();
    let series = array.series("displacement", &[branch.points.len(), 2], 3).unwrap();
    for (p, point) in branch.points.iter().enumerate() {
        for dof in 0..2 {
            let expected = point.state.displacement(&study.model, dof);
            assert_eq!(series[(2 * p + dof) * 7..][..7], expected);
        }
    }
    let names: String = store.one("SELECT displacement_dofs FROM model", [], |row| row.get(0)).unwrap().unwrap();
    assert_eq!(names, r#"["x1","x2"]"#);
}
