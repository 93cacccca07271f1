//! Results that bring no curve, drawn to be computed again, and what several workers say of them.

use protocol::from_worker::Lease;
use protocol::ids::{Attempt, WorkerId};
use results::journal::{Change, Holder, Said};
use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

/// What one worker says of a task.
#[derive(Debug, Clone)]
pub(super) struct Vote {
    pub attempt: Attempt,
    pub worker: WorkerId,
    pub said: Said,
}

/// What is said of a task: first by the result that counts.
#[derive(Debug, Clone)]
pub(super) struct Claim {
    /// Chain and entry.
    pub place: (usize, usize),
    pub votes: Vec<Vote>,
    /// Computing time of the result, s.
    pub seconds: f64,
    /// How often it was handed out to be repeated.
    pub tries: u32,
}

/// What so many say of a task is undecided if no two of them agree.
const MOST_VOTES: usize = 5;

/// Most times that what a task comes to is asked for once more: those who are asked may never answer.
const MOST_TRIES: u32 = 10;

impl Claim {
    /// Whether it is of no use to ask once more.
    pub fn is_exhausted(&self) -> bool {
        self.votes.len() >= MOST_VOTES || self.tries >= MOST_TRIES
    }

    pub fn is_of(&self, worker: &WorkerId) -> bool {
        self.votes.iter().any(|vote| vote.worker == *worker)
    }
}

/// A result that is being repeated.
#[derive(Debug)]
pub(super) struct Held {
    pub claim: Claim,
    pub holder: Holder,
    pub attempt: Attempt,
    pub granted_at: Duration,
    pub deadline: Duration,
}

/// What is repeated.
#[derive(Debug, Default)]
pub(super) struct Repeats {
    /// Until when somebody may come who decides what another coordinator has left undecided.
    pub awaited: Option<Duration>,
    /// What was not repeated so far, by who said it.
    pub claims: BTreeMap<WorkerId, Vec<Claim>>,
    /// What two disagree on.
    pub disputes: VecDeque<Claim>,
    pub held: Vec<Held>,
    /// Computing time of results, s.
    pub total: f64,
    /// That of repeating them, s.
    pub spent: f64,
    /// Number of draws so far.
    draws: u64,
}

/// What became of a repetition.
#[derive(Debug)]
pub(super) struct Repeated {
    /// Whether it came to the same.
    pub agrees: bool,
    /// When it was handed out.
    pub granted_at: Duration,
    pub changes: Vec<Change>,
}

impl Repeats {
    /// Holders and tasks of what is being repeated.
    pub fn holders(&self) -> impl Iterator<Item = (&Holder, (usize, usize))> {
        self.held.iter().map(|held| (&held.holder, held.claim.place))
    }

    /// Computing time that repeating results takes, with what is being repeated, s.
    pub fn taken(&self) -> f64 {
        self.spent + self.held.iter().map(|held| held.claim.seconds).sum::<f64>()
    }

    pub fn find(&self, place: (usize, usize), lease: &Lease) -> Option<usize> {
        let is_it = |held: &Held| {
            held.claim.place == place
                && held.attempt == lease.attempt
                && held.holder.worker == lease.worker
                && held.holder.slot == lease.slot
        };
        self.held.iter().position(is_it)
    }

    /// One of `count`, for who does not know `seed` not to be told before.
    pub fn draw(&mut self, seed: u64, count: usize) -> usize {
        self.draws += 1;
        // Steele, Lea & Flood, Fast splittable pseudorandom number generators, 2014.
        let mut z = seed.wrapping_add(self.draws.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % count.max(1) as u64) as usize
    }

    /// What was begun and did not come to an end: a dispute is for somebody else, and so is what is `suspect`; what was drawn for nobody
    /// any more.
    pub fn drop_held(&mut self, i: usize, is_suspect: bool) -> Held {
        let held = self.held.swap_remove(i);
        let (claim, author) = (&held.claim, &held.claim.votes[0].worker);
        if claim.is_exhausted() {
            return held;
        }
        if claim.votes.len() > 1 {
            self.disputes.push_back(claim.clone());
        } else if is_suspect {
            self.claims.entry(author.clone()).or_default().push(claim.clone());
        }
        held
    }
}
