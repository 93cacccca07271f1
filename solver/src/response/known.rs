//! Telling what is new from the branches of a level that are known.

use crate::formulation::Formulation;
use crate::formulation::state::State;
use crate::response::branch::{Branch, BranchKind};
use crate::response::forced::Forced;
use crate::response::name::BranchId;

/// A curve along a main branch is another one only if it is higher by more than this, relative.
const HIGHER: f64 = 1e-3;

/// A new branch, of the kind that it has in view of those known: a piece of a main branch is main, and as long as a known branch
/// goes on where it ends, nobody knows whether an open curve is detached from it.
pub(super) fn named<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    branch: Branch,
    known: &[(BranchId, &Branch)],
) -> Branch {
    if branch.is_cancelled() || branch.is_closed() {
        return branch;
    }
    let ends = |branch: &Branch| [branch.points.first(), branch.points.last()].map(|end| end.map(|p| p.state.clone()));
    let piece = known.iter().find(|(_, other)| {
        let is_met = ends(&branch).iter().flatten().any(|end| forced.lies_on(end, other));
        is_met || (!other.is_closed() && ends(other).iter().flatten().any(|end| forced.lies_on(end, &branch)))
    });
    let kind = match piece {
        Some((id, _)) if id.is_main() => BranchKind::Main,
        Some(_) => branch.kind,
        None if branch.kind == BranchKind::Open && known.iter().any(|(_, other)| other.outcome.is_unfinished()) => {
            BranchKind::Cut
        }
        None => branch.kind,
    };
    Branch { kind, ..branch }
}

/// The branch that a converged state lies on, if it is known.
pub(super) fn identify<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    state: &State,
    known: &[(BranchId, &Branch)],
) -> Option<BranchId> {
    known.iter().find(|(_, branch)| forced.lies_on(state, branch)).map(|(id, _)| *id)
}

/// The main branch that an open curve runs along from end to end, if there is one and the curve is no higher within its range:
/// what the steps of one of the two have passed over is no branch of its own.
pub(super) fn retraced<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    branch: &Branch,
    known: &[(BranchId, &Branch)],
) -> Option<BranchId> {
    if branch.is_cancelled() || branch.is_closed() {
        return None;
    }
    let mut mains = known.iter().filter(|(id, main)| id.is_main() && !main.outcome.is_unfinished());
    let mut runs_along = |main: &Branch| {
        let ((low, high), highest) = (main.frequency_range(), main.peak().amplitude());
        let mut within = branch.points.iter().filter(|point| (low..=high).contains(&point.omega()));
        let ends = [main.points.first(), main.points.last()];
        within.all(|point| point.amplitude() <= (1.0 + HIGHER) * highest)
            && ends.iter().flatten().all(|end| forced.lies_on(&end.state, branch))
    };
    mains.find(|(_, main)| runs_along(main)).map(|(id, _)| *id)
}
