//! Any interleaving of events gives the same result: nothing lost, nothing counted twice.

mod cases;
mod disputes;
mod driver;
mod homotopies;
mod load;
mod trust;

use super::chain::{Chain, LevelRecord};
use super::task::TaskEntry;
use super::*;
use driver::Driver;
use proptest::prelude::*;
use protocol::from_worker::Lease;
use protocol::ids::{Attempt, TaskId, WorkerId};
use protocol::to_everyone::Amplitude;
use protocol::to_worker::RenewReply;
use results::journal::{
    AddedTask, AttemptEnd, Change, Evidence, Holder, LevelPlan, Said, StoredTask, TaskState, Troubles,
};
use solver::response::branch::{BranchKind, Side};
use solver::response::forcing::Unreached;
use solver::response::scout::ScoutPlace;
use solver::response::seeds::{LandingFailure, LandingMethod, Phase};
use solver::response::starts::StartPlace;
use solver::response::task::{
    BranchEnd, BranchId, Brought, CarryPlace, CrossingPlace, DisturbPlace, FoldPlace, SeedOutcome, SeedPlace,
    SwitchPlace, Task, Unfollowed,
};
use solver::response::windows::Window;
use solver::settings::VerifyEffort;
use std::collections::HashMap;
use std::time::Duration;

fn window(number: usize) -> Window {
    Window {
        mode: 0,
        first: 10 * number,
        last: 10 * number + 5,
        best: 10 * number + 2,
        threshold: 1.0,
        omega: (1.0, 2.0),
    }
}

/// A level of `windows` windows of one well each.
fn plan(amplitude: f64, windows: usize) -> LevelPlan {
    let mut tasks = vec![Task::Main(Side::Below), Task::Main(Side::Above)];
    for window_number in 0..windows {
        for method in [LandingMethod::FullForcing, LandingMethod::SteppedForcing] {
            for phase in [Phase::First, Phase::Second] {
                let well = window(window_number);
                let place = SeedPlace { window: window_number, well, phase, method };
                tasks.extend([Task::Land(place), Task::Seed(place)]);
            }
        }
    }
    let amplitude = Amplitude { text: amplitude.to_string(), value: amplitude };
    LevelPlan { amplitude, windows: (0..windows).map(window).collect(), tasks }
}

/// What a worker would find: a function of the task and of what is known, as tracing is. Some windows have an isola at
/// either phase, some the main branch, some nothing with the full forcing, and then a branch that is cut. Folds lie on one of
/// three curves, of which the second crosses no level; crossings lead to known branches and sometimes to an isola.
fn find(granted: &Granted) -> Brought {
    let Granted { work, known, curves, amplitude, .. } = granted;
    let amplitude = amplitude.value;
    let main = Brought::Nothing(SeedOutcome::Found(BranchId::MAIN));
    let place = match work {
        Task::Main(_) if known.is_empty() => {
            return Brought::Branch { kind: BranchKind::Main, folds: 2, branch_points: 2 };
        }
        Task::Main(_) => return main,
        Task::Scout(scout) => {
            assert!(known.is_empty() && curves.is_empty(), "a scout does not depend on what is known");
            return if scout.number == 1 { Brought::Nothing(SeedOutcome::NoFold) } else { Brought::Landings(2) };
        }
        Task::Fold(FoldPlace::Scout { scout, fold }) => {
            assert!(granted.landing.is_some() && known.is_empty(), "it is a fold of no level");
            let number = curves.len();
            return match (scout.number, fold) {
                (0, 1) => Brought::Curve([0.5, 1.5, 6.5].into()),
                _ if number > 0 => Brought::Nothing(SeedOutcome::OnCurve(curves[0].number)),
                _ => Brought::Nothing(SeedOutcome::NotFollowed(Unfollowed::Elsewhere)),
            };
        }
        Task::Fold(FoldPlace::Branch { branch, fold }) => {
            assert_eq!(known.len(), 1, "the branch that the fold is of");
            let forcing = |far: bool| if far { [10.0, 20.0].into() } else { [0.5, 5.5].into() };
            let number = curves.len();
            return match (branch.kind, fold) {
                (BranchKind::Main, 0) if number == 0 => Brought::Curve(forcing(false)),
                (BranchKind::Main, 0) => Brought::Nothing(SeedOutcome::OnCurve(0)),
                (BranchKind::Main, _) if amplitude < 2.0 => Brought::Curve(forcing(true)),
                (BranchKind::Isola, 1) if number == 1 => Brought::Curve(forcing(false)),
                _ => Brought::Nothing(SeedOutcome::NotFollowed(Unfollowed::Elsewhere)),
            };
        }
        // What is cut is on one curve from either end, as at other levels; fold curves are none of its business.
        Task::Carry(CarryPlace { branch, end }) => {
            assert_eq!(known.iter().map(|known| known.branch).collect::<Vec<_>>(), [*branch], "what is carried");
            return match (curves.first(), end) {
                (Some(curve), _) => Brought::Nothing(SeedOutcome::OnCurve(curve.number)),
                (None, BranchEnd::First) => Brought::Nothing(SeedOutcome::NotFollowed(Unfollowed::Elsewhere)),
                (None, BranchEnd::Last) => Brought::Curve([0.25, 4.5].into()),
            };
        }
        // What crosses the main branch twice is new once, and where it does that it crosses the main branch.
        Task::Switch(SwitchPlace { branch, point }) => {
            assert!(known.iter().any(|known| known.branch == *branch), "the branch that is crossed");
            let across = known.iter().map(|known| known.branch).find(|branch| branch.kind == BranchKind::Branched);
            return match (branch.kind, point, across) {
                (BranchKind::Main, 0, None) => {
                    Brought::Branch { kind: BranchKind::Branched, folds: 1, branch_points: 1 }
                }
                (BranchKind::Main, _, Some(across)) => Brought::Nothing(SeedOutcome::Found(across)),
                _ => main,
            };
        }
        Task::Crossing(CrossingPlace { curve, .. }) => {
            assert_eq!(curves.len(), 1, "the curve that crosses");
            let is_new = (curve + amplitude as usize).is_multiple_of(2);
            return if is_new { Brought::Branch { kind: BranchKind::Isola, folds: 2, branch_points: 0 } } else { main };
        }
        Task::Verify(place) => {
            assert_eq!(
                known.iter().map(|known| known.branch).collect::<Vec<_>>(),
                [place.branch],
                "the branch to verify"
            );
            return Brought::Verification(7, [(2, 2.5), (5, 2.75)].into());
        }
        Task::Disturb(place) => {
            assert!(known.iter().any(|known| known.branch.is_main()), "where pushes start from");
            assert!(known.iter().all(|known| known.branch.is_main() || known.branch == place.branch));
            return Brought::Disturbance(16);
        }
        Task::March(place) => {
            assert!(known.iter().any(|known| known.branch == place.branch), "what it is marched from");
            // Where it ends depends on all branches of the level: as many as there are.
            return Brought::Settling(known.len());
        }
        Task::Land(place) if (place.window + amplitude as usize).is_multiple_of(4) => return Brought::Landings(2),
        Task::Land(place) => {
            assert!(known.is_empty() && curves.is_empty(), "a landing does not depend on what is known");
            let failure = LandingFailure::NotConverged(Unreached::OutOfReach);
            let lands = (place.window + amplitude as usize) % 4 == 1 || place.method == LandingMethod::SteppedForcing;
            return if lands { Brought::Landings(1) } else { Brought::Nothing(SeedOutcome::NotLanded(failure)) };
        }
        Task::Start(_) => {
            assert!(known.is_empty() && curves.is_empty(), "a start does not depend on what is known");
            return Brought::Landings(5);
        }
        // The first batch leads to a branch, and again to another one.
        Task::Begin(place) => {
            assert!(granted.landing.is_some(), "what began knows from where");
            let is_new = place.landing() == StartPlace::random(0) && place.round < amplitude as usize;
            return if is_new { Brought::branch(BranchKind::Cut) } else { main };
        }
        Task::Seed(place) => {
            assert!(granted.landing.is_some(), "a seed knows what it landed on");
            place
        }
    };
    // Either phase of a window leads to the same one.
    let seed = |phase: usize| TaskId::of_level(&granted.amplitude.text, 2 + 8 * place.window + 1 + 2 * phase).unwrap();
    let isola = match known.iter().find(|known| [seed(0), seed(1)].contains(&known.task)) {
        Some(isola) => Brought::Nothing(SeedOutcome::Found(isola.branch)),
        None => Brought::Branch { kind: BranchKind::Isola, folds: 1, branch_points: 0 },
    };
    match ((place.window + amplitude as usize) % 4, place.method, place.phase) {
        (0, _, _) => main,
        (1, LandingMethod::FullForcing, _) => isola,
        (2, LandingMethod::SteppedForcing, Phase::Second) => Brought::branch(BranchKind::Cut),
        _ => Brought::Nothing(SeedOutcome::NotLanded(LandingFailure::Far(0.5))),
    }
}

/// Number of levels, and what becomes of all tasks of all levels.
type Book = Vec<(TaskId, TaskState)>;

fn book(ledger: &Ledger) -> Book {
    let mut book: Book = ledger.entries().map(|entry| (entry.id.clone(), entry.state.clone())).collect();
    // Branches are found, and verified, in any order.
    let verifications = ledger.chains[ledger.verifications()].entries.len();
    let others = book.len() - verifications;
    book[others..].sort_by(|a, b| a.0.cmp(&b.0));
    book
}
/// Levels of three windows and two batches of starts each, and one of homotopies that need not be; three scouts of the largest one.
fn plans(levels: usize) -> Vec<LevelPlan> {
    let starts = (0..2).map(StartPlace::random).chain([StartPlace::homotopy(0)]);
    let starts: Vec<Task> = starts.flat_map(Task::from_starts).collect();
    let mut plans: Vec<LevelPlan> = (1..=levels).map(|level| plan(level as f64, 3)).collect();
    plans.iter_mut().for_each(|plan| plan.tasks.extend(&starts));
    let scouts = (0..3).map(|number| Task::Scout(ScoutPlace { number, batches: 1 }));
    plans.last_mut().expect("there is a level").tasks.extend(scouts);
    plans
}

fn rules(verify: VerifyEffort) -> Rules {
    Rules { max_failures: 1000, max_lapses: 1000, most_folds: 20, verify, repeated: 1e9, ..Rules::default() }
}

/// One worker, no trouble.
fn quiet(levels: usize, verify: VerifyEffort) -> Book {
    let mut ledger = Ledger::new(rules(verify), plans(levels));
    let worker = WorkerId::new("w").unwrap();
    while let (Leased::Grant(granted), _) = ledger.lease(&worker, 0, Duration::ZERO) {
        let lease = Lease { task: granted.task.clone(), attempt: granted.attempt, worker: worker.clone(), slot: 0 };
        assert!(matches!(ledger.submit(&lease, &find(&granted)).0, Submitted::Accepted(_)));
    }
    assert!(ledger.is_finished());
    book(&ledger)
}

#[derive(Debug, Clone)]
enum Event {
    Lease(u8),
    Submit(usize),
    Fail(usize),
    Release(usize),
    Renew(usize),
    Gone(u8),
    Forget(usize),
    Later(u64),
    Restart,
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        4 => (0u8..4).prop_map(Event::Lease),
        4 => any::<usize>().prop_map(Event::Submit),
        1 => any::<usize>().prop_map(Event::Fail),
        1 => any::<usize>().prop_map(Event::Release),
        1 => any::<usize>().prop_map(Event::Renew),
        1 => (0u8..4).prop_map(Event::Gone),
        1 => any::<usize>().prop_map(Event::Forget),
        2 => (0u64..20).prop_map(Event::Later),
        1 => Just(Event::Restart),
    ]
}

/// Verifications alone, and with motions that are marched on.
fn effort() -> impl Strategy<Value = VerifyEffort> {
    prop_oneof![Just(VerifyEffort::Standard), Just(VerifyEffort::All)]
}

fn name(worker: u8) -> WorkerId {
    WorkerId::new(&format!("w{worker}")).unwrap()
}

proptest! {
    #[test]
    fn any_interleaving_gives_the_same_result(
        levels in 1usize..4,
        verify in effort(),
        events in prop::collection::vec(event(), 0..200),
    ) {
        let mut driver = Driver::new(levels, verify);
        for event in &events {
            driver.apply(event);
        }
        driver.conclude();
        prop_assert_eq!(book(&driver.ledger), quiet(levels, verify));
        let done = driver.changes.iter().filter(|record| matches!(record, Change::Done { .. })).count();
        prop_assert_eq!(done, driver.accepted.len());
        prop_assert_eq!(driver.ledger.sequence() as usize, done);
    }

    #[test]
    fn one_task_of_a_chain_at_a_time_beside_landings(events in prop::collection::vec(event(), 0..200)) {
        let mut driver = Driver::new(2, VerifyEffort::Standard);
        for event in &events {
            driver.apply(event);
            for (c, chain) in driver.ledger.chains.iter().enumerate() {
                let held = chain.entries.iter().filter(|entry| entry.holder().is_some());
                let ordered = held.filter(|entry| entry.task.is_ordered()).count();
                prop_assert!(ordered <= 1, "{ordered} tasks of chain {c} at a time");
            }
        }
    }
}
