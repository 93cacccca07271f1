//! Results on their way in: only of what was handed out, no more bytes at a time than there is room for, checked against the
//! equations on the blocking pool, and then handed to the engine.

use super::answers::{Answers, respond};
use crate::engine::{Answer, CheckedResult, Event, Expected, Meters, Offer, Reference, Request};
use protocol::from_worker::{Lease, SubmitRequest};
use protocol::ids::TaskId;
use protocol::session::{answer, question_parts, refuse};
use protocol::to_worker::SubmitReply;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::time::Instant;
use tokio::runtime::Handle;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use zenoh::query::Query;

/// Most results that are checked at a time.
const CHECKED: usize = 4;
/// What room is measured in, bytes.
const UNIT: usize = 1 << 10;
/// When to send a result again for which there is no room, ms.
const BUSY_MS: u64 = 500;

/// Takes results in.
pub(super) struct Intake {
    engine: Sender<Request>,
    runtime: Handle,
    answers: Arc<Answers>,
    reference: Reference,
    meters: Meters,
    /// Largest result, bytes; as many of all results together wait to be checked.
    most: usize,
    /// Bytes of results that wait or are checked.
    held: Arc<AtomicUsize>,
    /// For results that are checked.
    room: Arc<Semaphore>,
    /// What points of results are drawn by: nobody else knows it.
    draw: u64,
}

impl Intake {
    /// Takes results of at most so many bytes in, checked against this.
    pub fn new(
        engine: Sender<Request>,
        answers: Arc<Answers>,
        reference: Reference,
        meters: Meters,
        most: usize,
    ) -> Self {
        let room = Arc::new(Semaphore::new(units(most)));
        let draw = uuid::Uuid::new_v4().as_u64_pair().0;
        let (runtime, held) = (Handle::current(), Arc::default());
        Self { engine, runtime, answers, reference, meters, most, held, room, draw }
    }

    /// Takes a result of a task; answers it later.
    pub fn take(self: &Arc<Self>, query: Query, task: TaskId) {
        let size = query.payload().map_or(0, |payload| payload.len());
        self.meters.received.inc_by(size as u64);
        if size > self.most {
            let why = format!("the result has {size} bytes, this run accepts {}", self.most);
            return self.reply(query, SubmitReply::Rejected { why });
        }
        let Some(held) = Held::of(&self.held, size, self.most) else {
            return self.reply(query, SubmitReply::Busy { retry_ms: BUSY_MS });
        };
        let intake = self.clone();
        self.runtime.spawn(async move {
            let needed = units(size).max(units(intake.most) / CHECKED);
            let Ok(room) = intake.room.clone().acquire_many_owned(needed as u32).await else { return };
            let pool = intake.runtime.clone();
            pool.spawn_blocking(move || intake.look_at(query, &task, (held, room)));
        });
    }

    fn reply(&self, query: Query, reply: SubmitReply) {
        self.runtime.spawn_blocking(move || answer(&query, query.key_expr(), &reply));
    }

    /// Looks at a result whose turn it is; `held` is let go once it is decided.
    fn look_at(&self, query: Query, task: &TaskId, held: (Held, OwnedSemaphorePermit)) {
        let (bytes, encoding) = question_parts(&query);
        let rejected = |why: String| answer(&query, query.key_expr(), &SubmitReply::Rejected { why });
        let lease = match SubmitRequest::lease_in(&bytes, &encoding) {
            Ok(lease) if lease.task != *task => {
                return rejected(format!("a result of task {} under the key of task {task}", lease.task));
            }
            Ok(lease) => lease,
            Err(error) => return refuse(&query, &error.to_string()),
        };
        let expected = match self.ask(lease.clone()) {
            Some(Offer::Check(expected)) => expected,
            Some(Offer::Refuse(why)) => return rejected(why),
            // The sweep is about to begin, or to end: asked again without an answer.
            None => return,
        };
        let event = match self.check(&bytes, &encoding, &expected) {
            Ok(result) => Event::Submit(Box::new(result)),
            Err(why) => Event::Refused(lease, why),
        };
        drop(bytes);
        let respond = respond(self.runtime.clone(), self.answers.clone(), query, held);
        // The engine is gone only when the process ends.
        let _ = self.engine.send(Request { event, respond: Some(respond) });
    }

    /// What a result under this lease has to be of; `None` if that is not known now.
    fn ask(&self, lease: Lease) -> Option<Offer> {
        let (sender, offered) = channel();
        let respond = Box::new(move |answer| drop(sender.send(answer)));
        self.engine.send(Request { event: Event::Offer(lease), respond: Some(respond) }).ok()?;
        match offered.recv().ok()? {
            Answer::Offer(offer) => Some(offer),
            _ => None,
        }
    }

    fn check(&self, bytes: &[u8], encoding: &str, expected: &Expected) -> Result<CheckedResult, String> {
        let request = protocol::codec::decode::<SubmitRequest>(bytes, encoding).map_err(|error| error.to_string())?;
        let (computed, began) = (request.seconds, Instant::now());
        let checked = CheckedResult::new(request, &self.reference, expected, self.draw);
        tracing::debug!(work = ?expected.work, computed, checked = began.elapsed().as_secs_f64(), "checked");
        checked.map_err(|error| error.to_string())
    }
}

fn units(bytes: usize) -> usize {
    bytes.div_ceil(UNIT).max(1)
}

/// Bytes that wait; given back when dropped.
struct Held {
    all: Arc<AtomicUsize>,
    bytes: usize,
}

impl Held {
    /// So many more, if there is room or nothing else waits.
    fn of(all: &Arc<AtomicUsize>, bytes: usize, most: usize) -> Option<Self> {
        let more = |held: usize| (held == 0 || held + bytes <= most).then_some(held + bytes);
        all.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more).ok()?;
        Some(Self { all: all.clone(), bytes })
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        self.all.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}
