//! Half of a computing thread's work: lease, trace, submit. The other half goes on meanwhile: while the result of one lane is on its
//! way, maybe a long one, and until it is stored, the other lane computes; where tasks are brief there are more lanes than two.

use crate::checkpoints;
use crate::compute::{Computed, Computer, Finished, Job, Watch};
use crate::error::WorkerError;
use crate::findings::{Findings, Found};
use crate::leasing::{LAST_WORDS, lease_of, next_task, notice_cancelled, release};
use crate::patience::OutOfPatience;
use crate::renewal::{Interruption, keep};
use crate::shared::Shared;
use crate::shutdown::Phase;
use crate::turns::{Turn, Turns};
use protocol::from_worker::{LANES, Lease};
use protocol::to_worker::{Grant, SubmitReply};
use solver::response::task::{FoldPlace, Task, TaskResult};
use std::pin::{Pin, pin};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use zenoh::bytes::ZBytes;

/// Works with computing thread `number` until all is done, the run is cancelled, there is nothing to do for too long, or the worker
/// is told to end; the first error counts, once both lanes have ended.
pub async fn work_with_thread(shared: Arc<Shared>, number: u32) -> Result<(), WorkerError> {
    let computer = Computer::start(number, shared.orders.clone())
        .map_err(|source| WorkerError::System { what: "start a computing thread", source })?;
    let (computer, turns) = (Arc::new(computer), Arc::new(Turns::default()));
    let [first, second, third, fourth] = [0, 1, 2, 3].map(|lane| {
        let slot = LANES * number + lane;
        let known = Findings::new(shared.size, shared.harmonics, shared.max_result_bytes);
        Lane { shared: shared.clone(), slot, computer: computer.clone(), turns: turns.clone(), known }.run()
    });
    let steady = async {
        let (first, second) = tokio::join!(first, second);
        turns.end();
        first.and(second)
    };
    let (steady, third, fourth) = tokio::join!(steady, third, fourth);
    steady.and(third).and(fourth)
}

/// One of those that take turns on a computing thread.
struct Lane {
    shared: Arc<Shared>,
    slot: u32,
    computer: Arc<Computer>,
    turns: Arc<Turns>,
    known: Findings,
}

impl Lane {
    async fn run(mut self) -> Result<(), WorkerError> {
        let mut at_hand = None;
        loop {
            let Some((grant, turn)) = next_task(&self.shared, self.slot, &self.turns, at_hand).await? else {
                return Ok(());
            };
            at_hand = self.execute(grant, turn).await?;
        }
    }

    /// Carries out a task, once it is this lane's turn; the next one may come with the acknowledgement.
    async fn execute(&mut self, grant: Grant, mut turn: Option<Turn>) -> Result<Option<Grant>, WorkerError> {
        let shared = self.shared.clone();
        let _busy = shared.begin();
        let (lease, watch) = (lease_of(&self.shared, self.slot, &grant), Arc::new(Watch::default()));
        tracing::debug!(task = %lease.task, attempt = %lease.attempt, slot = self.slot, "leased");
        let ttl = Duration::from_millis(grant.ttl_ms);
        let (hints, drained) = (shared.hints.subscribe(), shared.drained.subscribe());
        // Only what walks has steps.
        let given = grant.work.is_ordered() || matches!(grant.work, Task::Scout(_));
        let given = if given { grant.fingerprint() } else { String::new() };
        // Dropped with the computation, and with it its turn on the way that the result takes.
        let send = async { after(pin!(checkpoints::send(&shared.bus, &lease, &given, watch.unsent()))).await };
        let mut keep = pin!(keep(&shared.bus, &lease, ttl, &watch, hints, drained));
        let computed = tokio::select! {
            // What is computed counts, even if it is interrupted at the same time.
            biased;
            computed = self.compute(grant, &lease, &watch, &mut turn) => computed.ok_or(Interruption::Stopping),
            interruption = &mut keep => Err(interruption),
            never = send => match never {},
            () = shared.shutdown.reached(Phase::Stopping) => Err(Interruption::Stopping),
        };
        let computed = match computed {
            Ok(computed) => computed,
            Err(interruption) => {
                self.give_up(&lease, &watch, interruption, turn.is_some()).await?;
                return Ok(None);
            }
        };
        drop(turn);
        // What is computed is delivered, whatever becomes of the lease.
        tokio::select! {
            delivered = self.deliver(&lease, computed) => delivered,
            never = after(keep) => match never {},
            () = shared.shutdown.reached_for(Phase::Stopping, LAST_WORDS) => {
                tracing::warn!(task = %lease.task, "the result was not taken in time, the worker ends");
                Ok(None)
            }
        }
    }

    /// Computes a task, in its turn; `None` if the worker is told to end before that.
    async fn compute(
        &mut self,
        grant: Grant,
        lease: &Lease,
        watch: &Arc<Watch>,
        turn: &mut Option<Turn>,
    ) -> Option<Computed> {
        let job = match self.prepare(grant, lease).await {
            Ok(job) => job,
            Err(reason) => return Some(Computed::Failed(reason)),
        };
        if turn.is_none() {
            tokio::select! {
                taken = self.turns.take_with_task() => *turn = Some(taken),
                () = self.shared.shutdown.reached(Phase::Finishing) => return None,
            }
        }
        let begin = Instant::now();
        let computed = self.computer.compute(job, watch.clone()).await;
        self.turns.note(begin.elapsed());
        Some(computed)
    }

    /// Everything that a task needs.
    async fn prepare(&mut self, grant: Grant, lease: &Lease) -> Result<Job, String> {
        let shared = &self.shared;
        let seeds = grant.seeds.seeds(&shared.size).map_err(|error| format!("unusable seeds: {error}"))?;
        let harmonics = shared.harmonics;
        if let Some(seed) = seeds.iter().find(|seed| seed.state.harmonics != harmonics) {
            return Err(format!("unusable seeds: {} harmonics in a run of {harmonics}", seed.state.harmonics));
        }
        if seeds.is_empty() && matches!(grant.work, Task::Land(_)) {
            return Err("unusable seeds: there is none".into());
        }
        let lands = matches!(grant.work, Task::Seed(_) | Task::Begin(_) | Task::Fold(FoldPlace::Scout { .. }));
        if grant.landing.is_none() && lands {
            return Err("unusable task: there is no landing".into());
        }
        let Found { landings, branches: known, curves } = self.known.get(&shared.bus, lease, &grant).await?;
        let most = shared.max_checkpoint_bytes;
        let before = checkpoints::taken_before(&shared.bus, lease, &grant).await;
        let Grant { amplitude, order, reach, work, .. } = grant;
        Ok(Job { lease: lease.clone(), amplitude, order, reach, work, seeds, landings, known, curves, before, most })
    }

    async fn deliver(&mut self, lease: &Lease, computed: Computed) -> Result<Option<Grant>, WorkerError> {
        let patience = self.shared.bus.patience;
        let (reason, patience) = match computed {
            Computed::Stopped => return Ok(None),
            Computed::Failed(reason) => (reason, patience),
            Computed::Finished(finished) => {
                let Finished { payload, finding, summary } = *finished;
                let size = payload.len();
                match self.submit(lease, payload, finding, &summary).await {
                    Ok(Ok(next)) => return Ok(next),
                    Ok(Err(reason)) => (reason, patience),
                    // Nobody is there, or only this result does not get through: one more request tells.
                    Err(OutOfPatience) => {
                        let seconds = patience.as_secs_f64();
                        (format!("the result of {size} bytes was not answered for {seconds} s"), Duration::ZERO)
                    }
                }
            }
        };
        tracing::warn!(task = %lease.task, attempt = %lease.attempt, reason, "failed");
        self.shared.bus.fail(lease, &reason, patience).await.map_err(|OutOfPatience| self.shared.abandoned())?;
        Ok(None)
    }

    /// Sends a result until it is answered, maybe with the next task; gives the reason if the task fails by the answer.
    async fn submit(
        &mut self,
        lease: &Lease,
        payload: Vec<u8>,
        finding: TaskResult,
        summary: &str,
    ) -> Result<Result<Option<Grant>, String>, OutOfPatience> {
        let (size, most) = (payload.len(), self.shared.max_result_bytes);
        if size > most {
            return Ok(Err(format!("the result has {size} bytes, this run accepts {most}")));
        }
        let mut next = None;
        match self.shared.bus.submit(&lease.task, &ZBytes::from(payload)).await? {
            SubmitReply::Rejected { why } => return Ok(Err(format!("the result was rejected: {why}"))),
            SubmitReply::Busy { .. } => unreachable!("sent again until there is room"),
            reply @ (SubmitReply::Accepted | SubmitReply::Next(_)) => {
                tracing::info!(task = %lease.task, "{summary}");
                self.known.add(lease.task.clone(), finding);
                if let SubmitReply::Next(grant) = reply {
                    next = Some(*grant);
                }
            }
            SubmitReply::Duplicate { agrees: true } => {
                tracing::info!(task = %lease.task, "{summary}; there was a result already");
            }
            SubmitReply::Duplicate { agrees: false } => {
                tracing::warn!(task = %lease.task, "{summary}; another result of this task says something else");
            }
        }
        self.shared.done.fetch_add(1, Ordering::Relaxed);
        Ok(Ok(next))
    }

    /// Stops computing a task that is no longer worth it, and waits until the thread is free if it was begun.
    async fn give_up(
        &self,
        lease: &Lease,
        watch: &Watch,
        interruption: Interruption,
        is_begun: bool,
    ) -> Result<(), WorkerError> {
        watch.stop();
        tracing::info!(task = %lease.task, attempt = %lease.attempt, reason = ?interruption, "given up");
        match interruption {
            Interruption::Lost => {}
            Interruption::Abandoned => return Err(self.shared.abandoned()),
            Interruption::Stopping => {
                release(&self.shared, lease).await;
                return Ok(());
            }
            Interruption::Cancelled => {
                // Asked for before the task is given back: the coordinator may end after that.
                notice_cancelled(&self.shared).await;
                release(&self.shared, lease).await;
            }
        }
        if is_begun {
            tokio::select! {
                () = self.computer.idle() => {}
                () = self.shared.shutdown.reached(Phase::Stopping) => {}
            }
        }
        Ok(())
    }
}

/// Lets a future end, and never does itself.
async fn after<T>(future: Pin<&mut impl Future<Output = T>>) -> std::convert::Infallible {
    future.await;
    std::future::pending().await
}
