//! What is believed of workers, and how long they are waited for.

use super::cases::{MAIN, leased};
use super::*;
use std::cell::RefCell;

/// A lease that ran out is taken up again, unless somebody else has the task or its thread another one.
#[test]
fn a_lease_that_ran_out_and_is_heard_of_again() {
    let rules = Rules::default();
    let mut ledger = Ledger::new(rules, plans(1));
    let lease = leased(&mut ledger, "a", Duration::ZERO);
    let mut now = Duration::ZERO;
    for _ in 0..2 * rules.max_lapses {
        now += rules.lease;
        let ended = ledger.tick(now);
        assert!(matches!(&ended[..], [Change::Ended { end: AttemptEnd::Expired, .. }]), "{ended:?}");
        let (reply, changes) = ledger.renew(&lease, None, now);
        let adopted = Change::Adopted { task: lease.task.clone(), attempt: lease.attempt };
        assert_eq!((reply, &changes[..]), (RenewReply::Ok, &[adopted][..]));
    }
    // A thread that was given something else meanwhile has given this up.
    let other = Lease { worker: WorkerId::new("b").unwrap(), ..lease.clone() };
    assert_eq!(ledger.renew(&other, None, now).0, RenewReply::Lost);
    ledger.tick(now + rules.lease);
    let taken = leased(&mut ledger, "b", now + rules.lease);
    assert_eq!((&taken.task, taken.attempt), (&lease.task, Attempt(2)));
    assert_eq!(ledger.renew(&lease, None, now + rules.lease), (RenewReply::Lost, Vec::new()));
    assert!(matches!(ledger.submit(&lease, &MAIN).0, Submitted::Accepted(_)));
    assert_eq!(ledger.renew(&taken, None, now + rules.lease).0, RenewReply::Lost);
}

/// Not being heard of is held against a task far later than failing is, and what this side missed against nobody.
#[test]
fn expiry_is_no_failure() {
    let rules = Rules::default();
    let mut ledger = Ledger::new(rules, plans(1));
    let mut now = Duration::ZERO;
    for attempt in 1..=rules.max_lapses {
        let lease = leased(&mut ledger, &format!("w{attempt}"), now);
        assert_eq!((lease.task.as_str(), lease.attempt), ("1-0", Attempt(attempt)));
        now += rules.lease;
        let is_last = attempt == rules.max_lapses;
        assert_eq!(ledger.tick(now).iter().any(|change| matches!(change, Change::Dead { .. })), is_last);
    }
    let mut ledger = Ledger::new(rules, plans(1));
    let lease = leased(&mut ledger, "a", Duration::ZERO);
    ledger.forbear(rules.lease);
    ledger.worker_gone(&lease.worker, rules.lease);
    assert!(ledger.tick(rules.lease + rules.reconnection() - Duration::from_millis(1)).is_empty());
    assert_eq!(ledger.tick(rules.lease + rules.reconnection()).len(), 1);
}

/// Only what was handed out is believed, and a worker whose results are refused is given nothing any more.
#[test]
fn results_of_what_was_never_granted() {
    let mut ledger = Ledger::new(Rules::default(), plans(1));
    let lease = leased(&mut ledger, "a", Duration::ZERO);
    let expected = Offered::Expected { amplitude: 1.0, order: None, work: Task::Main(Side::Below), branch: None };
    assert_eq!(ledger.offered(&lease), expected);
    let others = [
        Lease { task: TaskId::new("1-1").unwrap(), ..lease.clone() },
        Lease { attempt: Attempt(2), ..lease.clone() },
        Lease { attempt: Attempt(0), ..lease.clone() },
        Lease { worker: WorkerId::new("b").unwrap(), ..lease.clone() },
        Lease { slot: 1, ..lease.clone() },
    ];
    for other in &others {
        assert_eq!(ledger.offered(other), Offered::NeverGranted);
        assert_eq!(ledger.submit(other, &MAIN), (Submitted::NeverGranted, Vec::new()));
        assert!(ledger.refuse(other, "not finite", Duration::ZERO).is_empty());
    }
    let nowhere = Lease { task: TaskId::new("7-0").unwrap(), ..lease.clone() };
    assert_eq!(ledger.offered(&nowhere), Offered::Unknown);
    assert!(matches!(ledger.submit(&lease, &MAIN).0, Submitted::Accepted(_)));
    // Nothing was held against anybody for what others said in their names.
    assert!(matches!(ledger.lease(&lease.worker, 0, Duration::ZERO).0, Leased::Grant(_)));
}

#[test]
fn a_worker_whose_results_are_refused() {
    let rules = Rules { max_failures: 10, ..Rules::default() };
    let mut ledger = Ledger::new(rules, plans(1));
    let mut now = Duration::ZERO;
    for refused in 1..=rules.max_refusals {
        let lease = leased(&mut ledger, "a", now);
        let changes = ledger.refuse(&lease, "not finite", now);
        let [Change::Ended { end: AttemptEnd::Refused(reason), .. }] = &changes[..] else { panic!("{changes:?}") };
        assert_eq!(reason, "a: the result was refused: not finite");
        now += rules.backoff * 2u32.pow(refused);
    }
    let (Leased::Unwelcome(reasons), _) = ledger.lease(&WorkerId::new("a").unwrap(), 0, now) else {
        panic!("served again")
    };
    assert_eq!(reasons, vec!["1-0: not finite".to_string(); 3]);
    assert_eq!(leased(&mut ledger, "b", now).task.as_str(), "1-0");
}

/// Lets workers carry out what they are given in turn, until nothing is handed out; `what` they come to, and how long it takes.
pub(super) fn in_turn(
    ledger: &mut Ledger,
    workers: &[&str],
    what: impl Fn(&str, &Granted) -> Brought,
    seconds: f64,
) -> Vec<Change> {
    let (mut all, mut now) = (Vec::new(), Duration::ZERO);
    loop {
        let mut is_idle = true;
        for name in workers {
            let worker = WorkerId::new(name).unwrap();
            let (leased, changes) = ledger.lease(&worker, 0, now);
            all.extend(changes);
            let Leased::Grant(granted) = leased else { continue };
            is_idle = false;
            now += Duration::from_secs_f64(seconds);
            let lease = Lease { task: granted.task.clone(), attempt: granted.attempt, worker, slot: 0 };
            let (submitted, changes) = ledger.submit(&lease, &what(name, &granted));
            all.extend(changes);
            match submitted {
                Submitted::Accepted(_) => ledger.note_claim(&lease, seconds, now),
                Submitted::Repeated { granted_at, .. } => ledger.note_repeat(granted_at, seconds, now),
                other => panic!("{other:?}"),
            }
        }
        if is_idle {
            return all;
        }
    }
}

pub(super) fn number(changes: &[Change], is_it: impl Fn(&AttemptEnd) -> bool) -> usize {
    changes.iter().filter(|change| matches!(change, Change::Ended { end, .. } if is_it(end))).count()
}

fn repeats(changes: &[Change]) -> usize {
    changes.iter().filter(|change| matches!(change, Change::Repeated { .. })).count()
}

/// Honest workers: one in a hundred is repeated, never by who said it, and comes to the same.
#[test]
fn what_can_only_be_repeated_is_repeated_for_a_hundredth_of_the_time() {
    let mut ledger = Ledger::new(Rules::default(), plans(24));
    let changes = in_turn(&mut ledger, &["a", "b"], |_, granted| find(granted), 1.0);
    assert!(ledger.is_finished());
    let done = changes.iter().filter(|change| matches!(change, Change::Done { .. })).count();
    assert!(done > 600, "{done}");
    assert_eq!(repeats(&changes), (done - 1) / 100);
    assert_eq!(number(&changes, |end| *end == AttemptEnd::Confirmed), repeats(&changes));
    for change in &changes {
        let Change::Repeated { task, holder, .. } = change else { continue };
        let is_first = |change: &&Change| matches!(change, Change::Granted { task: granted, .. } if granted == task);
        let Some(Change::Granted { holder: first, .. }) = changes.iter().find(is_first) else { panic!("{task}") };
        assert_ne!(first.worker, holder.worker);
    }
    let mut expected = Ledger::new(Rules { repeated: 0.0, ..Rules::default() }, plans(24));
    in_turn(&mut expected, &["a"], |_, granted| find(granted), 1.0);
    assert_eq!(book(&ledger), book(&expected));
}

/// Who is alone is asked again.
#[test]
fn a_worker_that_is_alone_repeats_its_own_results() {
    let mut ledger = Ledger::new(Rules::default(), plans(8));
    let changes = in_turn(&mut ledger, &["a"], |_, granted| find(granted), 1.0);
    assert!(repeats(&changes) > 0);
    assert_eq!(number(&changes, |end| *end == AttemptEnd::Confirmed), repeats(&changes));
}

/// Says that nothing is there where something is, and nobody else has to know of it.
fn deny(granted: &Granted) -> Option<Brought> {
    let failure = LandingFailure::NotConverged(Unreached::OutOfReach);
    let (can_lie, lie) = match granted.work {
        Task::Scout(_) => (true, SeedOutcome::NoFold),
        Task::Land(place) => {
            let is_needed = place.phase == Phase::First && place.method == LandingMethod::FullForcing;
            (!is_needed, SeedOutcome::NotLanded(failure))
        }
        work => (matches!(work, Task::Start(_)), SeedOutcome::NotLanded(failure)),
    };
    let is_there = can_lie && matches!(find(granted), Brought::Landings(_));
    is_there.then_some(Brought::Nothing(lie))
}

/// Who says that nothing is there is found out by two others, and given nothing any more; nothing is held against them.
#[test]
fn a_worker_that_finds_nothing() {
    let mut ledger = Ledger::new(Rules::default(), plans(40));
    let denied = RefCell::new(Vec::new());
    let what = |name: &str, granted: &Granted| {
        let lie = deny(granted).filter(|_| name == "liar");
        denied.borrow_mut().extend(lie.as_ref().map(|_| (granted.task.clone(), granted.attempt)));
        lie.unwrap_or_else(|| find(granted))
    };
    let changes = in_turn(&mut ledger, &["a", "liar", "b"], what, 1.0);
    let liar = WorkerId::new("liar").unwrap();
    let Leased::Unwelcome(reasons) = ledger.lease(&liar, 0, Duration::MAX / 2).0 else { panic!("served") };
    assert!(reasons.len() >= 3, "{reasons:?}");
    assert!(reasons[0].contains("nothing, where "), "{reasons:?}");
    let refuted: Vec<(TaskId, Attempt)> = changes
        .iter()
        .filter_map(|change| {
            let Change::Ended { task, attempt, end: AttemptEnd::Refuted(why) } = change else { return None };
            assert!(why.starts_with("liar: nothing, where "), "{why}");
            Some((task.clone(), *attempt))
        })
        .collect();
    for honest in ["a", "b"] {
        assert_eq!(ledger.refusals(&WorkerId::new(honest).unwrap()), None);
    }
    // Once it was found out everything that it had said was repeated, however little time is left for that.
    let mut denied = denied.into_inner();
    denied.retain(|lie| !refuted.contains(lie));
    assert_eq!(denied, []);
}

/// Of two that disagree nobody is believed more than the other.
#[test]
fn two_that_disagree_without_a_third() {
    let mut ledger = Ledger::new(Rules { repeated: 1.0, ..Rules::default() }, plans(2));
    let lie = |name: &str, granted: &Granted| deny(granted).filter(|_| name == "liar");
    let what = |name: &str, granted: &Granted| lie(name, granted).unwrap_or_else(|| find(granted));
    let changes = in_turn(&mut ledger, &["a", "liar"], what, 1.0);
    assert!(number(&changes, |end| matches!(end, AttemptEnd::Disputed(_))) > 0);
    assert_eq!(number(&changes, |end| matches!(end, AttemptEnd::Refuted(_))), 0);
    assert!(ledger.is_finished());
}
