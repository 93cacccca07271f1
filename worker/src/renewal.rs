//! Signs of life of a task under way.

use crate::bus::Bus;
use crate::compute::Watch;
use crate::patience::Patience;
use protocol::from_worker::{Lease, Progress};
use protocol::session::RequestError;
use protocol::to_worker::RenewReply;
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::{Instant, sleep_until};

/// Progress is shown no more often.
const SHOWN: Duration = Duration::from_millis(500);

/// Why a task is no longer worth computing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interruption {
    /// Done, or somebody else's.
    Lost,
    /// The run was cancelled or stops.
    Cancelled,
    /// The coordinator was gone for longer than patience lasts.
    Abandoned,
    /// This worker ends.
    Stopping,
}

/// Keeps a lease alive, three times as often as needed and at every hint, and shows progress, until the task is no longer
/// worth computing. `hints` tells of hints, `drained` that all work of the run is done.
pub async fn keep(
    bus: &Bus,
    lease: &Lease,
    ttl: Duration,
    watch: &Watch,
    mut hints: watch::Receiver<()>,
    drained: watch::Receiver<bool>,
) -> Interruption {
    let period = (ttl / 3).max(Duration::from_millis(10));
    let mut patience = Patience::new(bus.patience);
    let (mut renew_at, mut show_at) = (Instant::now() + period, Instant::now() + SHOWN);
    let mut shown: Option<Progress> = None;
    loop {
        tokio::select! {
            () = sleep_until(renew_at) => {}
            Ok(()) = hints.changed() => {}
            () = sleep_until(show_at) => {
                let progress = watch.progress();
                if let Some(progress) = &progress && shown.as_ref() != Some(progress) {
                    bus.show(&lease.task, progress).await;
                }
                (shown, show_at) = (progress, Instant::now() + SHOWN);
                continue;
            }
        }
        let pause = match bus.renew(lease, watch.progress()).await {
            Ok(RenewReply::Ok) => {
                patience.restore();
                period
            }
            Ok(RenewReply::Lost) => return Interruption::Lost,
            Ok(RenewReply::Cancel) => return Interruption::Cancelled,
            Err(RequestError::NoReply) if *drained.borrow() => return Interruption::Lost,
            Err(error) => {
                tracing::debug!(task = %lease.task, %error, "sign of life");
                let Ok(pause) = patience.next_pause() else { return Interruption::Abandoned };
                pause.min(period)
            }
        };
        renew_at = Instant::now() + pause;
    }
}
