//! Where curves over the forcing amplitude start, and where they cross levels.

use crate::formulation::unknown::Quantity;
use crate::response::branch::BranchKind;
use crate::response::name::BranchId;
use crate::response::scout::ScoutPlace;
use serde::{Deserialize, Serialize};

/// Where a fold curve starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(untagged)]
pub enum FoldPlace {
    /// At a fold of a branch of the task's level.
    Branch {
        /// The branch.
        branch: BranchId,
        /// Number of the fold along the branch, from 0.
        fold: usize,
    },
    /// At a fold that a scout met.
    Scout {
        /// The scout.
        scout: ScoutPlace,
        /// Number of the fold among those that it met, from 0.
        fold: usize,
    },
}

impl FoldPlace {
    /// Of a branch with so many folds those that are followed: not of one that branches off others, whose fold curves end where they
    /// meet those branch points over the forcing, or run along them.
    pub fn of(branch: BranchId, folds: usize) -> impl Iterator<Item = Self> {
        let is_followed = branch.kind != BranchKind::Branched;
        (0..folds).filter(move |_| is_followed).map(move |fold| Self::Branch { branch, fold })
    }
}

/// What is carried over the forcing amplitude at fixed frequency: where an open branch enters the frequencies of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct CarryPlace {
    /// The branch, of the task's level.
    pub branch: BranchId,
    /// From which of its ends.
    pub end: BranchEnd,
}

/// An end of an open branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BranchEnd {
    /// Where its first point is.
    First,
    /// Where its last point is.
    Last,
}

impl CarryPlace {
    /// What is carried of a branch: one that leaves through bounds of the frequency need not have a fold that leads to the same
    /// branch at another forcing amplitude.
    pub fn of(branch: BranchId) -> impl Iterator<Item = Self> {
        let is_carried = matches!(branch.kind, BranchKind::Open | BranchKind::Cut);
        [BranchEnd::First, BranchEnd::Last].into_iter().filter(move |_| is_carried).map(move |end| Self { branch, end })
    }
}

/// Where a branch crosses another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct SwitchPlace {
    /// The branch that is crossed, of the task's level.
    pub branch: BranchId,
    /// Number of the branch point along it, from 0.
    pub point: usize,
}

/// Where a curve over the forcing amplitude starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Origin {
    /// At a fold.
    Fold(FoldPlace),
    /// At a response that is carried at fixed frequency.
    Carry(CarryPlace),
}

impl Origin {
    /// What has an extremum along the curve; nothing if its frequency is fixed.
    pub fn quantity(self) -> Option<Quantity> {
        match self {
            Self::Fold(_) => Some(Quantity::Frequency),
            Self::Carry(_) => None,
        }
    }
}

/// Where a curve crosses a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct CrossingPlace {
    /// Number of the curve, from 0.
    pub curve: usize,
    /// The crossing lies between this point of the curve and the next.
    pub segment: usize,
}
