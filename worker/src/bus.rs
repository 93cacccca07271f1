//! Requests to the coordinator.

use crate::patience::{OutOfPatience, Patience};
use protocol::codec::{encode, encoding};
use protocol::from_worker::{FailRequest, Lease, LeaseRequest, Progress, ReleaseRequest, RenewRequest, SubmitRequest};
use protocol::ids::{RunId, TaskId, WorkerId};
use protocol::keys::Keys;
use protocol::pieces::{PIECE, request_in_pieces};
use protocol::session::{RequestError, fetch, fetch_bulk, request};
use protocol::steps::PORTION;
use protocol::to_everyone::{Done, Manifest, StoredResult};
use protocol::to_worker::{Acknowledgement, Checkpoint, LeaseReply, RenewReply, SubmitReply};
use std::time::Duration;
use tokio::sync::{Semaphore, SemaphorePermit};
use zenoh::Session;
use zenoh::bytes::{Encoding, ZBytes};
use zenoh::qos::CongestionControl;

/// How long a small answer may take; it is asked for again afterwards.
pub const ANSWER: Duration = Duration::from_secs(5);
/// How long it may take besides until a result that has arrived is answered; it is sent again afterwards, and then waited for twice
/// as long.
const PATIENT: Duration = Duration::from_secs(30);
/// The slowest connection that results are sent over once, bytes/s.
pub const SLOWEST: u64 = 20_000;
/// A connection slower than that is not expected: whether a result has arrived is asked from then on.
const USUAL: u64 = 1_000_000;
/// There is a result of this task, this one or one like it.
const STORED: SubmitReply = SubmitReply::Duplicate { agrees: true };

/// The coordinator of a run, as a worker sees it.
pub struct Bus {
    /// Session.
    pub session: Session,
    /// Where the coordinator is.
    pub endpoint: String,
    /// Run.
    pub run: RunId,
    /// Keys of the run.
    pub keys: Keys,
    /// This worker.
    pub worker: WorkerId,
    /// How long to go on without an answer.
    pub patience: Duration,
    /// Whose turn it is to send something in pieces.
    pub bulk: Semaphore,
}

impl Bus {
    /// Asks for work.
    pub async fn lease(&self, slot: u32) -> Result<LeaseReply, RequestError> {
        let question = LeaseRequest {
            protocol: protocol::VERSION,
            program: protocol::PROGRAM.into(),
            worker: self.worker.clone(),
            slot,
        };
        request(&self.session, &self.keys.lease(), &question, ANSWER).await
    }

    /// Gives a sign of life.
    pub async fn renew(&self, lease: &Lease, progress: Option<Progress>) -> Result<RenewReply, RequestError> {
        let question = RenewRequest { lease: lease.clone(), progress };
        request(&self.session, &self.keys.renew(), &question, ANSWER).await
    }

    /// Sends a result until it is answered, or is known to be stored: a connection may be so slow, or a disk so busy, that an answer
    /// takes minutes. What is on its way is not sent once more as long as the connection holds.
    pub async fn submit(&self, task: &TaskId, result: &ZBytes) -> Result<SubmitReply, OutOfPatience> {
        let (key, encoding) = (self.keys.submit(task), encoding::<SubmitRequest>());
        let _turn = self.turn(result).await;
        let mut patience = Patience::new(self.patience);
        let mut timeout = PATIENT + transfer(result.len(), SLOWEST);
        loop {
            // At least as long as a small answer may take: nobody may be there, or only this one does not get through.
            let longest = timeout.min(patience.left().max(ANSWER));
            let reply = tokio::select! {
                reply = request_in_pieces(&self.session, &key, result, &encoding, longest) => reply,
                () = self.stored(task, ANSWER + transfer(result.len(), USUAL)) => return Ok(STORED),
            };
            match reply {
                Ok(SubmitReply::Busy { retry_ms }) => {
                    patience.restore();
                    tokio::time::sleep(Duration::from_millis(retry_ms)).await;
                }
                Ok(reply) => return Ok(reply),
                Err(error @ (RequestError::Refused(_) | RequestError::Codec(_))) => {
                    return Ok(SubmitReply::Rejected { why: error.to_string() });
                }
                Err(RequestError::NoReply | RequestError::Closed(_)) => {
                    patience.pause().await?;
                    if self.is_stored(task).await {
                        return Ok(STORED);
                    }
                    timeout = timeout.saturating_mul(2);
                }
            }
        }
    }

    /// Waits until nothing else is sent in pieces, if this is to be.
    pub async fn turn(&self, message: &ZBytes) -> Option<SemaphorePermit<'_>> {
        if message.len() > PIECE { self.bulk.acquire().await.ok() } else { None }
    }

    /// Waits until a task is known to have a stored result; looks for it for the first time after so long, and less and less often.
    async fn stored(&self, task: &TaskId, first: Duration) {
        let mut pause = first;
        loop {
            tokio::time::sleep(pause).await;
            if self.is_stored(task).await {
                return;
            }
            pause *= 2;
        }
    }

    async fn is_stored(&self, task: &TaskId) -> bool {
        fetch::<Done>(&self.session, &self.keys.done(task), ANSWER).await.is_ok()
    }

    /// Reports that a task cannot be carried out, at least once and until it is answered.
    pub async fn fail(&self, lease: &Lease, reason: &str, patience: Duration) -> Result<(), OutOfPatience> {
        let question = FailRequest { lease: lease.clone(), reason: reason.to_string() };
        let key = self.keys.fail();
        let send = || request::<_, Acknowledgement>(&self.session, &key, &question, ANSWER);
        self.insist(patience, send)
            .await?
            .map_or_else(|why| tracing::warn!(task = %lease.task, why, "failure refused"), drop);
        Ok(())
    }

    /// Gives a task back. Tried once: if it does not arrive, the lease runs out.
    pub async fn release(&self, lease: &Lease) {
        let question = ReleaseRequest { lease: lease.clone() };
        let reply = request::<_, Acknowledgement>(&self.session, &self.keys.release(), &question, ANSWER).await;
        if let Err(error) = reply {
            tracing::debug!(task = %lease.task, %error, "not given back");
        }
    }

    /// The manifest as it is now.
    pub async fn manifest(&self) -> Result<Manifest, RequestError> {
        fetch(&self.session, &self.keys.run(), ANSWER).await
    }

    /// A stored result of at most so many bytes.
    pub async fn result(&self, task: &TaskId, most: usize) -> Result<StoredResult, RequestError> {
        fetch_bulk(&self.session, &self.keys.result(task), ANSWER + transfer(most, USUAL)).await
    }

    /// The steps that earlier attempts at a task took from the one with this number on, as many as one answer holds.
    pub async fn checkpoint(&self, task: &TaskId, first: usize) -> Result<Checkpoint, RequestError> {
        fetch_bulk(&self.session, &self.keys.checkpoint_from(task, first), ANSWER + transfer(2 * PORTION, USUAL)).await
    }

    /// Tells people where a branch is; lost if there is no room on the way.
    pub async fn show(&self, task: &TaskId, progress: &Progress) {
        let put = self.session.put(self.keys.progress(task), encode(progress));
        let put = put.encoding(Encoding::from(encoding::<Progress>())).congestion_control(CongestionControl::Drop);
        if let Err(error) = put.await {
            tracing::debug!(%task, %error, "progress not shown");
        }
    }

    /// Repeats a request until it is answered, if by a refusal in words.
    async fn insist<R, F>(&self, patience: Duration, send: impl Fn() -> F) -> Result<Result<R, String>, OutOfPatience>
    where
        F: Future<Output = Result<R, RequestError>>,
    {
        let mut patience = Patience::new(patience);
        loop {
            match send().await {
                Ok(reply) => return Ok(Ok(reply)),
                Err(error @ (RequestError::Refused(_) | RequestError::Codec(_))) => return Ok(Err(error.to_string())),
                Err(RequestError::NoReply | RequestError::Closed(_)) => patience.pause().await?,
            }
        }
    }
}

/// How long so many bytes take at a speed, bytes/s.
pub fn transfer(bytes: usize, speed: u64) -> Duration {
    Duration::from_millis(1000 * bytes as u64 / speed)
}
