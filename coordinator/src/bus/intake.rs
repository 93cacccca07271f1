//! Results on their way in: only of what was handed out, no more bytes at a time than there is room for, checked against the
//! equations on the blocking pool, and then handed to the engine.

use super::answers::{Answers, reply, respond};
use super::held::Held;
use super::pieces::{Arrived, Pieces};
use crate::engine::{CheckedResult, Decider, Event, Expected, Meters, Offer};
use protocol::from_worker::SubmitRequest;
use protocol::ids::TaskId;
use protocol::session::{answer, encoding_of, refuse};
use protocol::to_worker::SubmitReply;
use solver::response::orders::Orders;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use std::time::Instant;
use tokio::runtime::Handle;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use zenoh::bytes::ZBytes;
use zenoh::query::Query;

/// Most results that are checked at a time.
const CHECKED: usize = 4;
/// What room is measured in, bytes.
const UNIT: usize = 1 << 10;
/// When to send a result again for which there is no room, ms.
const BUSY_MS: u64 = 500;

/// Takes results in.
pub(super) struct Intake {
    engine: Arc<Decider>,
    runtime: Handle,
    answers: Arc<Answers>,
    orders: Orders,
    meters: Meters,
    /// Largest result, bytes; as many of all results together wait to be checked.
    most: usize,
    /// Bytes of results that wait or are checked.
    held: Arc<AtomicUsize>,
    /// For results that are checked.
    room: Arc<Semaphore>,
    /// Results of which there are pieces.
    pieces: Pieces,
    /// What points of results are drawn by: nobody else knows it.
    draw: u64,
}

impl Intake {
    /// Takes results of at most so many bytes in, checked against this.
    pub fn new(engine: Arc<Decider>, answers: Arc<Answers>, orders: Orders, meters: Meters, most: usize) -> Self {
        let room = Arc::new(Semaphore::new(units(most)));
        let draw = uuid::Uuid::new_v4().as_u64_pair().0;
        let (runtime, held) = (Handle::current(), Arc::default());
        Self { engine, runtime, answers, orders, meters, most, held, room, pieces: Pieces::new(most), draw }
    }

    /// Takes a result of a task; answers it later.
    pub fn take(self: &Arc<Self>, query: Query, task: TaskId) {
        self.meters.received.inc_by(query.payload().map_or(0, |payload| payload.len()) as u64);
        let payload = match self.pieces.take_from(&query) {
            Ok(Arrived::Whole(payload)) => payload,
            Ok(Arrived::Piece(taken)) => return reply(&self.runtime, query, taken),
            Ok(Arrived::TooLarge(size)) => {
                let why = format!("the result has {size} bytes, this run accepts {}", self.most);
                return reply(&self.runtime, query, SubmitReply::Rejected { why });
            }
            Err(why) => return reply(&self.runtime, query, SubmitReply::Rejected { why }),
        };
        let size = payload.len();
        let Some(held) = Held::of(&self.held, size, self.most) else {
            return reply(&self.runtime, query, SubmitReply::Busy { retry_ms: BUSY_MS });
        };
        let needed = units(size).max(units(self.most) / CHECKED) as u32;
        if let Ok(room) = self.room.clone().try_acquire_many_owned(needed) {
            return self.clone().look_at_beside((query, payload), task, (held, room));
        }
        let intake = self.clone();
        self.runtime.spawn(async move {
            let Ok(room) = intake.room.clone().acquire_many_owned(needed).await else { return };
            intake.look_at_beside((query, payload), task, (held, room));
        });
    }

    fn look_at_beside(self: Arc<Self>, message: (Query, ZBytes), task: TaskId, held: (Held, OwnedSemaphorePermit)) {
        self.runtime.clone().spawn_blocking(move || self.look_at(message, &task, held));
    }

    /// Looks at a result whose turn it is; `held` is let go once it is decided.
    fn look_at(&self, (query, payload): (Query, ZBytes), task: &TaskId, held: (Held, OwnedSemaphorePermit)) {
        let (bytes, encoding) = (payload.to_bytes(), encoding_of(&query));
        let rejected = |why: String| answer(&query, query.key_expr(), &SubmitReply::Rejected { why });
        let lease = match SubmitRequest::lease_in(&bytes, &encoding) {
            Ok(lease) if lease.task != *task => {
                return rejected(format!("a result of task {} under the key of task {task}", lease.task));
            }
            Ok(lease) => lease,
            Err(error) => return refuse(&query, &error.to_string()),
        };
        let expected = match self.engine.offer(lease.clone()) {
            Some(Offer::Check(expected)) => expected,
            Some(Offer::Refuse(why)) => return rejected(why),
            // The sweep is about to begin, or to end: asked again without an answer.
            None => return,
        };
        let event = match self.check(&bytes, &encoding, &expected) {
            Ok(result) => Event::Submit(Box::new(result)),
            Err(why) => Event::Refused(lease, why),
        };
        let respond = respond(self.runtime.clone(), self.answers.clone(), query, held);
        self.engine.ask(event, respond);
    }

    fn check(&self, bytes: &[u8], encoding: &str, expected: &Expected) -> Result<CheckedResult, String> {
        let request = protocol::codec::decode::<SubmitRequest>(bytes, encoding).map_err(|error| error.to_string())?;
        let (computed, began) = (request.seconds, Instant::now());
        // Another one for every attempt: what is refused tells nothing of what is looked at next time.
        let mut hasher = DefaultHasher::new();
        (self.draw, &request.lease).hash(&mut hasher);
        let checked = CheckedResult::new(request, &self.orders, expected, hasher.finish());
        tracing::debug!(work = ?expected.work, computed, checked = began.elapsed().as_secs_f64(), "checked");
        checked.map_err(|error| error.to_string())
    }
}

fn units(bytes: usize) -> usize {
    bytes.div_ceil(UNIT).max(1)
}
