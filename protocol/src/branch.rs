//! A branch as a message.

use crate::array::ArrayError;
use crate::critical::CriticalMessage;
use crate::curve::{Motions, Points, Size};
use crate::landings::LandingsMessage;
use serde::{Deserialize, Serialize};
use solver::response::branch::{Branch, BranchKind, Certificate, Outcome, SpecialKind, SpecialPoint, Standing};
use solver::response::task::{Brought, SeedOutcome, TaskResult};
use solver::stability::disturbance::Disturbance;
use solver::stability::settling::Settling;
use solver::stability::verification::Verification;

/// A forced-response branch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BranchMessage {
    /// What kind of branch it is; not in results of the first programs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<BranchKind>,
    /// Forcing amplitude A.
    pub amplitude: f64,
    /// How it ends.
    pub outcome: Outcome,
    /// Start, peak and folds, by index of the point.
    pub special: Vec<SpecialPoint>,
    /// Steps that were refused and repeated shorter.
    pub rejections: usize,
    /// Whether the largest amplitude is that of a maximum; not in results of the first programs, as the next.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak_standing: Option<Standing>,
    /// What is known of the harmonics that were left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certificate: Option<Certificate>,
    /// Points in the order of the arc; a closed branch does not repeat its first one.
    pub points: Points,
}

impl From<&Branch> for BranchMessage {
    fn from(branch: &Branch) -> Self {
        Self {
            kind: Some(branch.kind),
            amplitude: branch.forcing,
            outcome: branch.outcome,
            special: branch.special.clone(),
            rejections: branch.rejections,
            peak_standing: Some(branch.peak_standing()),
            certificate: Some(branch.certificate),
            points: Points::new(branch.points.iter()),
        }
    }
}

impl BranchMessage {
    /// What kind of branch it is, as far as its ends tell where it does not say so.
    pub fn kind(&self) -> BranchKind {
        self.kind.unwrap_or_else(|| BranchKind::of_detached(&self.outcome, false))
    }

    /// Number of its special points of a kind.
    pub fn count(&self, kind: SpecialKind) -> usize {
        self.special.iter().filter(|special| special.kind == kind).count()
    }

    /// The branch, for a model of this size.
    ///
    /// # Errors
    /// Arrays of other shapes than such a model has, values that are not finite, and special points that are none of its own.
    pub fn branch(&self, size: &Size) -> Result<Branch, ArrayError> {
        let points = self.points.points(size)?;
        // A branch has at least its start.
        let special = self.special.iter().map(|special| special.index).max().unwrap_or(0);
        if special >= points.len() {
            return Err(ArrayError::Special { index: special, points: points.len() });
        }
        Ok(Branch {
            kind: self.kind(),
            forcing: self.amplitude,
            points,
            special: self.special.clone(),
            outcome: self.outcome,
            rejections: self.rejections,
            certificate: self.certificate.unwrap_or_default(),
        })
    }
}

/// The result of a task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TaskResultMessage {
    /// Forced responses that seeds landed on.
    Landings(LandingsMessage),
    /// A branch that was not known.
    Branch(BranchMessage),
    /// A curve over the forcing amplitude that was not known.
    Curve(CriticalMessage),
    /// What marching says of a branch.
    Verification(Verification),
    /// Where pushes end.
    Disturbance(Disturbance),
    /// What an unstable motion turns into.
    Settling(Settling),
    /// No new branch, and why.
    Nothing(SeedOutcome),
}

impl TaskResultMessage {
    /// The motions in it, if there are some.
    pub fn motions(&self) -> Option<&Motions> {
        match self {
            Self::Landings(landings) => Some(&landings.motions),
            Self::Branch(branch) => Some(&branch.points.motions),
            Self::Curve(curve) => Some(&curve.points.motions),
            Self::Verification(_) | Self::Disturbance(_) | Self::Settling(_) | Self::Nothing(_) => None,
        }
    }

    /// The same without the branch itself.
    pub fn brought(&self) -> Brought {
        match self {
            Self::Landings(landings) => Brought::Landings(landings.motions.len()),
            Self::Branch(branch) => Brought::Branch {
                kind: branch.kind(),
                folds: branch.count(SpecialKind::Fold),
                branch_points: branch.count(SpecialKind::BranchPoint),
            },
            Self::Curve(curve) => Brought::Curve(curve.forcing().into()),
            Self::Verification(verification) => {
                Brought::Verification(verification.points.len(), verification.unsettled().into())
            }
            Self::Disturbance(disturbance) => Brought::Disturbance(disturbance.endings.len()),
            Self::Settling(settling) => Brought::Settling(settling.periods),
            Self::Nothing(outcome) => Brought::Nothing(*outcome),
        }
    }
}

impl From<&TaskResult> for TaskResultMessage {
    fn from(finding: &TaskResult) -> Self {
        match finding {
            TaskResult::Landings(landings) => Self::Landings(landings[..].into()),
            TaskResult::Branch(branch) => Self::Branch(branch.into()),
            TaskResult::Curve(curve) => Self::Curve(curve.into()),
            TaskResult::Nothing(outcome) => Self::Nothing(*outcome),
        }
    }
}
