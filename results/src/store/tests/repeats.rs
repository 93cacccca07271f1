//! What is computed once more leaves the task as it is, and tells what is not to be believed.

use super::*;
use crate::fixture::accepted;
use crate::journal::{AttemptEnd, Evidence, Extension, Holder, MorePlan, Said, TaskState};
use crate::overview::{Omissions, Overview, unfinished};
use protocol::ids::Attempt;
use protocol::to_everyone::{Done, StoredResult};
use solver::response::forced::SearchRange;

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

/// What is said where two disagree is there for a coordinator that goes on; what is withdrawn is as if it never had been.
#[test]
fn what_is_withdrawn_is_done_again() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, mut sweep) = study.begin(dir.path());
    while sweep.step(&mut store) {}
    let before = store.done().unwrap();
    let result = sweep.results.iter().find(|result| result.name.is_none()).unwrap().clone();
    let place = before.iter().position(|done| done.task == result.task).unwrap();
    let task = result.task.clone();
    let evidence = |store: &Store| {
        let stored = store.tasks().unwrap().into_iter().find(|stored| stored.id == task).unwrap();
        (stored.state, stored.evidence)
    };
    let holder = Holder { worker: WorkerId::new("w2").unwrap(), slot: 0 };
    let why = || AttemptEnd::Disputed("w1: nothing; w2: something new".into());
    let (first, second) = (result.attempt, Attempt(result.attempt.0 + 1));
    store
        .commit(&[
            Change::Repeated { task: task.clone(), attempt: second, holder },
            Change::Ended { task: task.clone(), attempt: second, end: why() },
            Change::Said { task: task.clone(), attempt: second, said: Said::New },
        ])
        .unwrap();
    assert_eq!(store.contradictions().unwrap(), (0, 1));
    let (state, known) = evidence(&store);
    assert!(matches!(state, TaskState::Done(_)));
    let said = vec![(second, Said::New)];
    assert_eq!(known, Evidence { result: Some((first, result.seconds)), ends: vec![(second, why())], said });

    let refuted = AttemptEnd::Refuted("w1: nothing, where w2 and w3 come to something new".into());
    store
        .commit(&[
            Change::Ended { task: task.clone(), attempt: first, end: refuted.clone() },
            Change::Ended { task: task.clone(), attempt: second, end: AttemptEnd::Confirmed },
            Change::Withdrawn { task: task.clone() },
        ])
        .unwrap();
    assert_eq!(store.contradictions().unwrap(), (0, 0));
    let (state, known) = evidence(&store);
    assert_eq!((state, known.result), (TaskState::Waiting, None));
    assert_eq!(known.ends, [(first, refuted), (second, AttemptEnd::Confirmed)]);
    // Announcements are counted on from one to the next.
    let left = store.done().unwrap();
    assert!(left.iter().zip(1..).all(|(done, number)| done.sequence == number) && left.len() == before.len() - 1);
    let tasks = |done: &[Done]| done.iter().map(|done| done.task.clone()).collect::<Vec<_>>();
    let mut others = tasks(&before);
    others.remove(place);
    assert_eq!(tasks(&left), others);
    assert!(store.result(&task).unwrap().is_none() && store.done_of(&task).unwrap().is_none());

    // Somebody else does it again.
    let (sequence, attempt) = (before.len() as u64, Attempt(second.0 + 1));
    let outcome = result.outcome;
    let again = StoredResult { attempt, worker: WorkerId::new("w3").unwrap(), ..result };
    let holder = Holder { worker: again.worker.clone(), slot: 0 };
    let accepted = Change::Result(accepted(again.clone(), sequence));
    let done = Change::Done { task: task.clone(), attempt, outcome, sequence };
    store.commit(&[Change::Granted { task: task.clone(), attempt, holder }, done, accepted]).unwrap();
    assert_eq!(store.result(&task).unwrap(), Some(again));
    assert_eq!(
        store.done().unwrap().last().map(|done| (done.task.clone(), done.sequence)),
        Some((task.clone(), sequence))
    );
    assert_eq!(store.contradictions().unwrap(), (0, 0));
    assert_eq!(evidence(&store).1.result.map(|(attempt, _)| attempt), Some(attempt));
}

/// After levels were added, within other bounds, nothing from before is to be said again; what is found then is.
#[test]
fn what_was_said_within_other_bounds_is_compared_with_nothing() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, results) = study.finished(dir.path());
    let compared = |store: &Store| store.tasks().unwrap().iter().filter(|task| task.evidence.result.is_some()).count();
    assert_eq!(compared(&store), results.len());
    let extension = |reach| Extension {
        overrides: Vec::new(),
        study: "model = \"damper\"\n".into(),
        amplitudes: Vec::new(),
        plan: Some(MorePlan { reach, orders: Vec::new(), levels: Vec::new() }),
    };
    store.extend(&extension(study.reach)).unwrap();
    assert_eq!(compared(&store), results.len(), "the bounds are the same");
    let (low, high) = study.reach.frequency;
    store.extend(&extension(SearchRange { frequency: (low, 1.1 * high), ..study.reach })).unwrap();
    assert_eq!(compared(&store), 0);
}
