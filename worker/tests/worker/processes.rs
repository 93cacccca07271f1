//! The program itself: signals, lifeline, exit codes.

use crate::fake::{Asked, Fake, PATIENCE, fine, grant, hand_out, own_endpoint, wait};
use crate::study::Study;
use rustix::process::{Pid, Signal, kill_process};
use std::io::pipe;
use std::net::TcpListener;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A worker process, killed if a test fails.
struct Process(Option<Child>);

impl Process {
    fn start(endpoint: &str, more: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_isola-worker"));
        command.args(["--connect", endpoint]).args(more);
        if !more.contains(&"--slots") {
            command.args(["--slots", "1"]);
        }
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).env_remove("ISOLA_LOG");
        Self(Some(command.spawn().unwrap()))
    }

    fn child(&mut self) -> &mut Child {
        self.0.as_mut().unwrap()
    }

    fn signal(&mut self, signal: Signal) {
        kill_process(Pid::from_child(self.child()), signal).unwrap();
    }

    fn cut(&mut self) {
        drop(self.child().stdin.take());
    }

    fn is_running(&mut self) -> bool {
        self.child().try_wait().unwrap().is_none()
    }

    /// Waits for the end; gives exit code and log.
    async fn end(mut self) -> (Option<i32>, String) {
        let started = Instant::now();
        while self.is_running() {
            assert!(started.elapsed() < PATIENCE, "does not end");
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        let Output { status, stderr, .. } = self.0.take().unwrap().wait_with_output().unwrap();
        (status.code(), String::from_utf8(stderr).unwrap())
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Starts a worker on an endless branch, and waits until that is under way.
async fn busy(more: &[&str]) -> (Fake, Process) {
    let study = Study::endless();
    let fake = Fake::start(&study, hand_out(vec![study.main()])).await;
    let process = Process::start(&fake.endpoint, more);
    fake.seen.wait_for(Asked::is_renew, 1).await;
    (fake, process)
}

/// It ends though its branch does not: it has given it back.
async fn assert_gives_back(fake: Fake, process: Process) {
    let (code, log) = process.end().await;
    assert_eq!(code, Some(0), "{log}");
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

/// With a lifeline, Ctrl-C is for whoever holds it: the branch goes on.
#[tokio::test(flavor = "multi_thread")]
async fn a_lifeline_that_is_cut() {
    let (fake, mut process) = busy(&["--lifeline"]).await;
    process.signal(Signal::INT);
    fake.seen.wait_for_another(Asked::is_renew).await;
    fake.seen.wait_for_another(Asked::is_renew).await;
    assert_eq!(fake.seen.count(Asked::is_release), 0);
    process.cut();
    assert_gives_back(fake, process).await;
}

/// The coordinator died without a word: nobody waits for it as long as patience lasts.
#[tokio::test(flavor = "multi_thread")]
async fn a_lifeline_that_is_cut_with_the_coordinator_gone() {
    let (fake, mut process) = busy(&["--lifeline", "--patience", "1000000"]).await;
    fake.session.close().await.unwrap();
    process.cut();
    let (code, log) = process.end().await;
    assert_eq!(code, Some(0), "{log}");
}

#[tokio::test(flavor = "multi_thread")]
async fn without_a_lifeline_input_may_end() {
    let (fake, mut process) = busy(&[]).await;
    process.cut();
    fake.seen.wait_for_another(Asked::is_renew).await;
    fake.seen.wait_for_another(Asked::is_renew).await;
    assert!(process.is_running());
    process.signal(Signal::TERM);
    assert_gives_back(fake, process).await;
}

/// The first one leaves the branch its grace, the second one nothing.
#[tokio::test(flavor = "multi_thread")]
async fn a_second_signal_ends_at_once() {
    let (fake, mut process) = busy(&["--grace", "1000000"]).await;
    process.signal(Signal::TERM);
    fake.seen.wait_for_another(Asked::is_renew).await;
    fake.seen.wait_for_another(Asked::is_renew).await;
    assert!(process.is_running(), "the branch has its grace");
    process.signal(Signal::TERM);
    let (code, log) = process.end().await;
    assert_eq!(code, Some(143), "{log}");
    assert_eq!(fake.seen.count(Asked::is_release), 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn grace_ends() {
    let (fake, mut process) = busy(&["--grace", "0.5"]).await;
    let told = Instant::now();
    process.signal(Signal::TERM);
    assert_gives_back(fake, process).await;
    assert!(told.elapsed() >= Duration::from_millis(500));
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
    let mut process = Process::start(&fake.endpoint, &["--grace", "1000000"]);
    fake.seen.wait_for(Asked::is_renew, 1).await;
    process.signal(Signal::TERM);
    let (code, log) = process.end().await;
    assert_eq!(code, Some(0), "{log}");
    let [leased, submitted, released] =
        [Asked::is_lease, Asked::is_submit, Asked::is_release].map(|kind| fake.seen.count(kind));
    assert!(leased > 0 && submitted == leased && released == 0, "{log}");
}

#[tokio::test(flavor = "multi_thread")]
async fn sigterm_while_there_is_no_work() {
    let fake = Fake::start(&Study::new(1), |_| wait()).await;
    let mut process = Process::start(&fake.endpoint, &["--patience", "1000000"]);
    fake.seen.wait_for(Asked::is_lease, 3).await;
    process.signal(Signal::TERM);
    let (code, log) = process.end().await;
    assert_eq!(code, Some(0), "{log}");
}

#[tokio::test(flavor = "multi_thread")]
async fn sigterm_while_there_is_no_coordinator() {
    let endpoint = own_endpoint();
    let silent = TcpListener::bind(endpoint.trim_start_matches("tcp/")).unwrap();
    let mut process = Process::start(&endpoint, &["--wait", "1000000"]);
    // It looks for a coordinator, and goes on doing so when nobody listens any more.
    let (attempt, _) = tokio::task::spawn_blocking(move || silent.accept()).await.unwrap().unwrap();
    drop(attempt);
    process.signal(Signal::TERM);
    let (code, log) = process.end().await;
    assert_eq!(code, Some(0), "{log}");
}

/// What a worker says may go nowhere.
#[tokio::test(flavor = "multi_thread")]
async fn nobody_reads_the_log() {
    let study = Study::new(1);
    let fake = Fake::start(&study, hand_out(vec![study.main()])).await;
    let unheard = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_isola-worker"));
        let (_, closed) = pipe().unwrap();
        command.args(arguments).stdin(Stdio::null()).stdout(closed.try_clone().unwrap()).stderr(closed);
        command.spawn().unwrap()
    };
    let child = unheard(&["--connect", &fake.endpoint, "--slots", "1", "-vv"]);
    let (code, _) = Process(Some(child)).end().await;
    assert_eq!(code, Some(0));
    assert_eq!(fake.seen.count(Asked::is_submit), 1);
    for (arguments, expected) in [(["--help"], 0), (["--version"], 0), (["--nonsense"], 2)] {
        assert_eq!(Process(Some(unheard(&arguments))).end().await.0, Some(expected), "{arguments:?}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn exit_codes_and_messages() {
    let study = Study::new(1);
    let fake = Fake::start(&study, hand_out(vec![study.main()])).await;
    let (code, log) = Process::start(&fake.endpoint, &["--wait", "100"]).end().await;
    assert_eq!(code, Some(0), "{log}");
    assert!(log.contains("joined") && log.contains("all work is done"), "{log}");

    let endpoint = own_endpoint();
    let (code, log) = Process::start(&endpoint, &["--wait", "0"]).end().await;
    assert_eq!(code, Some(1), "{log}");
    assert_eq!(log.lines().count(), 1, "{log}");
    assert!(log.starts_with("error: no coordinator") && log.contains(&endpoint), "{log}");

    for wrong in [
        ["--slots", "0"],
        ["--namespace", "a/**"],
        ["--run", "a b"],
        ["--wait", "soon"],
        ["--wait", "1e10"],
        ["--patience", "nan"],
        ["--grace", "1e300"],
        ["--unknown", "1"],
    ] {
        let (code, log) = Process::start(&fake.endpoint, &wrong).end().await;
        assert_eq!(code, Some(2), "{log}");
        assert!(log.starts_with("error: ") && log.contains(wrong[0]), "{log}");
    }
    let (code, log) = Process::start("somewhere", &[]).end().await;
    assert_eq!(code, Some(2), "{log}");
    assert!(log.starts_with("error: ") && log.contains("tcp/HOST:7447"), "{log}");
    fake.change(|manifest| manifest.protocol = 99);
    let (code, log) = Process::start(&fake.endpoint, &["--wait", "100"]).end().await;
    assert_eq!(code, Some(3), "{log}");
}
