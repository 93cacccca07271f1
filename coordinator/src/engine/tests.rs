//! Every event has its decision.

mod checkpoints;
mod deciding;
mod next;
mod parking;
mod repeats;

use super::{Answer, Beginning, CheckedResult, Decision, Engine, Event, News, Stored};
use crate::ledger::{Granted, Rules};
use crate::run::preparation::manifest;
use protocol::codec::encode;
use protocol::control::{ControlReply, ControlRequest};
use protocol::digest::{Digest, HashedBranch};
use protocol::from_worker::{FailRequest, Lease, LeaseRequest, ReleaseRequest, RenewRequest};
use protocol::ids::{Attempt, TaskId, WorkerId};
use protocol::to_everyone::{Manifest, Stage};
use protocol::to_worker::{Acknowledgement, RenewReply, SubmitReply};
use results::fixture::Study;
use results::journal::{AttemptEnd, Change, Evidence, Holder, SweepPlan, TaskState, Troubles};
use results::store::Extent;
use solver::curve::problem::Failure;
use solver::response::branch::BranchKind;
use solver::response::task::{BranchId, Brought, SeedOutcome};
use std::sync::{Arc, LazyLock};
use std::time::Duration;

/// One level of a main branch and seeds.
static RUN: LazyLock<(Manifest, Arc<SweepPlan>)> = LazyLock::new(|| {
    let study = Study::new("duffing", 1, &["0.01"]);
    let manifest = manifest(&study.header(), Stage::Backbone, Rules::default().lease);
    (manifest, Arc::new(study.plan()))
});

const EXTENT: [f64; 4] = [1.0, 2.0, 0.5, 1.5];

fn at(seconds: u64) -> Duration {
    Duration::from_secs(seconds)
}

fn waiting() -> Engine {
    Engine::new(RUN.0.clone(), Rules { repeated: 0.0, ..Rules::default() })
}

fn begin(stored: Option<Stored>) -> Event {
    Event::Begin(Box::new(Beginning { plan: RUN.1.clone(), stored }))
}

/// An engine whose sweep has begun.
fn sweeping() -> Engine {
    let mut engine = waiting();
    engine.handle(begin(None), at(0));
    engine
}

fn worker(name: &str) -> WorkerId {
    WorkerId::new(name).unwrap()
}

fn ask(engine: &mut Engine, name: &str, now: Duration) -> Decision {
    ask_for(engine, name, 0, now)
}

fn ask_for(engine: &mut Engine, name: &str, slot: u32, now: Duration) -> Decision {
    let request = LeaseRequest { protocol: protocol::VERSION, program: "0".into(), worker: worker(name), slot };
    engine.handle(Event::Lease(request), now)
}

fn grant(engine: &mut Engine, name: &str, now: Duration) -> (Granted, Lease) {
    let Some(Answer::Grant(granted)) = ask(engine, name, now).answer else { panic!("no task") };
    let lease = Lease { task: granted.task.clone(), attempt: granted.attempt, worker: worker(name), slot: 0 };
    (granted, lease)
}

/// Hands out the main branch, and lands every seed that can be.
fn grant_landed(engine: &mut Engine, now: Duration) -> Lease {
    let (_, main) = grant(engine, "a", now);
    while let Some(Answer::Grant(granted)) = ask(engine, "b", now).answer {
        let lease = Lease { task: granted.task, attempt: granted.attempt, worker: worker("b"), slot: 0 };
        engine.handle(submit(&lease, None, Brought::Landings(1)), now);
    }
    main
}

/// A branch in numbers without its points, or nothing.
fn result(lease: &Lease, found: Result<[f64; 4], SeedOutcome>) -> Event {
    match found {
        Ok(extent) => submit(lease, Some(Extent::from(extent)), Brought::branch(BranchKind::Main)),
        Err(outcome) => submit(lease, None, Brought::Nothing(outcome)),
    }
}

fn submit(lease: &Lease, extent: Option<Extent>, brought: Brought) -> Event {
    Event::Submit(Box::new(CheckedResult {
        lease: lease.clone(),
        program: "0".into(),
        seconds: 1.0,
        next: false,
        branch: HashedBranch::new(None),
        found: None,
        extent,
        brought,
    }))
}

fn submitted(reply: SubmitReply) -> Option<Answer> {
    Some(Answer::Submit(reply))
}

fn order(engine: &mut Engine, request: ControlRequest) -> (Decision, String) {
    let decision = engine.handle(Event::Control(request), at(1));
    let Some(Answer::Control(ControlReply { message })) = &decision.answer else { panic!("no answer") };
    let message = message.clone();
    (decision, message)
}

fn stages(decision: &Decision) -> Vec<Stage> {
    let stage = |change: &Change| match change {
        Change::Stage(stage) => Some(*stage),
        _ => None,
    };
    decision.changes.iter().filter_map(stage).collect()
}

/// Stages that are told.
fn told(decision: &Decision) -> Vec<Stage> {
    let stage = |news: &News| match news {
        News::Manifest(manifest) => Some(manifest.stage),
        _ => None,
    };
    decision.news.iter().filter_map(stage).collect()
}

#[test]
fn before_the_sweep_there_is_nothing_to_hand_out() {
    let mut engine = waiting();
    let answer = Some(Answer::Wait(Duration::from_secs(1)));
    assert_eq!(ask(&mut engine, "a", at(0)), Decision { answer, ..Decision::default() });
    // Whoever survived an earlier coordinator asks again.
    let lease = Lease { task: TaskId::new("0.01-0").unwrap(), attempt: Attempt(1), worker: worker("a"), slot: 0 };
    let renewal = RenewRequest { lease: lease.clone(), progress: None };
    for event in [
        Event::Renew(renewal),
        result(&lease, Ok(EXTENT)),
        Event::Fail(FailRequest { lease: lease.clone(), reason: "x".into() }),
        Event::Release(ReleaseRequest { lease }),
        Event::WorkerGone(worker("a")),
    ] {
        assert_eq!(engine.handle(event, at(0)), Decision::default());
    }
    assert!(order(&mut engine, ControlRequest::RetryDead).1.contains("has not begun"));
}

#[test]
fn a_worker_of_another_version_is_sent_away() {
    let request = LeaseRequest { protocol: 99, program: "9.9".into(), worker: worker("a"), slot: 0 };
    let decision = sweeping().handle(Event::Lease(request), at(0));
    let Some(Answer::Stop(reason)) = decision.answer else { panic!("not sent away") };
    assert!(reason.contains("version 99") && reason.contains("9.9"), "{reason}");
    assert!(decision.changes.is_empty());
}

#[test]
fn a_sweep_begins_with_its_plan_on_disk_and_goes_on_without() {
    let mut engine = waiting();
    let decision = engine.handle(begin(None), at(1));
    assert_eq!(decision.changes, [Change::Planned(RUN.1.clone()), Change::Stage(Stage::Sweep)]);
    let [News::Manifest(manifest), News::Status(status)] = &decision.news[..] else { panic!("not told") };
    assert_eq!((manifest.stage, manifest.reach), (Stage::Sweep, Some(RUN.1.reach)));
    assert_eq!((status.stage, status.elapsed), (Stage::Sweep, 1.0));
    let decision = waiting().handle(begin(Some(Stored::default())), at(1));
    assert_eq!(decision.changes, [Change::Stage(Stage::Sweep)]);
}

#[test]
fn a_task_is_granted_once_on_disk_first() {
    let mut engine = sweeping();
    let decision = ask(&mut engine, "a", at(1));
    let Some(Answer::Grant(granted)) = &decision.answer else { panic!("no task") };
    assert_eq!((granted.task.as_str(), granted.attempt), ("0.01-0", Attempt(1)));
    assert!(matches!(&decision.changes[..], [Change::Granted { .. }]));
    let again = ask(&mut engine, "a", at(2));
    assert_eq!((again.answer, again.changes), (decision.answer, Vec::new()));
}

#[test]
fn a_sign_of_life_changes_nothing_on_disk() {
    let mut engine = sweeping();
    let (_, lease) = grant(&mut engine, "a", at(0));
    let renew = |lease: &Lease| Event::Renew(RenewRequest { lease: lease.clone(), progress: None });
    let decision = engine.handle(renew(&lease), at(10));
    assert_eq!(decision, Decision { answer: Some(Answer::Renew(RenewReply::Ok)), ..Decision::default() });
    // Renewed for another 15 s.
    assert!(engine.handle(Event::Tick, at(20)).changes.is_empty());
    let expired = engine.handle(Event::Tick, at(25)).changes;
    assert!(matches!(&expired[..], [Change::Ended { end: AttemptEnd::Expired, .. }]), "{expired:?}");
    let adopted = engine.handle(renew(&lease), at(26));
    assert_eq!(adopted.answer, Some(Answer::Renew(RenewReply::Ok)));
    assert!(matches!(&adopted.changes[..], [Change::Adopted { .. }]), "{adopted:?}");
    // What this side missed is held against nobody.
    engine.handle(Event::Stalled, at(40));
    assert!(engine.handle(Event::Tick, at(51)).changes.is_empty());
    assert_eq!(engine.handle(Event::Tick, at(52)).changes.len(), 1);
}

#[test]
fn a_first_result_is_stored_and_announced_with_its_digest() {
    let mut engine = sweeping();
    let (granted, lease) = grant(&mut engine, "a", at(0));
    let decision = engine.handle(result(&lease, Ok(EXTENT)), at(1));
    assert_eq!(decision.answer, submitted(SubmitReply::Accepted));
    let [Change::Result(accepted), Change::Done { outcome, sequence, .. }] = &decision.changes[..] else {
        panic!("{:?}", decision.changes)
    };
    assert_eq!((*outcome, *sequence), (SeedOutcome::Found(BranchId::MAIN), 1));
    assert_eq!((&accepted.result.task, accepted.result.name), (&granted.task, Some(BranchId::MAIN)));
    assert_eq!(accepted.digest, Digest::of(&accepted.result));
    let [News::Result(task, bytes), News::Done(done)] = &decision.news[..] else { panic!("{:?}", decision.news) };
    assert_eq!((task, bytes), (&granted.task, &encode(&*accepted.result)));
    assert_eq!((done.sequence, &done.task, done.branch), (1, &granted.task, Some(BranchId::MAIN)));
    assert_eq!((done.size, &done.sha256), (accepted.digest.size, &accepted.digest.sha256));
}

#[test]
fn a_second_result_is_compared_with_the_first_also_after_a_restart() {
    let mut engine = sweeping();
    let (granted, lease) = grant(&mut engine, "a", at(0));
    engine.handle(result(&lease, Ok(EXTENT)), at(1));
    let done = results::journal::StoredTask {
        id: granted.task.clone(),
        state: TaskState::Done(SeedOutcome::Found(BranchId::MAIN)),
        brought: Some(Brought::branch(BranchKind::Main)),
        holders: vec![Holder { worker: worker("a"), slot: 0 }],
        troubles: Troubles::default(),
        evidence: Evidence::default(),
    };
    let extents = [(granted.task, Extent::from(EXTENT))].into();
    let mut restarted = waiting();
    restarted.handle(begin(Some(Stored { tasks: vec![done], extents, ..Stored::default() })), at(0));
    for engine in [&mut engine, &mut restarted] {
        for (found, agrees) in [
            (Ok(EXTENT), true),
            (Ok(EXTENT.map(|value| value * (1.0 + 1e-7))), true),
            (Ok(EXTENT.map(|value| value * (1.0 + 1e-5))), false),
            (Err(SeedOutcome::OutOfBounds), false),
        ] {
            let decision = engine.handle(result(&lease, found), at(2));
            let answer = submitted(SubmitReply::Duplicate { agrees });
            assert_eq!(decision, Decision { answer, ..Decision::default() });
        }
    }
}

#[test]
fn results_of_no_task_and_of_one_that_was_given_up_are_refused() {
    let mut engine = sweeping();
    let refusal = |decision: Decision| match decision {
        Decision { changes, answer: Some(Answer::Submit(SubmitReply::Rejected { why })), news } => {
            assert!(changes.is_empty() && news.is_empty());
            why
        }
        other => panic!("{other:?}"),
    };
    let main = grant_landed(&mut engine, at(0));
    let nowhere = Lease { task: TaskId::new("7-0").unwrap(), ..main.clone() };
    assert!(refusal(engine.handle(result(&nowhere, Ok(EXTENT)), at(1))).ends_with("has no task 7-0"));
    engine.handle(result(&main, Ok(EXTENT)), at(1));
    let late = poison(&mut engine, 100);
    let next = grant(&mut engine, "a", at(200)).1;
    assert_ne!(next.task, late.task);
    assert!(refusal(engine.handle(result(&late, Ok(EXTENT)), at(201))).contains("was given up"));
}

/// Fails the next task until it is given up; its last lease.
fn poison(engine: &mut Engine, from: u64) -> Lease {
    let mut last = None;
    for attempt in 0..u64::from(Rules::default().max_failures) {
        let now = at(from + 10 * attempt);
        let (_, lease) = grant(engine, "a", now);
        let decision = engine.handle(Event::Fail(FailRequest { lease: lease.clone(), reason: "boom".into() }), now);
        assert_eq!(decision.answer, Some(Answer::Acknowledge(Acknowledgement::Ok)));
        last = Some(lease);
    }
    last.unwrap()
}

#[test]
fn dead_tasks_are_tried_again_and_the_run_goes_on() {
    let mut engine = sweeping();
    grant_landed(&mut engine, at(0));
    // Main branches from below and from above.
    let lease = poison(&mut engine, 0);
    poison(&mut engine, 50);
    assert_eq!(ask(&mut engine, "a", at(90)).answer, Some(Answer::Drained));
    let again = Event::Fail(FailRequest { lease, reason: "boom".into() });
    assert_eq!(engine.handle(again, at(90)).answer, Some(Answer::Acknowledge(Acknowledgement::Lost)));
    assert!(order(&mut engine, ControlRequest::Cancel).1.contains("has finished already"));
    let (decision, message) = order(&mut engine, ControlRequest::RetryDead);
    assert!(message.starts_with("2 dead tasks"), "{message}");
    assert!(matches!(
        &decision.changes[..],
        [Change::Revived { .. }, Change::Revived { .. }, Change::Stage(Stage::Sweep)]
    ));
    assert_eq!(told(&decision), [Stage::Sweep]);
    assert_eq!(grant(&mut engine, "a", at(91)).1.attempt, Attempt(4));
    assert!(order(&mut engine, ControlRequest::RetryDead).1.ends_with("there is nothing to try again"));
}

#[test]
fn the_last_result_finishes_the_run() {
    let mut engine = sweeping();
    let failed = || Err(SeedOutcome::NotTraced(Failure::Diverged.into()));
    let below = grant_landed(&mut engine, at(0));
    assert_eq!(stages(&engine.handle(result(&below, failed()), at(0))), []);
    let (_, above) = grant(&mut engine, "a", at(0));
    ask(&mut engine, "b", at(0));
    // Without a main branch there is nothing that seeds could be compared with.
    let decision = engine.handle(result(&above, failed()), at(1));
    assert_eq!(decision.answer, submitted(SubmitReply::Accepted));
    assert!(matches!(&decision.changes[..], [Change::Result(_), Change::Done { .. }, Change::Skipped { .. }, ..]));
    assert_eq!((stages(&decision), told(&decision)), (vec![Stage::Finished], vec![Stage::Finished]));
    // Whoever landed seeds waits, and is told.
    assert!(matches!(
        &decision.news[..],
        [News::Result(..), News::Done(_), News::Manifest(_), News::Status(_), News::Hint]
    ));
    assert_eq!(ask(&mut engine, "a", at(2)).answer, Some(Answer::Drained));
}

#[test]
fn cancelling_is_told_to_everybody_and_stays() {
    let mut engine = sweeping();
    let (_, lease) = grant(&mut engine, "a", at(0));
    let (decision, message) = order(&mut engine, ControlRequest::Cancel);
    assert!(message.ends_with("is cancelled; what is stored stays"), "{message}");
    assert_eq!(decision.changes, [Change::Stage(Stage::Cancelled)]);
    assert!(matches!(&decision.news[..], [News::Manifest(_), News::Status(_), News::Hint]));
    let renewal = Event::Renew(RenewRequest { lease: lease.clone(), progress: None });
    assert_eq!(engine.handle(renewal, at(2)).answer, Some(Answer::Renew(RenewReply::Cancel)));
    let stop = || Some(Answer::Stop("the run was cancelled".into()));
    assert_eq!(ask(&mut engine, "a", at(2)).answer, stop());
    let released = engine.handle(Event::Release(ReleaseRequest { lease: lease.clone() }), at(2));
    assert!(matches!(&released.changes[..], [Change::Ended { end: AttemptEnd::Released, .. }]));
    // What is computed counts.
    assert_eq!(engine.handle(result(&lease, Ok(EXTENT)), at(3)).answer, submitted(SubmitReply::Accepted));
    assert!(order(&mut engine, ControlRequest::RetryDead).1.contains("isola resume"));

    let mut early = waiting();
    order(&mut early, ControlRequest::Cancel);
    assert_eq!(early.handle(begin(None), at(2)), Decision::default());
    assert_eq!(ask(&mut early, "a", at(2)).answer, stop());
}

#[test]
fn a_process_that_ends_hands_out_nothing_and_blames_nobody() {
    let mut engine = sweeping();
    let (_, lease) = grant(&mut engine, "a", at(0));
    engine.handle(Event::Stop, at(1));
    assert!(matches!(ask(&mut engine, "b", at(1)).answer, Some(Answer::Wait(_))));
    assert!(engine.handle(Event::Tick, at(100)).changes.is_empty());
    assert_eq!(engine.handle(result(&lease, Ok(EXTENT)), at(101)).answer, submitted(SubmitReply::Accepted));
}

#[test]
fn the_status_is_told_twice_a_second() {
    let mut engine = sweeping();
    let mut reports = |ms: u64| {
        let news = engine.handle(Event::Tick, Duration::from_millis(ms)).news;
        let count = |is: fn(&News) -> bool| news.iter().filter(|news| is(news)).count();
        let (statuses, loads) = (count(|n| matches!(n, News::Status(_))), count(|n| matches!(n, News::Load(_))));
        assert_eq!(statuses, loads);
        statuses
    };
    assert_eq!([0, 100, 499, 500, 900, 1000].map(&mut reports), [1, 0, 0, 1, 0, 1]);
}
