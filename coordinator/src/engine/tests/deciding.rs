//! Whoever asks decides; what has to be on disk is answered by whoever commits.

use super::*;
use crate::engine::Decider;
use crate::engine::commit::Decided;
use std::sync::mpsc::channel;

/// Nobody commits here: whoever waits for that waits, and a sign of life is answered all the same.
#[test]
fn a_sign_of_life_does_not_wait_for_the_disk() {
    let (decisions, decided) = channel::<Decided>();
    let (answers, answered) = channel();
    let decider = Decider::new(waiting(), decisions);
    let ask = |event| {
        let answers = answers.clone();
        decider.ask(event, Box::new(move |answer| drop(answers.send(answer))));
    };
    assert!(decider.tell(begin(None)));
    let lease = LeaseRequest { protocol: protocol::VERSION, program: "0".into(), worker: worker("a"), slot: 0 };
    ask(Event::Lease(lease));
    let lease = Lease { task: TaskId::new("0.01-0").unwrap(), attempt: Attempt(1), worker: worker("a"), slot: 0 };
    ask(Event::Renew(RenewRequest { lease, progress: None }));
    assert_eq!(answered.recv().unwrap(), Answer::Renew(RenewReply::Ok));
    drop(decider);
    let decided: Vec<Decided> = decided.iter().collect();
    assert!(answered.try_recv().is_err());
    decided.into_iter().filter_map(|decision| decision.answer).for_each(|answer| answer());
    assert!(matches!(answered.recv().unwrap(), Answer::Grant(_)));
}

#[test]
fn without_whoever_commits_nothing_is_decided() {
    let (decisions, decided) = channel::<Decided>();
    let decider = Decider::new(waiting(), decisions);
    drop(decided);
    assert!(!decider.tell(begin(None)));
    assert!(!decider.tell(Event::Tick));
}
