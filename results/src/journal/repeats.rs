//! What is said of tasks whose results can only be repeated, and what is known of how far they are to be believed.

use super::AttemptEnd;
use protocol::ids::Attempt;
use serde::{Deserialize, Serialize};
use solver::response::task::{BranchId, Brought, SeedOutcome};
use std::fmt;

/// What a result says, as far as another one has to say the same: why nothing was found, and how many of some random starts end where
/// others have not, may depend on the processor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Said {
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
    /// What an outcome without anything new says; `None` of what is marched.
    pub fn of(outcome: &SeedOutcome) -> Option<Self> {
        match *outcome {
            SeedOutcome::Found(branch) | SeedOutcome::Passing(branch, _) => Some(Self::OnBranch(branch)),
            SeedOutcome::OnCurve(number) => Some(Self::OnCurve(number)),
            SeedOutcome::Landed(_) => Some(Self::Landed),
            SeedOutcome::Verified(_) | SeedOutcome::Disturbed(_) | SeedOutcome::Marched(_) => None,
            _ => Some(Self::Nothing),
        }
    }

    /// What is said by what a task brought; `None` if that is something that can be checked, or is marched.
    pub fn by(brought: &Brought) -> Option<Self> {
        match brought {
            Brought::Nothing(outcome) => Self::of(outcome),
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

/// What the store knows of how far what was said of a task is to be believed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Evidence {
    /// The attempt that the result is of, and its computing time, s.
    pub result: Option<(Attempt, f64)>,
    /// Attempts that were compared with others, or refused, and what came of it.
    pub ends: Vec<(Attempt, AttemptEnd)>,
    /// What those said that others disagree with.
    pub said: Vec<(Attempt, Said)>,
}
