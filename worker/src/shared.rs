//! What the computing threads of a worker share.

use crate::bus::Bus;
use crate::error::WorkerError;
use crate::join::Joined;
use crate::shutdown::{Phase, Shutdown};
use protocol::curve::Size;
use solver::response::orders::Orders;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::watch;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Subscriber;
use zenoh::sample::{Sample, SampleKind};

/// What the computing threads of a worker share.
pub struct Shared {
    /// The coordinator.
    pub bus: Bus,
    /// The model with its numerics, for every order of motions.
    pub orders: Orders,
    /// Its size.
    pub size: Size,
    /// Number of harmonics H.
    pub harmonics: usize,
    /// Largest result accepted, bytes.
    pub max_result_bytes: usize,
    /// Most steps kept of a task, bytes.
    pub max_checkpoint_bytes: usize,
    /// Ending when told to.
    pub shutdown: Shutdown,
    /// The coordinator's hints to ask for orders.
    pub hints: watch::Sender<()>,
    /// The coordinator's hints that there may be work.
    pub wakes: watch::Sender<()>,
    /// Whether all work of the run is done.
    pub drained: watch::Sender<bool>,
    /// Whether the run was cancelled.
    pub cancelled: AtomicBool,
    /// Whether there was nothing to do for too long.
    pub idle: watch::Sender<bool>,
    /// How long is too long, if anything is.
    idle_exit: Option<Duration>,
    /// Tasks under way, and since when there is none.
    activity: Mutex<Activity>,
    /// Tasks done.
    pub done: AtomicUsize,
}

/// Whether any computing thread has something to do.
struct Activity {
    tasks: usize,
    since: Instant,
}

/// A thread with something to do, until it is dropped.
pub struct Busy<'s>(&'s Shared);

impl Drop for Busy<'_> {
    fn drop(&mut self) {
        let mut activity = self.0.activity();
        activity.tasks -= 1;
        activity.since = Instant::now();
    }
}

/// Makes the worker visible and reachable; gone with the session.
pub struct Presence {
    _token: LivelinessToken,
    _hints: Subscriber<()>,
    _wakes: Subscriber<()>,
    _coordinator: Subscriber<()>,
}

impl Shared {
    /// Of a worker that has joined a run.
    pub fn new(bus: Bus, joined: Joined, shutdown: Shutdown, idle_exit: Option<Duration>) -> Self {
        let Joined { manifest, model } = joined;
        Self {
            bus,
            size: Size::of(&model),
            orders: Orders::of(&model, &manifest.settings),
            harmonics: manifest.settings.harmonics.count,
            max_result_bytes: manifest.max_result_bytes,
            max_checkpoint_bytes: manifest.max_checkpoint_bytes(),
            shutdown,
            hints: watch::Sender::new(()),
            wakes: watch::Sender::new(()),
            drained: watch::Sender::new(false),
            cancelled: AtomicBool::new(false),
            idle: watch::Sender::new(false),
            idle_exit,
            activity: Mutex::new(Activity { tasks: 0, since: Instant::now() }),
            done: AtomicUsize::new(0),
        }
    }

    /// Announces the worker and listens to hints.
    pub async fn appear(&self) -> Result<Presence, WorkerError> {
        let refused = |error: zenoh::Error| self.refused(error.to_string());
        let (hints, wakes) = (self.hints.clone(), self.wakes.clone());
        let (session, keys) = (&self.bus.session, &self.bus.keys);
        let hint = move || {
            hints.send_modify(|()| {});
            wakes.send_modify(|()| {});
        };
        let hint_again = hint.clone();
        let hints = session.declare_subscriber(keys.hint()).callback(move |_| hint()).await.map_err(refused)?;
        let wakes = self.wakes.clone();
        let work =
            session.declare_subscriber(keys.wake(&self.bus.worker)).callback(move |_| wakes.send_modify(|()| {}));
        let wakes = work.await.map_err(refused)?;
        // When the way there is back, the first sign of life is given at once.
        let back = move |sample: Sample| {
            if sample.kind() == SampleKind::Put {
                hint_again();
            }
        };
        let coordinator = session.liveliness().declare_subscriber(keys.alive_coordinator()).callback(back);
        let coordinator = coordinator.await.map_err(refused)?;
        let token = session.liveliness().declare_token(keys.alive_worker(&self.bus.worker));
        Ok(Presence { _token: token.await.map_err(refused)?, _hints: hints, _wakes: wakes, _coordinator: coordinator })
    }

    fn activity(&self) -> MutexGuard<'_, Activity> {
        self.activity.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A thread has something to do.
    pub fn begin(&self) -> Busy<'_> {
        self.activity().tasks += 1;
        Busy(self)
    }

    /// There is nothing to do now: if it has been so for too long, for all threads, the worker ends. Otherwise, when to look again.
    pub fn note_idle(&self) -> Duration {
        let Some(longest) = self.idle_exit else { return Duration::MAX };
        let activity = self.activity();
        if activity.tasks > 0 {
            return longest;
        }
        let left = longest.saturating_sub(activity.since.elapsed());
        if left.is_zero() {
            self.idle.send_replace(true);
        }
        left
    }

    /// Whether to lease no more: nothing left, cancelled, idle for too long, or told to end.
    pub fn is_over(&self) -> bool {
        *self.drained.borrow()
            || *self.idle.borrow()
            || self.cancelled.load(Ordering::Relaxed)
            || self.shutdown.phase() > Phase::Working
    }

    /// Waits, but not longer than until there is something to ask, also since `wakes` was last looked at, or it is over.
    pub async fn rest(&self, duration: Duration, wakes: &mut watch::Receiver<()>) {
        let (mut drained, mut idle) = (self.drained.subscribe(), self.idle.subscribe());
        tokio::select! {
            () = tokio::time::sleep(duration) => {}
            _ = wakes.changed() => {}
            _ = drained.wait_for(|drained| *drained) => {}
            _ = idle.wait_for(|idle| *idle) => {}
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
