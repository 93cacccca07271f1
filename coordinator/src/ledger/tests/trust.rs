//! What is believed of workers, and how long they are waited for.

use super::cases::{MAIN, leased};
use super::*;

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
    let expected = Offered::Expected { amplitude: 1.0, work: Task::Main(Side::Below), branch: None };
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
