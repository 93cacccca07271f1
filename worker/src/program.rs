//! The whole program.

use crate::bus::Bus;
use crate::error::WorkerError;
use crate::identity::worker_id;
use crate::join;
use crate::lane::work_with_thread;
use crate::log;
use crate::options::Options;
use crate::shared::Shared;
use crate::shutdown::{self, Phase, Shutdown};
use crate::terminal;
use protocol::keys::Keys;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;
use tokio::sync::Semaphore;
use tokio::task::JoinSet;
use zenoh::Session;

/// Closing a session may hang for much longer.
const CLOSING: Duration = Duration::from_secs(1);
/// Threads that talk. The others compute.
const TALKING_THREADS: usize = 2;

/// Why a worker ended, if in an ordinary way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// All work is done.
    Drained,
    /// The run was cancelled.
    Cancelled,
    /// There was nothing to do for so long.
    Idle,
    /// It was told to.
    Told,
}

/// What a worker did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Summary {
    /// Why it ended.
    pub ending: Ending,
    /// Results that were stored, or had been by another worker.
    pub done: usize,
}

/// Runs a worker as a program: with its own runtime, signals, log and exit code (see the [library](crate)).
pub fn run(options: &Options) -> ExitCode {
    log::start(options.log_format, default_log(options.verbose));
    match start(options) {
        Ok(summary) => {
            let why = match summary.ending {
                Ending::Drained => "all work is done",
                Ending::Cancelled => "the run was cancelled",
                Ending::Idle => "nothing to do",
                Ending::Told => "told to end",
            };
            tracing::info!(tasks = summary.done, "{why}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            terminal::complain(&error);
            ExitCode::from(error.exit_code())
        }
    }
}

fn default_log(verbose: u8) -> &'static str {
    match verbose {
        0 => "warn,zenoh=error,worker=info",
        1 => "warn,worker=debug",
        _ => "debug",
    }
}

fn start(options: &Options) -> Result<Summary, WorkerError> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(TALKING_THREADS)
        .enable_all()
        .build()
        .map_err(|source| WorkerError::System { what: "start threads", source })?;
    let result = runtime.block_on(async {
        let shutdown = Shutdown::default();
        shutdown::listen(&shutdown, options.grace, options.lifeline)?;
        work(options, &shutdown).await
    });
    // Nothing that is left is worth waiting for.
    runtime.shutdown_background();
    result
}

/// Works for a run until all is done, it is cancelled, there is nothing to do for too long, or the worker is told to end. Needs a multi-threaded runtime.
pub async fn work(options: &Options, shutdown: &Shutdown) -> Result<Summary, WorkerError> {
    let deadline = join::deadline(options);
    let session = tokio::select! {
        session = join::open(options, deadline) => session?,
        () = shutdown.reached(Phase::Finishing) => return Ok(Summary { ending: Ending::Told, done: 0 }),
    };
    let result = work_within(session.clone(), options, shutdown, deadline).await;
    let _ = tokio::time::timeout(CLOSING, session.close()).await;
    result
}

async fn work_within(
    session: Session,
    options: &Options,
    shutdown: &Shutdown,
    deadline: tokio::time::Instant,
) -> Result<Summary, WorkerError> {
    let joined = tokio::select! {
        joined = join::find(&session, options, deadline) => joined?,
        () = shutdown.reached(Phase::Finishing) => return Ok(Summary { ending: Ending::Told, done: 0 }),
    };
    let bus = Bus {
        session,
        endpoint: options.connect.clone(),
        run: joined.manifest.run.clone(),
        keys: Keys::new(&options.namespace, &joined.manifest.run),
        worker: worker_id(),
        patience: options.patience,
        bulk: Semaphore::new(1),
    };
    let (run, name) = (&joined.manifest.run, &joined.manifest.name);
    tracing::info!(%run, name, worker = %bus.worker, slots = options.threads(), "joined");
    let shared = Arc::new(Shared::new(bus, joined, shutdown.clone(), options.idle_exit));
    let _presence = shared.appear().await?;
    work_with_threads(&shared, options.threads()).await?;
    let ending = if shared.cancelled.load(Ordering::Relaxed) {
        Ending::Cancelled
    } else if *shared.drained.borrow() {
        Ending::Drained
    } else if *shared.idle.borrow() {
        Ending::Idle
    } else {
        Ending::Told
    };
    Ok(Summary { ending, done: shared.done.load(Ordering::Relaxed) })
}

/// Works with every computing thread; the first error counts, once the others have ended as well.
async fn work_with_threads(shared: &Arc<Shared>, count: usize) -> Result<(), WorkerError> {
    let mut threads = JoinSet::new();
    for number in 0..count {
        threads.spawn(work_with_thread(shared.clone(), number as u32));
    }
    let mut result = Ok(());
    while let Some(thread) = threads.join_next().await {
        let ended = thread.unwrap_or_else(|error| std::panic::resume_unwind(error.into_panic()));
        result = result.and(ended);
    }
    result
}
