//! What the computing threads of a worker share.

use crate::bus::Bus;
use crate::error::WorkerError;
use crate::join::Joined;
use crate::shutdown::{Phase, Shutdown};
use protocol::curve::Size;
use solver::settings::Settings;
use solver::structure::Model;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;
use tokio::sync::watch;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Subscriber;
use zenoh::sample::{Sample, SampleKind};

/// What the computing threads of a worker share.
pub struct Shared {
    /// The coordinator.
    pub bus: Bus,
    /// The model.
    pub model: Arc<Model>,
    /// Its size.
    pub size: Size,
    /// Numerics.
    pub settings: Settings,
    /// Largest result accepted, bytes.
    pub max_result_bytes: usize,
    /// Ending when told to.
    pub shutdown: Shutdown,
    /// The coordinator's hints to ask for orders.
    pub hints: watch::Sender<()>,
    /// Whether all work of the run is done.
    pub drained: watch::Sender<bool>,
    /// Whether the run was cancelled.
    pub cancelled: AtomicBool,
    /// Tasks done.
    pub done: AtomicUsize,
}

/// Makes the worker visible and reachable; gone with the session.
pub struct Presence {
    _token: LivelinessToken,
    _hints: Subscriber<()>,
    _coordinator: Subscriber<()>,
}

impl Shared {
    /// Of a worker that has joined a run.
    pub fn new(bus: Bus, joined: Joined, shutdown: Shutdown) -> Self {
        let Joined { manifest, model } = joined;
        Self {
            bus,
            size: Size::of(&model),
            model: Arc::new(model),
            settings: manifest.settings,
            max_result_bytes: manifest.max_result_bytes,
            shutdown,
            hints: watch::Sender::new(()),
            drained: watch::Sender::new(false),
            cancelled: AtomicBool::new(false),
            done: AtomicUsize::new(0),
        }
    }

    /// Announces the worker and listens to hints.
    pub async fn appear(&self) -> Result<Presence, WorkerError> {
        let refused = |error: zenoh::Error| self.refused(error.to_string());
        let hints = self.hints.clone();
        let session = &self.bus.session;
        let subscriber = session.declare_subscriber(self.bus.keys.hint()).callback(move |_| hints.send_modify(|()| {}));
        let hints = subscriber.await.map_err(refused)?;
        // When the way there is back, the first sign of life is given at once.
        let hints_again = self.hints.clone();
        let back = move |sample: Sample| {
            if sample.kind() == SampleKind::Put {
                hints_again.send_modify(|()| {});
            }
        };
        let coordinator = session.liveliness().declare_subscriber(self.bus.keys.alive_coordinator()).callback(back);
        let coordinator = coordinator.await.map_err(refused)?;
        let token = session.liveliness().declare_token(self.bus.keys.alive_worker(&self.bus.worker));
        Ok(Presence { _token: token.await.map_err(refused)?, _hints: hints, _coordinator: coordinator })
    }

    /// Whether to lease no more: nothing left, cancelled, or told to end.
    pub fn is_over(&self) -> bool {
        *self.drained.borrow() || self.cancelled.load(Ordering::Relaxed) || self.shutdown.phase() > Phase::Working
    }

    /// Waits, but not longer than until there is something to ask or it is over.
    pub async fn rest(&self, duration: Duration) {
        let (mut hints, mut drained) = (self.hints.subscribe(), self.drained.subscribe());
        tokio::select! {
            () = tokio::time::sleep(duration) => {}
            _ = hints.changed() => {}
            _ = drained.wait_for(|drained| *drained) => {}
            () = self.shutdown.reached(Phase::Finishing) => {}
        }
    }

    /// The coordinator has no work for this worker.
    pub fn refused(&self, reason: String) -> WorkerError {
        WorkerError::Refused { endpoint: self.bus.endpoint.clone(), run: self.bus.run.clone(), reason }
    }

    /// The coordinator is gone.
    pub fn abandoned(&self) -> WorkerError {
        let Bus { endpoint, run, patience, .. } = &self.bus;
        WorkerError::Abandoned { endpoint: endpoint.clone(), run: run.clone(), patience: *patience }
    }
}
