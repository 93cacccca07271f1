//! What branches off what. Whichever of two branches that cross is come upon first, the one that branches off comes second: only then it is
//! known what the first one is.

use crate::formulation::Formulation;
use crate::formulation::state::State;
use crate::response::branch::{Branch, BranchKind, Observer, SpecialKind};
use crate::response::forced::Forced;
use crate::response::known::{identify, named, new_part};
use crate::response::name::BranchId;
use crate::response::switch::{Crossed, beside};
use crate::response::symmetry::parents;
use crate::response::task::TaskResult;

/// Relative distance of a response from where it is looked for, up to which it is that.
const BESIDE: f64 = 0.05;

/// A new branch that a task has brought, or what it branches off, if that is not known either: it may be an isola, and the branch is none.
/// From there the branch is come upon again, at a branch point; a task that `is_repeated` comes upon it itself.
pub(super) fn parent_first<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    found: TaskResult,
    known: &[(BranchId, &Branch)],
    is_repeated: bool,
    observer: &mut Observer<'_>,
) -> TaskResult {
    let TaskResult::Branch(branch) = &found else { return found };
    let mut line = vec![branch.clone()];
    while let Some(parent) = parent(forced, &line, known, is_repeated, observer) {
        if parent.is_cancelled() {
            return TaskResult::Branch(parent);
        }
        line.push(parent);
    }
    match line.pop().filter(|_| !line.is_empty()).map(|first| new_part(forced, first, known)) {
        Some(TaskResult::Branch(first)) => TaskResult::Branch(first),
        _ => found,
    }
}

/// What the last one of branches, each of which the one before it branches off, branches off itself, if that is neither known nor one of
/// them.
fn parent<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    line: &[Branch],
    known: &[(BranchId, &Branch)],
    is_repeated: bool,
    observer: &mut Observer<'_>,
) -> Option<Branch> {
    let branch = line.last()?;
    for state in responses_on_parents(forced, branch) {
        let is_known = identify(forced, &state, known).is_some() || line.iter().any(|one| forced.lies_on(&state, one));
        if is_known || forced.is_shorter(&state) {
            continue;
        }
        let Ok(parent) = forced.branch_through(&state, observer) else { continue };
        let parent = named(forced, parent, known);
        if parent.is_cancelled() {
            return Some(parent);
        }
        let is_spare = parent.kind == BranchKind::Main && whole_main(known).is_some();
        if !is_spare && !parent.is_branched() && (is_repeated || leads_to(forced, &parent, branch)) {
            return Some(parent);
        }
    }
    None
}

/// Responses on what a branch branches off: beside its ends, or its branch points if it closes and is not known to branch off anything.
fn responses_on_parents<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, branch: &Branch) -> Vec<State> {
    let mut list = Vec::new();
    for motion in parents(forced.problem(), branch) {
        let state = forced.converge(&motion).ok();
        list.extend(state.filter(|state| forced.distance(state, &motion) < BESIDE));
    }
    let count = if branch.kind == BranchKind::Isola { branch.special(SpecialKind::BranchPoint).count() } else { 0 };
    for point in 0..count {
        let Crossed { states, is_parent } = beside(forced, branch, point);
        list.extend(states.into_iter().take(usize::from(is_parent)));
    }
    list
}

/// Whether one of the branch points of a branch leads to another branch.
fn leads_to<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, branch: &Branch, other: &Branch) -> bool {
    let count = branch.special(SpecialKind::BranchPoint).count();
    (0..count).any(|point| beside(forced, branch, point).states.iter().any(|state| forced.lies_on(state, other)))
}

/// A main branch that is whole: it goes on beyond the range, and what is not on it is a loop that its steps have passed over.
pub(super) fn whole_main(known: &[(BranchId, &Branch)]) -> Option<BranchId> {
    known.iter().find(|(id, main)| id.is_main() && !main.outcome.is_unfinished()).map(|(id, _)| *id)
}
