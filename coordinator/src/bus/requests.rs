//! Requests of workers and people: queries become events of the engine, its decisions become answers.
//!
//! Results are decoded, checked, encoded and hashed here, and seeds are made here, on the blocking pool.

use super::announcements::put;
use super::state::RunState;
use crate::engine::{Answer, CheckedResult, Event, Request, Responder};
use crate::ledger::Granted;
use protocol::codec::Message;
use protocol::curve::Size;
use protocol::from_worker::SubmitRequest;
use protocol::ids::TaskId;
use protocol::keys::{Keys, last_chunk};
use protocol::session::{answer, question, refuse};
use protocol::to_everyone::SeedMessage;
use protocol::to_worker::{Grant, LeaseReply, SubmitReply};
use std::sync::Arc;
use std::sync::mpsc::Sender;
use tokio::runtime::Handle;
use tokio::sync::{Semaphore, watch};
use zenoh::Session;
use zenoh::query::Query;

/// Results under way between bus and store at a time: bounds the memory that many submits at once take.
const SUBMITS: usize = 4;

/// Turns queries into requests to the engine.
pub(super) struct Requests {
    pub engine: Sender<Request>,
    pub keys: Keys,
    pub runtime: Handle,
    pub answers: Arc<Answers>,
    /// Size of the model.
    pub size: Size,
    /// Number of harmonics H of the run.
    pub harmonics: usize,
    permits: Arc<Semaphore>,
}

impl Requests {
    /// Hands requests to the engine.
    pub fn new(engine: Sender<Request>, keys: Keys, answers: Answers, size: Size, harmonics: usize) -> Self {
        let permits = Arc::new(Semaphore::new(SUBMITS));
        Self { engine, keys, runtime: Handle::current(), answers: Arc::new(answers), size, harmonics, permits }
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
        } else if TaskId::new(last_chunk(&key)).is_ok_and(|task| key == keys.submit(&task)) {
            self.submit(query);
        } else {
            self.runtime.spawn_blocking(move || refuse(&query, &format!("there is no request `{key}`")));
        }
    }

    fn ask<Q: Message>(&self, query: Query, event: impl FnOnce(Q) -> Event) {
        match question::<Q>(&query) {
            Ok(question) => {
                let respond = respond(self.runtime.clone(), self.answers.clone(), query, ());
                // The engine is gone only when the process ends.
                let _ = self.engine.send(Request { event: event(question), respond: Some(respond) });
            }
            Err(error) => {
                self.runtime.spawn_blocking(move || refuse(&query, &error.to_string()));
            }
        }
    }

    fn submit(&self, query: Query) {
        let (engine, permits, size, harmonics) = (self.engine.clone(), self.permits.clone(), self.size, self.harmonics);
        let (runtime, answers) = (self.runtime.clone(), self.answers.clone());
        self.runtime.spawn(async move {
            let Ok(permit) = permits.acquire_owned().await else { return };
            let pool = runtime.clone();
            pool.spawn_blocking(move || match question::<SubmitRequest>(&query) {
                Ok(request) => match CheckedResult::new(request, &size, harmonics) {
                    Ok(result) => {
                        let respond = respond(runtime, answers, query, permit);
                        let event = Event::Submit(Box::new(result));
                        let _ = engine.send(Request { event, respond: Some(respond) });
                    }
                    Err(error) => answer(&query, query.key_expr(), &SubmitReply::Rejected { why: error.to_string() }),
                },
                Err(error) => refuse(&query, &error.to_string()),
            });
        });
    }
}

/// Answers a query from the blocking pool: whoever asked may be frozen. `held` is let go once the answer is decided.
fn respond(runtime: Handle, answers: Arc<Answers>, query: Query, held: impl Send + 'static) -> Responder {
    Box::new(move |decided| {
        drop(held);
        runtime.spawn_blocking(move || answers.give(&query, decided));
    })
}

/// Turns decisions into answers.
pub(super) struct Answers {
    pub session: Session,
    pub keys: Keys,
    pub state: watch::Receiver<RunState>,
}

impl Answers {
    fn give(&self, query: &Query, decided: Answer) {
        let key = query.key_expr().as_str();
        match decided {
            Answer::Grant(granted) => self.grant(query, granted),
            Answer::Wait(pause) => answer(query, key, &LeaseReply::Wait { retry_ms: pause.as_millis() as u64 }),
            Answer::Drained => answer(query, key, &LeaseReply::Drained),
            Answer::Stop(reason) => answer(query, key, &LeaseReply::Stop { reason }),
            Answer::Renew(reply) => answer(query, key, &reply),
            Answer::Submit(reply) => answer(query, key, &reply),
            Answer::Acknowledge(reply) => answer(query, key, &reply),
            Answer::Control(reply) => answer(query, key, &reply),
        }
    }

    /// Hands a task out with its seeds, and shows them to everybody.
    fn grant(&self, query: &Query, granted: Granted) {
        let (sweep, ttl_ms) = {
            let state = self.state.borrow();
            (state.sweep.clone(), state.manifest.lease_ms)
        };
        // There is no task before there is a sweep.
        let Some(sweep) = sweep else { return };
        let Granted { task, attempt, amplitude, work, landing, known, curves } = granted;
        let seeds = sweep.seeds(&work, amplitude.value);
        let seed = SeedMessage { task: task.clone(), amplitude: amplitude.clone(), work, seeds: seeds.clone() };
        let (amplitude, reach) = (amplitude.value, sweep.plan.reach);
        let grant = Grant { task, attempt, ttl_ms, amplitude, reach, work, seeds, landing, known, curves };
        answer(query, query.key_expr().as_str(), &LeaseReply::Grant(grant));
        put(&self.session, &self.keys.seed(&seed.task), &seed);
    }
}
