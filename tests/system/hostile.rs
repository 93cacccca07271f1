//! Somebody who reaches the port and means harm: nothing of what they say is stored, and the run's files are those of a run that
//! nobody disturbed.

use crate::stand_in::StandIn;
use crate::{BRIEF, DAMPER, LEVELS, LONG};
use protocol::array::Array;
use protocol::branch::{BranchMessage, TaskResultMessage};
use protocol::codec::{encode, encoding};
use protocol::from_worker::{Lease, LeaseRequest, SubmitRequest};
use protocol::ids::{Attempt, TaskId, WorkerId};
use protocol::session::{RequestError, fetch, request, request_encoded};
use protocol::to_everyone::Status;
use protocol::to_worker::{LeaseReply, RenewReply, SubmitReply};
use rustix::process::Signal;
use solver::response::task::Task;
use solver::stability::verification::MarchedOrbit;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};
use tests::{PATIENCE, System, block_on};

/// One level.
const ONE: &[&str] = &["--amplitudes", "0.007"];

/// The files of a run that say what was found.
pub fn files(directory: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for folder in [directory.to_path_buf(), directory.join("branches")] {
        for entry in std::fs::read_dir(folder).unwrap().flatten() {
            let path = entry.path();
            if path.extension().is_some_and(|extension| extension == "csv") {
                let name = path.strip_prefix(directory).unwrap().display().to_string();
                found.insert(name, std::fs::read(path).unwrap());
            }
        }
    }
    found
}

/// Why a result was refused.
fn refusal(reply: SubmitReply) -> String {
    match reply {
        SubmitReply::Rejected { why } => why,
        other => panic!("{other:?}"),
    }
}

fn with_branch(genuine: &SubmitRequest, change: impl FnOnce(&mut BranchMessage)) -> SubmitRequest {
    let mut request = genuine.clone();
    let TaskResultMessage::Branch(branch) = &mut request.finding else { panic!("a main branch") };
    change(branch);
    request
}

/// An array with one of its numbers changed.
fn changed(array: &mut Array, index: usize, change: impl Fn(f64) -> f64) {
    let (numbers, _) = array.data.as_chunks_mut::<8>();
    numbers[index] = change(f64::from_le_bytes(numbers[index])).to_le_bytes();
}

#[test]
fn what_is_not_true_is_not_stored() {
    let mut undisturbed = System::sweep_with(DAMPER, &[LEVELS, BRIEF, &["--workers", "1"]].concat());
    undisturbed.expect_complete();

    let mut system = System::sweep(DAMPER, &[LEVELS, BRIEF, LONG].concat());
    block_on(async {
        let honest = StandIn::of(&system).await;
        let grant = honest.grant_of("0.009-0").await;
        let genuine = honest.compute(&grant).await;
        let (session, keys, _) = system.viewer().await;
        let submit = async |request: &SubmitRequest| honest.submit(request).await;

        // What nobody was given.
        let lease = genuine.lease.clone();
        let strangers = [
            Lease { worker: WorkerId::new("stranger").unwrap(), ..lease.clone() },
            Lease { attempt: Attempt(lease.attempt.0 + 1), ..lease.clone() },
            Lease { slot: lease.slot + 1, ..lease.clone() },
            Lease { task: TaskId::new("0.007-0").unwrap(), ..lease.clone() },
        ];
        for stranger in strangers {
            let why = refusal(submit(&SubmitRequest { lease: stranger, ..genuine.clone() }).await);
            assert!(why.contains("was not handed out to"), "{why}");
        }
        let nowhere = Lease { task: TaskId::new("7-0").unwrap(), ..lease.clone() };
        let why = refusal(submit(&SubmitRequest { lease: nowhere, ..genuine.clone() }).await);
        assert!(why.ends_with("has no task 7-0"), "{why}");
        // Under the key of another task.
        let key = keys.submit(&TaskId::new("0.007-0").unwrap());
        let why = refusal(request(&session, &key, &genuine, PATIENCE).await.unwrap());
        assert!(why.contains("under the key of task 0.007-0"), "{why}");

        // A large request, and bytes that are none.
        let (protocol, worker) = (protocol::VERSION, WorkerId::new("large").unwrap());
        let large = LeaseRequest { protocol, program: "x".repeat(1 << 20), worker, slot: 0 };
        let refused = request::<_, LeaseReply>(&session, &keys.lease(), &large, PATIENCE).await;
        assert!(matches!(&refused, Err(RequestError::Refused(why)) if why.contains("bytes")), "{refused:?}");
        let noise: Vec<u8> = encode(&genuine).into_iter().map(|byte| byte ^ 0x55).collect();
        let of_results = encoding::<SubmitRequest>();
        let refused =
            request_encoded::<SubmitReply>(&session, &keys.submit(&lease.task), noise, &of_results, PATIENCE).await;
        assert!(matches!(&refused, Err(RequestError::Refused(_))), "{refused:?}");

        // What was given, and numbers that cannot be true: each ends an attempt, three a worker's work.
        let points = match &genuine.finding {
            TaskResultMessage::Branch(branch) => branch.points.len(),
            other => panic!("{other:?}"),
        };
        let not_a_number = with_branch(&genuine, |branch| changed(&mut branch.points.motions.omega, 3, |_| f64::NAN));
        let other_harmonics = with_branch(&genuine, |branch| branch.points.motions.harmonics = 1);
        let other_forcing = with_branch(&genuine, |branch| {
            branch.amplitude = 999.0;
            (0..points).for_each(|i| changed(&mut branch.points.motions.forcing, i, |_| 999.0));
        });
        let perturbed = with_branch(&genuine, |branch| {
            let modal = &mut branch.points.motions.modal;
            let first = modal.data.len() / 8 / points;
            (0..points).for_each(|i| changed(modal, i * first + 2, |y| y * (1.0 + 1e-5)));
        });
        let endless = SubmitRequest { seconds: f64::INFINITY, ..genuine.clone() };
        let mut attempt = lease.attempt;
        for (number, (request, expected)) in [
            (not_a_number, "not finite"),
            (other_harmonics, "1 harmonics in a run of"),
            (other_forcing, "forcing amplitude 999"),
            (perturbed, "does not solve the equations"),
            (endless, "computing time of inf"),
        ]
        .into_iter()
        .enumerate()
        {
            // By two workers: of three it would be the task's fault.
            let liar = WorkerId::new(if number < 3 { "stand-in" } else { "liar" }).unwrap();
            let lease = if number == 0 {
                lease.clone()
            } else {
                let grant = honest.grant_of_for("0.009-0", &liar).await;
                Lease { task: grant.task, attempt: grant.attempt, worker: liar, slot: honest.slot() }
            };
            attempt = lease.attempt;
            let why = refusal(submit(&SubmitRequest { lease: lease.clone(), ..request }).await);
            assert!(why.contains(expected), "{why}");
            // The attempt is over, whatever is said of it afterwards.
            assert_eq!(honest.renew(&lease).await, RenewReply::Lost);
        }
        assert!(attempt.0 >= 5);
        assert_eq!(system.number("SELECT count(*) FROM results"), 0);
        assert_eq!(system.attempts("ending = 'refused'"), 5);
    });
    let _worker = system.worker();
    system.expect_complete();
    assert_eq!(files(&undisturbed.directory()), files(&system.directory()));
}

/// A result that was accepted is not replaced: it is compared, and the second one says whether it was the same.
#[test]
fn a_result_that_is_sent_again() {
    let mut system = System::sweep(DAMPER, &[ONE, BRIEF, LONG].concat());
    block_on(async {
        let honest = StandIn::of(&system).await;
        let genuine = honest.compute(&honest.grant_of("0.007-0").await).await;
        assert_eq!(honest.submit(&genuine).await, SubmitReply::Accepted);
        for _ in 0..3 {
            assert_eq!(honest.submit(&genuine).await, SubmitReply::Duplicate { agrees: true });
        }
        assert_eq!(system.number("SELECT count(*) FROM results"), 1);
    });
    let _worker = system.worker();
    system.expect_complete();
}

/// Bad memory, another build: a worker whose results do not hold is told to end, and why; the others go on.
#[test]
fn a_worker_whose_results_do_not_hold() {
    let mut system = System::sweep(DAMPER, &[ONE, BRIEF, LONG].concat());
    block_on(async {
        let liar = StandIn::of(&system).await;
        for _ in 0..3 {
            let genuine = liar.compute(&liar.grant_of("0.007-0").await).await;
            let seconds = SubmitRequest { seconds: f64::NAN, ..genuine };
            assert!(refusal(liar.submit(&seconds).await).contains("computing time of NaN"));
        }
        match liar.lease().await {
            LeaseReply::Stop { reason } => assert!(reason.starts_with("3 of its results were refused"), "{reason}"),
            other => panic!("{other:?}"),
        }
    });
    let _worker = system.worker();
    system.expect_complete();
}

/// Levels enough for somebody to be asked again.
const MANY: &[&str] = &["--amplitudes", "0.004:0.012:0.0002"];

/// Others may have nothing to do.
const TURN: Duration = Duration::from_secs(2);

/// Somebody who says that nothing is there, whatever is asked, is found out by two others who are asked again, told of and sent away.
#[test]
fn a_worker_that_finds_nothing() {
    let mut system = System::sweep(DAMPER, &[MANY, BRIEF, &["--stay"]].concat());
    let _honest = [system.worker(), system.worker()];
    let reason = block_on(async {
        let liar = StandIn::of(&system).await;
        let (session, keys, _) = system.viewer().await;
        loop {
            match liar.lease().await {
                LeaseReply::Grant(grant) => {
                    let reply = liar.deny(&grant).await;
                    assert!(matches!(reply, SubmitReply::Accepted | SubmitReply::Duplicate { .. }), "{reply:?}");
                    // Others have their turn: three of their results for one of these.
                    let done = async || fetch::<Status>(&session, &keys.status(), PATIENCE).await.unwrap().tasks.done;
                    let before = done().await;
                    let deadline = Instant::now() + TURN;
                    while done().await < before + 3 && Instant::now() < deadline {
                        tokio::time::sleep(Duration::from_millis(20)).await;
                    }
                }
                LeaseReply::Wait { .. } => tokio::time::sleep(Duration::from_millis(50)).await,
                LeaseReply::Stop { reason } => break reason,
                LeaseReply::Drained => panic!("it was not found out"),
            }
        }
    });
    assert!(reason.contains("of its results were refused") && reason.contains(": nothing, where "), "{reason}");
    system.wait_until_finished();
    assert!(system.attempts("ending = 'refuted' AND worker = 'stand-in'") >= 3);
    assert_eq!(system.attempts("ending = 'refuted' AND worker <> 'stand-in'"), 0);
    assert!(system.coordinator.output().contains("is wrong (stand-in: "), "{}", system.coordinator.output());
    // Nothing of that is left but what others were built on: main branches.
    let wrong = "SELECT count(*) FROM attempts JOIN results USING (task, attempt) JOIN tasks ON tasks.id = task \
                 WHERE \"end\" = 'refuted' AND kind <> 'main'";
    assert_eq!(system.number(wrong), 0);
    assert_eq!(system.number("SELECT count(*) FROM tasks WHERE state IN ('waiting', 'leased', 'dead')"), 0);
}

/// Landings that somebody denied before others came are taken back, with what was skipped for them: the run's files are those of a run
/// that nobody disturbed.
#[test]
fn landings_that_were_denied_are_taken_back() {
    const DENIED: i64 = 6;
    let mut undisturbed = System::sweep_with(DAMPER, &[MANY, BRIEF, &["--workers", "2"]].concat());
    let mut system = System::sweep(DAMPER, &[MANY, BRIEF, &["--repeat", "0"]].concat());
    block_on(async {
        let liar = StandIn::of(&system).await;
        let mut denied = 0;
        while denied < DENIED {
            let grant = liar.grant().await;
            let reply = match grant.work {
                Task::Main(_) => liar.submit(&liar.compute(&grant).await).await,
                Task::Land(_) => {
                    denied += 1;
                    liar.deny(&grant).await
                }
                other => panic!("nothing is known to begin at: {other:?}"),
            };
            assert_eq!(reply, SubmitReply::Accepted);
        }
    });
    system.coordinator.signal(Signal::KILL);
    system.coordinator.wait();
    system.resume(&["--workers", "2", "--repeat", "1"]);
    system.expect_complete();
    let refuted = "SELECT count(*) FROM attempts JOIN tasks ON tasks.id = task \
                   WHERE \"end\" = 'refuted' AND worker = 'stand-in' AND kind = 'land'";
    assert_eq!(system.number(refuted), DENIED);
    let left = "SELECT count(*) FROM attempts JOIN results USING (task, attempt) WHERE \"end\" = 'refuted'";
    assert_eq!(system.number(left), 0);
    undisturbed.expect_complete();
    assert_eq!(files(&undisturbed.directory()), files(&system.directory()));
}

/// A verification that tells of orbits that are none is refused; what is true is stored.
#[test]
fn a_verification_that_does_not_hold() {
    let mut system = System::sweep_with(DAMPER, &[ONE, BRIEF, &["--workers", "1"]].concat());
    system.expect_complete();
    system.go_on("verify", &[&["--workers", "0"], LONG].concat());
    block_on(async {
        let stand_in = StandIn::of(&system).await;
        let honest = stand_in.verify(&stand_in.grant().await).await;
        let orbits = honest.orbits.clone().unwrap();
        let finding = |change: &dyn Fn(&mut MarchedOrbit)| {
            let mut finding = honest.finding.clone();
            let TaskResultMessage::Verification(found) = &mut finding else { panic!("a verification") };
            found.points.iter_mut().filter_map(|point| point.orbit.as_mut()).for_each(change);
            finding
        };
        let mut elsewhere = orbits.clone();
        let numbers = elsewhere.states.data.len() / 8;
        (0..numbers).for_each(|i| changed(&mut elsewhere.states, i, |x| x * (1.0 + 1e-4)));
        let doctored = [
            (SubmitRequest { orbits: None, ..honest.clone() }, "0 came with it"),
            (SubmitRequest { orbits: Some(elsewhere), ..honest.clone() }, "does not come back after a period"),
            (
                SubmitRequest { finding: finding(&|orbit| orbit.amplitudes[0] *= 1.01), ..honest.clone() },
                "its amplitude is ",
            ),
        ];
        let task = honest.lease.task.clone();
        for (number, (request, expected)) in doctored.into_iter().enumerate() {
            let worker = WorkerId::new(&format!("liar-{number}")).unwrap();
            let lease = if number == 0 {
                honest.lease.clone()
            } else {
                let grant = stand_in.grant_of_for(task.as_str(), &worker).await;
                Lease { task: grant.task, attempt: grant.attempt, worker, slot: stand_in.slot() }
            };
            let why = refusal(stand_in.submit(&SubmitRequest { lease, ..request }).await);
            assert!(why.contains(expected), "{why}");
        }
        assert_eq!(system.number("SELECT count(*) FROM verifications"), 0);
    });
}
