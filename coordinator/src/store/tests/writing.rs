//! Commits: atomic, durable, next to readers, fast.

use super::*;
use crate::fixture::worker;
use crate::ledger::Record;
use protocol::branch::BranchMessage;
use protocol::curve::Points;
use protocol::ids::{Attempt, TaskId};
use solver::branch::{BranchPoint, Certificate, Monitored, Outcome};
use solver::state::State;
use solver::task::SeedOutcome;
use std::time::Instant;

#[test]
fn a_full_disk_loses_nothing_that_was_stored() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, mut sweep) = study.begin(dir.path());
    sweep.step(&mut store);
    let (granted, lease) = sweep.lease(&mut store, 0, Duration::ZERO).unwrap();
    let tasks = store.tasks().unwrap();
    let limit = |store: &mut Store, pages: u32| {
        let (db, _) = store.reader.parts_mut();
        db.pragma_update_and_check(None, "max_page_count", pages, |row| row.get::<_, u32>(0)).unwrap()
    };
    let pages = limit(&mut store, 1);
    let mut result = sweep.results[0].clone();
    (result.task, result.name) = (granted.task.clone(), Some(BranchId::Isola(0)));
    let record = Record::Done { task: lease.task, attempt: lease.attempt, outcome: result.outcome, sequence: 2 };
    let changes = [Change::Record(&record), Change::Result { result: &result, sequence: 2, size: 1, sha256: "0" }];
    let error = store.commit(&changes).unwrap_err();
    assert!(matches!(error, StoreError::Full { .. }), "{error}");
    assert!(error.to_string().contains("free space, then `isola resume"), "{error}");
    assert_eq!(store.tasks().unwrap(), tasks);
    assert_eq!(store.done().unwrap().len(), 1);
    limit(&mut store, pages + 1000);
    store.commit(&changes).unwrap();
    assert_eq!(store.done().unwrap().len(), 2);
}

#[test]
fn what_is_committed_survives_a_kill() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, mut sweep) = study.begin(&dir.path().join("a"));
    sweep.step(&mut store);
    sweep.lease(&mut store, 0, Duration::ZERO).unwrap();
    // What a killed process leaves behind.
    let copy = dir.path().join("b");
    fs::create_dir(&copy).unwrap();
    for entry in fs::read_dir(store.dir()).unwrap() {
        let entry = entry.unwrap();
        fs::copy(entry.path(), copy.join(entry.file_name())).unwrap();
    }
    let after = Store::open(&copy).unwrap();
    assert_eq!(after.tasks().unwrap(), store.tasks().unwrap());
    assert_eq!(after.done().unwrap(), store.done().unwrap());
    assert_eq!(after.counts().unwrap().running, 1);
}

#[test]
fn readers_and_the_writer_do_not_wait_for_each_other() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, mut sweep) = study.begin(dir.path());
    sweep.step(&mut store);
    let reader = Reader::open(dir.path()).unwrap();
    let snapshot = reader.snapshot().unwrap();
    assert_eq!(reader.done().unwrap().len(), 1);
    let thread = std::thread::spawn({
        let dir = dir.path().to_path_buf();
        move || (0..50).all(|_| !Reader::open(&dir).unwrap().done().unwrap().is_empty())
    });
    while sweep.step(&mut store) {}
    assert!(thread.join().unwrap());
    assert_eq!(reader.done().unwrap().len(), 1);
    drop(snapshot);
    assert_eq!(reader.done().unwrap(), store.done().unwrap());
    for done in reader.done().unwrap() {
        assert!(reader.result(&done.task).unwrap().is_some());
    }
}

/// A branch as large as those of a blade.
fn large(points: usize, modes: usize, channels: usize, contacts: usize, harmonics: usize) -> BranchMessage {
    let nc = 2 * harmonics + 1;
    let number = |i: usize| (i as f64 * 0.7).sin() + 1.5;
    let point = |p: usize| BranchPoint {
        state: State {
            harmonics,
            omega: 2100.0 + p as f64,
            decay: 0.0,
            amplitude: 60.0,
            arguments: (0..channels * nc).map(|i| number(i + p)).collect(),
            modal: (0..modes * nc).map(|i| number(i * p + 1)).collect(),
        },
        monitors: vec![Monitored { amplitude: number(p), rms: number(p + 1) }],
        contact: (0..contacts).map(|i| number(i + p)).collect(),
        certificate: Certificate { residual: 1e-10, high_harmonics: 1e-3, iterations: 3 },
    };
    let points: Vec<BranchPoint> = (0..points).map(point).collect();
    let points = Points::new(points.iter());
    BranchMessage { amplitude: 60.0, outcome: Outcome::Closed, special: Vec::new(), rejections: 0, points }
}

#[test]
#[ignore = "prints times: cargo test --release -p coordinator -- --ignored --nocapture commit_times"]
fn commit_times() {
    let dir = tempdir().unwrap();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/rotor67");
    let model = ModelMessage::from(&solver::model::Model::load(&folder).unwrap());
    let header = RunHeader { model, ..Study::new("duffing", 1, &["0.1"]).header() };
    let (levels, tasks) = (2000, 8);
    let amplitudes: Vec<Amplitude> =
        (0..levels).map(|l| Amplitude { text: format!("{l}.5"), value: l as f64 + 0.5 }).collect();
    let plan = |amplitude: &Amplitude| LevelPlan {
        amplitude: amplitude.clone(),
        windows: Vec::new(),
        tasks: vec![solver::task::Task::Main; tasks],
    };
    let plans: Vec<LevelPlan> = amplitudes.iter().map(plan).collect();
    let mut store = Store::create(dir.path(), &RunHeader { amplitudes, ..header }).unwrap();
    let backbone = BackboneMessage {
        mode: 0,
        outcome: Outcome::Closed,
        rejections: 0,
        points: large(700, 39, 18, 9, 10).points,
        r_lin: column(700),
        r_nl: column(700),
        work_per_amplitude: column(700),
        certificate: column(700),
        threshold: column(700),
        arc: column(700),
        contributions: Array::new([700, 39], (0..700 * 39).map(|i| i as f64)),
    };
    let reach = Reach { frequency: (1.0, 2.0), amplitude: 1.0 };
    timed("backbone, 16,000 tasks", 1, || store.set_backbone(&backbone, &reach, &plans).unwrap());

    let task = |l: usize, t: usize| TaskId::of_level(&format!("{l}.5"), t).unwrap();
    let mut sequence = 0;
    let mut tiny = |store: &mut Store, l: usize, branch: Option<&BranchMessage>| {
        sequence += 1;
        let (task, attempt) = (task(l, sequence as usize % tasks), Attempt(1));
        let outcome = branch.map_or(SeedOutcome::OutOfBounds, |_| SeedOutcome::Found(BranchId::Main));
        let result = StoredResult {
            task: task.clone(),
            attempt,
            amplitude: plans[l].amplitude.clone(),
            work: solver::task::Task::Main,
            outcome,
            name: branch.map(|_| BranchId::Main),
            branch: branch.cloned(),
            worker: worker(),
            program: String::new(),
            seconds: 1.0,
        };
        let grant = Record::Granted { task: task.clone(), attempt, worker: worker(), slot: 0 };
        commit(store, &[grant]);
        let record = Record::Done { task, attempt, outcome, sequence };
        let change = Change::Result { result: &result, sequence, size: 1, sha256: "" };
        store.commit(&[Change::Record(&record), change]).unwrap();
    };
    let branch = large(170, 39, 18, 9, 10);
    timed("large results", 40, || (0..40).for_each(|l| tiny(&mut store, l, Some(&branch))));
    timed("tiny results", 1000, || (100..1100).for_each(|l| tiny(&mut store, l, None)));
    let lost: Vec<Record> = (0..1000).map(|l| Record::Skipped { task: task(l, 7) }).collect();
    timed("records in one commit", 1000, || commit(&mut store, &lost));
    timed("tasks()", 1, || assert_eq!(store.tasks().unwrap().len(), levels * tasks));
    timed("done()", 1, || assert_eq!(store.done().unwrap().len(), 1040));
    let size = fs::metadata(dir.path().join(FILE)).unwrap().len() >> 20;
    drop(store);
    timed(&format!("open with quick_check, {size} MB"), 1, || drop(Store::open(dir.path()).unwrap()));
}

fn column(points: usize) -> Array {
    Array::new([points], (0..points).map(|i| i as f64 + 0.5))
}

fn timed(what: &str, count: u32, work: impl FnOnce()) {
    let start = Instant::now();
    work();
    println!("{what}: {:.2} ms each", start.elapsed().as_secs_f64() * 1e3 / f64::from(count));
}
