//! A run that was interrupted goes on: the ledger is restored from what the store has.

use coordinator::ledger::{Granted, Leased, Ledger, Rules, Submitted};
use protocol::branch::BranchMessage;
use protocol::critical::CriticalMessage;
use protocol::from_worker::Lease;
use protocol::ids::TaskId;
use protocol::landings::LandingsMessage;
use protocol::to_everyone::StoredResult;
use results::fixture::{Study, accepted, worker};
use results::journal::{Change, TaskState};
use results::report::{Report, Selection};
use results::store::{CurveRow, Store};
use solver::response::branch::{Branch, BranchPoint};
use solver::response::critical::CriticalCurve;
use solver::response::forced::Forced;
use solver::response::seeds::Landing;
use solver::response::task::{BranchId, Brought, SeedOutcome, TaskResult};
use solver::response::trace::{Given, execute};
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::time::Duration;
use tempfile::tempdir;

/// One worker whose tasks come from a ledger.
struct Sweep<'s> {
    study: &'s Study,
    ledger: Ledger,
    branches: HashMap<TaskId, Branch>,
    curves: HashMap<TaskId, CriticalCurve>,
    landings: HashMap<TaskId, Vec<Landing>>,
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
        let curves: Vec<(usize, &CriticalCurve)> =
            granted.curves.iter().map(|known| (known.number, &self.curves[&known.task])).collect();
        let landings = granted.landing.as_ref().map_or(&[][..], |task| &self.landings[task]);
        let given = Given { seeds: &seeds, landings, known: &known, curves: &curves };
        let observer = &mut |_: &BranchPoint| ControlFlow::Continue(());
        let finding = execute(&mut forced, &granted.work, &given, observer).unwrap();
        let (submitted, mut changes) = self.ledger.submit(&lease, &finding.brought());
        let Submitted::Accepted(done) = submitted else { panic!("accepted") };
        let (branch, curve, landings) = match finding {
            TaskResult::Landings(landings) => (None, None, Some(landings)),
            TaskResult::Branch(branch) => (Some(branch), None, None),
            TaskResult::Curve(curve) => (None, Some(curve), None),
            TaskResult::Nothing(_) => (None, None, None),
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
            curve: curve.as_ref().map(CriticalMessage::from),
            landings: landings.as_deref().map(LandingsMessage::from),
            verification: None,
            disturbance: None,
            settling: None,
            worker: worker(),
            program: "0.1.0".into(),
            seconds: 0.25,
        };
        changes.push(Change::Result(accepted(result, done.sequence)));
        store.commit(&changes).unwrap();
        self.branches.extend(branch.map(|branch| (granted.task.clone(), branch)));
        self.curves.extend(curve.map(|curve| (granted.task.clone(), curve)));
        self.landings.extend(landings.map(|landings| (granted.task, landings)));
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
    let mut sweep =
        Sweep { study: &study, ledger, branches: HashMap::new(), curves: HashMap::new(), landings: HashMap::new() };
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
    let (mut ledger, _) = Ledger::restore(Rules::default(), store.plans().unwrap(), &[], tasks, hour(7));
    assert_eq!(ledger.counts(), sweep.ledger.counts());
    assert_eq!(store.counts().unwrap(), ledger.counts());
    assert_eq!(ledger.dead(), sweep.ledger.dead());
    assert_eq!(ledger.dead()[0].1, vec!["worker-1: out of memory"; 3]);
    let stored = store.tasks().unwrap().into_iter().find(|task| task.id == held.task).unwrap();
    assert_eq!((stored.holders.len(), stored.troubles.lapses), (2, 1));
    assert_eq!(stored.troubles.reasons, ["worker-1: no sign of life"]);
    assert!(ledger.renew(&held, None, hour(7)).0 == protocol::to_worker::RenewReply::Ok);

    store.commit(&ledger.retry_dead()).unwrap();
    assert!(store.tasks().unwrap().iter().all(|task| task.troubles.reasons.len() < 3));
    store.commit(&ledger.release(&held, hour(8)).1).unwrap();
    sweep.ledger = ledger;
    for _ in 0..5 {
        sweep.step(&mut store);
    }
    drop(store);
    let mut store = Store::open(&dir).unwrap();
    (sweep.ledger, _) = Ledger::restore(Rules::default(), store.plans().unwrap(), &[], store.tasks().unwrap(), hour(9));
    while sweep.step(&mut store) {}
    for result in expected {
        let stored = store.result(&result.task).unwrap().unwrap();
        assert_eq!((stored.outcome, stored.name, stored.branch), (result.outcome, result.name, result.branch));
    }
    assert_eq!(sweep.ledger.counts(), store.counts().unwrap());
}

/// All that a store has of a search: tasks by name, for landings wait for nothing, and the curves.
fn searched(store: &Store) -> (Vec<(TaskId, TaskState)>, Vec<CurveRow>) {
    let tasks = store.tasks().unwrap().into_iter().map(|task| (task.id, task.state));
    let mut tasks: Vec<(TaskId, TaskState)> = tasks.collect();
    tasks.sort_by(|a, b| a.0.cmp(&b.0));
    (tasks, store.curves().unwrap())
}

#[test]
fn an_interrupted_search_goes_on() {
    let (mut study, dir) = (Study::damper(), tempdir().unwrap());
    // Wide enough for the fold curve of the isola to close.
    study.reach.forcing = Some((1e-3, 0.1));
    let rules = Rules { most_folds: 12, ..Rules::default() };
    let whole = {
        let (mut store, _) = study.begin(&dir.path().join("whole"));
        let ledger = Ledger::new(rules, study.plans.clone());
        let mut sweep =
            Sweep { study: &study, ledger, branches: HashMap::new(), curves: HashMap::new(), landings: HashMap::new() };
        while sweep.step(&mut store) {}
        searched(&store)
    };
    let curves = &whole.1;
    assert!(!curves.is_empty() && curves.iter().all(|curve| curve.points.len() > 10));
    assert!(curves.iter().flat_map(|curve| &curve.points).any(|point| point.event.as_deref() == Some("birth")));
    let is_crossing = |id: &TaskId| {
        !id.as_str().starts_with("fold")
            && study
                .plans
                .iter()
                .all(|plan| (0..plan.tasks.len()).all(|i| TaskId::of_level(&plan.amplitude.text, i).unwrap() != *id))
    };
    assert!(whole.0.iter().any(|(id, _)| is_crossing(id)));

    let parts = dir.path().join("parts");
    let (store, _) = study.begin(&parts);
    drop(store);
    let (mut branches, mut curves, mut landings) = (HashMap::new(), HashMap::new(), HashMap::new());
    for _ in 0..whole.0.len() + 1 {
        let mut store = Store::open(&parts).unwrap();
        let (levels, added, tasks) = (store.plans().unwrap(), store.added().unwrap(), store.tasks().unwrap());
        let (ledger, changes) = Ledger::restore(rules, levels, &added, tasks, Duration::ZERO);
        assert!(changes.is_empty(), "what is stored together is restored together: {changes:?}");
        let mut sweep = Sweep { study: &study, ledger, branches, curves, landings };
        let goes_on = sweep.step(&mut store);
        (branches, curves, landings) = (sweep.branches, sweep.curves, sweep.landings);
        if !goes_on {
            break;
        }
    }
    let store = Store::open(&parts).unwrap();
    assert_eq!(searched(&store), whole);
    assert!(curves.values().any(CriticalCurve::is_closed));
    for task in store.tasks().unwrap() {
        if let Some(curve) = curves.get(&task.id) {
            assert_eq!(task.brought, Some(Brought::Curve(curve.forcing().collect())), "{}", task.id);
        }
    }

    // Where curves cross levels, the branches that turn back there are known.
    let rows = store.curves().unwrap();
    let crossings: Vec<_> =
        rows.iter().flat_map(|row| row.crossings.iter().map(move |crossing| (row, crossing))).collect();
    assert!(crossings.iter().any(|(_, crossing)| crossing.branch == "isola 1" && crossing.amplitude == "0.006"));
    for (row, crossing) in crossings {
        let [a, b] = [0, 1].map(|k| row.points[crossing.segment + k].forcing);
        assert!((a.min(b)..=a.max(b)).contains(&crossing.forcing), "{crossing:?} between {a} and {b}");
    }

    let report = Report::read(&store, &Selection::Fitting).unwrap();
    assert!(report.figures.drawn.contains_key("folds"), "{:?}", report.figures.nothing);
    let onset = &report.verdict[1].text;
    assert!(onset.contains("Computed along fold curves: an isola is born at A = 0.0048"), "{onset}");
    assert!(onset.contains("; at A = 0.011") && onset.contains(" it merges or parts, and may go on"), "{onset}");
}
