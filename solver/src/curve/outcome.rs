//! How a walk along a curve ends.

use crate::curve::continuation::Rejection;
use serde::{Deserialize, Serialize};

/// Why a walk along a curve ended.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// It began here, where it grows out of the linear response.
    Start,
    /// It began here, where a forcing that grows from zero leads: the response is not the linear one, and what is beyond was not
    /// followed.
    Rest,
    /// It came back to its first point.
    Closed,
    /// It reached a frequency bound.
    FrequencyBound,
    /// It reached the amplitude bound.
    AmplitudeBound,
    /// It used up its points.
    PointBudget,
    /// The smallest step failed.
    Stalled(Rejection),
    /// It turned back and walked along itself.
    Reversed,
    /// It came to a branch that was known: what follows is part of that.
    Joined,
    /// It branches off another curve here.
    Branching,
    /// Whoever drives it asked to stop.
    Cancelled,
    /// It left the range of forcing amplitudes.
    ForcingBound,
}

impl std::fmt::Display for Stop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Stop::Start => write!(f, "linear range"),
            Stop::Rest => write!(f, "forcing grown from zero"),
            Stop::Closed => write!(f, "closed"),
            Stop::FrequencyBound => write!(f, "frequency bound"),
            Stop::AmplitudeBound => write!(f, "amplitude bound"),
            Stop::PointBudget => write!(f, "point budget used up"),
            Stop::Stalled(rejection) => write!(f, "stalled at the smallest step: {rejection}"),
            Stop::Reversed => write!(f, "turned back along itself"),
            Stop::Joined => write!(f, "known branch"),
            Stop::Branching => write!(f, "branch point"),
            Stop::Cancelled => write!(f, "cancelled"),
            Stop::ForcingBound => write!(f, "forcing bound"),
        }
    }
}

/// How a curve begins and ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// A closed curve.
    Closed,
    /// An open curve, with what is at its first and at its last point.
    Open(Stop, Stop),
}

impl Outcome {
    /// Whether the curve ends where it branches off another.
    pub fn is_branched(&self) -> bool {
        matches!(self, Outcome::Open(first, last) if [first, last].contains(&&Stop::Branching))
    }

    /// Whether the curve goes on where it ends: it stalled, turned back along itself, used up its points or was cancelled.
    pub fn is_unfinished(&self) -> bool {
        let is_unfinished =
            |stop: &Stop| matches!(stop, Stop::Stalled(_) | Stop::Reversed | Stop::PointBudget | Stop::Cancelled);
        matches!(self, Outcome::Open(first, last) if is_unfinished(first) || is_unfinished(last))
    }
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Outcome::Closed => write!(f, "closed"),
            Outcome::Open(first, last) => write!(f, "open: {first} to {last}"),
        }
    }
}
