//! Following what branches have over the forcing amplitude: their folds, and those of their responses that no fold leads from.

use crate::formulation::Formulation;
use crate::formulation::state::State;
use crate::response::branch::{Observer, SpecialKind};
use crate::response::forced::Forced;
use crate::response::given::Given;
use crate::response::task::{BranchEnd, CarryPlace, FoldPlace, Origin, SeedOutcome, Task, TaskResult, Unfollowed};

/// What is carried over the forcing amplitude lies this share of the study's frequencies within them: at the same frequency
/// whatever the level is.
const WITHIN: f64 = 1e-3;

/// Follows what a task names over the forcing amplitude, unless it lies on a known curve. `None` if `observer` breaks.
pub(super) fn follow<'m, F: Formulation<'m>>(
    forced: &Forced<'m, F>,
    task: &Task,
    given: &Given<'_>,
    observer: &mut Observer<'_>,
) -> Option<TaskResult> {
    let nothing = |failure| Some(TaskResult::Nothing(SeedOutcome::NotFollowed(failure)));
    let state = match task.origin()? {
        Origin::Fold(place) => fold(&place, given),
        Origin::Carry(place) => carried(&place, given, forced.reach().frequency),
    };
    let Some(state) = state else { return nothing(Unfollowed::Elsewhere) };
    let critical = match task.origin()?.quantity() {
        Some(quantity) => forced.extrema(quantity),
        None => forced.responses_at(state.omega),
    };
    let mut critical = match critical {
        Ok(critical) => critical,
        Err(error) => return nothing(error.into()),
    };
    if let Some((number, _)) = given.curves.iter().find(|(_, curve)| critical.lies_on(&state, curve)) {
        return Some(TaskResult::Nothing(SeedOutcome::OnCurve(*number)));
    }
    match critical.curve(&state, observer) {
        Ok(curve) if curve.is_cancelled() => None,
        Ok(curve) => Some(TaskResult::Curve(curve)),
        Err(error) => nothing(error.into()),
    }
}

/// A fold of a branch, or one that a scout met.
fn fold(place: &FoldPlace, given: &Given<'_>) -> Option<State> {
    match *place {
        FoldPlace::Branch { branch, fold } => {
            let fold = given.branch(branch)?.special(SpecialKind::Fold).nth(fold);
            fold.map(|fold| fold.state.clone())
        }
        FoldPlace::Scout { fold, .. } => given.landings.get(fold).map(|landing| landing.state.clone()),
    }
}

/// Where a branch comes, from one of its ends, into the frequencies of the study.
fn carried(place: &CarryPlace, given: &Given<'_>, (low, high): (f64, f64)) -> Option<State> {
    let points = &given.branch(place.branch)?.points;
    let margin = WITHIN * (high - low);
    let within = low + margin..=high - margin;
    let is_within = |i: &usize| within.contains(&points[*i].omega());
    let count = points.len();
    let (first, outside) = match place.end {
        BranchEnd::First => {
            let first = (0..count).find(is_within)?;
            (first, first.checked_sub(1))
        }
        BranchEnd::Last => {
            let last = (0..count).rev().find(is_within)?;
            (last, Some(last + 1).filter(|next| *next < count))
        }
    };
    let inside = &points[first].state;
    let Some(outside) = outside.map(|i| &points[i].state) else { return Some(inside.clone()) };
    let bound = if outside.omega < inside.omega { *within.start() } else { *within.end() };
    let share = (bound - inside.omega) / (outside.omega - inside.omega);
    Some(State { omega: bound, ..inside.interpolate(outside, share) })
}
