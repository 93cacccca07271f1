//! What runs beside the steps of a run, from start to stop.

use super::endpoint::Connection;
use super::link::watch as watch_link;
use super::preparation::{Prepared, manifest};
use crate::bus::{Presence, Recent, RunState, Served, announce, serve};
use crate::engine::{Decider, Engine, Event, Meters, News, commit, tick};
use crate::error::Error;
use crate::ledger::Rules;
use protocol::codec::encode;
use protocol::keys::Keys;
use protocol::to_everyone::{Stage, Status};
use results::store::{RunHeader, Store, StoreError};
use solver::response::orders::Orders;
use solver::structure::Model;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};
use tokio::sync::{mpsc, watch};
use tokio::task::{JoinError, JoinHandle, spawn_blocking};
use tokio::time::timeout;

/// How long what was decided last may take to be stored, and then to be announced.
const LAST_COMMIT: Duration = Duration::from_secs(2);
const LAST_NEWS: Duration = Duration::from_secs(1);

/// Presence on the bus, the engine, and whoever commits and announces.
pub(super) struct Services {
    engine: Arc<Decider>,
    state: Arc<watch::Sender<RunState>>,
    changes: watch::Receiver<RunState>,
    meters: Meters,
    presence: Presence,
    committing: JoinHandle<Result<(), StoreError>>,
    announcing: JoinHandle<()>,
    /// Over a router.
    watching: Option<JoinHandle<()>>,
}

/// What services are started with.
pub(super) struct Start<'s> {
    pub directory: PathBuf,
    pub header: &'s RunHeader,
    pub connection: &'s Connection,
    pub store: Store,
    pub model: Arc<Model>,
    pub rules: Rules,
    /// The sweep, if the store has it.
    pub prepared: Option<Prepared>,
}

impl Services {
    /// Starts everything. A sweep that goes on does so before anybody can ask: workers that survived keep what they have.
    pub async fn start(start: Start<'_>) -> Result<Self, Error> {
        let Start { directory, header, connection, store, model, rules, prepared } = start;
        let (session, keys) = (&connection.session, Keys::new(&header.namespace, &header.run));
        let stage = if prepared.is_some() { Stage::Sweep } else { Stage::Backbone };
        let manifest = manifest(header, stage, rules.lease);
        let (decisions, decided) = channel();
        let engine = Arc::new(Decider::new(Engine::new(manifest.clone(), rules), decisions));
        let (news, told) = mpsc::unbounded_channel();
        let (state, changes) = watch::channel(RunState::new(manifest));
        let state = Arc::new(state);
        if let Some(prepared) = prepared {
            begin(prepared, &state, &engine);
        }
        let model_bytes = encode(&header.model);
        let orders = Orders::of(&model, &header.settings);
        let meters = Meters::default();
        let recent = Arc::new(Recent::default());
        let (counted, kept) = (meters.clone(), recent.clone());
        let served = Served { directory, model_bytes, orders, meters: meters.clone(), recent, state: changes.clone() };
        let presence = serve(session, &keys, served, engine.clone())
            .await
            .map_err(|error| Error::Other(format!("the run cannot be served on the bus: {error}")))?;
        let watching = connection.is_over_router.then(|| tokio::spawn(watch_link(session.clone(), engine.clone())));
        let announcing = tokio::spawn(announce(session.clone(), keys, told));
        tokio::spawn(tick(Arc::downgrade(&engine)));
        let updated = state.clone();
        let committing = spawn_blocking(move || {
            commit(store, &decided, &counted, |item| match item {
                News::Result(task, bytes) => kept.keep(task, bytes),
                News::Withdrawn(task) => kept.forget(&task),
                item => {
                    update(&updated, &item);
                    // Without whoever announces, those who want to know can still ask.
                    let _ = news.send(item);
                }
            })
        });
        Ok(Self { engine, state, changes, meters, presence, committing, announcing, watching })
    }

    /// Lets a sweep begin.
    pub fn begin(&self, prepared: Prepared) {
        begin(prepared, &self.state, &self.engine);
    }

    /// Tells the engine something.
    pub fn send(&self, event: Event) {
        // If the engine has ended, it says why when changes are waited for.
        self.engine.tell(event);
    }

    /// For whoever tells the engine something on the way.
    pub fn engine(&self) -> Arc<Decider> {
        self.engine.clone()
    }

    /// The run as it is, and what is counted: for whoever shows them.
    pub fn shown(&self) -> (watch::Receiver<RunState>, Meters) {
        (self.state.subscribe(), self.meters.clone())
    }

    /// Where the run is.
    pub fn stage(&self) -> Stage {
        self.changes.borrow().manifest.stage
    }

    /// How the run is doing.
    pub fn status(&self) -> Option<Status> {
        self.changes.borrow().status.clone()
    }

    /// Waits for a change of the run.
    ///
    /// # Errors
    /// If nothing can be decided or stored any more.
    pub async fn changed(&mut self) -> Result<(), Error> {
        tokio::select! {
            ended = &mut self.committing => Err(abnormal_end(ended)),
            // The sender lives as long as `self`.
            _ = self.changes.changed() => Ok(()),
        }
    }

    /// Waits until the run is somewhere.
    pub async fn reach(&mut self, is_reached: impl Fn(Stage) -> bool) -> Result<(), Error> {
        while !is_reached(self.stage()) {
            self.changed().await?;
        }
        Ok(())
    }

    /// Stops everything, in the order in which it depends on each other.
    ///
    /// # Errors
    /// If what was decided last cannot be stored.
    pub async fn stop(self) -> Result<(), Error> {
        // Without presence on the bus and this engine nothing is left to decide, and the store is closed.
        drop(self.presence);
        if let Some(watching) = self.watching {
            watching.abort();
        }
        drop(self.engine);
        if let Ok(Ok(Err(error))) = timeout(LAST_COMMIT, self.committing).await {
            return Err(error.into());
        }
        let _ = timeout(LAST_NEWS, self.announcing).await;
        Ok(())
    }
}

/// Shows what is known when the sweep begins, and lets it begin.
fn begin(prepared: Prepared, state: &watch::Sender<RunState>, engine: &Decider) {
    let Prepared { sweep, beginning } = prepared;
    state.send_modify(|state| state.sweep = Some(sweep));
    engine.tell(Event::Begin(Box::new(beginning)));
}

/// What is told is so from now on.
fn update(state: &watch::Sender<RunState>, news: &News) {
    match news {
        News::Manifest(manifest) => state.send_modify(|state| state.manifest = manifest.as_ref().clone()),
        News::Status(status) => state.send_modify(|state| {
            (state.status, state.told) = (Some(status.clone()), Instant::now());
        }),
        News::Load(load) => state.send_modify(|state| state.load = Some(load.as_ref().clone())),
        News::Result(..) | News::Withdrawn(_) | News::Done(_) | News::Hint | News::Wake(_) => {}
    }
}

fn abnormal_end(ended: Result<Result<(), StoreError>, JoinError>) -> Error {
    match ended {
        Ok(Err(error)) => error.into(),
        Ok(Ok(())) | Err(_) => {
            Error::Other("the engine of the run ended abnormally: this is a bug; the run can be resumed".into())
        }
    }
}
