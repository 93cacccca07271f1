//! What single events do.

use super::*;

/// What tasks bring.
pub(super) const MAIN: Brought = Brought::Branch { kind: BranchKind::Main, folds: 0, branch_points: 0 };
pub(super) const ISOLA: Brought = Brought::Branch { kind: BranchKind::Isola, folds: 0, branch_points: 0 };
pub(super) const ON_MAIN: Brought = Brought::Nothing(SeedOutcome::Found(BranchId::MAIN));
const UNREACHED: Brought = Brought::Nothing(SeedOutcome::NotTraced(Unreached::OutOfReach));

pub(super) fn leased(ledger: &mut Ledger, worker: &str, now: Duration) -> Lease {
    let worker = WorkerId::new(worker).unwrap();
    let (Leased::Grant(granted), _) = ledger.lease(&worker, 0, now) else { panic!("no task") };
    Lease { task: granted.task, attempt: granted.attempt, worker, slot: 0 }
}

/// The main branch handed out, and every seed landed that can be.
fn landed(ledger: &mut Ledger) -> Lease {
    let main = leased(ledger, "a", Duration::ZERO);
    let worker = WorkerId::new("b").unwrap();
    while let (Leased::Grant(granted), _) = ledger.lease(&worker, 0, Duration::ZERO) {
        assert!(!granted.work.is_ordered());
        let lease = Lease { task: granted.task, attempt: granted.attempt, worker: worker.clone(), slot: 0 };
        assert!(matches!(ledger.submit(&lease, &Brought::Landings(1)).0, Submitted::Accepted(_)));
    }
    main
}

#[test]
fn a_lease_is_idempotent() {
    let mut ledger = Ledger::new(Rules::default(), plans(2));
    let first = leased(&mut ledger, "a", Duration::ZERO);
    assert_eq!(leased(&mut ledger, "a", Duration::from_secs(1)), first);
    assert_ne!(leased(&mut ledger, "b", Duration::from_secs(1)).task, first.task);
}

#[test]
fn a_worker_that_vanishes_has_a_grace_that_a_sign_of_life_ends() {
    let rules = Rules::default();
    let mut ledger = Ledger::new(rules, plans(1));
    let lease = leased(&mut ledger, "a", Duration::ZERO);
    ledger.worker_gone(&lease.worker, Duration::from_secs(1));
    assert!(ledger.tick(rules.grace).is_empty());
    assert_eq!(ledger.renew(&lease, None, rules.grace).0, RenewReply::Ok);
    assert!(ledger.tick(rules.grace + Duration::from_secs(2)).is_empty());
    ledger.worker_gone(&lease.worker, Duration::from_secs(8));
    let ended = ledger.tick(Duration::from_secs(8) + rules.grace);
    assert!(matches!(&ended[..], [Change::Ended { end: AttemptEnd::Expired, .. }]));
}

/// Fails a task until it is given up; returns its last lease.
fn poison(ledger: &mut Ledger, task: &str, now: &mut Duration) -> Lease {
    let rules = Rules::default();
    for attempt in 1..=rules.max_failures {
        let lease = leased(ledger, "a", *now);
        assert_eq!((lease.task.as_str(), lease.attempt), (task, Attempt(attempt)));
        assert!(ledger.fail(&lease, "boom", *now).0);
        if attempt == rules.max_failures {
            return lease;
        }
        // Its level waits for the pause to pass.
        assert!(matches!(ledger.lease(&lease.worker, 0, *now).0, Leased::Wait));
        *now += rules.backoff * 2u32.pow(attempt);
    }
    unreachable!("there is a last attempt")
}

#[test]
fn a_poison_seed_dies_with_its_reasons_and_blocks_nobody() {
    let mut ledger = Ledger::new(Rules::default(), plans(1));
    let mut now = Duration::ZERO;
    let main = landed(&mut ledger);
    assert!(matches!(ledger.submit(&main, &MAIN).0, Submitted::Accepted(_)));
    let above = leased(&mut ledger, "a", now);
    assert!(matches!(ledger.submit(&above, &ON_MAIN).0, Submitted::Accepted(_)));
    let late = poison(&mut ledger, "1-3", &mut now);
    assert_eq!(ledger.dead(), [(TaskId::new("1-3").unwrap(), vec!["a: boom".to_string(); 3])]);
    let next = leased(&mut ledger, "a", now);
    assert_eq!(next.task.as_str(), "1-5");
    // A result of the dead task may be a branch that the next one is about to find.
    assert_eq!(ledger.submit(&late, &ISOLA).0, Submitted::Late);
    assert!(!ledger.retry_dead().is_empty());
    // What is under way comes first; then the one revived, with what is known by then.
    assert_eq!(leased(&mut ledger, "a", now), next);
    assert!(matches!(ledger.submit(&next, &ISOLA).0, Submitted::Accepted(_)));
    let revived = leased(&mut ledger, "a", now);
    assert_eq!(revived.task.as_str(), "1-3");
    assert_eq!(ledger.submit(&late, &ISOLA).0, Submitted::Late);
    let on_isola = Brought::Nothing(SeedOutcome::Found(BranchId::isola(0)));
    assert!(matches!(ledger.submit(&revived, &on_isola).0, Submitted::Accepted(_)));
}

#[test]
fn a_level_waits_for_its_main_branch() {
    let mut ledger = Ledger::new(Rules::default(), plans(1));
    let mut now = Duration::ZERO;
    landed(&mut ledger);
    poison(&mut ledger, "1-0", &mut now);
    let late = poison(&mut ledger, "1-1", &mut now);
    assert!(ledger.is_finished(), "nothing of the level can be handed out");
    assert!(matches!(ledger.lease(&late.worker, 0, now).0, Leased::Drained));
    // Nobody went on without it.
    assert!(matches!(ledger.submit(&late, &MAIN).0, Submitted::Accepted(_)));
    assert_eq!(leased(&mut ledger, "a", now).task.as_str(), "1-3");
}

#[test]
fn a_main_branch_from_above_is_one_to_compare_with() {
    for is_dead in [false, true] {
        let mut ledger = Ledger::new(Rules::default(), plans(1));
        let mut now = Duration::ZERO;
        landed(&mut ledger);
        if is_dead {
            poison(&mut ledger, "1-0", &mut now);
        } else {
            let below = leased(&mut ledger, "a", now);
            assert!(matches!(ledger.submit(&below, &UNREACHED).0, Submitted::Accepted(_)));
        }
        let above = leased(&mut ledger, "a", now);
        let Submitted::Accepted(accepted) = ledger.submit(&above, &MAIN).0 else { panic!("not accepted") };
        assert_eq!(accepted.outcome, SeedOutcome::Found(BranchId::MAIN));
        assert_eq!(leased(&mut ledger, "a", now).task.as_str(), "1-3");
    }
}

#[test]
fn without_a_main_branch_there_is_nothing_to_compare_with() {
    let mut ledger = Ledger::new(Rules::default(), vec![plan(1.0, 3)]);
    landed(&mut ledger);
    for _ in [Side::Below, Side::Above] {
        let main = leased(&mut ledger, "a", Duration::ZERO);
        assert!(matches!(ledger.submit(&main, &UNREACHED).0, Submitted::Accepted(_)));
    }
    assert!(ledger.is_finished() && ledger.counts().skipped == 18);
}

#[test]
fn starts_are_tried_whatever_becomes_of_main_branches() {
    let mut level = plan(1.0, 0);
    let place = StartPlace::random(0);
    level.tasks.extend(Task::from_starts(place));
    let mut ledger = Ledger::new(Rules::default(), vec![level]);
    for (task, brought) in [
        ("1-0", &UNREACHED),
        ("1-1", &MAIN),
        ("1-2", &Brought::Landings(3)),
        ("1-3", &ISOLA),
        // It may lead to one more.
        ("1-4", &ON_MAIN),
    ] {
        let lease = leased(&mut ledger, "a", Duration::ZERO);
        assert_eq!(lease.task.as_str(), task);
        assert!(matches!(ledger.submit(&lease, brought).0, Submitted::Accepted(_)), "{task}");
    }
    assert!(ledger.is_finished() && ledger.counts().skipped == 0);
}

#[test]
fn what_does_not_land_leads_nowhere_and_stepping_comes_after_what_did_not_lead_to_a_branch() {
    let mut ledger = Ledger::new(Rules::default(), vec![plan(1.0, 1)]);
    let mut take = |expected: &str, brought: &Brought| {
        let lease = leased(&mut ledger, "a", Duration::ZERO);
        assert_eq!(lease.task.as_str(), expected);
        assert!(matches!(ledger.submit(&lease, &Brought::Curve([1.0].into())).0, Submitted::Foreign));
        assert!(matches!(ledger.submit(&lease, brought).0, Submitted::Accepted(_)), "{expected}");
    };
    let not_landed = Brought::Nothing(SeedOutcome::NotLanded(LandingFailure::Far(0.5)));
    for (task, brought) in [
        ("1-0", &MAIN),
        ("1-1", &ON_MAIN),
        ("1-2", &Brought::Landings(3)),
        ("1-3", &ISOLA),
        ("1-4", &not_landed),
        // The first phase led to a branch.
        ("1-8", &Brought::Landings(1)),
        ("1-9", &ON_MAIN),
    ] {
        take(task, brought);
    }
    assert!(ledger.is_finished() && ledger.counts().skipped == 3);
}

#[test]
fn a_landing_that_is_given_up_holds_up_its_own_seed_only() {
    let mut ledger = Ledger::new(Rules::default(), vec![plan(1.0, 2)]);
    let mut now = Duration::ZERO;
    let main = leased(&mut ledger, "a", now);
    poison_beside(&mut ledger, "1-2", &mut now);
    assert!(matches!(ledger.submit(&main, &MAIN).0, Submitted::Accepted(_)));
    let landed = Brought::Landings(1);
    for (task, brought) in [
        ("1-1", &ON_MAIN),
        ("1-4", &landed),
        ("1-5", &ISOLA),
        // The other way to land what was given up.
        ("1-6", &landed),
        ("1-7", &ON_MAIN),
        // The other window.
        ("1-10", &landed),
        ("1-11", &ON_MAIN),
        ("1-12", &landed),
        ("1-13", &ON_MAIN),
    ] {
        let lease = leased(&mut ledger, "a", now);
        assert_eq!(lease.task.as_str(), task);
        assert!(matches!(ledger.submit(&lease, brought).0, Submitted::Accepted(_)));
    }
    assert!(ledger.is_finished() && ledger.dead().len() == 1);
    assert!(!ledger.retry_dead().is_empty() || !ledger.is_finished());
    assert_eq!(leased(&mut ledger, "a", now).task.as_str(), "1-2");
}

/// The same as [`poison`], of a landing beside what "a" holds.
fn poison_beside(ledger: &mut Ledger, task: &str, now: &mut Duration) {
    let rules = Rules::default();
    for attempt in 1..=rules.max_failures {
        let lease = leased(ledger, "b", *now);
        assert_eq!((lease.task.as_str(), lease.attempt), (task, Attempt(attempt)));
        assert!(ledger.fail(&lease, "boom", *now).0);
        *now += rules.backoff * 2u32.pow(attempt);
        let held = leased(ledger, "a", *now);
        assert_eq!(held.task.as_str(), "1-0");
    }
}

#[test]
fn a_crash_of_the_coordinator_is_no_failure_of_a_task() {
    let rules = Rules::default();
    let holder = Holder { worker: name(0), slot: 0 };
    let under_way = StoredTask {
        id: TaskId::new("1-0").unwrap(),
        state: TaskState::Leased { holder: holder.clone(), deadline: Duration::ZERO },
        brought: None,
        holders: vec![holder],
        troubles: Troubles::default(),
        evidence: Evidence::default(),
    };
    let (mut ledger, _) = Ledger::restore(rules, plans(1), &[], vec![under_way], Duration::ZERO);
    let ended = ledger.tick(Duration::from_secs(60));
    assert!(matches!(&ended[..], [Change::Ended { end: AttemptEnd::Released, .. }]));
    assert_eq!(leased(&mut ledger, "b", Duration::from_secs(60)).attempt, Attempt(2));
}

#[test]
fn cancelling_is_heard_in_the_answer_to_a_sign_of_life() {
    let mut ledger = Ledger::new(Rules::default(), plans(1));
    let lease = leased(&mut ledger, "a", Duration::ZERO);
    ledger.cancel();
    assert_eq!(ledger.renew(&lease, None, Duration::ZERO).0, RenewReply::Cancel);
    assert!(matches!(ledger.lease(&lease.worker, 0, Duration::ZERO).0, Leased::Stop));
    assert!(ledger.release(&lease, Duration::ZERO).0 && ledger.counts().running == 0);
}

#[test]
fn folds_are_followed_over_the_levels_and_lead_to_branches_where_they_cross() {
    let rules = Rules { most_folds: 2, ..Rules::default() };
    let mut ledger = Ledger::new(rules, vec![plan(1.0, 0), plan(2.0, 0)]);
    let main = Brought::Branch { kind: BranchKind::Main, folds: 2, branch_points: 0 };
    let mut take = |expected: &str, brought: &Brought| {
        let lease = leased(&mut ledger, "a", Duration::ZERO);
        assert_eq!(lease.task.as_str(), expected);
        ledger.submit(&lease, brought).0
    };
    for (task, brought) in [("2-0", &main), ("2-1", &ON_MAIN), ("1-0", &main), ("1-1", &ON_MAIN)] {
        assert!(matches!(take(task, brought), Submitted::Accepted(_)));
    }
    assert_eq!(take("fold-0", &main), Submitted::Foreign);
    let curve = Brought::Curve([0.5, 1.5, 3.0].into());
    let Submitted::Accepted(accepted) = take("fold-0", &curve) else { panic!("not accepted") };
    assert_eq!((accepted.outcome, accepted.amplitude.text.as_str()), (SeedOutcome::OnCurve(0), "2"));
    // One more, instead of the one that turned out to lie on it.
    let unknown = Brought::Nothing(SeedOutcome::OnCurve(1));
    assert_eq!(take("fold-1", &unknown), Submitted::Foreign);
    let known = Brought::Nothing(SeedOutcome::OnCurve(0));
    assert!(matches!(take("fold-1", &known), Submitted::Accepted(_)));
    let elsewhere = Brought::Nothing(SeedOutcome::NotFollowed(Unfollowed::Elsewhere));
    assert!(matches!(take("fold-2", &elsewhere), Submitted::Accepted(_)));
    // There are no more folds than allowed; every level that the curve crosses gets a task.
    assert_eq!(take("2-2", &curve), Submitted::Foreign);
    assert!(matches!(take("2-2", &ISOLA), Submitted::Accepted(_)));
    assert!(matches!(take("1-2", &ON_MAIN), Submitted::Accepted(_)));
    assert!(ledger.is_finished());
    let (branches, curves) = (ledger.counts().branches, ledger.chains[ledger.curves()].curves().len());
    assert_eq!((branches, curves), (3, 1));
}

/// What motions of one order lie on is nothing to those of another, at whatever forcing.
#[test]
fn curves_are_of_an_order_of_motions() {
    let rules = Rules { most_folds: 9, ..Rules::default() };
    let mut further = plan(1.0, 0);
    further.amplitude = further.amplitude.of_order(3);
    further.tasks = vec![Task::Begin(StartPlace::random(0))];
    let mut ledger = Ledger::new(rules, vec![plan(1.0, 0), plan(2.0, 0), further]);
    let main = Brought::Branch { kind: BranchKind::Main, folds: 1, branch_points: 0 };
    let isola = Brought::Branch { kind: BranchKind::Isola, folds: 1, branch_points: 0 };
    let curve = Brought::Curve([0.5, 1.5, 3.0].into());
    let mut take = |expected: &str, curves: &[usize], brought: &Brought| {
        let (Leased::Grant(granted), _) = ledger.lease(&name(0), 0, Duration::ZERO) else { panic!("no {expected}") };
        let Granted { task, attempt, amplitude, .. } = &granted;
        assert_eq!(
            (task.as_str(), amplitude.order()),
            (expected, ["1-m3-0", "1-m3-1", "1-m3-2", "fold-2"].contains(&expected).then_some(3))
        );
        let given: Vec<usize> = granted.curves.iter().map(|curve| curve.number).collect();
        assert_eq!(given, curves, "{task}");
        let lease = Lease { task: task.clone(), attempt: *attempt, worker: name(0), slot: 0 };
        assert!(matches!(ledger.submit(&lease, brought).0, Submitted::Accepted(_)), "{task}");
    };
    take("2-0", &[], &main);
    take("2-1", &[], &ON_MAIN);
    take("1-0", &[], &main);
    take("1-1", &[], &ON_MAIN);
    take("1-m3-0", &[], &isola);
    take("1-m3-1", &[], &Brought::Nothing(SeedOutcome::OutOfBounds));
    take("fold-0", &[], &curve);
    take("fold-1", &[0], &Brought::Nothing(SeedOutcome::OnCurve(0)));
    // That of the isola is given no curve of the main branches, and its own leads to no level of theirs.
    take("fold-2", &[], &curve);
    take("2-2", &[0], &ON_MAIN);
    take("1-2", &[0], &ON_MAIN);
    take("1-m3-2", &[1], &Brought::Nothing(SeedOutcome::Found(BranchId::isola(0))));
    assert!(ledger.is_finished());
}

/// No fold leads from an open branch to another level: a response of it is carried there, and its curve is no fold curve.
#[test]
fn open_branches_are_carried_over_the_levels() {
    let rules = Rules { most_folds: 9, ..Rules::default() };
    let mut ledger = Ledger::new(rules, vec![plan(1.0, 0), plan(2.0, 0)]);
    let main = Brought::Branch { kind: BranchKind::Main, folds: 0, branch_points: 0 };
    let open = Brought::branch(BranchKind::Open);
    let fold = Brought::Branch { kind: BranchKind::Open, folds: 1, branch_points: 0 };
    let on_curve = |number| Brought::Nothing(SeedOutcome::OnCurve(number));
    let curve = Brought::Curve([0.5, 3.0].into());
    let is_given = |granted: &Granted, curves: &[usize]| {
        assert_eq!(granted.curves.iter().map(|curve| curve.number).collect::<Vec<_>>(), curves, "{}", granted.task);
    };
    let mut take = |expected: &str, curves: &[usize], brought: &Brought| {
        let (Leased::Grant(granted), _) = ledger.lease(&name(0), 0, Duration::ZERO) else { panic!("no {expected}") };
        assert_eq!(granted.task.as_str(), expected);
        is_given(&granted, curves);
        let lease = Lease { task: granted.task, attempt: granted.attempt, worker: name(0), slot: 0 };
        assert!(matches!(ledger.submit(&lease, brought).0, Submitted::Accepted(_)), "{expected}");
    };
    for (task, brought) in [("2-0", &main), ("2-1", &fold), ("1-0", &main), ("1-1", &ON_MAIN)] {
        take(task, &[], brought);
    }
    // From both ends, then along its folds.
    take("carry-0", &[], &curve);
    take("carry-1", &[0], &on_curve(0));
    take("fold-2", &[], &curve);
    // Both curves cross both levels.
    let on_open = Brought::Nothing(SeedOutcome::Found(BranchId::new(BranchKind::Open, 0)));
    take("2-2", &[0], &on_open);
    take("2-3", &[1], &on_open);
    take("1-2", &[0], &open);
    take("1-3", &[1], &on_open);
    // What was found so is carried as well, and is on the curve that led to it.
    take("carry-3", &[0], &on_curve(0));
    take("carry-4", &[0], &on_curve(0));
    assert!(ledger.is_finished());
}

/// Verifications fill what time there is, and hold nobody up: whoever asks gets what others wait for first.
#[test]
fn branches_are_verified_once_and_last() {
    let rules = Rules { verify: VerifyEffort::Standard, ..Rules::default() };
    let mut ledger = Ledger::new(rules, vec![plan(2.0, 1)]);
    let worker = WorkerId::new("w").unwrap();
    let mut order = Vec::new();
    while let (Leased::Grant(granted), _) = ledger.lease(&worker, 0, Duration::ZERO) {
        let lease = Lease { task: granted.task.clone(), attempt: granted.attempt, worker: worker.clone(), slot: 0 };
        assert!(matches!(ledger.submit(&lease, &find(&granted)).0, Submitted::Accepted(_)));
        order.push(granted);
    }
    let (verified, others): (Vec<&Granted>, Vec<&Granted>) =
        order.iter().partition(|granted| matches!(granted.work, Task::Verify(_)));
    let names: Vec<&str> = verified.iter().map(|granted| granted.task.as_str()).collect();
    // A whole branch takes longer than what is around a peak.
    assert_eq!(names, ["verify-2-cut-1", "verify-2-main-1-peak"]);
    assert!(order[others.len()..].iter().all(|granted| matches!(granted.work, Task::Verify(_))), "{order:?}");
}

/// A run that is to be verified from end to end keeps what was verified of isolas and looks at main branches again.
#[test]
fn a_finished_run_can_be_verified_further() {
    let mut driver = Driver::new(1, VerifyEffort::Standard);
    driver.conclude();
    let (levels, added) = driver.planned();
    let tasks: Vec<StoredTask> = driver.ledger.entries().map(|entry| driver.stored(entry)).collect();
    let again = |verify| Ledger::restore(rules(verify), levels.clone(), &added, tasks.clone(), Duration::ZERO);
    let (same, changes) = again(VerifyEffort::Standard);
    assert!(same.is_finished() && changes.is_empty());
    let (more, changes) = again(VerifyEffort::All);
    let added = |change: &Change| match change {
        Change::Added(tasks) => tasks.iter().map(|task| task.id.to_string()).collect(),
        _ => Vec::new(),
    };
    // The unstable motions of what was verified from end to end are followed.
    let names: Vec<String> = changes.iter().flat_map(added).collect();
    assert_eq!(names[..3], ["verify-1-main-1", "march-1-isola-1-point-2", "march-1-isola-1-point-5"]);
    assert!(!more.is_finished() && !names.iter().any(|name| name.starts_with("march-1-main")), "{names:?}");
}

/// Pushes are added to a run that is finished: with the main branch and the one that they may end on, each once.
#[test]
fn a_finished_run_can_be_pushed() {
    let mut driver = Driver::new(1, VerifyEffort::Standard);
    driver.conclude();
    let (levels, mut added) = driver.planned();
    let tasks: Vec<StoredTask> = driver.ledger.entries().map(|entry| driver.stored(entry)).collect();
    let branch = BranchId::new(BranchKind::Cut, 0);
    for mode in 0..2 {
        let place = DisturbPlace { branch, mode, omega: 2.5 };
        let id = TaskId::of_disturbance("1", &place).unwrap();
        added.push(AddedTask { id, amplitude: "1".into(), task: Task::Disturb(place) });
    }
    let (mut ledger, changes) = Ledger::restore(rules(VerifyEffort::Standard), levels, &added, tasks, Duration::ZERO);
    assert!(changes.is_empty() && !ledger.is_finished());
    let mut names = Vec::new();
    while let (Leased::Grant(granted), _) = ledger.lease(&WorkerId::new("w").unwrap(), 0, Duration::ZERO) {
        let worker = WorkerId::new("w").unwrap();
        let lease = Lease { task: granted.task.clone(), attempt: granted.attempt, worker, slot: 0 };
        let foreign = ledger.submit(&lease, &Brought::Verification(3, [].into())).0;
        assert!(matches!(foreign, Submitted::Foreign), "{foreign:?}");
        let Submitted::Accepted(accepted) = ledger.submit(&lease, &find(&granted)).0 else { panic!("{granted:?}") };
        assert_eq!(accepted.outcome, SeedOutcome::Disturbed(16));
        names.push(granted.task.to_string());
    }
    assert_eq!(names, ["disturb-1-cut-1-mode-1", "disturb-1-cut-1-mode-2"]);
    assert!(ledger.is_finished());
}
