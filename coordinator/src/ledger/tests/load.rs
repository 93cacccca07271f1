//! How busy everybody is, and how long it will take.

use super::cases::{MAIN, ON_MAIN, leased};
use super::*;
use crate::ledger::STATES;
use protocol::from_worker::Progress;
use results::journal::{KINDS, kind};

fn at(seconds: u64) -> Duration {
    Duration::from_secs(seconds)
}

/// Tasks of a kind in a state.
fn count(load: &Load, kind: &str, state: &str) -> usize {
    let place = |names: &[&str], name| names.iter().position(|n| *n == name).unwrap();
    load.tasks[place(&KINDS, kind)][place(&STATES, state)]
}

#[test]
fn a_moment_of_a_run() {
    let tasks = plan(1.0, 1).tasks;
    assert_eq!([&tasks[0], &tasks[2], &tasks[3]].map(kind), ["main", "land", "seed"]);
    let mut ledger = Ledger::new(Rules::default(), vec![plan(1.0, 1)]);
    let load = ledger.load(at(0));
    assert_eq!(["main", "land", "seed"].map(|kind| count(&load, kind, "waiting")), [2, 4, 4]);
    // The main branch, and two landings with the full forcing.
    assert_eq!((load.queue, load.oldest_waiting, load.oldest_lease), (3, Some(at(0)), None));

    ledger.measure(at(1));
    let lease = leased(&mut ledger, "a", at(1));
    ledger.measure(at(3));
    let load = ledger.load(at(3));
    assert_eq!((load.queue, load.oldest_waiting), (2, Some(at(3))));
    assert_eq!((load.leases, load.silent_leases, load.oldest_lease), (1, 0, Some(at(2))));
    let [worker] = &load.workers[..] else { panic!("{:?}", load.workers) };
    assert_eq!((worker.threads, worker.leases, worker.busy, worker.present), (1, 1, at(2), at(2)));
    assert!(ledger.release(&lease, at(3)).0);
    ledger.measure(at(5));
    let load = ledger.load(at(5));
    assert_eq!((load.workers[0].leases, load.workers[0].busy, load.workers[0].present), (0, at(2), at(4)));
    // What was given back waits anew.
    assert_eq!((load.queue, load.oldest_waiting), (3, Some(at(5))));

    let lease = leased(&mut ledger, "a", at(6));
    ledger.worker_gone(&lease.worker, at(7));
    let load = ledger.load(at(7));
    assert_eq!((load.leases, load.silent_leases, load.workers.len()), (0, 1, 0));
}

#[test]
fn the_time_left_is_that_of_what_will_be_needed() {
    let mut ledger = Ledger::new(Rules::default(), vec![plan(1.0, 1)]);
    let is_left = |ledger: &Ledger, seconds: f64| {
        let left = ledger.time_left().unwrap();
        assert!((left / seconds - 1.0).abs() < 0.01, "{left} instead of {seconds}");
    };
    let main = leased(&mut ledger, "a", at(0));
    assert_eq!(ledger.time_left(), None);
    assert!(matches!(ledger.submit(&main, &MAIN).0, Submitted::Accepted(_)));
    // The second main branch, and four landings and seeds of which nothing is known.
    ledger.note_cost(&Task::Main(Side::Below), 10.0);
    is_left(&ledger, 90.0);
    for (task, seconds) in [(0, 10.0), (2, 1.0), (3, 2.0)] {
        let task = ledger.chains[0].entries[task].task;
        (0..10_000).for_each(|_| ledger.note_cost(&task, seconds));
    }
    is_left(&ledger, 10.0 + 4.0 + 8.0);
    // Branches of a level follow one after the other, whoever is there.
    for worker in ["b", "c", "d"] {
        assert!(matches!(ledger.lease(&WorkerId::new(worker).unwrap(), 0, at(1)).0, Leased::Grant(_)));
    }
    is_left(&ledger, 5.0 + 8.0);
    // Half of the seeds so far were not needed.
    let skipped = ledger.chains[0].entries.iter_mut().filter(|entry| matches!(entry.task, Task::Seed(_))).take(1);
    skipped.for_each(|entry| entry.state = TaskState::Skipped);
    is_left(&ledger, 5.0 + 3.0 * 2.0 / 2.0);
    let seed = ledger.chains[0].entries[3].task;
    ledger.note_cost(&seed, f64::NAN);
    is_left(&ledger, 5.0 + 3.0 * 2.0 / 2.0);
}

/// What levels ask for that have not begun is told by those that are done, and threads that wait for the coordinator take longer.
#[test]
fn the_time_left_counts_what_levels_to_come_ask_for() {
    let plans: Vec<LevelPlan> = (1..=100).map(|level| plan(f64::from(level), 0)).collect();
    let mut ledger = Ledger::new(Rules { verify: VerifyEffort::All, ..Rules::default() }, plans);
    let worker = WorkerId::new("a").unwrap();
    // The level that is offered first is done, whichever that is.
    while !ledger.chains.iter().any(|chain| chain.level().is_some() && chain.has_branches()) {
        let (Leased::Grant(granted), _) = ledger.lease(&worker, 0, at(0)) else { panic!("no task") };
        let found = if granted.known.is_empty() { &MAIN } else { &ON_MAIN };
        let lease = Lease { task: granted.task, attempt: granted.attempt, worker: worker.clone(), slot: 0 };
        assert!(matches!(ledger.submit(&lease, found).0, Submitted::Accepted(_)));
    }
    (0..10_000).for_each(|_| ledger.note_cost(&Task::Main(Side::Below), 1.0));
    let verification = ledger.entries().map(|entry| entry.task).find(|task| matches!(task, Task::Verify(_))).unwrap();
    (0..10_000).for_each(|_| ledger.note_cost(&verification, 10.0));
    // Its branch is to be verified for 10 s, and so will be those of the others.
    let left = ledger.time_left().unwrap();
    assert!((1000.0..1250.0).contains(&left), "{left}");
    // Only half of the time was computed so far.
    let computed = 10_000.0 * 11.0;
    let worker = ledger.workers.values_mut().next().unwrap();
    worker.wanted = Duration::from_secs_f64(2.0 * computed);
    assert!((ledger.time_left().unwrap() / (2.0 * left) - 1.0).abs() < 1e-9);
}

/// Workers that stay while there is nothing to do are no slower for that when levels are added.
#[test]
fn time_without_tasks_tells_nothing() {
    let mut ledger = Ledger::new(Rules::default(), vec![plan(1.0, 1)]);
    let main = leased(&mut ledger, "a", at(0));
    ledger.measure(at(2));
    assert!(matches!(ledger.submit(&main, &MAIN).0, Submitted::Accepted(_)));
    ledger.note_cost(&Task::Main(Side::Below), 2.0);
    let left = ledger.time_left().unwrap();
    let waiting: Vec<Vec<usize>> = ledger.chains.iter_mut().map(|chain| std::mem::take(&mut chain.ready)).collect();
    ledger.measure(at(1000));
    for (chain, ready) in ledger.chains.iter_mut().zip(waiting) {
        chain.ready = ready;
    }
    let [worker] = &ledger.load(at(1000)).workers[..] else { panic!("one worker") };
    assert_eq!(worker.present, at(1000));
    assert_eq!(ledger.time_left(), Some(left));
}

/// One that took long does not make all of its kind.
#[test]
fn the_first_of_a_kind_says_little() {
    let mut ledger = Ledger::new(Rules::default(), vec![plan(1.0, 1)]);
    let main = leased(&mut ledger, "a", at(0));
    assert!(matches!(ledger.submit(&main, &MAIN).0, Submitted::Accepted(_)));
    (0..1000).for_each(|_| ledger.note_cost(&Task::Main(Side::Below), 1.0));
    let before = ledger.time_left().unwrap();
    let seed = ledger.chains[0].entries[3].task;
    ledger.note_cost(&seed, 100.0);
    assert!((before..0.3 * (before + 4.0 * 100.0)).contains(&ledger.time_left().unwrap()));
}

#[test]
fn what_does_not_get_on_is_told() {
    let mut ledger = Ledger::new(Rules::default(), vec![plan(1.0, 1)]);
    let main = leased(&mut ledger, "a", at(0));
    let seconds = |ledger: &Ledger, now: u64| ledger.stalled(at(now)).first().map(|stalled| stalled.seconds);
    let point = |points: usize| Some(Progress { points, omega: 1.0, amplitude: 1.0 });
    // A sign of life that says the same is none of getting on.
    for (now, points) in [(5, 7), (300, 8), (700, 8)] {
        ledger.renew(&main, point(points), at(now));
    }
    assert_eq!((seconds(&ledger, 899), seconds(&ledger, 900)), (None, Some(600.0)));
    assert_eq!(ledger.stalled(at(900))[0].task, main.task);
    ledger.renew(&main, point(9), at(950));
    assert_eq!((seconds(&ledger, 960), seconds(&ledger, 1549), seconds(&ledger, 1550)), (None, None, Some(600.0)));
    // Where tasks of its kind take long it may take longer.
    ledger.note_cost(&Task::Main(Side::Below), 60.0);
    assert_eq!((seconds(&ledger, 2149), seconds(&ledger, 2150)), (None, Some(1200.0)));
    // Of a worker that is gone it is known why.
    ledger.worker_gone(&main.worker, at(2200));
    assert_eq!(seconds(&ledger, 2200), None);
}
