//! The thread that decides.

use super::commit::Decided;
use super::decision::{Answer, Decision};
use super::event::Event;
use super::machine::Engine;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

/// Time between two looks at the clock.
const TICK: Duration = Duration::from_millis(100);
/// A pause between two looks at the clock that is no ordinary one: this process was stopped, or its machine has no time for it.
const GAP: Duration = Duration::from_secs(1);

/// Most requests that are read while the next look at the clock is due.
const BURST: usize = 1000;

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
///
/// What has come is read before leases run out: signs of life that wait here were given in time. And time passes only as far as
/// this process runs: nobody can be heard of by one that is stopped.
pub fn decide(mut engine: Engine, requests: &Receiver<Request>, decided: &Sender<Decided>) {
    let mut clock = Clock { last: Instant::now(), now: Duration::ZERO };
    let (mut next_tick, mut read) = (Duration::ZERO, 0);
    loop {
        let left = next_tick.saturating_sub(clock.now);
        let is_due = left.is_zero();
        let received =
            if is_due && read == BURST { Err(RecvTimeoutError::Timeout) } else { requests.recv_timeout(left) };
        if clock.advance() && !hand_on(engine.handle(Event::Stalled, clock.now), None, decided) {
            return;
        }
        let (event, respond) = match received {
            Ok(Request { event, respond }) => {
                read += usize::from(is_due);
                (event, respond)
            }
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) if !is_due => continue,
            Err(RecvTimeoutError::Timeout) => {
                (next_tick, read) = (clock.now + TICK, 0);
                (Event::Tick, None)
            }
        };
        if !hand_on(engine.handle(event, clock.now), respond, decided) {
            return;
        }
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
