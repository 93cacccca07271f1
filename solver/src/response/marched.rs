//! What of a level is marched.

use crate::response::name::BranchId;
use crate::settings::{Stretch, VerifyEffort};
use serde::{Deserialize, Serialize};

/// A branch that is verified by time marching.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct VerifyPlace {
    /// The branch.
    pub branch: BranchId,
    /// How much of it.
    pub stretch: Stretch,
}

impl VerifyPlace {
    /// What of a branch is verified.
    pub fn of(effort: VerifyEffort, branch: BranchId) -> Option<Self> {
        let stretch = match effort {
            VerifyEffort::None => return None,
            VerifyEffort::Standard if branch.is_main() => Stretch::Peak,
            VerifyEffort::Standard | VerifyEffort::All => Stretch::Whole,
        };
        Some(Self { branch, stretch })
    }
}

/// Pushes that may throw the structure onto a branch: [`crate::stability::disturbance::disturb`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DisturbPlace {
    /// The branch.
    pub branch: BranchId,
    /// Number of the mode that is pushed, from 0.
    pub mode: usize,
    /// Frequency, rad/s.
    pub omega: f64,
}

/// An unstable motion that is marched on until it settles: [`crate::stability::settling::settle`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MarchPlace {
    /// The branch.
    pub branch: BranchId,
    /// Number of its point from which it is marched, from 0.
    pub index: usize,
    /// Frequency, rad/s: that of the marched orbit near this point.
    pub omega: f64,
}
