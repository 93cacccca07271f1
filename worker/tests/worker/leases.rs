//! Leases that are renewed, lost, cancelled, given twice.

use crate::fake::{Answer, Asked, Fake, drained, fine, grant, hand_out, wait};
use crate::study::{LONG_LEASE, Study};
use protocol::branch::TaskResultMessage;
use protocol::from_worker::{Progress, thread_of};
use protocol::ids::{Attempt, TaskId};
use protocol::to_everyone::Stage;
use protocol::to_worker::{Grant, RenewReply, SubmitReply};
use std::time::{Duration, Instant};
use worker::shutdown::Shutdown;
use worker::{Ending, Summary};

/// An endless branch, and then nothing; renewals are answered by `verdict`.
async fn endless(study: &Study, grant: Grant, verdict: RenewReply) -> Fake {
    let mut grants = vec![grant].into_iter();
    let answer = move |asked: &Asked| match asked {
        Asked::Lease(_) => grants.next().map_or_else(drained, self::grant),
        Asked::Renew(_) => Answer::Renew(verdict),
        _ => fine(asked),
    };
    Fake::start(study, answer).await
}

/// Runs a worker on an endless branch with a lease that needs no sign of life for long; once it is under way, the
/// coordinator hints that there is something to ask.
async fn hinted(fake: &Fake) -> Summary {
    let task = TaskId::of_level("0.008", 0).unwrap();
    let under_way = fake.session.declare_subscriber(fake.keys.progress(&task)).await.unwrap();
    let options = fake.options(&[]);
    let worker = tokio::spawn(async move { worker::work(&options, &Shutdown::default()).await });
    under_way.recv_async().await.unwrap();
    assert_eq!(fake.seen.count(Asked::is_renew), 0);
    let started = Instant::now();
    fake.hint().await;
    let summary = worker.await.unwrap().unwrap();
    assert!(started.elapsed() < LONG_LEASE / 3, "it did not hear the hint");
    summary
}

#[tokio::test(flavor = "multi_thread")]
async fn a_lost_lease_stops_its_branch() {
    let study = Study::endless();
    let fake = endless(&study, study.long_main(), RenewReply::Lost).await;
    let summary = hinted(&fake).await;
    assert_eq!((summary.ending, summary.done), (Ending::Drained, 0));
    assert_eq!(fake.seen.count(Asked::is_release), 0);
    assert_eq!(fake.seen.count(Asked::is_submit), 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn cancelling_gives_the_branch_back() {
    let study = Study::endless();
    let fake = endless(&study, study.long_main(), RenewReply::Cancel).await;
    fake.change(|manifest| manifest.stage = Stage::Cancelled);
    let summary = hinted(&fake).await;
    assert_eq!((summary.ending, summary.done), (Ending::Cancelled, 0));
    assert_eq!(fake.seen.count(Asked::is_release), 1);
    // Nothing is asked of a coordinator that may be gone already.
    assert_eq!(fake.seen.count(Asked::is_lease), 1);
}

/// Without a hint it is heard by renewals, three times a lease.
#[tokio::test(flavor = "multi_thread")]
async fn a_lost_lease_is_noticed_by_itself() {
    let study = Study::endless();
    let fake = endless(&study, study.main(), RenewReply::Lost).await;
    assert_eq!(fake.work(&[]).await.unwrap().ending, Ending::Drained);
    assert_eq!(fake.seen.count(Asked::is_renew), 1);
}

/// A coordinator that stops, and may come back: the worker asks again.
#[tokio::test(flavor = "multi_thread")]
async fn a_coordinator_that_stops_is_waited_for() {
    let study = Study::endless();
    let fake = endless(&study, study.main(), RenewReply::Cancel).await;
    assert_eq!(fake.work(&[]).await.unwrap().ending, Ending::Drained);
    assert_eq!(fake.seen.count(Asked::is_release), 1);
    assert_eq!(fake.seen.count(Asked::is_lease), 2);
}

#[tokio::test(flavor = "multi_thread")]
async fn progress_is_shown_and_told() {
    let study = Study::endless();
    let fake = Fake::start(&study, hand_out(vec![study.main()])).await;
    let task = TaskId::of_level("0.008", 0).unwrap();
    let puts = fake.session.declare_subscriber(fake.keys.progress(&task)).await.unwrap();
    let (options, shutdown) = (fake.options(&[]), Shutdown::default());
    let told_to_end = shutdown.clone();
    let started = Instant::now();
    let worker = tokio::spawn(async move { worker::work(&options, &shutdown).await });
    let mut points = Vec::new();
    for _ in 0..3 {
        let sample = puts.recv_async().await.unwrap();
        let encoding = sample.encoding().to_string();
        let progress: Progress = protocol::codec::decode(&sample.payload().to_bytes(), &encoding).unwrap();
        points.push(progress.points);
    }
    assert!(points.is_sorted_by(|earlier, later| earlier < later), "{points:?}");
    assert!(started.elapsed() > Duration::from_millis(1400), "more often than twice a second: {:?}", started.elapsed());
    let tells = |asked: &Asked| matches!(asked, Asked::Renew(request) if request.progress.is_some());
    fake.seen.wait_for(tells, 1).await;
    told_to_end.begin(Duration::ZERO);
    worker.await.unwrap().unwrap();
}

/// A grant that is given again is computed again: its result may have been lost with the answer.
#[tokio::test(flavor = "multi_thread")]
async fn the_same_grant_twice() {
    let study = Study::new(1);
    let mut grants = vec![study.main(), study.main()].into_iter();
    let mut replies = [SubmitReply::Accepted, SubmitReply::Duplicate { agrees: true }].into_iter();
    let mut under_way = false;
    let answer = move |asked: &Asked| match asked {
        Asked::Lease(_) if under_way => wait(),
        Asked::Lease(_) => {
            under_way = true;
            grants.next().map_or_else(drained, grant)
        }
        Asked::Submit(_) => {
            under_way = false;
            Answer::Submit(replies.next().unwrap())
        }
        _ => fine(asked),
    };
    let fake = Fake::start(&study, answer).await;
    assert_eq!(fake.work(&[]).await.unwrap().done, 2);
    let submitted = fake.seen.submitted();
    let [first, second] = &submitted[..] else { panic!("{} results", submitted.len()) };
    assert_eq!((&first.lease.task, first.lease.attempt), (&second.lease.task, second.lease.attempt));
    assert_eq!(first.finding, second.finding);
    assert!(matches!(first.finding, TaskResultMessage::Branch(_)));
}

/// The first task is asked for, the next ones come with acknowledgements.
#[tokio::test(flavor = "multi_thread")]
async fn the_next_task_comes_with_the_acknowledgement() {
    let study = Study::new(1);
    let again = |attempt| Grant { attempt: Attempt(attempt), ..study.main() };
    let mut grants = vec![study.main()].into_iter();
    let mut next = vec![again(2), again(3)].into_iter();
    let answer = move |asked: &Asked| match asked {
        Asked::Lease(_) => grants.next().map_or_else(drained, grant),
        Asked::Submit(request) if request.next => {
            let next = next.next().map(|grant| SubmitReply::Next(Box::new(grant)));
            Answer::Submit(next.unwrap_or(SubmitReply::Accepted))
        }
        _ => fine(asked),
    };
    let fake = Fake::start(&study, answer).await;
    assert_eq!(fake.work(&[]).await.unwrap().done, 3);
    let attempts: Vec<u32> = fake.seen.submitted().iter().map(|request| request.lease.attempt.0).collect();
    assert_eq!(attempts, [1, 2, 3]);
    assert_eq!(fake.seen.count(Asked::is_lease), 2);
}

/// A worker that was told to end gives back what comes with the last acknowledgement.
#[tokio::test(flavor = "multi_thread")]
async fn a_worker_that_ends_gives_the_next_task_back() {
    let study = Study::new(1);
    let shutdown = Shutdown::default();
    let (told_to_end, runtime) = (shutdown.clone(), tokio::runtime::Handle::current());
    let next = Grant { attempt: Attempt(2), ..study.main() };
    let mut grants = vec![study.main()].into_iter();
    let answer = move |asked: &Asked| match asked {
        Asked::Lease(_) => grants.next().map_or_else(drained, grant),
        Asked::Submit(_) => {
            let _context = runtime.enter();
            told_to_end.begin(Duration::from_secs(100));
            Answer::Submit(SubmitReply::Next(Box::new(next.clone())))
        }
        _ => fine(asked),
    };
    let fake = Fake::start(&study, answer).await;
    worker::work(&fake.options(&[]), &shutdown).await.unwrap();
    assert_eq!((fake.seen.count(Asked::is_submit), fake.seen.count(Asked::is_release)), (1, 1));
}

#[tokio::test(flavor = "multi_thread")]
async fn waits_for_work_and_hears_of_it() {
    let study = Study::new(1);
    let mut grants = vec![study.main()].into_iter();
    let mut waits = 5;
    let answer = move |asked: &Asked| match asked {
        Asked::Lease(_) if waits > 0 => {
            waits -= 1;
            wait()
        }
        Asked::Lease(_) => grants.next().map_or_else(drained, grant),
        _ => fine(asked),
    };
    let fake = Fake::start(&study, answer).await;
    assert_eq!(fake.work(&[]).await.unwrap().done, 1);
    assert_eq!(fake.seen.count(Asked::is_lease), 7);
}

/// Computing threads lease independently, and all of them end.
#[tokio::test(flavor = "multi_thread")]
async fn every_slot_has_its_own_lease() {
    let study = Study::new(1);
    let attempts = (1..=3).map(|attempt| {
        let mut grant = study.main();
        (grant.task, grant.attempt) = (TaskId::new(&format!("0.008-{attempt}")).unwrap(), Attempt(attempt));
        grant
    });
    let fake = Fake::start(&study, hand_out(attempts.collect())).await;
    assert_eq!(fake.work(&["--slots", "2"]).await.unwrap().done, 3);
    for request in fake.seen.submitted() {
        assert!(thread_of(request.lease.slot) < 2);
        assert_eq!(request.lease.task.as_str(), format!("0.008-{}", request.lease.attempt));
    }
}
