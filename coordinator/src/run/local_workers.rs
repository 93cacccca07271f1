//! Worker processes of a local sweep: the same executable, one a core.

use protocol::certificate::{self, Certificate};
use protocol::credentials::Credentials;
use protocol::ids::RunId;
use protocol::secret::{self, Secret};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use worker::LogFormat;

/// Restarts of workers that died, without a result in between, before a run ends with a message.
const RESTARTS: u32 = 10;

/// How local workers are started.
#[derive(Debug, Clone)]
pub struct Launch {
    /// Endpoint to connect to.
    pub endpoint: String,
    /// What lets them in: that of their coordinator.
    pub credentials: Credentials,
    /// Namespace of the keys.
    pub namespace: String,
    /// Run to join.
    pub run: RunId,
    /// Where each worker writes what it has to say.
    pub logs: PathBuf,
    /// How it is written.
    pub log_format: LogFormat,
}

/// The local workers of a run. Each has its standard input connected to this process: when that ends, however it ends, so
/// do they.
pub struct LocalWorkers {
    launch: Launch,
    children: Vec<(usize, Child)>,
    restarts: u32,
    /// Results when workers were last counted on.
    done: usize,
}

impl LocalWorkers {
    /// Starts `count` workers.
    pub fn start(launch: Launch, count: usize) -> io::Result<Self> {
        std::fs::create_dir_all(&launch.logs)?;
        let children = (1..=count).map(|number| Ok((number, launch.spawn(number)?))).collect::<io::Result<_>>()?;
        Ok(Self { launch, children, restarts: 0, done: 0 })
    }

    /// Starts workers again that died, and those that were told to end if no other is left. Says why not if that happens
    /// too often without a result; `done` is the number of results so far.
    pub fn tend(&mut self, done: usize) -> Result<(), String> {
        if done > self.done {
            (self.done, self.restarts) = (done, 0);
        }
        let all_gone = self.children.iter_mut().all(|(_, child)| matches!(child.try_wait(), Ok(Some(_))));
        for (number, child) in &mut self.children {
            let Ok(Some(status)) = child.try_wait() else { continue };
            if status.success() && !all_gone {
                continue;
            }
            let log = self.launch.log(*number);
            tracing::warn!(worker = *number, %status, log = %log.display(), "a local worker died");
            if self.restarts == RESTARTS {
                return Err(format!(
                    "local workers died {RESTARTS} times, the last one with {status}: see {}",
                    log.display()
                ));
            }
            self.restarts += 1;
            *child =
                self.launch.spawn(*number).map_err(|error| format!("a local worker cannot be started: {error}"))?;
        }
        Ok(())
    }

    /// Asks all workers to give back what they have and to end, and waits for that; after `patience` they are killed.
    pub fn stop(mut self, patience: Duration) {
        for (_, child) in &mut self.children {
            drop(child.stdin.take());
        }
        self.wait(patience);
    }

    /// Waits for workers to end by themselves, at most for `patience`; then they are killed.
    pub fn wait(&mut self, patience: Duration) {
        let deadline = Instant::now() + patience;
        for (_, child) in &mut self.children {
            loop {
                match child.try_wait() {
                    Ok(Some(_)) => break,
                    Ok(None) if Instant::now() < deadline => std::thread::sleep(Duration::from_millis(10)),
                    _ => {
                        // It may have ended in between.
                        let _ = child.kill();
                        let _ = child.wait();
                        break;
                    }
                }
            }
        }
    }
}

impl Launch {
    fn log(&self, number: usize) -> PathBuf {
        self.logs.join(format!("worker-{number}.log"))
    }

    fn spawn(&self, number: usize) -> io::Result<Child> {
        Command::new(std::env::current_exe()?)
            .args(["worker", "--lifeline", "--slots", "1"])
            .args(["--log-format", self.log_format.name()])
            .args(["--connect", &self.endpoint])
            .args(["--namespace", &self.namespace])
            .args(["--run", self.run.as_str()])
            // That of a run elsewhere would go before this run's own.
            .env_remove("ISOLA_SECRET_FILE")
            .env(secret::ENVIRONMENT, self.credentials.secret.as_ref().map_or("", Secret::reveal))
            .env(
                certificate::ENVIRONMENT,
                self.credentials.certificate.as_ref().map_or(Path::new(""), Certificate::folder),
            )
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(append(&self.log(number))?)
            .spawn()
    }
}

fn append(path: &Path) -> io::Result<File> {
    File::options().create(true).append(true).open(path)
}
