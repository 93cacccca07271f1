//! A run that was interrupted goes on: the ledger is restored from what the store has.

use coordinator::ledger::{Granted, Leased, Ledger, Rules, Submitted};
use protocol::branch::BranchMessage;
use protocol::from_worker::Lease;
use protocol::to_everyone::StoredResult;
use results::fixture::{Study, accepted, worker};
use results::journal::Change;
use results::store::Store;
use solver::response::branch::{Branch, BranchPoint};
use solver::response::forced::Forced;
use solver::response::task::{BranchId, Finding, SeedOutcome, carry_out};
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::time::Duration;
use tempfile::tempdir;

/// One worker whose tasks come from a ledger.
struct Sweep<'s> {
    study: &'s Study,
    ledger: Ledger,
    branches: HashMap<protocol::ids::TaskId, Branch>,
}

impl Sweep<'_> {
    fn lease(&mut self, store: &mut Store, slot: u32, now: Duration) -> Option<(Granted, Lease)> {
        let (leased, changes) = self.ledger.lease(&worker(), slot, now);
        store.commit(&changes).unwrap();
        let Leased::Grant(granted) = leased else { return None };
        let lease = Lease { task: granted.task.clone(), attempt: granted.attempt, worker: worker(), slot };
        Some((granted, lease))
    }

    fn fail(&mut self, store: &mut Store, reason: &str, now: Duration) {
        let (_, lease) = self.lease(store, 0, now).unwrap();
        let (held, changes) = self.ledger.fail(&lease, reason, now);
        assert!(held);
        store.commit(&changes).unwrap();
    }

    /// Carries out a task; false if there is none left.
    fn step(&mut self, store: &mut Store) -> bool {
        let Some((granted, lease)) = self.lease(store, 0, Duration::from_secs(360_000)) else { return false };
        let study = self.study;
        let mut forced = Forced::new(&study.model, &study.settings, study.reach, granted.amplitude.value);
        let seeds = granted.work.seeds(forced.modal(), &study.backbone, granted.amplitude.value);
        let known: Vec<(BranchId, &Branch)> =
            granted.known.iter().map(|known| (known.branch, &self.branches[&known.task])).collect();
        let observer = &mut |_: &BranchPoint| ControlFlow::Continue(());
        let finding = carry_out(&mut forced, &granted.work, &seeds, &known, observer).unwrap();
        let (submitted, mut changes) = self.ledger.submit(&lease, finding.brought());
        let Submitted::Accepted(done) = submitted else { panic!("accepted") };
        let branch = match finding {
            Finding::Branch(branch) => Some(branch),
            Finding::Nothing(_) => None,
        };
        let name = match done.outcome {
            SeedOutcome::Found(id) if branch.is_some() => Some(id),
            _ => None,
        };
        let result = StoredResult {
            task: granted.task.clone(),
            attempt: granted.attempt,
            amplitude: done.amplitude,
            work: done.work,
            outcome: done.outcome,
            name,
            branch: branch.as_ref().map(BranchMessage::from),
            worker: worker(),
            program: "0.1.0".into(),
            seconds: 0.25,
        };
        changes.push(Change::Result(accepted(result, done.sequence)));
        store.commit(&changes).unwrap();
        self.branches.extend(branch.map(|branch| (granted.task, branch)));
        true
    }
}

#[test]
fn an_interrupted_run_goes_on() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (_, expected) = study.finished(&dir.path().join("whole"));
    let dir = dir.path().join("parts");
    let (mut store, _) = study.begin(&dir);
    let ledger = Ledger::new(Rules::default(), study.plans.clone());
    let mut sweep = Sweep { study: &study, ledger, branches: HashMap::new() };
    let hour = |count: u64| Duration::from_secs(3600 * count);
    for count in 0..3 {
        sweep.fail(&mut store, "out of memory", hour(count));
    }
    let (granted, lease) = sweep.lease(&mut store, 1, hour(4)).unwrap();
    let changes = sweep.ledger.tick(hour(5));
    store.commit(&changes).unwrap();
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

    store.commit(&ledger.retry_dead()).unwrap();
    assert!(store.tasks().unwrap().iter().all(|task| task.reasons.len() < 3));
    store.commit(&ledger.release(&held, hour(8)).1).unwrap();
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
