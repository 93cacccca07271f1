//! Workers that replay a recording: they ask, fetch, give signs of life and submit as real ones do, by the same code, and sleep
//! instead of computing. Each has a name of its own and one computing thread; several share a connection.

use crate::meter::Meter;
use crate::recording::Recording;
use protocol::codec::encode;
use protocol::from_worker::{LANES, SubmitRequest};
use protocol::ids::{TaskId, WorkerId};
use protocol::keys::Keys;
use protocol::to_worker::{Grant, SubmitReply};
use std::collections::HashSet;
use std::error::Error;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;
use tokio::sync::Semaphore;
use tokio::task::JoinSet;
use tokio::time::sleep;
use worker::bus::Bus;
use worker::compute::Watch;
use worker::leasing::{lease_of, next_task};
use worker::patience::OutOfPatience;
use worker::renewal::keep;
use worker::shared::Shared;
use worker::shutdown::{Phase, Shutdown};
use worker::turns::{STEADY, Turn, Turns};
use worker::{Options, join};
use zenoh::Session;
use zenoh::bytes::ZBytes;

/// Workers that share a connection.
const A_SESSION: usize = 16;
/// Landings of which a real worker keeps what it found.
const LANDINGS: usize = 64;

/// What replayed workers share.
pub struct Replay {
    /// What is given back.
    pub recording: Arc<Recording>,
    /// What is counted.
    pub meter: Arc<Meter>,
    /// Give nothing back, but hold on to the first task until told to end.
    pub idle: bool,
}

/// Starts so many workers for the run that `options` lead to; each joins it as a real one does, up to the model, which is fetched
/// once.
///
/// # Errors
/// If there is no run, or it cannot be joined.
pub async fn start(
    replay: Arc<Replay>,
    options: &Options,
    count: usize,
    shutdown: &Shutdown,
) -> Result<JoinSet<Result<(), String>>, Box<dyn Error>> {
    let deadline = join::deadline(options);
    let first = join::open(options, deadline).await?;
    let joined = join::find(&first, options, deadline).await?;
    let mut sessions = vec![first];
    while sessions.len() * A_SESSION < count {
        sessions.push(join::open(options, deadline).await?);
    }
    let mut workers = JoinSet::new();
    for number in 0..count {
        let session = sessions[number / A_SESSION].clone();
        let bus = bus(session, options, &joined.manifest.run, number)?;
        let shared = Arc::new(Shared::new(bus, joined.clone(), shutdown.clone(), None));
        workers.spawn(run(replay.clone(), shared));
    }
    Ok(workers)
}

fn bus(session: Session, options: &Options, run: &protocol::ids::RunId, number: usize) -> Result<Bus, Box<dyn Error>> {
    Ok(Bus {
        session,
        endpoint: options.connect.clone(),
        run: run.clone(),
        keys: Keys::new(&options.namespace, run),
        worker: WorkerId::new(&format!("replay-{number}"))?,
        patience: options.patience,
        bulk: Semaphore::new(1),
    })
}

/// A worker with one computing thread.
async fn run(replay: Arc<Replay>, shared: Arc<Shared>) -> Result<(), String> {
    let _presence = shared.appear().await.map_err(|error| error.to_string())?;
    let turns = Arc::new(Turns::default());
    let lanes = |slots: Range<u32>| {
        let mut lanes = JoinSet::new();
        for slot in slots {
            let (replay, shared, turns) = (replay.clone(), shared.clone(), turns.clone());
            lanes.spawn(Lane { replay, shared, slot, turns, known: HashSet::new(), landed: HashSet::new() }.run());
        }
        lanes
    };
    let (steady, spare) = (lanes(0..STEADY), lanes(STEADY..LANES));
    let steady = steady.join_all().await;
    turns.end();
    steady.into_iter().chain(spare.join_all().await).collect()
}

/// One of those that take turns on a computing thread.
struct Lane {
    replay: Arc<Replay>,
    shared: Arc<Shared>,
    slot: u32,
    turns: Arc<Turns>,
    /// Branches and curves that a real worker would have at hand.
    known: HashSet<TaskId>,
    /// Landings likewise.
    landed: HashSet<TaskId>,
}

impl Lane {
    async fn run(mut self) -> Result<(), String> {
        let mut at_hand = None;
        loop {
            let next = next_task(&self.shared, self.slot, &self.turns, at_hand).await;
            let Some((grant, turn)) = next.map_err(|error| error.to_string())? else { return Ok(()) };
            self.replay.meter.granted();
            at_hand = self.execute(grant, turn).await?;
        }
    }

    /// Carries out a task; the next one may come with the acknowledgement.
    async fn execute(&mut self, grant: Grant, turn: Option<Turn>) -> Result<Option<Grant>, String> {
        let shared = self.shared.clone();
        let lease = lease_of(&shared, self.slot, &grant);
        let (recording, meter) = (self.replay.recording.clone(), self.replay.meter.clone());
        let answer = recording.answer(&grant.task, &grant.work);
        let (seconds, finding) =
            answer.ok_or_else(|| format!("task {} is not of the recording: {:?}", grant.task, grant.work))?;
        let is_landing = !grant.work.is_ordered();
        let ttl = Duration::from_millis(grant.ttl_ms);
        let watch = Watch::default();
        let (hints, drained) = (shared.hints.subscribe(), shared.drained.subscribe());
        let program = protocol::PROGRAM.into();
        let request = SubmitRequest { lease: lease.clone(), program, seconds, next: true, orbits: None, finding };
        let done = async {
            self.fetch(&grant).await;
            let payload = ZBytes::from(encode(&request));
            if self.replay.idle {
                std::future::pending::<()>().await;
            }
            let _turn = match turn {
                Some(turn) => turn,
                None => self.turns.take_with_task().await,
            };
            sleep(Duration::from_secs_f64(seconds)).await;
            self.turns.note(Duration::from_secs_f64(seconds));
            payload
        };
        let payload = tokio::select! {
            payload = done => payload,
            interruption = keep(&shared.bus, &lease, ttl, &watch, hints, drained) => {
                return Err(format!("task {}: {interruption:?}", grant.task));
            }
            () = shared.shutdown.reached(Phase::Stopping) => return Ok(None),
        };
        let next = match shared.bus.submit(&grant.task, &payload).await {
            Ok(SubmitReply::Next(next)) => Some(*next),
            Ok(SubmitReply::Accepted | SubmitReply::Duplicate { agrees: true }) => None,
            Ok(reply) => return Err(format!("task {}: {reply:?}", grant.task)),
            Err(OutOfPatience) => return Err(format!("task {} was not answered", grant.task)),
        };
        if recording.task(&grant.task).is_none() {
            meter.speculative.fetch_add(1, Ordering::Relaxed);
        }
        meter.accepted();
        if is_landing && self.landed.len() == LANDINGS {
            self.landed.clear();
        }
        if is_landing { &mut self.landed } else { &mut self.known }.insert(grant.task);
        Ok(next)
    }

    /// Fetches what a real worker would not have at hand.
    async fn fetch(&mut self, grant: &Grant) {
        let names = || grant.known.iter().map(|known| &known.task).chain(grant.curves.iter().map(|curve| &curve.task));
        if grant.work.is_ordered() {
            self.known.retain(|task| names().any(|named| named == task));
        }
        let landing = grant.landing.as_ref().filter(|&task| !self.landed.remove(task));
        let missing: Vec<TaskId> =
            landing.into_iter().chain(names().filter(|&t| !self.known.contains(t))).cloned().collect();
        for task in missing {
            let fetched = self.shared.bus.result(&task, self.shared.max_result_bytes).await;
            if fetched.is_ok() && grant.landing.as_ref() != Some(&task) {
                self.known.insert(task);
            }
        }
    }
}
