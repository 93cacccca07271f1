//! An acknowledgement brings the next task to threads that take one.

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
    let decision = engine.handle(and_next(result(&main, failed())), at(1));
    let Some(Answer::Next(above)) = decision.answer else { panic!("{:?}", decision.answer) };
    let above = Lease { task: above.task, attempt: above.attempt, ..main };
    let decision = engine.handle(and_next(result(&above, failed())), at(1));
    assert_eq!(decision.answer, submitted(SubmitReply::Accepted));
}

#[test]
fn a_thread_that_has_its_next_task_is_not_expected_to_ask() {
    let mut engine = sweeping();
    let main = grant_landed(&mut engine, at(0));
    let decision = engine.handle(and_next(result(&main, Ok(EXTENT))), at(1));
    let Some(Answer::Next(next)) = decision.answer else { panic!("{:?}", decision.answer) };
    // So that when it gives the task back somebody else is woken at once.
    let lease = Lease { task: next.task, attempt: next.attempt, ..main };
    let released = engine.handle(Event::Release(ReleaseRequest { lease }), at(1));
    assert_eq!(released.news, [News::Wake(worker("b"))]);
}
