//! Deciding: on the thread of whoever asks, one after the other.

use super::commit::Decided;
use super::decision::{Answer, Decision, Offer};
use super::event::Event;
use super::machine::Engine;
use protocol::from_worker::Lease;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::{Duration, Instant};

/// Time between two looks at the clock.
const TICK: Duration = Duration::from_millis(100);
/// A pause between two looks at the clock that is no ordinary one: this process was stopped, or its machine has no time for it.
const GAP: Duration = Duration::from_secs(1);

/// Sends an answer on its way. Dropped, there is none.
pub type Responder = Box<dyn FnOnce(Answer) + Send>;

/// An engine that many threads ask: a decision takes less time than it takes to wake another thread for it.
///
/// Time passes only as far as this process runs: nobody can be heard of by one that is stopped.
pub struct Decider(Mutex<Option<Deciding>>);

struct Deciding {
    engine: Engine,
    clock: Clock,
    decided: Sender<Decided>,
}

impl Decider {
    /// Hands what an engine decides to whoever commits, in that order.
    pub fn new(engine: Engine, decided: Sender<Decided>) -> Self {
        let clock = Clock { last: Instant::now(), now: Duration::ZERO };
        Self(Mutex::new(Some(Deciding { engine, clock, decided })))
    }

    /// Tells the engine something; false if nothing is decided any more.
    pub fn tell(&self, event: Event) -> bool {
        self.decide(event, None).is_some()
    }

    /// Asks the engine; without an answer nothing is decided any more, or it is not to be known now.
    pub fn ask(&self, event: Event, respond: Responder) {
        if let Some(Some((answer, respond))) = self.decide(event, Some(respond)) {
            respond(answer);
        }
    }

    /// What a result under this lease has to be of; `None` if that is not known now.
    pub fn offer(&self, lease: Lease) -> Option<Offer> {
        match self.decide(Event::Offer(lease), Some(Box::new(drop)))? {
            Some((Answer::Offer(offer), _)) => Some(offer),
            _ => None,
        }
    }

    /// Decides. What follows is handed on in the order of the decisions; what tells of nothing that has to be on disk is given back.
    fn decide(&self, event: Event, respond: Option<Responder>) -> Option<Option<(Answer, Responder)>> {
        let mut place = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // If the engine panics it is gone, and with it whoever commits: that ends the run in order.
        let mut deciding = place.take()?;
        if deciding.clock.advance() {
            deciding.handle(Event::Stalled, None)?;
        }
        let immediate = deciding.handle(event, respond)?;
        *place = Some(deciding);
        Some(immediate)
    }
}

impl Deciding {
    /// `None` if nobody commits any more.
    fn handle(&mut self, event: Event, respond: Option<Responder>) -> Option<Option<(Answer, Responder)>> {
        let Decision { changes, answer, news } = self.engine.handle(event, self.clock.now);
        let mut answer = answer.zip(respond);
        let immediate = answer.take_if(|(answer, _)| answer.is_immediate());
        if !(changes.is_empty() && answer.is_none() && news.is_empty()) {
            let answer =
                answer.map(|(answer, respond)| -> Box<dyn FnOnce() + Send> { Box::new(move || respond(answer)) });
            self.decided.send(Decided { changes, answer, news }).ok()?;
        }
        Some(immediate)
    }
}

/// Lets the engine look at the clock, as long as there is one.
pub async fn tick(decider: Weak<Decider>) {
    let is_there = |decider: Arc<Decider>| decider.tell(Event::Tick);
    while decider.upgrade().is_some_and(is_there) {
        tokio::time::sleep(TICK).await;
    }
}

/// The time that this process has lived through.
struct Clock {
    last: Instant,
    now: Duration,
}

impl Clock {
    /// Goes on to the present; tells whether this process did not run in between.
    fn advance(&mut self) -> bool {
        let passed = self.last.elapsed();
        self.last += passed;
        self.now += passed.min(GAP);
        passed > GAP
    }
}
