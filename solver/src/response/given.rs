//! What a task is given beside its level.

use crate::response::branch::Branch;
use crate::response::critical::CriticalCurve;
use crate::response::name::BranchId;
use crate::response::seeds::{Landing, Seed};

/// What a task is given beside its level.
#[derive(Debug, Clone, Copy, Default)]
pub struct Given<'g> {
    /// Those of [`Task::seeds`](crate::response::task::Task::seeds).
    pub seeds: &'g [Seed],
    /// Of a seed: what it landed on; of a fold that a scout met: all that it met.
    pub landings: &'g [Landing],
    /// The branches found at this level before it; of what starts a curve on a branch, that branch.
    pub known: &'g [(BranchId, &'g Branch)],
    /// Curves over the forcing amplitude found before: those that a point may lie on, or the one that crosses the level.
    pub curves: &'g [(usize, &'g CriticalCurve)],
}

impl<'g> Given<'g> {
    /// The branch of this name.
    pub(super) fn branch(&self, id: BranchId) -> Option<&'g Branch> {
        self.known.iter().find(|(known, _)| *known == id).map(|(_, branch)| *branch)
    }
}
