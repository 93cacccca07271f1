//! Ending when told to: signals, lifeline, grace.

use crate::error::WorkerError;
use std::io::Read;
use std::sync::Arc;
use std::time::Duration;
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::{oneshot, watch};

/// How far the ending of the worker has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// Not begun.
    Working,
    /// Branches under way may be finished, no more are begun.
    Finishing,
    /// Branches under way are given back.
    Stopping,
}

/// Tells everyone how far the ending has come.
#[derive(Debug, Clone)]
pub struct Shutdown(Arc<watch::Sender<Phase>>);

impl Default for Shutdown {
    fn default() -> Self {
        Self(Arc::new(watch::Sender::new(Phase::Working)))
    }
}

impl Shutdown {
    /// Begins the ending: at once, or after a time of grace.
    pub fn begin(&self, grace: Duration) {
        if grace.is_zero() {
            return self.advance(Phase::Stopping);
        }
        self.advance(Phase::Finishing);
        let this = self.clone();
        tokio::spawn(async move {
            tokio::time::sleep(grace).await;
            this.advance(Phase::Stopping);
        });
    }

    fn advance(&self, phase: Phase) {
        self.0.send_modify(|current| *current = phase.max(*current));
    }

    /// How far it has come.
    pub fn phase(&self) -> Phase {
        *self.0.borrow()
    }

    /// Waits until it has come so far.
    pub async fn reached(&self, phase: Phase) {
        // The sender lives as long as `self`.
        let _ = self.0.subscribe().wait_for(|current| *current >= phase).await;
    }

    /// Waits until it has come so far, and for `extra` longer.
    pub async fn reached_for(&self, phase: Phase, extra: Duration) {
        self.reached(phase).await;
        tokio::time::sleep(extra).await;
    }
}

/// Begins the ending at a signal, or when standard input ends if that is the lifeline. A second signal ends the process.
pub fn listen(shutdown: &Shutdown, grace: Duration, lifeline: bool) -> Result<(), WorkerError> {
    let system = |source| WorkerError::System { what: "listen to signals", source };
    let mut terminate = signal(SignalKind::terminate()).map_err(system)?;
    let mut interrupt = signal(SignalKind::interrupt()).map_err(system)?;
    let cut = if lifeline { Some(end_of_input().map_err(system)?) } else { None };
    let shutdown = shutdown.clone();
    tokio::spawn(async move {
        let cut = async {
            match cut {
                Some(cut) => drop(cut.await),
                None => std::future::pending().await,
            }
        };
        tokio::pin!(cut);
        let (mut is_signalled, mut is_cut) = (false, false);
        loop {
            let code = tokio::select! {
                _ = terminate.recv() => 143,
                // Of a terminal's Ctrl-C the whole process group hears: whoever holds the lifeline decides.
                _ = interrupt.recv(), if !lifeline => 130,
                () = &mut cut, if !is_cut => {
                    is_cut = true;
                    tracing::debug!("lifeline cut");
                    shutdown.begin(grace);
                    continue;
                }
            };
            if is_signalled {
                std::process::exit(code);
            }
            is_signalled = true;
            tracing::info!("told to end");
            shutdown.begin(grace);
        }
    });
    Ok(())
}

/// Reports the end of standard input. A plain thread: a read that blocks cannot be cancelled, and the runtime would wait
/// for it at the end.
fn end_of_input() -> std::io::Result<oneshot::Receiver<()>> {
    let (sender, receiver) = oneshot::channel();
    std::thread::Builder::new().name("lifeline".into()).spawn(move || {
        let mut buffer = [0; 64];
        let mut input = std::io::stdin().lock();
        loop {
            match input.read(&mut buffer) {
                Ok(1..) => {}
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Ok(0) | Err(_) => break,
            }
        }
        let _ = sender.send(());
    })?;
    Ok(receiver)
}
