//! Silence, restarts, failures.

use crate::fake::{Answer, Asked, Fake, drained, fine, grant, hand_out, own_endpoint};
use crate::study::Study;
use protocol::curve::Seeds;
use protocol::ids::TaskId;
use protocol::to_everyone::StoredResult;
use protocol::to_worker::{Grant, Known, SubmitReply};
use solver::response::branch::Side;
use solver::response::task::{BranchId, SeedOutcome, Task, plan};
use std::sync::Arc;
use std::time::{Duration, Instant};
use worker::Ending;
use worker::shutdown::Shutdown;

/// The first landing of the level.
fn first_landing(study: &Study) -> Task {
    let (_, tasks) = plan(&study.backbone, 0.008, &study.settings.frequency, 0);
    tasks.into_iter().find(|task| matches!(task, Task::Land(_))).unwrap()
}

/// Reasons of the failures when a worker is given this.
async fn reasons(study: &Study, grant: Grant) -> Vec<String> {
    let fake = Fake::start(study, hand_out(vec![grant])).await;
    let summary = fake.work(&[]).await.unwrap();
    assert_eq!((summary.ending, summary.done), (Ending::Drained, 0), "the worker lives on");
    assert_eq!(fake.seen.count(Asked::is_submit), 0);
    fake.seen.reasons()
}

fn assert_one(reasons: &[String], parts: &[&str]) {
    let [reason] = reasons else { panic!("{reasons:?}") };
    for part in parts {
        assert!(reason.contains(part), "{part:?} is not in: {reason}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn silence_is_outlasted() {
    let study = Study::new(1);
    let mut grants = vec![study.main()].into_iter();
    let (mut leases, mut submits) = (0, 0);
    let answer = move |asked: &Asked| match asked {
        Asked::Lease(_) => {
            leases += 1;
            if leases <= 2 { Answer::Silence } else { grants.next().map_or_else(drained, grant) }
        }
        Asked::Submit(_) => {
            submits += 1;
            if submits <= 2 { Answer::Silence } else { fine(asked) }
        }
        _ => fine(asked),
    };
    let fake = Fake::start(&study, answer).await;
    assert_eq!(fake.work(&[]).await.unwrap().done, 1);
    let submitted = fake.seen.submitted();
    assert_eq!(submitted.len(), 3);
    assert!(submitted.windows(2).all(|pair| pair[0] == pair[1]), "computed once, sent three times");
}

/// The coordinator goes away while a branch is computed, and comes back at the same place: the branch goes on.
#[tokio::test(flavor = "multi_thread")]
async fn a_restart_of_the_coordinator() {
    let (study, endpoint) = (Study::endless(), own_endpoint());
    let first = Fake::start_at(&endpoint, Arc::default(), &study, hand_out(vec![study.main()])).await;
    let (options, shutdown) = (first.options(&["--grace", "0"]), Shutdown::default());
    let worker = {
        let shutdown = shutdown.clone();
        tokio::spawn(async move { worker::work(&options, &shutdown).await })
    };
    first.seen.wait_for(Asked::is_renew, 1).await;
    first.session.close().await.unwrap();
    let second = Fake::start_at(&endpoint, Arc::default(), &study, hand_out(Vec::new())).await;
    second.seen.wait_for(Asked::is_renew, 2).await;
    assert_eq!(second.seen.count(Asked::is_lease), 0);
    shutdown.begin(Duration::ZERO);
    assert_eq!(worker.await.unwrap().unwrap().ending, Ending::Told);
    assert_eq!(second.seen.count(Asked::is_release), 1);
}

#[tokio::test(flavor = "multi_thread")]
async fn patience_ends() {
    let study = Study::endless();
    let mut grants = vec![study.main()].into_iter();
    let answer = move |asked: &Asked| match asked {
        Asked::Lease(_) => grants.next().map_or(Answer::Silence, grant),
        _ => Answer::Silence,
    };
    let fake = Fake::start(&study, answer).await;
    let started = Instant::now();
    let error = fake.work(&["--patience", "2"]).await.unwrap_err();
    assert!(started.elapsed() >= Duration::from_secs(2));
    assert_eq!(error.exit_code(), 1);
    let message = error.to_string();
    assert!(message.contains(&fake.endpoint) && message.contains("for 2 s") && message.contains("`one`"), "{message}");
}

#[tokio::test(flavor = "multi_thread")]
async fn seeds_of_another_truncation() {
    let (study, other) = (Study::new(3), Study::new(2));
    let seeds = other.grant(1, first_landing(&other), Vec::new()).seeds;
    let grant = Grant { seeds, ..study.grant(1, first_landing(&study), Vec::new()) };
    assert_one(&reasons(&study, grant).await, &["2 harmonics in a run of 3"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn seeds_that_are_missing() {
    let study = Study::new(1);
    let grant = Grant { seeds: Seeds::new(&[]), ..study.grant(1, first_landing(&study), Vec::new()) };
    assert_one(&reasons(&study, grant).await, &["unusable seeds"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn seeds_of_another_model() {
    let study = Study::new(1);
    let mut grant = study.grant(1, first_landing(&study), Vec::new());
    grant.seeds.motions.modal.shape[1] = 2;
    assert_one(&reasons(&study, grant).await, &["unusable seeds", "`modal`"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_known_branch_that_is_not_stored() {
    let study = Study::new(1);
    let known = Known { branch: BranchId::MAIN, task: TaskId::new("0.008-0").unwrap() };
    let reasons = reasons(&study, study.grant(1, first_landing(&study), vec![known])).await;
    assert_one(&reasons, &["does not hand out", "0.008-0"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_known_branch_of_another_truncation() {
    let (study, other) = (Study::new(3), Study::new(2));
    let fake = Fake::start(&other, hand_out(vec![other.main()])).await;
    fake.work(&[]).await.unwrap();
    let main = fake.seen.submitted().remove(0);
    let protocol::branch::TaskResultMessage::Branch(branch) = main.finding else { panic!("no branch") };

    let known = Known { branch: BranchId::MAIN, task: main.lease.task.clone() };
    let grants = vec![study.grant(1, first_landing(&study), vec![known]), study.main()];
    let fake = Fake::start(&study, hand_out(grants)).await;
    let stored = StoredResult {
        task: main.lease.task.clone(),
        attempt: main.lease.attempt,
        amplitude: study.manifest().amplitudes[0].clone(),
        work: Task::Main(Side::Below),
        outcome: SeedOutcome::Found(BranchId::MAIN),
        name: Some(BranchId::MAIN),
        branch: Some(branch),
        curve: None,
        landings: None,
        verification: None,
        disturbance: None,
        settling: None,
        worker: main.lease.worker.clone(),
        program: main.program,
        seconds: main.seconds,
    };
    fake.seen.results.lock().unwrap().insert(stored.task.clone(), stored);
    assert_eq!(fake.work(&[]).await.unwrap().done, 1, "the thread lives on");
    assert_one(&fake.seen.reasons(), &["0.008-0", "2 harmonics in a run of 3"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_result_that_is_too_large() {
    let study = Study::new(1);
    let fake = Fake::start(&study, hand_out(vec![study.main()])).await;
    fake.change(|manifest| manifest.max_result_bytes = 1000);
    assert_eq!(fake.work(&[]).await.unwrap().done, 0);
    assert_eq!(fake.seen.count(Asked::is_submit), 0);
    assert_one(&fake.seen.reasons(), &["the result has", "bytes, this run accepts 1000"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_result_that_is_rejected() {
    let study = Study::new(1);
    for answer in
        [|| Answer::Submit(SubmitReply::Rejected { why: "no such task".into() }), || Answer::Refuse("no such task")]
    {
        let mut hand_out = hand_out(vec![study.main()]);
        let fake = Fake::start(&study, move |asked| if asked.is_submit() { answer() } else { hand_out(asked) }).await;
        assert_eq!(fake.work(&[]).await.unwrap().done, 0);
        assert_one(&fake.seen.reasons(), &["rejected", "no such task"]);
    }
}

/// Everything is answered but the result (a size limit on the way, say): the task fails with a reason, the worker lives on.
#[tokio::test(flavor = "multi_thread")]
async fn a_result_that_does_not_get_through() {
    let study = Study::new(1);
    let mut hand_out = hand_out(vec![study.main()]);
    let answer = move |asked: &Asked| if asked.is_submit() { Answer::Silence } else { hand_out(asked) };
    let fake = Fake::start(&study, answer).await;
    assert_eq!(fake.work(&["--patience", "5"]).await.unwrap().done, 0);
    assert!(fake.seen.count(Asked::is_submit) > 2);
    assert!(fake.seen.count(Asked::is_renew) > 0, "the lease is kept meanwhile");
    assert_one(&fake.seen.reasons(), &["bytes was not answered for 5 s"]);
}
