//! Results that are wrong: found out, taken back and done again by others, also by another coordinator.

use super::cases::leased;
use super::driver::lie;
use super::trust::{in_turn, number};
use super::*;
use std::collections::BTreeSet;

/// Everything is repeated. Without curves, whose numbers follow from the order in which they are found.
pub(super) fn rules(verify: VerifyEffort) -> Rules {
    Rules { max_failures: 1000, max_lapses: 1000, verify, repeated: 1e9, ..Rules::default() }
}

/// The branches of every level, by what leads to them alone.
fn branches(ledger: &Ledger) -> Vec<BTreeSet<String>> {
    let levels = ledger.levels();
    let names = levels.map(|(chain, level)| {
        let name = |task: &TaskId| match chain.entries.iter().find(|entry| entry.id == *task).unwrap().task {
            Task::Seed(place) if place.method == LandingMethod::FullForcing => format!("window {}", place.window),
            _ => task.to_string(),
        };
        level.branches.iter().map(|branch| name(&branch.known.task)).collect()
    });
    names.collect()
}

/// Those that one worker finds.
fn expected(levels: usize) -> Vec<BTreeSet<String>> {
    let mut ledger = Ledger::new(rules(VerifyEffort::None), plans(levels));
    in_turn(&mut ledger, &["a"], |_, granted| find(granted), 1.0);
    branches(&ledger)
}

fn withdrawn(changes: &[Change]) -> usize {
    changes.iter().filter(|change| matches!(change, Change::Withdrawn { .. })).count()
}

proptest! {
    /// Whoever is wrong, and whenever the coordinator is interrupted: what was found out is done again, and nothing else is lost. What was
    /// not is what nobody else was there to repeat.
    #[test]
    fn what_is_wrong_is_done_again(
        levels in 1usize..4,
        verify in effort(),
        events in prop::collection::vec(event(), 0..300),
    ) {
        let mut driver = Driver::new(levels, verify);
        driver.ledger = Ledger::new(rules(verify), plans(levels));
        driver.liar = Some(name(3));
        for event in &events {
            driver.apply(event);
        }
        driver.conclude();
        let ends = |id: &TaskId| driver::evidence(&driver.changes, id).ends;
        let stands = |(task, attempt): &&(TaskId, Attempt)| {
            let is_result = |change: &&Change| matches!(change, Change::Done { task: done, .. } | Change::Withdrawn { task: done } if done == task);
            let last = driver.changes.iter().rev().find(is_result);
            matches!(last, Some(Change::Done { attempt: counts, .. }) if counts == attempt)
        };
        let standing: BTreeSet<_> = driver.lies.iter().filter(stands).collect();
        for (task, attempt) in &standing {
            prop_assert!(!ends(task).iter().any(|(other, end)| other == attempt && matches!(end, AttemptEnd::Refuted(_))));
        }
        if standing.is_empty() {
            prop_assert_eq!(branches(&driver.ledger), expected(levels));
        }
        prop_assert!(driver.ledger.entries().all(TaskEntry::is_settled));
        let done = driver.ledger.counts().done;
        prop_assert_eq!((driver.ledger.sequence() as usize, driver.accepted.len()), (done, done));
    }
}

/// Who is wrong with everything is found out, and everything is as if it had never been there.
#[test]
fn nothing_is_left_of_who_is_wrong() {
    let mut ledger = Ledger::new(Rules { repeated: 1.0, ..rules(VerifyEffort::None) }, plans(12));
    let what = |name: &str, granted: &Granted| lie(granted).filter(|_| name == "liar").unwrap_or_else(|| find(granted));
    let changes = in_turn(&mut ledger, &["a", "liar", "b"], what, 1.0);
    let refuted = number(&changes, |end| matches!(end, AttemptEnd::Refuted(why) if why.starts_with("liar: ")));
    assert!(refuted >= 3 && withdrawn(&changes) >= 3, "{refuted}");
    assert_eq!(number(&changes, |end| matches!(end, AttemptEnd::Refuted(why) if !why.starts_with("liar: "))), 0);
    assert!(ledger.is_finished());
    assert_eq!(branches(&ledger), expected(12));
}

/// A ledger of one level of which worker `a` has said that nothing is where starts lead, and `b` that something is; the last lease is
/// of the main branch, which `main` holds.
fn disputed() -> (Driver, Lease) {
    let mut driver = Driver::new(1, VerifyEffort::None);
    driver.ledger = Ledger::new(rules(VerifyEffort::None), plans(1));
    driver.liar = Some(name(3));
    let main = leased(&mut driver.ledger, "main", Duration::ZERO);
    driver.changes.push(granted(&main));
    driver.apply(&Event::Lease(3));
    driver.apply(&Event::Submit(0));
    driver.held.clear();
    assert_eq!(driver.lies.len(), 1);
    driver.apply(&Event::Lease(0));
    driver.apply(&Event::Submit(0));
    driver.held.clear();
    assert_eq!(number(&driver.changes, |end| matches!(end, AttemptEnd::Disputed(_))), 1);
    (driver, main)
}

fn granted(lease: &Lease) -> Change {
    let holder = Holder { worker: lease.worker.clone(), slot: lease.slot };
    Change::Granted { task: lease.task.clone(), attempt: lease.attempt, holder }
}

#[test]
fn a_dispute_outlasts_the_coordinator() {
    for is_interrupted in [false, true] {
        let (mut driver, _main) = disputed();
        if is_interrupted {
            driver.apply(&Event::Restart);
        }
        // Neither of the two decides.
        driver.apply(&Event::Lease(0));
        assert_ne!(driver.held[0].0.task, driver.lies[0].0);
        driver.apply(&Event::Lease(1));
        assert_eq!(driver.held[1].0.task, driver.lies[0].0);
        driver.apply(&Event::Submit(1));
        let why = "w3: nothing, where w0 and w1 come to forced responses";
        assert_eq!(number(&driver.changes, |end| *end == AttemptEnd::Refuted(why.into())), 1);
        assert_eq!(withdrawn(&driver.changes), 1);
        if is_interrupted {
            driver.apply(&Event::Restart);
        }
        let (leased, _) = driver.ledger.lease(&name(3), 0, driver.now);
        assert!(!matches!(leased, Leased::Grant(granted) if granted.task == driver.lies[0].0));
    }
}

/// A run of which a dispute alone is left waits for who may come to decide it, and no longer than that takes.
#[test]
fn what_is_left_undecided_is_waited_for() {
    let (mut driver, main) = disputed();
    driver.held.clear();
    driver.changes.extend(driver.ledger.release(&main, driver.now).1);
    driver.ledger.worker_gone(&main.worker, driver.now);
    let worker = name(0);
    while let (Leased::Grant(granted), changes) = driver.ledger.lease(&worker, 0, driver.now) {
        driver.changes.extend(changes);
        let lease = Lease { task: granted.task.clone(), attempt: granted.attempt, worker: worker.clone(), slot: 0 };
        driver.held.push((lease, granted));
        driver.apply(&Event::Submit(0));
        driver.held.clear();
        driver.now += Duration::from_secs(1);
    }
    assert!(driver.ledger.is_finished(), "nobody else is there");
    driver.apply(&Event::Restart);
    assert!(!driver.ledger.is_finished(), "somebody may come");
    driver.apply(&Event::Later(30));
    assert!(driver.ledger.is_finished(), "nobody has come");
    driver.apply(&Event::Lease(1));
    assert!(driver.held.is_empty() || driver.held[0].0.task == driver.lies[0].0);
}

/// What others were taken for isolas with stays, and so does what branches begin at.
#[test]
fn what_something_was_made_of_stays() {
    let nothing = Brought::Nothing(SeedOutcome::NotLanded(LandingFailure::Far(0.5)));
    for is_main in [true, false] {
        let mut ledger = Ledger::new(rules(VerifyEffort::None), vec![plan(1.0, 1)]);
        let (main, landing) = (leased(&mut ledger, "a", Duration::ZERO), leased(&mut ledger, "a2", Duration::ZERO));
        let (wrong, lied, right) = if is_main {
            let unreached = Brought::Nothing(SeedOutcome::OutOfBounds);
            (main.clone(), unreached, Brought::branch(BranchKind::Main))
        } else {
            (landing.clone(), Brought::Landings(1), nothing.clone())
        };
        let on_main = Brought::Nothing(SeedOutcome::Found(BranchId::MAIN));
        let isola = Brought::branch(BranchKind::Isola);
        let mut carried_out = vec![(main, Brought::branch(BranchKind::Main)), (landing, Brought::Landings(1))];
        carried_out.iter_mut().filter(|(lease, _)| *lease == wrong).for_each(|(_, brought)| *brought = lied.clone());
        for (lease, brought) in &carried_out {
            assert!(matches!(ledger.submit(lease, brought).0, Submitted::Accepted(_)));
        }
        // Others go on from there before anything is repeated.
        for brought in [&Brought::branch(BranchKind::Main), &isola] {
            let lease = leased(&mut ledger, "x", Duration::ZERO);
            assert!(matches!(ledger.submit(&lease, brought).0, Submitted::Accepted(_)));
        }
        ledger.note_claim(&wrong, 1.0, Duration::MAX);
        let mut changes = Vec::new();
        for i in 0..20 {
            let worker = WorkerId::new(["b", "c", "d"][i % 3]).unwrap();
            let (Leased::Grant(granted), _) = ledger.lease(&worker, 0, Duration::ZERO) else { continue };
            let lease = Lease { task: granted.task.clone(), attempt: granted.attempt, worker, slot: 0 };
            let brought = match granted.work {
                _ if lease.task == wrong.task => right.clone(),
                Task::Land(_) => Brought::Landings(1),
                _ => on_main.clone(),
            };
            changes.extend(ledger.submit(&lease, &brought).1);
        }
        let refuted = number(&changes, |end| matches!(end, AttemptEnd::Refuted(_)));
        assert_eq!((refuted, withdrawn(&changes)), (1, 0), "{changes:?}");
        let state = ledger.entries().find(|entry| entry.id == wrong.task).map(|entry| entry.state.clone());
        assert!(matches!(state, Some(TaskState::Done(_))));
        assert!(ledger.is_finished());
    }
}

/// Who is wrong under ever new names does not keep a run from its end.
#[test]
fn a_task_is_taken_back_so_often_and_no_more() {
    let mut ledger = Ledger::new(rules(VerifyEffort::None), vec![plan(1.0, 1)]);
    let mut all = Vec::new();
    let _main = leased(&mut ledger, "main", Duration::ZERO);
    let refused = Brought::Nothing(SeedOutcome::NotLanded(LandingFailure::Far(0.5)));
    for round in 0..20 {
        for who in ["liar", "b", "c"] {
            let worker = WorkerId::new(&format!("{who}-{round}")).unwrap();
            let (leased, changes) = ledger.lease(&worker, 0, Duration::ZERO);
            all.extend(changes);
            let Leased::Grant(granted) = leased else { continue };
            let lease = Lease { task: granted.task.clone(), attempt: granted.attempt, worker, slot: 0 };
            let is_lie = who == "liar" && granted.task.as_str() == "1-2";
            let brought = if is_lie { refused.clone() } else { Brought::Landings(1) };
            all.extend(ledger.submit(&lease, &brought).1);
            ledger.note_claim(&lease, 1.0, Duration::MAX);
        }
    }
    assert!((1..=5).contains(&withdrawn(&all)), "{}", withdrawn(&all));
}
