//! Requests of workers and people: queries become events of the engine, its decisions become answers.
//!
//! Results are taken in beside (`intake.rs`), and seeds are made when a task is handed out (`answers.rs`), on the blocking pool.

use super::answers::{Answers, respond};
use super::checkpoints::CheckpointIntake;
use super::intake::Intake;
use crate::engine::{Decider, Event, Meters};
use protocol::codec::Message;
use protocol::ids::TaskId;
use protocol::keys::{Keys, last_chunk};
use protocol::session::{question, refuse};
use solver::response::orders::Orders;
use std::sync::Arc;
use tokio::runtime::Handle;
use zenoh::query::Query;

/// Largest request that is no result, bytes: a lease, a few numbers, a reason.
const SMALL: usize = 1 << 16;

/// Turns queries into requests to the engine.
pub(super) struct Requests {
    pub engine: Arc<Decider>,
    pub keys: Keys,
    pub runtime: Handle,
    pub answers: Arc<Answers>,
    intake: Arc<Intake>,
    checkpoints: Arc<CheckpointIntake>,
}

impl Requests {
    /// Hands requests to the engine; results of at most so many bytes once they are checked against this, counted here.
    pub fn new(
        engine: Arc<Decider>,
        keys: Keys,
        answers: Answers,
        (orders, meters): (Orders, Meters),
        most: usize,
    ) -> Self {
        let answers = Arc::new(answers);
        let checkpoints = Arc::new(CheckpointIntake::new(engine.clone(), answers.clone(), most));
        let intake = Arc::new(Intake::new(engine.clone(), answers.clone(), orders, meters, most));
        Self { engine, keys, runtime: Handle::current(), answers, intake, checkpoints }
    }

    /// Takes a query; hands over whatever takes time.
    pub fn take(&self, query: Query) {
        let key = query.key_expr().as_str().to_string();
        let keys = &self.keys;
        if key == keys.lease() {
            self.ask(query, Event::Lease);
        } else if key == keys.renew() {
            self.ask(query, Event::Renew);
        } else if key == keys.fail() {
            self.ask(query, Event::Fail);
        } else if key == keys.release() {
            self.ask(query, Event::Release);
        } else if key == keys.control() {
            self.ask(query, Event::Control);
        } else if let Some(task) = TaskId::new(last_chunk(&key)).ok().filter(|task| key == keys.submit(task)) {
            self.intake.take(query, task);
        } else if let Some(task) = TaskId::new(last_chunk(&key)).ok().filter(|task| key == keys.keep(task)) {
            self.checkpoints.take(query, task);
        } else {
            self.runtime.spawn_blocking(move || refuse(&query, &format!("there is no request `{key}`")));
        }
    }

    fn ask<Q: Message>(&self, query: Query, event: impl FnOnce(Q) -> Event) {
        let size = query.payload().map_or(0, |payload| payload.len());
        if size > SMALL {
            let why = format!("a request of {size} bytes, where {SMALL} are enough");
            self.runtime.spawn_blocking(move || refuse(&query, &why));
            return;
        }
        match question::<Q>(&query) {
            Ok(question) => {
                let respond = respond(self.runtime.clone(), self.answers.clone(), query, ());
                self.engine.ask(event(question), respond);
            }
            Err(error) => {
                self.runtime.spawn_blocking(move || refuse(&query, &error.to_string()));
            }
        }
    }
}
