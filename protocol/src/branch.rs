//! A branch as a message.

use crate::array::ArrayError;
use crate::curve::{Points, Size};
use serde::{Deserialize, Serialize};
use solver::response::branch::{Branch, Outcome, SpecialPoint};
use solver::response::task::{Finding, SeedOutcome};

/// A forced-response branch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BranchMessage {
    /// Forcing amplitude A.
    pub amplitude: f64,
    /// How it ends.
    pub outcome: Outcome,
    /// Start, peak and folds, by index of the point.
    pub special: Vec<SpecialPoint>,
    /// Steps that were refused and repeated shorter.
    pub rejections: usize,
    /// Points in the order of the arc; a closed branch does not repeat its first one.
    pub points: Points,
}

impl From<&Branch> for BranchMessage {
    fn from(branch: &Branch) -> Self {
        Self {
            amplitude: branch.forcing,
            outcome: branch.outcome,
            special: branch.special.clone(),
            rejections: branch.rejections,
            points: Points::new(branch.points.iter()),
        }
    }
}

impl BranchMessage {
    /// The branch, for a model of this size.
    pub fn branch(&self, size: &Size) -> Result<Branch, ArrayError> {
        let points = self.points.points(size)?;
        // A branch has at least its start.
        let special = self.special.iter().map(|special| special.index).max().unwrap_or(0);
        if special >= points.len() {
            return Err(ArrayError::Special { index: special, points: points.len() });
        }
        Ok(Branch {
            forcing: self.amplitude,
            points,
            special: self.special.clone(),
            outcome: self.outcome,
            rejections: self.rejections,
        })
    }
}

/// The result of a task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[expect(clippy::large_enum_variant, reason = "one of them exists at a time")]
pub enum FindingMessage {
    /// A branch that was not known.
    Branch(BranchMessage),
    /// No new branch, and why.
    Nothing(SeedOutcome),
}

impl From<&Finding> for FindingMessage {
    fn from(finding: &Finding) -> Self {
        match finding {
            Finding::Branch(branch) => Self::Branch(branch.into()),
            Finding::Nothing(outcome) => Self::Nothing(*outcome),
        }
    }
}
