//! The program itself: signals, lifeline, exit codes.

use crate::fake::{Asked, Fake, fine, free_endpoint, grant, hand_out, wait};
use crate::study::Study;
use rustix::process::{Pid, Signal, kill_process};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A worker process, killed if a test fails.
struct Process {
    child: Option<Child>,
    started: Instant,
}

impl Process {
    fn start(endpoint: &str, more: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_isola-worker"));
        command.args(["--connect", endpoint]).args(more);
        if !more.contains(&"--slots") {
            command.args(["--slots", "1"]);
        }
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).env_remove("ISOLA_LOG");
        Self { child: Some(command.spawn().unwrap()), started: Instant::now() }
    }

    fn signal(&mut self, signal: Signal) {
        let child = self.child.as_ref().unwrap();
        kill_process(Pid::from_child(child), signal).unwrap();
        self.started = Instant::now();
    }

    fn cut(&mut self) {
        drop(self.child.as_mut().unwrap().stdin.take());
        self.started = Instant::now();
    }

    fn is_running(&mut self) -> bool {
        self.child.as_mut().unwrap().try_wait().unwrap().is_none()
    }

    /// Waits for the end; gives exit code and log, and how long it took since it was told.
    async fn end(mut self) -> (Option<i32>, String, Duration) {
        while self.is_running() {
            assert!(self.started.elapsed() < Duration::from_secs(15), "does not end");
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        let took = self.started.elapsed();
        let Output { status, stderr, .. } = self.child.take().unwrap().wait_with_output().unwrap();
        (status.code(), String::from_utf8(stderr).unwrap(), took)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if let Some(child) = &mut self.child {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

const SOON: Duration = Duration::from_millis(2500);

/// A worker with an endless branch.
async fn busy(more: &[&str]) -> (Fake, Process) {
    let study = Study::endless();
    let fake = Fake::start(&study, hand_out(vec![study.main()])).await;
    let process = Process::start(&fake.endpoint, more);
    fake.seen.wait_for(Asked::is_renew, 1).await;
    (fake, process)
}

async fn assert_gives_back(fake: Fake, process: Process) {
    let (code, log, took) = process.end().await;
    assert_eq!(code, Some(0), "{log}");
    assert!(took < SOON, "{took:?}");
    assert_eq!(fake.seen.count(Asked::is_release), 1, "{log}");
    assert_eq!(fake.seen.count(Asked::is_lease), 1, "{log}");
}

#[tokio::test(flavor = "multi_thread")]
async fn sigterm_gives_the_branch_back() {
    let (fake, mut process) = busy(&[]).await;
    process.signal(Signal::TERM);
    assert_gives_back(fake, process).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn sigint_gives_the_branch_back() {
    let (fake, mut process) = busy(&[]).await;
    process.signal(Signal::INT);
    assert_gives_back(fake, process).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_lifeline_that_is_cut() {
    let (fake, mut process) = busy(&["--lifeline"]).await;
    process.signal(Signal::INT);
    tokio::time::sleep(Duration::from_millis(200)).await;
    assert!(process.is_running(), "with a lifeline, Ctrl-C is for whoever holds it");
    process.cut();
    assert_gives_back(fake, process).await;
}

/// The coordinator died without a word.
#[tokio::test(flavor = "multi_thread")]
async fn a_lifeline_that_is_cut_with_the_coordinator_gone() {
    let (fake, mut process) = busy(&["--lifeline"]).await;
    fake.session.close().await.unwrap();
    process.cut();
    let (code, log, took) = process.end().await;
    assert_eq!(code, Some(0), "{log}");
    assert!(took < 2 * SOON, "{took:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn without_a_lifeline_input_may_end() {
    let (fake, mut process) = busy(&[]).await;
    process.cut();
    tokio::time::sleep(Duration::from_millis(200)).await;
    assert!(process.is_running());
    process.signal(Signal::TERM);
    assert_gives_back(fake, process).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_second_signal_ends_at_once() {
    let (fake, mut process) = busy(&["--grace", "1000"]).await;
    process.signal(Signal::TERM);
    tokio::time::sleep(Duration::from_millis(200)).await;
    assert!(process.is_running(), "the branch has its grace");
    process.signal(Signal::TERM);
    let (code, _, took) = process.end().await;
    assert_eq!(code, Some(143));
    assert!(took < Duration::from_millis(500), "{took:?}");
    assert_eq!(fake.seen.count(Asked::is_release), 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn grace_ends() {
    let (fake, mut process) = busy(&["--grace", "0.5"]).await;
    process.signal(Signal::TERM);
    assert_gives_back(fake, process).await;
}

/// A branch that ends within the grace is submitted, and no other is begun.
#[tokio::test(flavor = "multi_thread")]
async fn grace_lets_a_branch_finish() {
    let mut study = Study::endless();
    study.settings.branch.max_points = 12_000;
    let mut main = study.main();
    main.ttl_ms = 30;
    let answer = move |asked: &Asked| if asked.is_lease() { grant(main.clone()) } else { fine(asked) };
    let fake = Fake::start(&study, answer).await;
    let mut process = Process::start(&fake.endpoint, &["--grace", "100"]);
    fake.seen.wait_for(Asked::is_renew, 1).await;
    assert_eq!(fake.seen.count(Asked::is_submit), 0, "the branch is under way");
    process.signal(Signal::TERM);
    let (code, log, took) = process.end().await;
    assert_eq!(code, Some(0), "{log}");
    println!("finished in {took:?}");
    let counts = [Asked::is_lease, Asked::is_submit, Asked::is_release].map(|kind| fake.seen.count(kind));
    assert_eq!(counts, [1, 1, 0], "{log}");
}

#[tokio::test(flavor = "multi_thread")]
async fn sigterm_while_there_is_no_work() {
    let fake = Fake::start(&Study::new(1), |_| wait()).await;
    let mut process = Process::start(&fake.endpoint, &[]);
    fake.seen.wait_for(Asked::is_lease, 3).await;
    process.signal(Signal::TERM);
    let (code, log, took) = process.end().await;
    assert_eq!(code, Some(0), "{log}");
    assert!(took < SOON, "{took:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn sigterm_while_there_is_no_coordinator() {
    let mut process = Process::start(&free_endpoint(), &["--wait", "100"]);
    tokio::time::sleep(Duration::from_millis(500)).await;
    process.signal(Signal::TERM);
    let (code, log, took) = process.end().await;
    assert_eq!(code, Some(0), "{log}");
    assert!(took < SOON, "{took:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn exit_codes_and_messages() {
    let study = Study::new(1);
    let fake = Fake::start(&study, hand_out(vec![study.main()])).await;
    let (code, log, _) = Process::start(&fake.endpoint, &[]).end().await;
    assert_eq!(code, Some(0), "{log}");
    assert!(log.contains("joined") && log.contains("all work is done"), "{log}");

    let endpoint = free_endpoint();
    let (code, log, _) = Process::start(&endpoint, &["--wait", "0"]).end().await;
    assert_eq!(code, Some(1), "{log}");
    assert_eq!(log.lines().count(), 1, "{log}");
    assert!(log.starts_with("error: no coordinator") && log.contains(&endpoint), "{log}");

    let (code, log, _) = Process::start(&fake.endpoint, &["--slots", "0"]).end().await;
    assert_eq!(code, Some(2), "{log}");
    let (code, log, _) = Process::start(&fake.endpoint, &["--namespace", "a/**"]).end().await;
    assert_eq!(code, Some(2), "{log}");
    fake.change(|manifest| manifest.protocol = 7);
    let (code, log, _) = Process::start(&fake.endpoint, &[]).end().await;
    assert_eq!(code, Some(3), "{log}");
}
