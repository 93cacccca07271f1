//! Real processes on loopback, for tests of the whole system.
//!
//! Every run gets a folder and a port of its own; children are ended by their ids when a test ends, however it ends.

use protocol::keys::Keys;
use protocol::secret::Secret;
use protocol::session::{connect, fetch};
use protocol::to_everyone::{Manifest, Stage, Status};
use rustix::process::{Pid, Signal, kill_process};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::sync::atomic::{AtomicU16, Ordering};
use std::time::{Duration, Instant};

pub mod results;

use results::Attempt;

/// How long anything is waited for before a test fails: minutes, since the machine may be busy with other things.
pub const PATIENCE: Duration = Duration::from_secs(300);

/// An endpoint that no other test, of this process or another one, listens on or connects from: on a loopback address that
/// belongs to this process, with a port below those that the system gives to connections.
pub fn own_endpoint() -> String {
    static COUNT: AtomicU16 = AtomicU16::new(0);
    let [_, a, b, c] = std::process::id().to_be_bytes();
    format!("tcp/127.{}.{b}.{c}:{}", 64 + a % 64, 20_000 + COUNT.fetch_add(1, Ordering::Relaxed))
}

/// A program of this workspace, as built beside the test.
pub fn program(name: &str) -> PathBuf {
    let test = std::env::current_exe().expect("a test knows its own file");
    let directory = test.ancestors().find(|path| path.join(name).is_file());
    let directory = directory.unwrap_or_else(|| panic!("{name} is not built: run `cargo test --workspace`"));
    directory.join(name)
}

/// A file of this repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// A child process; killed when dropped.
pub struct Process {
    child: Child,
    log: PathBuf,
}

impl Process {
    /// Starts a program whose output goes to `log`.
    pub fn start(program: &Path, arguments: &[&str], log: &Path) -> Self {
        let file = std::fs::File::create(log).expect("the folder of a test is writable");
        let child = Command::new(program)
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(file.try_clone().expect("a file handle can be cloned"))
            .stderr(file)
            .spawn()
            .unwrap_or_else(|error| panic!("{}: {error}", program.display()));
        Self { child, log: log.to_path_buf() }
    }

    /// What it has said.
    pub fn output(&self) -> String {
        std::fs::read_to_string(&self.log).unwrap_or_default()
    }

    /// Its id.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Sends a signal.
    pub fn signal(&self, signal: Signal) {
        let id = Pid::from_child(&self.child);
        kill_process(id, signal).expect("the process is there");
    }

    /// Whether it has not ended.
    pub fn is_running(&mut self) -> bool {
        self.child.try_wait().expect("a child can be waited for").is_none()
    }

    /// Waits for it to end.
    pub fn wait(&mut self) -> ExitStatus {
        let mut status = None;
        let ended = || {
            status = self.child.try_wait().expect("a child can be waited for");
            status.is_some()
        };
        if !eventually(ended) {
            panic!("{} does not end:\n{}", self.id(), self.output());
        }
        status.expect("it has ended")
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Whether something holds before patience is over.
fn eventually(mut holds: impl FnMut() -> bool) -> bool {
    let deadline = Instant::now() + PATIENCE;
    loop {
        if holds() {
            return true;
        }
        if Instant::now() > deadline {
            return false;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Runs `isola` to its end.
pub fn isola(arguments: &[&str]) -> Output {
    let output = Command::new(program("isola")).args(arguments).stdin(Stdio::null()).output();
    output.expect("isola can be started")
}

/// Runs several commands side by side, such as wait more than they compute; their outputs in their order.
pub fn isola_each(commands: &[Vec<&str>]) -> Vec<Output> {
    std::thread::scope(|scope| {
        let running: Vec<_> = commands.iter().map(|arguments| scope.spawn(|| isola(arguments))).collect();
        running.into_iter().map(|command| command.join().expect("the thread does not panic")).collect()
    })
}

/// What a program wrote to standard error.
pub fn complaint(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A run with its folder, coordinator and workers.
pub struct System {
    folder: tempfile::TempDir,
    /// The coordinator.
    pub coordinator: Process,
    workers: usize,
}

impl System {
    /// Starts the sweep of a study without local workers.
    pub fn sweep(study: &str, more: &[&str]) -> Self {
        Self::sweep_with(study, &[&["--workers", "0"], more].concat())
    }

    /// Starts the sweep of a study.
    pub fn sweep_with(study: &str, more: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("there is a folder for temporary files");
        let run = folder.path().join("run");
        let study = repository(study);
        let fixed = ["sweep", study.to_str().expect("paths are text"), "--out", run.to_str().expect("paths are text")];
        let coordinator =
            Process::start(&program("isola"), &[&fixed, more].concat(), &folder.path().join("coordinator.log"));
        let system = Self { folder, coordinator, workers: 0 };
        system.wait_for_address();
        system
    }

    /// Resumes the run, on another port.
    pub fn resume(&mut self, more: &[&str]) {
        self.go_on("resume", more);
    }

    /// Goes on with the run by another command, on another port.
    pub fn go_on(&mut self, command: &str, more: &[&str]) {
        // What an interrupted or cancelled run has left says nothing of this one.
        for file in ["address", "summary.csv"] {
            let _ = std::fs::remove_file(self.directory().join(file));
        }
        let run = self.directory();
        let fixed = [command, run.to_str().expect("paths are text")];
        let log = self.folder.path().join("resumed.log");
        self.coordinator = Process::start(&program("isola"), &[&fixed, more].concat(), &log);
        self.wait_for_address();
    }

    fn wait_for_address(&self) {
        self.eventually("a coordinator", |system| {
            system.directory().join("address").exists() || system.directory().join("summary.csv").exists()
        });
    }

    /// Waits until something holds.
    pub fn eventually(&self, what: &str, holds: impl Fn(&Self) -> bool) {
        assert!(eventually(|| holds(self)), "not in time: {what}\n{}", self.coordinator.output());
    }

    /// Folder of the run.
    pub fn directory(&self) -> PathBuf {
        self.folder.path().join("run")
    }

    /// Folder of the run, as text.
    pub fn directory_text(&self) -> String {
        self.directory().display().to_string()
    }

    /// Folder for whatever a test needs beside the run.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Where the coordinator listens.
    pub fn address(&self) -> String {
        std::fs::read_to_string(self.directory().join("address")).expect("the coordinator is there").trim().to_string()
    }

    /// The secret of the run; none if everybody is let in.
    pub fn secret(&self) -> Option<Secret> {
        let file = self.secret_file();
        file.exists().then(|| Secret::read(&file).expect("the coordinator wrote it"))
    }

    /// Where it is.
    pub fn secret_file(&self) -> PathBuf {
        self.directory().join(protocol::secret::FILE)
    }

    /// Starts a worker of one computing thread.
    pub fn worker(&mut self) -> Process {
        let address = self.address();
        self.worker_at(&address)
    }

    /// Starts a worker that connects elsewhere.
    pub fn worker_at(&mut self, address: &str) -> Process {
        self.workers += 1;
        let log = self.folder.path().join(format!("worker-{}.log", self.workers));
        let file = self.secret_file();
        let secret = ["--secret-file", file.to_str().expect("paths are text")];
        let secret = if file.exists() { &secret[..] } else { &[] };
        let arguments = [&["--connect", address, "--slots", "1", "-v"][..], secret].concat();
        Process::start(&program("isola-worker"), &arguments, &log)
    }

    /// What a worker has been given; waits until it has something.
    pub fn attempt_of(&self, worker: &Process) -> Attempt {
        let found = RefCell::new(None);
        self.eventually("a task under way", |system| {
            *found.borrow_mut() = results::attempt_of(&system.directory(), worker.id());
            found.borrow().is_some()
        });
        found.take().expect("it was found")
    }

    /// How an attempt ended; waits until it has.
    pub fn end_of(&self, attempt: &Attempt) -> String {
        let end = || results::end_of(&self.directory(), attempt);
        self.eventually("the end of an attempt", |_| end().is_some());
        end().expect("what has ended stays so")
    }

    /// A worker whose lease of a task has expired: it is frozen, then `then` is done to it. A result that was on its way
    /// may still arrive: then another one.
    pub fn expired_worker(&mut self, then: impl Fn(&Process)) -> Process {
        loop {
            let worker = self.worker();
            let attempt = self.attempt_of(&worker);
            worker.signal(Signal::STOP);
            then(&worker);
            match self.end_of(&attempt).as_str() {
                "expired" => return worker,
                end => assert_eq!(end, "done"),
            }
        }
    }

    /// Freezes the coordinator while an SQL query of its store gives 1.
    pub fn freeze_coordinator(&self, sql: &str) {
        self.eventually(sql, |system| {
            if system.number(sql) != 1 {
                return false;
            }
            system.coordinator.signal(Signal::STOP);
            let holds = system.number(sql) == 1;
            if !holds {
                system.coordinator.signal(Signal::CONT);
            }
            holds
        });
    }

    /// Session, keys and manifest of a viewer.
    pub async fn viewer(&self) -> (zenoh::Session, Keys, Manifest) {
        let deadline = Instant::now() + PATIENCE;
        let key = protocol::keys::all_runs(protocol::keys::NAMESPACE);
        loop {
            if let Ok(session) = connect(&self.address(), &self.secret().into()).await
                && let Ok(manifest) = fetch::<Manifest>(&session, &key, PATIENCE).await
            {
                return (session, Keys::new(protocol::keys::NAMESPACE, &manifest.run), manifest);
            }
            assert!(Instant::now() < deadline, "no run on the bus\n{}", self.coordinator.output());
        }
    }

    /// Waits until the status of the run is as wanted.
    pub fn wait_until(&self, what: &str, holds: impl Fn(&Status) -> bool) -> Status {
        block_on(self.reaches(what, holds))
    }

    /// [`System::wait_until`], for whoever is on a runtime already.
    pub async fn reaches(&self, what: &str, holds: impl Fn(&Status) -> bool) -> Status {
        let (session, keys, _) = self.viewer().await;
        let deadline = Instant::now() + PATIENCE;
        loop {
            if let Ok(status) = fetch::<Status>(&session, &keys.status(), PATIENCE).await
                && holds(&status)
            {
                return status;
            }
            assert!(Instant::now() < deadline, "not in time: {what}\n{}", self.coordinator.output());
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }

    /// Waits until a branch is under way: a task with points.
    pub fn wait_for_a_branch(&self) -> Status {
        self.wait_until("a branch under way", |status| {
            status.active.iter().any(|level| level.progress.is_some_and(|progress| progress.points > 1))
        })
    }

    /// Waits for the coordinator to end with every task done.
    pub fn expect_complete(&mut self) {
        let status = self.coordinator.wait();
        assert!(status.success(), "{status}\n{}", self.coordinator.output());
        results::assert_stored_once(&self.directory());
    }

    /// Waits until every task is done, the coordinator staying.
    pub fn wait_until_finished(&self) -> Status {
        self.wait_until("the end of the run", |status| status.stage == Stage::Finished)
    }

    /// A number from the store.
    pub fn number(&self, sql: &str) -> i64 {
        results::number(&self.directory(), sql)
    }

    /// Attempts of which an SQL condition on `ending`, `reason` and `worker` holds.
    pub fn attempts(&self, condition: &str) -> i64 {
        let attempts = r#"SELECT worker, reason, "end" AS ending FROM attempts"#;
        self.number(&format!("SELECT count(*) FROM ({attempts}) WHERE {condition}"))
    }

    /// Attempts that brought nothing, as workers tell what they lease. One that repeats a task that is done is none, nor one that a
    /// coordinator has granted which was killed before its worker heard of it.
    pub fn attempts_in_vain(&self) -> Vec<String> {
        let ended = results::text(
            &self.directory(),
            r#"SELECT coalesce(group_concat('task=' || task || ' attempt=' || attempt || ' ' || coalesce("end", 'under way'), char(10)), '')
               FROM attempts WHERE coalesce("end", '') NOT IN ('done', 'confirmed')
               AND NOT ("end" = 'released' AND EXISTS (SELECT * FROM attempts AS first
                        WHERE first.task = attempts.task AND first.attempt < attempts.attempt AND first."end" = 'done'))"#,
        );
        let log = |number| std::fs::read_to_string(self.folder.path().join(format!("worker-{number}.log")));
        let heard: String = (1..=self.workers).map(|number| log(number).expect("a worker has a log")).collect();
        let is_unheard = |attempt: &&str| {
            attempt.strip_suffix("released").is_some_and(|attempt| !heard.contains(&format!("leased {attempt}")))
        };
        ended.lines().filter(|attempt| !is_unheard(attempt)).map(str::to_string).collect()
    }

    /// Tasks that are done, in the order of their announcements.
    pub fn done(&self) -> Vec<String> {
        results::done(&self.directory())
    }

    /// Number of workers whose attempts led to results.
    pub fn workers_with_results(&self) -> i64 {
        self.number("SELECT count(DISTINCT worker) FROM results")
    }

    /// Ids of the coordinator's local workers.
    pub fn children(&self) -> Vec<u32> {
        let id = self.coordinator.id();
        let list = std::fs::read_to_string(format!("/proc/{id}/task/{id}/children")).unwrap_or_default();
        list.split_whitespace().filter_map(|child| child.parse().ok()).collect()
    }
}

/// Runs a future on a runtime of its own.
pub fn block_on<T>(future: impl Future<Output = T>) -> T {
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build();
    let runtime = runtime.expect("a runtime can be made");
    let value = runtime.block_on(future);
    runtime.shutdown_background();
    value
}

/// Addresses that a process listens on, from the kernel's tables.
pub fn listening(id: u32) -> Vec<String> {
    let sockets: Vec<String> = std::fs::read_dir(format!("/proc/{id}/fd"))
        .map(|entries| entries.flatten().filter_map(|entry| std::fs::read_link(entry.path()).ok()).collect())
        .map(|links: Vec<PathBuf>| links.iter().map(|link| link.display().to_string()).collect())
        .unwrap_or_default();
    let mut found = Vec::new();
    for table in ["tcp", "tcp6", "udp", "udp6"] {
        let text = std::fs::read_to_string(format!("/proc/{id}/net/{table}")).unwrap_or_default();
        for line in text.lines().skip(1) {
            let fields: Vec<&str> = line.split_whitespace().collect();
            let [_, local, _, state, ..] = fields[..] else { continue };
            let inode = fields.get(9).copied().unwrap_or_default();
            let is_open = (table.starts_with("tcp") && state == "0A") || (table.starts_with("udp") && state == "07");
            if is_open && sockets.contains(&format!("socket:[{inode}]")) {
                found.push(address(local));
            }
        }
    }
    found
}

/// `0100007F:1F90` as `127.0.0.1:8080`.
fn address(hexadecimal: &str) -> String {
    let (host, port) = hexadecimal.split_once(':').unwrap_or((hexadecimal, "0"));
    let port = u16::from_str_radix(port, 16).unwrap_or(0);
    match u32::from_str_radix(host, 16) {
        Ok(host) => format!("{}:{port}", std::net::Ipv4Addr::from(host.swap_bytes())),
        Err(_) => format!("[{host}]:{port}"),
    }
}
