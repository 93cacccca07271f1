//! The process that replayed workers work for: `isola` itself, on a run that has nothing yet but the recording's study and model.

use results::store::{RunHeader, Store};
use std::error::Error;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use worker::{LogFormat, Options};

/// Clock ticks a second in which Linux gives processor times to programs.
const TICKS: f64 = 100.0;
/// Time between two looks for a file.
const PAUSE: Duration = Duration::from_millis(5);
/// How long the coordinator may take to listen.
const START: Duration = Duration::from_secs(60);

/// A coordinator under way; killed when dropped.
pub struct Coordinator {
    child: Child,
    folder: PathBuf,
    namespace: String,
}

/// What a process has used.
#[derive(Debug, Clone, Copy, Default)]
pub struct Usage {
    /// Processor time, s.
    pub processor: f64,
    /// Most memory at a time, MB.
    pub memory: f64,
}

impl Coordinator {
    /// Starts `isola` on a new run in `folder`, of the same study and model as the recorded one.
    ///
    /// # Errors
    /// If it cannot be started.
    pub async fn start(isola: &Path, header: &RunHeader, folder: &Path) -> Result<Self, Box<dyn Error>> {
        let namespace = format!("replay-{}", std::process::id());
        drop(Store::create(folder, &RunHeader { namespace: namespace.clone(), ..header.clone() })?);
        let log = File::create(folder.join("coordinator.log"))?;
        let child = Command::new(isola)
            .args(["resume", "--as-started", "--workers", "0", "--listen", "tcp/127.0.0.1:0"])
            .arg(folder)
            .stdin(Stdio::null())
            .stdout(log.try_clone()?)
            .stderr(log)
            .spawn()
            .map_err(|error| format!("{}: {error}", isola.display()))?;
        let mut this = Self { child, folder: folder.to_path_buf(), namespace };
        tokio::time::timeout(START, this.listens()).await.map_err(|_| "the coordinator does not listen")??;
        Ok(this)
    }

    async fn listens(&mut self) -> Result<(), Box<dyn Error>> {
        while !self.folder.join("address").exists() {
            if let Some(status) = self.child.try_wait()? {
                let log = std::fs::read_to_string(self.folder.join("coordinator.log"))?;
                return Err(format!("the coordinator ended with {status}:\n{log}").into());
            }
            tokio::time::sleep(PAUSE).await;
        }
        Ok(())
    }

    /// Options of a worker that joins it.
    ///
    /// # Errors
    /// If it does not say where it is.
    pub fn options(&self) -> Result<Options, Box<dyn Error>> {
        let address = std::fs::read_to_string(self.folder.join("address"))?;
        Ok(Options {
            connect: address.trim().to_string(),
            secret_file: Some(self.folder.join(protocol::secret::FILE)),
            tls: None,
            namespace: self.namespace.clone(),
            run: None,
            slots: None,
            wait: START,
            patience: Duration::from_secs(600),
            grace: Duration::ZERO,
            idle_exit: None,
            log_format: LogFormat::default(),
            lifeline: false,
            verbose: 0,
        })
    }

    /// What it has used so far; nothing once it has ended.
    pub fn usage(&self) -> Usage {
        let read =
            |file: &str| std::fs::read_to_string(format!("/proc/{}/{file}", self.child.id())).unwrap_or_default();
        let (stat, status) = (read("stat"), read("status"));
        // After the name, which may hold anything: state, nine numbers, and then the time in user and in kernel mode.
        let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
        let ticks = |index: usize| fields.get(index).and_then(|text| text.parse::<f64>().ok()).unwrap_or(0.0);
        let most = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let most = most.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok()).unwrap_or(0.0);
        Usage { processor: (ticks(11) + ticks(12)) / TICKS, memory: most / 1024.0 }
    }

    /// Waits until it has ended, and says whether every task was done.
    ///
    /// # Errors
    /// If it cannot be waited for.
    pub async fn wait(&mut self) -> std::io::Result<bool> {
        loop {
            if let Some(status) = self.child.try_wait()? {
                // 4: complete, with doubts about a curve, which the recorded run had as well.
                return Ok(matches!(status.code(), Some(0 | 4)));
            }
            tokio::time::sleep(PAUSE).await;
        }
    }
}

impl Drop for Coordinator {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
