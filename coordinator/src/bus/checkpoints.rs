//! Steps of tasks under way on their way in: no more bytes at a time than there is room for, read on the blocking pool, and then
//! handed to the engine.

use super::answers::{Answers, reply, respond};
use super::held::Held;
use super::pieces::{Arrived, Pieces};
use crate::engine::{Decider, Event};
use protocol::codec::{decode, encode};
use protocol::from_worker::CheckpointRequest;
use protocol::ids::TaskId;
use protocol::session::{encoding_of, refuse};
use protocol::to_worker::CheckpointReply;
use results::journal::CheckpointPart;
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use tokio::runtime::Handle;
use zenoh::bytes::ZBytes;
use zenoh::query::Query;

/// Takes steps in.
pub(super) struct CheckpointIntake {
    engine: Arc<Decider>,
    runtime: Handle,
    answers: Arc<Answers>,
    /// Most bytes that are looked at.
    most: usize,
    /// Bytes that are looked at.
    held: Arc<AtomicUsize>,
    /// Messages of which there are pieces.
    pieces: Pieces,
}

impl CheckpointIntake {
    /// Takes steps in, no more than so many bytes at a time.
    pub fn new(engine: Arc<Decider>, answers: Arc<Answers>, most: usize) -> Self {
        Self { engine, runtime: Handle::current(), answers, most, held: Arc::default(), pieces: Pieces::new(most) }
    }

    /// Takes steps of a task; answers later.
    pub fn take(self: &Arc<Self>, query: Query, task: TaskId) {
        let payload = match self.pieces.take_from(&query) {
            Ok(Arrived::Whole(payload)) => payload,
            Ok(Arrived::Piece(taken)) => return reply(&self.runtime, query, taken),
            Ok(Arrived::TooLarge(_)) => return reply(&self.runtime, query, CheckpointReply::Enough),
            Err(why) => {
                self.runtime.spawn_blocking(move || refuse(&query, &why));
                return;
            }
        };
        let Some(held) = Held::of(&self.held, payload.len(), self.most) else {
            return reply(&self.runtime, query, CheckpointReply::Busy);
        };
        let intake = self.clone();
        self.runtime.spawn_blocking(move || intake.look_at((query, payload), &task, held));
    }

    fn look_at(&self, (query, payload): (Query, ZBytes), task: &TaskId, held: Held) {
        let read = decode::<CheckpointRequest>(&payload.to_bytes(), &encoding_of(&query));
        let read = read.map_err(|error| error.to_string());
        let fits = |request: &CheckpointRequest| match request.steps.steps() {
            Err(error) => Err(error.to_string()),
            Ok(_) if request.lease.task != *task => {
                Err(format!("steps of task {} under the key of task {task}", request.lease.task))
            }
            Ok(_) => Ok(()),
        };
        let CheckpointRequest { lease, steps } = match read.and_then(|request| fits(&request).map(|()| request)) {
            Ok(request) => request,
            Err(why) => return refuse(&query, &why),
        };
        let (task, attempt, first) = (lease.task.clone(), lease.attempt, steps.first);
        let part = CheckpointPart { task, attempt, first, steps: steps.len(), payload: encode(&steps) };
        let respond = respond(self.runtime.clone(), self.answers.clone(), query, held);
        self.engine.ask(Event::Checkpoint(lease, part), respond);
    }
}
