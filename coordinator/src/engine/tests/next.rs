//! An acknowledgement brings the next task to threads that take one: if there is plenty, or they have nothing else to do.

use super::*;

/// The same result of a thread that takes its next task with the acknowledgement.
fn and_next(event: Event) -> Event {
    let Event::Submit(result) = event else { panic!("no result") };
    Event::Submit(Box::new(CheckedResult { next: true, ..*result }))
}

#[test]
fn an_accepted_result_is_answered_with_the_next_task() {
    let mut engine = sweeping();
    let (_, main) = grant(&mut engine, "a", at(0));
    let decision = engine.handle(and_next(result(&main, Ok(EXTENT))), at(1));
    let Some(Answer::Next(next)) = decision.answer else { panic!("{:?}", decision.answer) };
    assert!(matches!(decision.changes.first(), Some(Change::Result(_))));
    assert!(matches!(decision.changes.last(), Some(Change::Granted { task, .. }) if *task == next.task));
    // The answer may have been lost: the result is there, and the task is the thread's.
    let again = engine.handle(and_next(result(&main, Ok(EXTENT))), at(2));
    assert_eq!(again.answer, submitted(SubmitReply::Duplicate { agrees: true }));
    assert_eq!(grant(&mut engine, "a", at(2)).0, next);
}

#[test]
fn without_a_task_or_when_the_process_ends_a_result_is_acknowledged() {
    let mut engine = sweeping();
    let main = grant_landed(&mut engine, at(0));
    engine.handle(Event::Stop, at(1));
    let decision = engine.handle(and_next(result(&main, Ok(EXTENT))), at(1));
    assert_eq!(decision.answer, submitted(SubmitReply::Accepted));

    let mut engine = sweeping();
    let main = grant_landed(&mut engine, at(0));
    let failed = || Err(SeedOutcome::NotTraced(Failure::Diverged.into()));
    ask_for(&mut engine, "a", 1, at(0));
    let decision = engine.handle(and_next(result(&main, failed())), at(1));
    let Some(Answer::Next(above)) = decision.answer else { panic!("{:?}", decision.answer) };
    let above = Lease { task: above.task, attempt: above.attempt, ..main };
    let decision = engine.handle(and_next(result(&above, failed())), at(1));
    assert_eq!(decision.answer, submitted(SubmitReply::Accepted));
}

/// Its other lane computes, and somebody else could begin at once.
#[test]
fn what_is_scarce_is_not_kept_at_hand() {
    let mut engine = sweeping();
    let main = grant_landed(&mut engine, at(0));
    let decision = engine.handle(and_next(result(&main, Ok(EXTENT))), at(1));
    assert_eq!(decision.answer, submitted(SubmitReply::Accepted));
    assert!(decision.news.contains(&News::Wake(worker("b"))), "{:?}", decision.news);
}

#[test]
fn a_lane_that_waits_leaves_the_next_task_to_the_other_one() {
    let mut engine = sweeping();
    let main = grant_landed(&mut engine, at(0));
    ask_for(&mut engine, "a", 1, at(0));
    let decision = engine.handle(and_next(result(&main, Ok(EXTENT))), at(1));
    let Some(Answer::Next(next)) = decision.answer else { panic!("{:?}", decision.answer) };
    // It is not woken for what is given back.
    let lease = Lease { task: next.task, attempt: next.attempt, ..main };
    let released = engine.handle(Event::Release(ReleaseRequest { lease }), at(1));
    assert!(!released.news.contains(&News::Wake(worker("a"))), "{:?}", released.news);
}
