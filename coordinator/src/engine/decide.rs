//! The thread that decides.

use super::commit::Decided;
use super::decision::{Answer, Decision};
use super::event::Event;
use super::machine::Engine;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

/// Time between two looks at the clock.
const TICK: Duration = Duration::from_millis(100);

/// Sends an answer on its way. Dropped, there is none.
pub type Responder = Box<dyn FnOnce(Answer) + Send>;

/// An event, and whom to answer.
pub struct Request {
    /// What happened.
    pub event: Event,
    /// Who asked.
    pub respond: Option<Responder>,
}

impl From<Event> for Request {
    fn from(event: Event) -> Self {
        Self { event, respond: None }
    }
}

/// Decides until the senders of requests are gone, or whoever commits is.
pub fn decide(mut engine: Engine, requests: &Receiver<Request>, decided: &Sender<Decided>) {
    let origin = Instant::now();
    let mut next_tick = Duration::ZERO;
    loop {
        if origin.elapsed() >= next_tick {
            let now = origin.elapsed();
            next_tick = now + TICK;
            if !hand_on(engine.handle(Event::Tick, now), None, decided) {
                return;
            }
        }
        match requests.recv_timeout(next_tick.saturating_sub(origin.elapsed())) {
            Ok(Request { event, respond }) => {
                if !hand_on(engine.handle(event, origin.elapsed()), respond, decided) {
                    return;
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

/// Hands a decision to whoever commits; false if there is nobody.
fn hand_on(decision: Decision, respond: Option<Responder>, decided: &Sender<Decided>) -> bool {
    let Decision { changes, answer, news } = decision;
    let mut answer = answer.zip(respond);
    if let Some((answer, respond)) = answer.take_if(|(answer, _)| answer.is_immediate()) {
        respond(answer);
    }
    if changes.is_empty() && answer.is_none() && news.is_empty() {
        return true;
    }
    let answer = answer.map(|(answer, respond)| -> Box<dyn FnOnce() + Send> { Box::new(move || respond(answer)) });
    decided.send(Decided { changes, answer, news }).is_ok()
}
