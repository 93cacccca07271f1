//! Branches that random starts lead to.

use super::ring::quiet;
use solver::response::branch::BranchKind;
use solver::response::name::BranchId;
use solver::response::starts::{StartPlace, land};
use solver::response::task::{Task, TaskResult};
use solver::response::trace::{Given, execute};
use solver::{Branch, Forced};

/// The main branch, and with it those that so many batches of random starts lead to.
pub fn branches_from_starts(forced: &mut Forced<'_>, main: Branch, batches: usize) -> Vec<(BranchId, Branch)> {
    let mut found = vec![(BranchId::new(BranchKind::Main, 0), main)];
    for batch in 0..batches {
        let place = StartPlace::random(batch);
        let Ok(landings) = land(forced, &place) else { continue };
        loop {
            let known: Vec<(BranchId, &Branch)> = found.iter().map(|(id, branch)| (*id, branch)).collect();
            let given = Given { landings: &landings, known: &known, ..Given::default() };
            let begun = execute(forced, &Task::Begin(place), &given, &mut quiet);
            let Some(TaskResult::Branch(branch)) = begun else { break };
            found.push((BranchId::new(branch.kind, found.len()), branch));
        }
    }
    found
}
