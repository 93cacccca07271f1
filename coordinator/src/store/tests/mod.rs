//! What is stored comes back; what is not a run is told.

mod files;
mod writing;

use super::*;
use crate::fixture::{Study, commit};
use crate::ledger::{Ledger, Rules};
use protocol::array::Array;
use protocol::branch::BranchMessage;
use protocol::codec::{encode, sha256};
use protocol::curve::Points;
use solver::task::BranchId;
use std::time::Duration;
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

    let message = BackboneMessage::from(&study.backbone);
    store.set_backbone(&message, &study.reach, &study.plans).unwrap();
    store.set_stage(Stage::Cancelled).unwrap();
    drop(store);
    let store = Store::open(dir.path()).unwrap();
    assert_eq!(store.stage().unwrap(), Stage::Cancelled);
    assert_eq!(encode(&store.backbone().unwrap().unwrap()), encode(&message));
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
    let done = store.done().unwrap();
    assert_eq!(done.len(), results.len());
    assert!(results.iter().any(|result| result.name == Some(BranchId::Isola(0))));
    assert!(results.iter().any(|result| result.branch.is_none()));
    for ((done, result), sequence) in done.iter().zip(&results).zip(1..) {
        let bytes = encode(&store.result(&result.task).unwrap().unwrap());
        assert_eq!(bytes, encode(result));
        assert_eq!((done.sequence, &done.task), (sequence, &result.task));
        assert_eq!((done.size, &done.sha256), (bytes.len() as u64, &sha256(&bytes)));
        assert_eq!((done.outcome, done.branch), (result.outcome, result.name));
        assert_eq!(done.amplitude, result.amplitude);
        let summary = store.summary(&result.task).unwrap();
        assert_eq!(summary, result.branch.as_ref().map(Summary::of));
    }
    assert_eq!(store.done_since(3).unwrap(), done[3..]);
    assert!(store.result(&"0.006-99".parse().unwrap()).unwrap().is_none());
    let counts = store.counts().unwrap();
    assert_eq!((counts.done, counts.branches), (results.len(), 3));
    assert_eq!((counts.waiting, counts.running, counts.dead), (0, 0, 0));
}

#[test]
fn summaries_agree_to_a_tolerance() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (store, results) = study.finished(dir.path());
    let summary = store.summary(&results[0].task).unwrap().unwrap();
    let near = Summary { amplitude_max: summary.amplitude_max * (1.0 + 1e-7), ..summary };
    assert!(summary.agrees(&near, 1e-6) && !summary.agrees(&near, 1e-8));
    let no_points = BranchMessage { points: Points::new([].iter()), ..results[0].branch.clone().unwrap() };
    assert!(!summary.agrees(&Summary::of(&no_points), 1e-6));
}

#[test]
fn numbers_that_columns_cannot_hold_come_back() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (_, results) = study.finished(&dir.path().join("a"));
    let (mut store, mut sweep) = study.begin(&dir.path().join("b"));
    let (granted, lease) = sweep.lease(&mut store, 0, Duration::ZERO).unwrap();
    let (_, records) = sweep.ledger.submit(&lease, None);
    let mut result = results.iter().find(|result| result.task == granted.task).unwrap().clone();
    let points = &mut result.branch.as_mut().unwrap().points;
    let odd = [f64::NAN, -0.0, f64::INFINITY, f64::MIN_POSITIVE, 3.0];
    let spoil = |array: &Array| {
        let values = array.values("spoilt", &[array.len()]).unwrap();
        Array::new(array.shape.clone(), values.into_iter().enumerate().map(|(i, v)| *odd.get(i).unwrap_or(&v)))
    };
    points.residual = spoil(&points.residual);
    points.iterations = spoil(&points.iterations);
    result.seconds = f64::NAN;
    let (bytes, hash) = (encode(&result), sha256(&encode(&result)));
    commit(&mut store, &records);
    let size = bytes.len() as u64;
    store.commit(&[Change::Result { result: &result, sequence: 1, size, sha256: &hash }]).unwrap();
    assert_eq!(encode(&store.result(&result.task).unwrap().unwrap()), bytes);
}

#[test]
fn an_interrupted_run_goes_on() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (_, expected) = study.finished(&dir.path().join("whole"));
    let dir = dir.path().join("parts");
    let (mut store, mut sweep) = study.begin(&dir);
    let hour = |count: u64| Duration::from_secs(3600 * count);
    for count in 0..3 {
        sweep.fail(&mut store, "out of memory", hour(count));
    }
    let (granted, lease) = sweep.lease(&mut store, 1, hour(4)).unwrap();
    let records = sweep.ledger.tick(hour(5));
    commit(&mut store, &records);
    let (_, held) = sweep.lease(&mut store, 2, hour(6)).unwrap();
    assert_eq!((&held.task, lease.attempt.0, held.attempt.0), (&granted.task, 1, 2));
    drop(store);

    let mut store = Store::open(&dir).unwrap();
    let tasks = store.tasks().unwrap();
    let (mut ledger, _) = Ledger::restore(Rules::default(), store.plans().unwrap(), tasks, hour(7));
    assert_eq!(ledger.counts(), sweep.ledger.counts());
    assert_eq!(store.counts().unwrap(), ledger.counts());
    assert_eq!(ledger.dead(), sweep.ledger.dead());
    assert_eq!(ledger.dead()[0].1, vec!["worker-1: out of memory"; 3]);
    let stored = store.tasks().unwrap().into_iter().find(|task| task.id == held.task).unwrap();
    assert_eq!((stored.attempts, stored.reasons), (2, vec!["worker-1: no sign of life".to_string()]));
    assert!(ledger.renew(&held, None, hour(7)) == protocol::to_worker::RenewReply::Ok);

    commit(&mut store, &ledger.retry_dead());
    assert!(store.tasks().unwrap().iter().all(|task| task.reasons.len() < 3));
    commit(&mut store, &ledger.release(&held, hour(8)).1);
    sweep.ledger = ledger;
    for _ in 0..5 {
        sweep.step(&mut store);
    }
    drop(store);
    let mut store = Store::open(&dir).unwrap();
    (sweep.ledger, _) = Ledger::restore(Rules::default(), store.plans().unwrap(), store.tasks().unwrap(), hour(9));
    while sweep.step(&mut store) {}
    for result in expected {
        let stored = store.result(&result.task).unwrap().unwrap();
        assert_eq!((stored.outcome, stored.name, stored.branch), (result.outcome, result.name, result.branch));
    }
    assert_eq!(sweep.ledger.counts(), store.counts().unwrap());
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
            let expected = point.state.combine(study.model.modes.shapes.row(dof).iter().copied());
            assert_eq!(series[(2 * p + dof) * 7..][..7], expected);
        }
    }
    let names: String = store.one("SELECT displacement_dofs FROM model", [], |row| row.get(0)).unwrap().unwrap();
    assert_eq!(names, r#"["x1","x2"]"#);
}
