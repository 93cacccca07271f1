//! Requests to the coordinator.

use crate::patience::{OutOfPatience, Patience};
use protocol::codec::{encode, encoding};
use protocol::from_worker::{FailRequest, Lease, LeaseRequest, Progress, ReleaseRequest, RenewRequest, SubmitRequest};
use protocol::ids::{RunId, TaskId, WorkerId};
use protocol::keys::Keys;
use protocol::session::{RequestError, fetch, request, request_encoded};
use protocol::to_everyone::{Manifest, StoredResult};
use protocol::to_worker::{Acknowledgement, LeaseReply, RenewReply, SubmitReply};
use std::time::Duration;
use zenoh::Session;
use zenoh::bytes::{Encoding, ZBytes};
use zenoh::qos::CongestionControl;

/// How long a small answer may take; it is asked for again afterwards.
const ANSWER: Duration = Duration::from_secs(5);
/// The slowest connection that results are sent over, bytes/s.
const SLOWEST: u64 = 1_000_000;

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

    /// Sends a result until it is answered.
    pub async fn submit(&self, task: &TaskId, result: &ZBytes) -> Result<SubmitReply, OutOfPatience> {
        let (key, encoding) = (self.keys.submit(task), encoding::<SubmitRequest>());
        let timeout = transfer(result.len());
        let send = || request_encoded(&self.session, &key, result.clone(), &encoding, timeout);
        loop {
            match self.insist(self.patience, send).await? {
                Ok(SubmitReply::Busy { retry_ms }) => tokio::time::sleep(Duration::from_millis(retry_ms)).await,
                Ok(reply) => return Ok(reply),
                Err(why) => return Ok(SubmitReply::Rejected { why }),
            }
        }
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
        fetch(&self.session, &self.keys.result(task), transfer(most)).await
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

/// How long so many bytes may take.
fn transfer(bytes: usize) -> Duration {
    ANSWER + Duration::from_secs(bytes as u64 / SLOWEST)
}
