//! A result that is repeated is compared and not stored; what becomes of it is on disk.

use super::*;
use protocol::from_worker::Progress;
use protocol::to_worker::CheckpointReply;
use results::journal::{CheckpointPart, Said};
use solver::response::seeds::LandingFailure;

/// An engine that repeats whatever it can, the landings of worker `b` being there.
fn repeating() -> (Engine, Lease) {
    let mut engine = Engine::new(RUN.0.clone(), Rules { repeated: 1e9, ..Rules::default() });
    engine.handle(begin(None), at(0));
    let (_, main) = grant(&mut engine, "a", at(0));
    let (_, landing) = grant(&mut engine, "b", at(0));
    engine.handle(submit(&landing, None, Brought::Landings(1)), at(1));
    (engine, main)
}

/// Hands out a result once more.
fn repeat(engine: &mut Engine, name: &str) -> Lease {
    let decision = ask(engine, name, at(2));
    let Some(Answer::Grant(granted)) = decision.answer else { panic!("{:?}", decision.answer) };
    let lease = Lease { task: granted.task, attempt: granted.attempt, worker: worker(name), slot: 0 };
    let holder = Holder { worker: lease.worker.clone(), slot: 0 };
    assert_eq!(decision.changes, [Change::Repeated { task: lease.task.clone(), attempt: lease.attempt, holder }]);
    lease
}

fn ended(lease: &Lease, end: AttemptEnd) -> Change {
    Change::Ended { task: lease.task.clone(), attempt: lease.attempt, end }
}

#[test]
fn a_repetition_is_a_task_like_others_until_it_is_compared() {
    let (mut engine, _main) = repeating();
    let lease = repeat(&mut engine, "c");
    assert_eq!(lease.attempt, Attempt(2));
    // The answer may have been lost.
    assert_eq!(grant(&mut engine, "c", at(3)).1, lease);
    let progress = Some(Progress { points: 1, omega: 1.0, amplitude: 1.0 });
    let renewal = Event::Renew(RenewRequest { lease: lease.clone(), progress });
    assert_eq!(engine.handle(renewal, at(10)).answer, Some(Answer::Renew(RenewReply::Ok)));
    let part =
        CheckpointPart { task: lease.task.clone(), attempt: lease.attempt, first: 0, steps: 1, payload: vec![0] };
    let kept = engine.handle(Event::Checkpoint(lease.clone(), part), at(10));
    assert_eq!((kept.answer, kept.changes), (Some(Answer::Checkpoint(CheckpointReply::Enough)), Vec::new()));
    let decision = engine.handle(submit(&lease, None, Brought::Landings(1)), at(11));
    assert_eq!(decision.answer, submitted(SubmitReply::Duplicate { agrees: true }));
    assert_eq!(decision.changes, [ended(&lease, AttemptEnd::Confirmed)]);
    // Sent again, since the acknowledgement was lost.
    let again = engine.handle(submit(&lease, None, Brought::Landings(1)), at(11));
    assert_eq!((again.answer, again.changes), (submitted(SubmitReply::Duplicate { agrees: true }), Vec::new()));
}

#[test]
fn a_third_one_decides() {
    let (mut engine, _main) = repeating();
    let second = repeat(&mut engine, "c");
    let nothing = Brought::Nothing(SeedOutcome::NotTraced(Failure::Diverged.into()));
    let decision = engine.handle(submit(&second, None, nothing.clone()), at(3));
    assert_eq!(decision.answer, submitted(SubmitReply::Duplicate { agrees: false }));
    let disputed = AttemptEnd::Disputed("b: forced responses; c: nothing".into());
    let said = Change::Said { task: second.task.clone(), attempt: second.attempt, said: Said::Nothing };
    assert_eq!(decision.changes, [ended(&second, disputed), said]);
    let third = repeat(&mut engine, "d");
    let decision = engine.handle(submit(&third, None, nothing), at(3));
    let first = Lease { attempt: Attempt(1), ..third.clone() };
    let why = "b: forced responses, where c and d come to nothing".into();
    let [refuted, rest @ ..] = &decision.changes[..] else { panic!("nothing decided") };
    assert_eq!(*refuted, ended(&first, AttemptEnd::Refuted(why)));
    let task = third.task.clone();
    let confirmed = [ended(&second, AttemptEnd::Confirmed), ended(&third, AttemptEnd::Confirmed)];
    assert_eq!(rest[..2], confirmed);
    assert_eq!(rest[2..], [Change::Withdrawn { task: task.clone() }]);
    assert!(decision.news.contains(&News::Withdrawn(task.clone())));
    // Somebody else does it again; what was said before does not count, should it come once more.
    let first = Lease { worker: worker("b"), ..first };
    let again = engine.handle(submit(&first, None, Brought::Landings(1)), at(4));
    assert_eq!((again.answer, again.changes), (submitted(SubmitReply::Duplicate { agrees: true }), Vec::new()));
    assert_ne!(grant(&mut engine, "b", at(4)).0.task, task);
    let (granted, lease) = grant(&mut engine, "c", at(4));
    assert_eq!((granted.task, granted.attempt), (task, Attempt(4)));
    let nothing = Brought::Nothing(SeedOutcome::NotLanded(LandingFailure::Far(0.5)));
    let accepted = engine.handle(submit(&lease, None, nothing), at(5));
    assert_eq!(accepted.answer, submitted(SubmitReply::Accepted));
}

#[test]
fn a_repetition_that_is_given_back_lost_or_refused_changes_nothing() {
    let (mut engine, _main) = repeating();
    let lease = repeat(&mut engine, "c");
    let released = engine.handle(Event::Release(ReleaseRequest { lease: lease.clone() }), at(3));
    assert_eq!(released.changes, [ended(&lease, AttemptEnd::Released)]);

    let (mut engine, _main) = repeating();
    let lease = repeat(&mut engine, "c");
    let refused = engine.handle(Event::Refused(lease.clone(), "not finite".into()), at(3));
    assert!(matches!(&refused.changes[..], [Change::Ended { end: AttemptEnd::Refused(_), .. }]), "{refused:?}");

    let (mut engine, main) = repeating();
    let lease = repeat(&mut engine, "c");
    let renewal = Event::Renew(RenewRequest { lease: main, progress: None });
    engine.handle(renewal, at(10));
    let expired = engine.handle(Event::Tick, at(2) + Rules::default().lease);
    assert_eq!(expired.changes, [ended(&lease, AttemptEnd::Expired)]);
    let renewal = Event::Renew(RenewRequest { lease, progress: None });
    assert_eq!(engine.handle(renewal, at(20)).answer, Some(Answer::Renew(RenewReply::Lost)));
}
