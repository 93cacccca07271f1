//! Steps of tasks under way are kept for whoever is handed a task next, and for nobody else.

use super::*;
use protocol::to_worker::CheckpointReply;
use results::journal::{CheckpointPart, Kept};

fn part(lease: &Lease, first: usize, steps: usize) -> Event {
    sized(lease, first, steps, 100)
}

fn sized(lease: &Lease, first: usize, steps: usize, bytes: usize) -> Event {
    let (task, attempt, payload) = (lease.task.clone(), lease.attempt, vec![0; bytes]);
    Event::Checkpoint(lease.clone(), CheckpointPart { task, attempt, first, steps, payload })
}

/// The answer, and whether anything is put on disk.
fn told(decision: &Decision) -> (CheckpointReply, bool) {
    let Some(Answer::Checkpoint(reply)) = decision.answer else { panic!("{decision:?}") };
    let is_kept = |change: &Change| matches!(change, Change::Checkpoint(_));
    (reply, decision.changes.iter().any(is_kept))
}

const KEPT: (CheckpointReply, bool) = (CheckpointReply::Kept, true);
const AGAIN: (CheckpointReply, bool) = (CheckpointReply::Kept, false);
const ENOUGH: (CheckpointReply, bool) = (CheckpointReply::Enough, false);
const LOST: (CheckpointReply, bool) = (CheckpointReply::Lost, false);

#[test]
fn only_the_holder_adds_steps_that_follow() {
    let mut engine = sweeping();
    let (granted, lease) = grant(&mut engine, "a", at(0));
    assert_eq!(granted.checkpoint, 0);
    let mut send = |event: Event| told(&engine.handle(event, at(1)));
    assert_eq!(send(part(&lease, 1, 4)), ENOUGH, "there are none that it follows");
    assert_eq!(send(part(&lease, 0, 0)), ENOUGH);
    assert_eq!(send(part(&lease, 0, 10)), KEPT);
    assert_eq!(send(part(&lease, 0, 10)), AGAIN, "its answer was lost");
    assert_eq!(send(part(&lease, 10, 5)), KEPT);
    assert_eq!(send(part(&lease, 10, 5)), AGAIN);
    assert_eq!(send(part(&lease, 20, 5)), ENOUGH, "there is a gap");
    let most = RUN.0.max_checkpoint_bytes();
    assert_eq!(send(sized(&lease, 15, 1, most - 100)), ENOUGH, "more than are kept of a task");
    for foreign in [
        Lease { worker: worker("b"), ..lease.clone() },
        Lease { slot: 7, ..lease.clone() },
        Lease { attempt: Attempt(9), ..lease.clone() },
        Lease { task: TaskId::new("0.01-99").unwrap(), ..lease.clone() },
    ] {
        assert_eq!(send(part(&foreign, 15, 5)), LOST);
        assert_eq!(send(part(&foreign, 0, 5)), LOST);
    }
}

#[test]
fn a_successor_is_told_of_them_and_goes_on() {
    let mut engine = sweeping();
    let (_, first) = grant(&mut engine, "a", at(0));
    engine.handle(part(&first, 0, 10), at(1));
    engine.handle(Event::Release(ReleaseRequest { lease: first.clone() }), at(1));
    let decision = ask(&mut engine, "b", at(2));
    let Some(Answer::Grant(granted)) = &decision.answer else { panic!("no task") };
    assert_eq!((&granted.task, granted.checkpoint), (&first.task, 10));
    let handed_on = Change::HandedOn { task: first.task.clone(), attempt: Attempt(2), steps: 10 };
    assert!(decision.changes.contains(&handed_on));
    let again = ask(&mut engine, "b", at(2));
    assert!(again.changes.is_empty() && again.answer == decision.answer);
    let second = Lease { attempt: Attempt(2), worker: worker("b"), ..first.clone() };
    assert_eq!(told(&engine.handle(part(&first, 10, 5), at(3))), LOST);
    assert_eq!(told(&engine.handle(part(&second, 10, 5), at(3))), KEPT);
    // Another one cannot use them, and begins at the beginning.
    engine.handle(Event::Release(ReleaseRequest { lease: second }), at(3));
    let (granted, third) = grant(&mut engine, "c", at(4));
    assert_eq!(granted.checkpoint, 15);
    assert_eq!(told(&engine.handle(part(&third, 0, 3), at(5))), KEPT);
    assert_eq!(told(&engine.handle(part(&third, 3, 3), at(5))), KEPT);
    engine.handle(Event::Release(ReleaseRequest { lease: third }), at(5));
    assert_eq!(grant(&mut engine, "d", at(6)).0.checkpoint, 6);
}

/// They may be why an attempt has failed, or why its result is refused.
#[test]
fn what_fails_takes_them_along() {
    let ends: [fn(Lease) -> Event; 2] = [
        |lease| Event::Fail(FailRequest { lease, reason: "panicked".into() }),
        |lease| Event::Refused(lease, "it does not solve the equations".into()),
    ];
    for end in ends {
        let mut engine = sweeping();
        let (granted, lease) = grant(&mut engine, "a", at(0));
        engine.handle(part(&lease, 0, 10), at(1));
        engine.handle(end(lease), at(1));
        let mut second = grant(&mut engine, "b", at(100)).0;
        if second.task != granted.task {
            second = grant(&mut engine, "c", at(200)).0;
        }
        assert_eq!((second.task, second.checkpoint), (granted.task, 0));
    }
}

#[test]
fn they_are_kept_until_the_task_is_done_whoever_conducts_the_run() {
    let mut engine = sweeping();
    let (granted, lease) = grant(&mut engine, "a", at(0));
    engine.handle(part(&lease, 0, 10), at(1));
    let done = engine.handle(result(&lease, Ok(EXTENT)), at(2));
    assert!(done.changes.iter().any(|change| change.ends_checkpoint() == Some(&granted.task)));
    assert_eq!(told(&engine.handle(part(&lease, 10, 5), at(3))), LOST);
    // Another coordinator goes on with what is in the store.
    let waiting_task = results::journal::StoredTask {
        id: granted.task.clone(),
        state: TaskState::Waiting,
        brought: None,
        holders: vec![Holder { worker: worker("a"), slot: 0 }],
        troubles: Troubles::default(),
        evidence: Evidence::default(),
    };
    let kept = [(granted.task.clone(), Kept { steps: 10, bytes: 100, attempt: Attempt(1) })].into();
    let mut restarted = waiting();
    restarted.handle(begin(Some(Stored { tasks: vec![waiting_task], kept, ..Stored::default() })), at(0));
    let (again, _) = grant(&mut restarted, "b", at(1));
    assert_eq!((again.task, again.checkpoint), (granted.task, 10));
}
