//! Commits: atomic, durable, next to readers.

use super::*;
use crate::journal::AcceptedResult;
use protocol::digest::Digest;

#[test]
fn a_full_disk_loses_nothing_that_was_stored() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, mut sweep) = study.begin(dir.path());
    sweep.step(&mut store);
    let granted = sweep.lease(&mut store, 0).unwrap();
    let tasks = store.tasks().unwrap();
    let limit = |store: &mut Store, pages: u32| {
        let (db, _) = store.reader.parts_mut();
        db.pragma_update_and_check(None, "max_page_count", pages, |row| row.get::<_, u32>(0)).unwrap()
    };
    let pages = limit(&mut store, 1);
    let mut result = sweep.results[0].clone();
    (result.task, result.name) = (granted.task.clone(), Some(BranchId::isola(0)));
    let (task, attempt, outcome) = (granted.task, granted.attempt, result.outcome);
    let digest = Digest { size: 1, sha256: "0".into() };
    let stored = AcceptedResult { result: Box::new(result), sequence: 2, digest };
    let changes = [Change::Done { task, attempt, outcome, sequence: 2 }, Change::Result(stored)];
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
    sweep.lease(&mut store, 0).unwrap();
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
