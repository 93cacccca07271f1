//! Results that bring no curve, drawn to be computed again, and what several workers say of them.

use protocol::from_worker::Lease;
use protocol::ids::{Attempt, WorkerId};
use results::journal::{Change, Holder};
use solver::response::task::{BranchId, Brought, SeedOutcome};
use std::collections::{BTreeMap, VecDeque};
use std::fmt;
use std::time::Duration;

/// What a result says, as far as another one has to say the same: why nothing was found, and how many of some random starts end where
/// others have not, may depend on the processor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Said {
    /// Nothing is there.
    Nothing,
    /// What is there lies on this branch.
    OnBranch(BranchId),
    /// It lies on the fold curve of this number.
    OnCurve(usize),
    /// Forced responses are there.
    Landed,
    /// A branch or a curve that was not known.
    New,
}

impl Said {
    pub fn of(outcome: &SeedOutcome) -> Self {
        match *outcome {
            SeedOutcome::Found(branch) => Self::OnBranch(branch),
            SeedOutcome::OnCurve(number) => Self::OnCurve(number),
            SeedOutcome::Landed(_) => Self::Landed,
            _ => Self::Nothing,
        }
    }

    /// What is said by what a task brought; `None` if that is something that can be checked, or is marched.
    pub fn by(brought: &Brought) -> Option<Self> {
        match brought {
            Brought::Nothing(outcome) => Some(Self::of(outcome)),
            Brought::Landings(_) => Some(Self::Landed),
            Brought::Branch { .. } | Brought::Curve(_) => None,
            Brought::Verification(..) | Brought::Disturbance(_) | Brought::Settling(_) => None,
        }
    }
}

impl fmt::Display for Said {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => write!(f, "nothing"),
            Self::OnBranch(branch) => write!(f, "{branch}"),
            Self::OnCurve(number) => write!(f, "{}", SeedOutcome::OnCurve(*number)),
            Self::Landed => write!(f, "forced responses"),
            Self::New => write!(f, "something new"),
        }
    }
}

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
}

impl Claim {
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

    /// What was begun and did not come to an end: a dispute is for somebody else, what was drawn for nobody any more.
    pub fn drop_held(&mut self, i: usize) -> Held {
        let held = self.held.swap_remove(i);
        if held.claim.votes.len() > 1 {
            self.disputes.push_back(held.claim.clone());
        }
        held
    }
}
