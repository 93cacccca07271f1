//! What a run has found so far, level by level, as the store has it: branches, windows and what became of them.

mod levels;
mod summary;

pub use levels::BranchRow;
pub use summary::{LevelSummary, Rise, Survey, survey};

pub(crate) use levels::{LevelRow, WindowOutcome, WindowRow, branches, levels, main_failure, windows};
