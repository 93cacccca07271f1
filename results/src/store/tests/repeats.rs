//! What is computed once more leaves the task as it is, and tells what is not to be believed.

use super::*;
use crate::journal::{AttemptEnd, Holder, TaskState};
use crate::overview::{Omissions, Overview, unfinished};
use protocol::ids::Attempt;

#[test]
fn results_that_others_contradict() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, mut sweep) = study.begin(dir.path());
    while sweep.step(&mut store) {}
    let said = |store: &Store| {
        let overview = Overview::read(store, &mut Omissions::default()).unwrap();
        let complete = overview.levels.iter().filter(|level| level.is_complete()).count();
        (complete, unfinished(&overview.levels, true))
    };
    let (complete, before) = said(&store);
    assert_eq!((complete, before.len()), (study.plans.len(), 0), "{before:?}");
    let (task, other) = (sweep.results[0].task.clone(), sweep.results[1].task.clone());
    let states =
        |store: &Store| store.tasks().unwrap().into_iter().map(|task| (task.id, task.state)).collect::<Vec<_>>();
    let done = states(&store);
    let repeated = |task: &TaskId, attempt: u32| Change::Repeated {
        task: task.clone(),
        attempt: Attempt(attempt),
        holder: Holder { worker: WorkerId::new(&format!("w{attempt}")).unwrap(), slot: 0 },
    };
    let ended = |task: &TaskId, attempt, end| Change::Ended { task: task.clone(), attempt: Attempt(attempt), end };

    // One that agrees.
    store.commit(&[repeated(&other, 2), ended(&other, 2, AttemptEnd::Confirmed)]).unwrap();
    assert_eq!(said(&store), (complete, before));
    // One that does not.
    store.commit(&[repeated(&task, 2), ended(&task, 2, AttemptEnd::Disputed("w1: nothing; w2: main".into()))]).unwrap();
    let (left, sentences) = said(&store);
    assert_eq!(left, complete - 1);
    assert!(sentences[0].starts_with("1 result is doubtful, at A = "), "{sentences:?}");
    // And a third one against the first.
    let why = "w1: nothing, where w2 and w3 come to main".to_string();
    let decided = [
        repeated(&task, 3),
        ended(&task, 1, AttemptEnd::Refuted(why)),
        ended(&task, 3, AttemptEnd::Confirmed),
        ended(&task, 2, AttemptEnd::Confirmed),
    ];
    store.commit(&decided).unwrap();
    let (left, sentences) = said(&store);
    assert_eq!((left, sentences.len()), (complete - 1, 1));
    assert!(sentences[0].starts_with("1 result is wrong, at A = "), "{sentences:?}");
    // One that nobody hears of any more when another coordinator goes on.
    let open = |store: &Store| {
        let sql = "SELECT count(*) FROM attempts WHERE ended_at IS NULL";
        store.one(sql, [], |row| row.get::<_, usize>(0)).unwrap()
    };
    store.commit(&[repeated(&other, 3)]).unwrap();
    assert_eq!(open(&store), Some(1));
    store.commit(&[Change::Stage(Stage::Sweep)]).unwrap();
    assert_eq!(open(&store), Some(0));
    // What is stored stays as it is, and who was asked is known to a coordinator that goes on.
    assert_eq!(states(&store), done);
    assert!(done.iter().all(|(_, state)| matches!(state, TaskState::Done(_) | TaskState::Skipped)));
    let tasks = store.tasks().unwrap();
    let repeated = tasks.iter().find(|stored| stored.id == task).unwrap();
    assert_eq!(repeated.holders.len(), 3);
    assert!(repeated.troubles.reasons.is_empty());
}
