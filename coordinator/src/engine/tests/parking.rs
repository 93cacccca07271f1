//! Threads without work are woken when there is some, and told when there will be none.

use super::*;

/// Whom news wake, in their order.
fn woken(decision: &Decision) -> Vec<String> {
    let name = |news: &News| match news {
        News::Wake(worker) => Some(worker.as_str().to_string()),
        _ => None,
    };
    decision.news.iter().filter_map(name).collect()
}

#[test]
fn whoever_waits_is_woken_when_the_sweep_begins() {
    let mut engine = waiting();
    for name in ["a", "b", "c"] {
        ask(&mut engine, name, at(0));
    }
    let begun = engine.handle(begin(None), at(1));
    let names = woken(&begun);
    assert!(!names.is_empty() && names == ["a", "b", "c"][..names.len()], "{names:?}");
    // They are on their way.
    assert!(woken(&engine.handle(Event::Stalled, at(1))).is_empty());
}

#[test]
fn a_task_that_is_given_back_wakes_somebody_else() {
    let mut engine = sweeping();
    let lease = grant_landed(&mut engine, at(0));
    let waits = ask(&mut engine, "c", at(0));
    assert_eq!(waits.answer, Some(Answer::Wait(Duration::from_secs(1))));
    engine.handle(Event::Tick, at(0));
    // Somebody who vanished is not woken.
    ask(&mut engine, "d", at(0));
    engine.handle(Event::WorkerGone(worker("b")), at(0));
    engine.handle(Event::WorkerGone(worker("c")), at(0));
    let released = engine.handle(Event::Release(ReleaseRequest { lease }), at(1));
    assert_eq!(woken(&released), ["d"]);
}

#[test]
fn at_the_end_everybody_who_waits_is_told_at_once() {
    let mut engine = sweeping();
    let failed = || Err(SeedOutcome::NotTraced(Failure::Diverged.into()));
    let below = grant_landed(&mut engine, at(0));
    engine.handle(result(&below, failed()), at(0));
    let (_, above) = grant(&mut engine, "a", at(0));
    ask(&mut engine, "c", at(0));
    let last = engine.handle(result(&above, failed()), at(1));
    assert_eq!(told(&last), [Stage::Finished]);
    assert_eq!(last.news.last(), Some(&News::Hint));
}
