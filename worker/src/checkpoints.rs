//! Checkpoints: the steps of a task under way, sent in parts while it goes on, and taken up by whoever is handed it next.

use crate::bus::{ANSWER, Bus, SLOWEST, transfer};
use protocol::codec::{encode, encoding};
use protocol::from_worker::{CheckpointRequest, Lease};
use protocol::pieces::request_in_pieces;
use protocol::session::RequestError;
use protocol::steps::Steps;
use protocol::to_worker::{Checkpoint, CheckpointReply, Grant};
use solver::curve::record::Step;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use zenoh::bytes::ZBytes;

/// Shortest time between two parts; a test of the whole system freezes workers for so long.
const PERIOD: Duration = Duration::from_secs(2);
/// Of the time that a task has taken, the share that may be lost with a worker: so long between two parts.
const LOST: u32 = 30;
/// Between two parts it waits so many times as long as sending took beyond what a quick connection needs: on a slow one signs of life
/// and results come first.
const SENDING: u32 = 4;
/// What a quick connection carries and a coordinator keeps, bytes/s.
const QUICK: u64 = 10_000_000;
/// Size of a part, bytes.
const PART: usize = 1 << 20;
/// How often steps that earlier attempts took are asked for.
const ASKED: usize = 3;

/// Steps that are still to be sent.
#[derive(Debug, Default)]
pub struct Unsent(Mutex<Pile>);

#[derive(Debug, Default)]
struct Pile {
    /// Number of the first of them.
    first: usize,
    steps: Vec<Step>,
    /// Bytes of all that were ever added.
    bytes: usize,
    /// Whether no more of them are wanted.
    is_closed: bool,
}

impl Unsent {
    fn pile(&self) -> MutexGuard<'_, Pile> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a step with its number, of no more than `most` bytes in all.
    pub fn add(&self, number: usize, step: Step, most: usize) {
        let mut pile = self.pile();
        pile.bytes += size(&step);
        if pile.bytes > most {
            pile.is_closed = true;
            pile.steps = Vec::new();
        }
        if pile.is_closed {
            return;
        }
        if pile.steps.is_empty() {
            pile.first = number;
        }
        pile.steps.push(step);
    }

    /// Takes a part of them, the first ones: those that one message holds.
    fn take(&self, given: &str) -> Option<Steps> {
        let mut pile = self.pile();
        let mut bytes = 0;
        let fits = |step: &&Step| {
            bytes += size(step);
            bytes <= PART
        };
        let count = pile.steps.iter().take_while(fits).count().max(1).min(pile.steps.len());
        let part = Steps::new(given.to_string(), pile.first, &pile.steps[..count]);
        pile.steps.drain(..part.len());
        pile.first += part.len();
        (!part.is_empty()).then_some(part)
    }

    /// Whether there are as many as one message holds.
    fn fills_a_part(&self) -> bool {
        let pile = self.pile();
        pile.steps.first().is_some_and(|first| pile.steps.len() * size(first) >= PART)
    }

    fn close(&self) {
        let mut pile = self.pile();
        pile.is_closed = true;
        pile.steps = Vec::new();
    }
}

/// About as many bytes as a step takes in a message.
fn size(step: &Step) -> usize {
    8 * (step.point.y.len() + step.point.tangent.len() + step.memory.len()) + 64
}

/// Sends the steps of a task as they come, never all of the time; ends when no more of them are wanted. `given`: what the task was
/// given.
pub async fn send(bus: &Bus, lease: &Lease, given: &str, unsent: &Unsent) {
    let began = Instant::now();
    let mut pause = PERIOD;
    loop {
        tokio::time::sleep(pause).await;
        let mut slow = Duration::ZERO;
        while let Some(steps) = unsent.take(given) {
            let (first, count) = (steps.first, steps.len());
            let request = CheckpointRequest { lease: lease.clone(), steps };
            let (sent, payload) = (Instant::now(), ZBytes::from(encode(&request)));
            let quick = transfer(payload.len(), QUICK);
            if !deliver(bus, lease, payload).await {
                unsent.close();
                return;
            }
            slow += sent.elapsed().saturating_sub(quick);
            tracing::debug!(task = %lease.task, first, count, "checkpoint");
            // What has come meanwhile waits for its turn.
            if !unsent.fills_a_part() {
                break;
            }
        }
        pause = PERIOD.max(began.elapsed() / LOST).max(slow * SENDING);
    }
}

/// Sends a part until it is answered; false if it is not wanted.
async fn deliver(bus: &Bus, lease: &Lease, payload: ZBytes) -> bool {
    let mut timeout = ANSWER + transfer(payload.len(), SLOWEST);
    let (key, encoding) = (bus.keys.keep(&lease.task), encoding::<CheckpointRequest>());
    loop {
        let reply: Result<CheckpointReply, _> = {
            let _turn = bus.turn(&payload).await;
            request_in_pieces(&bus.session, &key, &payload, &encoding, timeout).await
        };
        match reply {
            Ok(CheckpointReply::Kept) => return true,
            Ok(CheckpointReply::Enough | CheckpointReply::Lost) => return false,
            Err(error @ (RequestError::Refused(_) | RequestError::Codec(_))) => {
                tracing::warn!(task = %lease.task, %error, "checkpoint refused");
                return false;
            }
            Ok(CheckpointReply::Busy) | Err(RequestError::NoReply | RequestError::Closed(_)) => {
                tokio::time::sleep(PERIOD).await;
                timeout *= 2;
            }
        }
    }
}

/// The steps that earlier attempts at a task took; none if they are not to be had, or are of something else: then it begins at its
/// beginning.
pub async fn taken_before(bus: &Bus, lease: &Lease, grant: &Grant) -> Vec<Step> {
    if grant.checkpoint == 0 {
        return Vec::new();
    }
    let (task, given) = (&lease.task, grant.fingerprint());
    let mut steps = Vec::new();
    while steps.len() < grant.checkpoint {
        let portion = fetch(bus, lease, steps.len()).await;
        if let Err(why) = portion.and_then(|portion| add_steps(&mut steps, &portion, &given)) {
            tracing::warn!(%task, attempt = %lease.attempt, why, "begins without its checkpoint");
            return Vec::new();
        }
    }
    tracing::info!(%task, attempt = %lease.attempt, steps = steps.len(), "goes on from a checkpoint");
    steps
}

async fn fetch(bus: &Bus, lease: &Lease, first: usize) -> Result<Checkpoint, String> {
    let mut why = String::new();
    for _ in 0..ASKED {
        match bus.checkpoint(&lease.task, first).await {
            Ok(checkpoint) => return Ok(checkpoint),
            Err(error @ (RequestError::Refused(_) | RequestError::Codec(_))) => return Err(error.to_string()),
            Err(error) => why = error.to_string(),
        }
    }
    Err(why)
}

/// Adds the steps of a portion that follow those before, of a task that was given this.
fn add_steps(steps: &mut Vec<Step>, portion: &Checkpoint, given: &str) -> Result<(), String> {
    let before = steps.len();
    for part in &portion.parts {
        if part.given != given {
            return Err("it is of something else".into());
        }
        if part.first != steps.len() {
            return Err(format!("step {} follows step {}", part.first, steps.len()));
        }
        steps.extend(part.steps().map_err(|error| error.to_string())?);
    }
    if steps.len() == before { Err(format!("there is no step {before}")) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::ids::TaskId;
    use solver::curve::continuation::CurvePoint;
    use solver::curve::record::Ahead;

    fn step(i: usize) -> Step {
        let point = CurvePoint {
            y: vec![i as f64; 40_000],
            tangent: vec![0.5; 40_000],
            iterations: 2,
            factorisations: 1,
            residual: 0.0,
            orientation: 1.0,
            step: 0.1,
        };
        let ahead = Ahead { step: 0.1, longest: 1.0, is_narrow: false, rejections: 0, is_refreshed: false };
        Step { walk: 1, point, ahead, memory: Vec::new() }
    }

    #[test]
    fn parts_are_small_and_follow_each_other() {
        let unsent = Unsent::default();
        (7..10).for_each(|i| unsent.add(i, step(i), usize::MAX));
        let mut firsts = Vec::new();
        while let Some(part) = unsent.take("a") {
            firsts.push((part.first, part.len()));
        }
        assert_eq!(firsts, [(7, 1), (8, 1), (9, 1)]);
        unsent.add(10, step(10), usize::MAX);
        assert_eq!(unsent.take("a").unwrap().first, 10);
    }

    #[test]
    fn what_is_too_large_is_not_kept() {
        let unsent = Unsent::default();
        (0..3).for_each(|i| unsent.add(i, step(i), 1_500_000));
        assert!(unsent.take("a").is_none());
    }

    #[test]
    fn a_checkpoint_that_does_not_fit_is_dropped() {
        let part = |given: &str, first: usize| Steps::new(given.into(), first, &[step(first)]);
        let mut taken = Vec::new();
        let mut add = |parts| add_steps(&mut taken, &Checkpoint { task: TaskId::new("1-0").unwrap(), parts }, "a");
        add(vec![part("a", 0), part("a", 1)]).unwrap();
        add(vec![part("a", 2)]).unwrap();
        assert_eq!(taken, [step(0), step(1), step(2)]);
        let mut damaged = part("a", 0);
        damaged.iterations.clear();
        for parts in [vec![], vec![part("b", 0)], vec![part("a", 1)], vec![part("a", 0), part("b", 1)], vec![damaged]] {
            let mut taken = Vec::new();
            let portion = Checkpoint { task: TaskId::new("1-0").unwrap(), parts };
            assert!(add_steps(&mut taken, &portion, "a").is_err());
        }
    }
}
