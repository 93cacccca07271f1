//! Decisions become answers.

use super::announcements::put;
use super::state::RunState;
use crate::engine::{Answer, Responder};
use crate::ledger::Granted;
use protocol::codec::Message;
use protocol::keys::Keys;
use protocol::session::answer;
use protocol::to_everyone::SeedMessage;
use protocol::to_worker::{Grant, LeaseReply, SubmitReply};
use std::sync::Arc;
use tokio::runtime::Handle;
use tokio::sync::watch;
use zenoh::Session;
use zenoh::query::Query;

/// Answers a query from the blocking pool: whoever asked may be frozen. `held` is let go once the answer is decided.
pub(super) fn respond(runtime: Handle, answers: Arc<Answers>, query: Query, held: impl Send + 'static) -> Responder {
    Box::new(move |decided| {
        drop(held);
        runtime.spawn_blocking(move || answers.give(&query, decided));
    })
}

/// Answers from the blocking pool: whoever asked may be frozen.
pub(super) fn reply<R: Message + Send + 'static>(runtime: &Handle, query: Query, reply: R) {
    runtime.spawn_blocking(move || answer(&query, query.key_expr(), &reply));
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
            Answer::Grant(granted) => self.grant(query, granted, LeaseReply::Grant),
            Answer::Next(granted) => self.grant(query, granted, |grant| SubmitReply::Next(Box::new(grant))),
            Answer::Wait(pause) => answer(query, key, &LeaseReply::Wait { retry_ms: pause.as_millis() as u64 }),
            Answer::Drained => answer(query, key, &LeaseReply::Drained),
            Answer::Stop(reason) => answer(query, key, &LeaseReply::Stop { reason }),
            Answer::Renew(reply) => answer(query, key, &reply),
            // Asked from within this process only.
            Answer::Offer(_) => {}
            Answer::Checkpoint(reply) => answer(query, key, &reply),
            Answer::Submit(reply) => answer(query, key, &reply),
            Answer::Acknowledge(reply) => answer(query, key, &reply),
            Answer::Control(reply) => answer(query, key, &reply),
        }
    }

    /// Hands a task out with its seeds, and shows them to everybody.
    fn grant<R: Message>(&self, query: &Query, granted: Granted, reply: impl FnOnce(Grant) -> R) {
        let (sweep, ttl_ms) = {
            let state = self.state.borrow();
            (state.sweep.clone(), state.manifest.lease_ms)
        };
        // There is no task before there is a sweep.
        let Some(sweep) = sweep else { return };
        let Granted { task, attempt, amplitude, work, landing, known, curves, checkpoint } = granted;
        let seeds = sweep.seeds(&work, &amplitude);
        let seed = SeedMessage { task: task.clone(), amplitude: amplitude.clone(), work, seeds: seeds.clone() };
        let (amplitude, order) = (amplitude.value, amplitude.order());
        let reach = sweep.plan.reach_of(order);
        let grant =
            Grant { task, attempt, ttl_ms, amplitude, order, reach, work, seeds, landing, known, curves, checkpoint };
        answer(query, query.key_expr().as_str(), &reply(grant));
        put(&self.session, &self.keys.seed(&seed.task), &seed);
    }
}
