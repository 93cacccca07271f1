//! Asking for work until there is some, or no more.

use crate::error::WorkerError;
use crate::patience::{OutOfPatience, Patience};
use crate::shared::Shared;
use crate::shutdown::Phase;
use crate::turns::{STEADY, Turn, Turns};
use protocol::from_worker::{LANES, Lease};
use protocol::session::RequestError;
use protocol::to_everyone::Stage;
use protocol::to_worker::{Grant, LeaseReply};
use std::hash::{BuildHasher, RandomState};
use std::sync::atomic::Ordering;
use std::time::Duration;

/// How much longer a request may take when the worker ends: a result at hand should arrive, a lease not be left behind.
pub const LAST_WORDS: Duration = Duration::from_secs(2);
/// The shortest wait between two requests for work that was not there.
const SHORTEST_WAIT: Duration = Duration::from_millis(5);

/// What comes of asking for work.
enum Next {
    /// A task.
    Task(Box<Grant>),
    /// There is none yet, and another lane of the thread has one.
    GiveWay,
    /// There is no more, or the worker takes no more.
    Over,
}

/// The next task of `slot`, with its turn unless the task was at hand and the turn is still to be waited for; `None` if there is no more
/// for it. Lanes beyond the first ones take no tasks while these are long, and give back what they have at hand: it would wait behind them.
///
/// # Errors
/// If the coordinator has no work for this worker, ever, or is gone for longer than patience lasts.
pub async fn next_task(
    shared: &Shared,
    slot: u32,
    turns: &Turns,
    at_hand: Option<Grant>,
) -> Result<Option<(Grant, Option<Turn>)>, WorkerError> {
    let is_spare = slot % LANES >= STEADY;
    match at_hand {
        Some(grant) if is_spare && !turns.are_brief() => release(shared, &lease_of(shared, slot, &grant)).await,
        Some(grant) => return Ok(take(shared, slot, grant).await.map(|grant| (grant, None))),
        None => {}
    }
    loop {
        if is_spare && !turns.become_brief().await {
            return Ok(None);
        }
        let turn = turns.take().await;
        if is_spare && !turns.are_brief() {
            continue;
        }
        match next(shared, slot, turns).await? {
            Next::Task(grant) => return Ok(Some((*grant, Some(turn)))),
            Next::GiveWay => {}
            Next::Over => return Ok(None),
        }
    }
}

/// Asks for work for `slot`, whose turn it is, until there is some or somebody else wants the turn.
async fn next(shared: &Shared, slot: u32, turns: &Turns) -> Result<Next, WorkerError> {
    let mut patience = Patience::new(shared.bus.patience);
    let mut wakes = shared.wakes.subscribe();
    while !shared.is_over() {
        // A hint that comes while this request is answered is not missed.
        wakes.mark_unchanged();
        let reply = tokio::select! {
            reply = shared.bus.lease(slot) => reply,
            () = shared.shutdown.reached_for(Phase::Finishing, LAST_WORDS) => break,
        };
        match reply {
            Ok(LeaseReply::Grant(grant)) => {
                if let Some(grant) = take(shared, slot, grant).await {
                    return Ok(Next::Task(Box::new(grant)));
                }
            }
            Ok(LeaseReply::Wait { retry_ms }) => {
                patience.restore();
                let pause = jittered(Duration::from_millis(retry_ms)).min(shared.note_idle());
                tokio::select! {
                    () = shared.rest(pause.max(SHORTEST_WAIT), &mut wakes) => {}
                    () = turns.is_wanted() => return Ok(Next::GiveWay),
                }
            }
            Ok(LeaseReply::Drained) => {
                shared.drained.send_replace(true);
            }
            Ok(LeaseReply::Stop { reason }) => stop(shared, reason).await?,
            Err(error @ (RequestError::Refused(_) | RequestError::Codec(_))) => {
                return Err(shared.refused(error.to_string()));
            }
            Err(RequestError::NoReply | RequestError::Closed(_)) => {
                let pause = patience.next_pause().map_err(|OutOfPatience| shared.abandoned())?;
                shared.rest(pause, &mut wakes).await;
            }
        }
    }
    Ok(Next::Over)
}

/// Takes a task that was handed out, or gives it back if the worker takes no more.
async fn take(shared: &Shared, slot: u32, grant: Grant) -> Option<Grant> {
    if shared.shutdown.phase() > Phase::Working {
        release(shared, &lease_of(shared, slot, &grant)).await;
        return None;
    }
    Some(grant)
}

/// A pause shortened by up to a quarter: workers that were told to wait at the same time do not come back at the same time.
fn jittered(pause: Duration) -> Duration {
    let share = RandomState::new().hash_one(()) as f64 / u64::MAX as f64;
    pause.mul_f64(1.0 - share / 4.0)
}

/// There is no work for this worker, ever: an ordinary end if the run was cancelled.
async fn stop(shared: &Shared, reason: String) -> Result<(), WorkerError> {
    if notice_cancelled(shared).await {
        return Ok(());
    }
    Err(shared.refused(reason))
}

/// Asks whether the run was cancelled.
pub async fn notice_cancelled(shared: &Shared) -> bool {
    let cancelled = shared.bus.manifest().await.is_ok_and(|manifest| manifest.stage == Stage::Cancelled);
    if cancelled {
        shared.cancelled.store(true, Ordering::Relaxed);
    }
    cancelled
}

/// Whose the task of a grant is: of `slot`.
pub fn lease_of(shared: &Shared, slot: u32, grant: &Grant) -> Lease {
    Lease { task: grant.task.clone(), attempt: grant.attempt, worker: shared.bus.worker.clone(), slot }
}

/// Gives a task back.
pub async fn release(shared: &Shared, lease: &Lease) {
    tokio::select! {
        () = shared.bus.release(lease) => {}
        () = shared.shutdown.reached_for(Phase::Stopping, LAST_WORDS) => {}
    }
}
