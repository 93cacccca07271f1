//! One replay, and what it came to.

use crate::bound::Bound;
use crate::coordinator::{Coordinator, Usage};
use crate::meter::Meter;
use crate::recording::Recording;
use crate::workers::{Replay, start};
use protocol::codec::encode;
use protocol::keys::Keys;
use protocol::session::fetch;
use protocol::to_everyone::Manifest;
use serde::Serialize;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use worker::join;
use worker::shutdown::Shutdown;
use zenoh::Session;

/// How long everybody has to join, and to come to rest, before it is measured what idling costs.
const SETTLING: Duration = Duration::from_secs(5);
/// Time between two looks at what the coordinator has used.
const SAMPLE: Duration = Duration::from_millis(100);
/// How long an answer may take.
const ANSWER: Duration = Duration::from_secs(5);

/// What a replay came to.
#[derive(Debug, Serialize)]
pub struct Measured {
    /// Workers.
    pub workers: usize,
    /// Results stored.
    pub tasks: usize,
    /// Landings among them that were not recorded.
    pub speculative: usize,
    /// From the first task handed out to the last result acknowledged, s.
    pub seconds: f64,
    /// The shortest time in which so many workers could do it, s.
    pub bound: f64,
    /// Bound over time.
    pub efficiency: f64,
    /// Results a second.
    pub rate: f64,
    /// Processor time of the coordinator in the same time, s.
    pub processor: f64,
    /// Most memory that the coordinator had at a time until then, MB.
    pub memory: f64,
    /// From the last result to the end of the process: files and table, s.
    pub closing: f64,
    /// Manifest, bytes.
    pub manifest: usize,
    /// Largest status, bytes.
    pub status: usize,
    /// Whether the files `summary.csv` and `events.csv` are those of the recorded run, to the byte.
    pub same: bool,
}

/// Replays a recording with so many workers, for a run in the empty folder `folder`.
///
/// # Errors
/// If a worker or the coordinator does not come to its end.
pub async fn replay(
    isola: &Path,
    recording: &Arc<Recording>,
    recorded: &Path,
    workers: usize,
    folder: &Path,
) -> Result<Measured, Box<dyn Error>> {
    let meter = Arc::new(Meter::default());
    let replay = Replay { recording: recording.clone(), meter: meter.clone(), idle: false };
    let mut coordinator = Coordinator::start(isola, &recording.header, folder).await?;
    let options = coordinator.options()?;
    let session = join::open(&options, join::deadline(&options)).await?;
    let keys = Keys::new(&options.namespace, &recording.header.run);
    listen(&session, &keys, &meter).await.map_err(|error| error.to_string())?;
    let mut running = start(Arc::new(replay), &options, workers, &Shutdown::default()).await?;
    let manifest: Manifest = fetch(&session, &keys.run(), ANSWER).await?;
    let (mut before, mut after) = (None, Usage::default());
    loop {
        tokio::select! {
            ended = running.join_next() => match ended {
                Some(ended) => ended??,
                None => break,
            },
            () = tokio::time::sleep(SAMPLE) => {}
        }
        let now = coordinator.usage();
        if meter.has_begun() {
            before.get_or_insert(now);
        }
        // The last look while it is there counts.
        if now.memory > 0.0 && meter.stored.load(Ordering::Relaxed) < recording.tasks.len() {
            after = now;
        }
    }
    let drained = Instant::now();
    if !coordinator.wait().await? {
        return Err(format!("not every task was done: see {}", folder.join("coordinator.log").display()).into());
    }
    let seconds = meter.seconds();
    let (tasks, bound) = (meter.stored.load(Ordering::Relaxed), Bound::of(recording).time(workers));
    Ok(Measured {
        workers,
        tasks,
        speculative: meter.speculative.load(Ordering::Relaxed),
        seconds,
        bound,
        efficiency: bound / seconds,
        rate: tasks as f64 / seconds,
        processor: after.processor - before.unwrap_or_default().processor,
        memory: after.memory,
        closing: drained.elapsed().as_secs_f64(),
        manifest: encode(&manifest).len(),
        status: meter.status.load(Ordering::Relaxed),
        same: ["summary.csv", "events.csv"].iter().all(|file| is_same(&recorded.join(file), &folder.join(file))),
    })
}

/// Takes down how large the status is.
async fn listen(session: &Session, keys: &Keys, meter: &Arc<Meter>) -> zenoh::Result<()> {
    let meter = meter.clone();
    let note = move |sample: zenoh::sample::Sample| {
        meter.status.fetch_max(sample.payload().len(), Ordering::Relaxed);
    };
    session.declare_subscriber(keys.status()).callback(note).background().await
}

fn is_same(one: &Path, other: &Path) -> bool {
    std::fs::read(one).ok() == std::fs::read(other).ok()
}

/// Processor time that the coordinator uses a second while as many of so many workers as possible have nothing to do: those that
/// have a task hold on to it.
///
/// # Errors
/// If the run cannot be begun.
pub async fn idle(
    isola: &Path,
    recording: &Arc<Recording>,
    workers: usize,
    seconds: f64,
    folder: &Path,
) -> Result<f64, Box<dyn Error>> {
    let meter = Arc::new(Meter::default());
    let replay = Replay { recording: recording.clone(), meter: meter.clone(), idle: true };
    let coordinator = Coordinator::start(isola, &recording.header, folder).await?;
    let options = coordinator.options()?;
    let _running = start(Arc::new(replay), &options, workers, &Shutdown::default()).await?;
    while !meter.has_begun() {
        tokio::time::sleep(SAMPLE).await;
    }
    tokio::time::sleep(SETTLING).await;
    let (before, began) = (coordinator.usage(), Instant::now());
    tokio::time::sleep(Duration::from_secs_f64(seconds)).await;
    let after = coordinator.usage();
    Ok((after.processor - before.processor) / began.elapsed().as_secs_f64())
}
