//! Homotopies: when they are tried, and what comes of them.

use super::cases::{ISOLA, MAIN, ON_MAIN, leased};
use super::*;

/// A level without windows, with a batch of random starts and two of homotopies.
fn with_homotopies() -> Ledger {
    let mut level = plan(1.0, 0);
    let places = [StartPlace::random(0), StartPlace::homotopy(0), StartPlace::homotopy(1)];
    level.tasks.extend(places.into_iter().flat_map(Task::from_starts));
    Ledger::new(Rules::default(), vec![level])
}

#[test]
fn homotopies_come_where_nothing_else_led_to_a_branch() {
    let landed = Brought::Landings(2);
    let follow = |steps: &[(&str, &Brought)]| {
        let mut ledger = with_homotopies();
        let before = [("1-0", &MAIN), ("1-1", &ON_MAIN), ("1-2", &landed)];
        for (task, brought) in before.iter().chain(steps) {
            let lease = leased(&mut ledger, "a", Duration::ZERO);
            assert_eq!(lease.task.as_str(), *task);
            assert!(matches!(ledger.submit(&lease, brought).0, Submitted::Accepted(_)), "{task}");
        }
        assert!(ledger.is_finished());
        ledger.counts().skipped
    };
    // What led to a branch may lead to one more.
    assert_eq!(follow(&[("1-3", &ISOLA), ("1-8", &ON_MAIN)]), 4);
    let on_main = [("1-3", &ON_MAIN), ("1-4", &landed), ("1-5", &ON_MAIN), ("1-6", &landed), ("1-7", &ON_MAIN)];
    assert_eq!(follow(&on_main), 0);
    // All that they lead to is found.
    let both = [("1-3", &ON_MAIN), ("1-4", &landed), ("1-5", &ISOLA), ("1-6", &landed), ("1-7", &ISOLA)];
    assert_eq!(follow(&[&both[..], &[("1-8", &ON_MAIN), ("1-9", &ON_MAIN)]].concat()), 0);
}

#[test]
fn homotopies_wait_for_everything_else_and_not_for_each_other() {
    let mut ledger = with_homotopies();
    for (task, brought) in [("1-0", MAIN), ("1-1", ON_MAIN), ("1-2", Brought::Landings(2))] {
        let lease = leased(&mut ledger, "a", Duration::ZERO);
        assert_eq!(lease.task.as_str(), task);
        assert!(matches!(ledger.submit(&lease, &brought).0, Submitted::Accepted(_)), "{task}");
    }
    let begin = leased(&mut ledger, "a", Duration::ZERO);
    assert!(matches!(ledger.lease(&WorkerId::new("b").unwrap(), 0, Duration::ZERO).0, Leased::Wait));
    assert!(matches!(ledger.submit(&begin, &ON_MAIN).0, Submitted::Accepted(_)));
    let tasks = ["a", "b"].map(|worker| leased(&mut ledger, worker, Duration::ZERO).task);
    assert_eq!(tasks.each_ref().map(TaskId::as_str), ["1-4", "1-6"]);
}
