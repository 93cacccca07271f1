//! Telling what is new from the branches of a level that are known.

use crate::formulation::Formulation;
use crate::formulation::state::State;
use crate::response::branch::{Branch, BranchKind, Outcome, SpecialKind, Stop};
use crate::response::forced::Forced;
use crate::response::name::BranchId;
use crate::response::switch::{Crossed, beside};
use crate::response::task::{SeedOutcome, TaskResult};

/// A curve along a main branch is another one only if it is higher by more than this, relative.
const HIGHER: f64 = 1e-3;

/// Of its width, how far the ends of a closed curve that is traced twice are from each other.
const SAME_ENDS: f64 = 1e-2;

/// Relative distance of the largest motions of a closed curve that is traced twice.
const SAME_PEAK: f64 = 1e-3;

/// Places along a branch that are looked at where something breaks off, or goes on.
const PLACES: usize = 24;

/// A new branch, of the kind that it has in view of those known: one that crosses a main branch branches off it, a piece of a main branch
/// is main, and as long as a known branch goes on where it ends, nobody knows whether an open curve is detached from it.
pub(super) fn named<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    branch: Branch,
    known: &[(BranchId, &Branch)],
) -> Branch {
    if branch.is_cancelled() || branch.is_branched() {
        return branch;
    }
    if crosses(forced, &branch, known) {
        return branch.branching_off();
    }
    if branch.is_closed() {
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

/// Whether a branch crosses, at a branch point of its own, one that is attached to a main branch, or leaves an isola there: in a cyclic
/// structure, say, closed curves of motions that lose a symmetry of the structure leave the main branch at one point and come back to it at
/// another.
fn crosses<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, branch: &Branch, known: &[(BranchId, &Branch)]) -> bool {
    let is_crossed = |id: &BranchId, is_parent: bool| match id.kind {
        BranchKind::Main | BranchKind::Branched => true,
        // Either may branch off the other one.
        BranchKind::Isola => is_parent,
        _ => false,
    };
    let others: Vec<&(BranchId, &Branch)> = known.iter().filter(|(id, _)| is_crossed(id, true)).collect();
    let count = if others.is_empty() { 0 } else { branch.special(SpecialKind::BranchPoint).count() };
    (0..count).any(|point| {
        let Crossed { states, is_parent } = beside(forced, branch, point);
        let mut others = others.iter().filter(|(id, _)| is_crossed(id, is_parent));
        others.any(|(_, other)| states.iter().any(|state| forced.lies_on(state, other)))
    })
}

/// The branch that a converged state lies on, if it is known.
pub(super) fn identify<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    state: &State,
    known: &[(BranchId, &Branch)],
) -> Option<BranchId> {
    known.iter().find(|(_, branch)| forced.lies_on(state, branch)).map(|(id, _)| *id)
}

/// What is new of a branch. Of a closed curve that was come upon by a wrong step nothing is known but that it is closed.
pub(super) fn new_part<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    branch: Branch,
    known: &[(BranchId, &Branch)],
) -> TaskResult {
    let first = branch.points.first().filter(|_| branch.is_closed());
    if let Some(id) = first.and_then(|first| identify(forced, &first.state, known)) {
        return TaskResult::Nothing(SeedOutcome::Found(id));
    }
    if let Some(id) = retraced(forced, &branch, known) {
        return TaskResult::Nothing(SeedOutcome::Found(id));
    }
    match unknown_part(forced, branch, known) {
        Ok(branch) => TaskResult::Branch(branch),
        Err(id) => TaskResult::Nothing(SeedOutcome::Found(id)),
    }
}

/// What of an open branch is not part of known ones: from where it leaves one to where it comes to another, around the point
/// from which it was followed if that is on none. What it is beyond a known branch that it runs across is left to other seeds.
///
/// # Errors
/// The known branch, if it lies on known ones from where it was followed to both ends.
pub(super) fn unknown_part<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    mut branch: Branch,
    known: &[(BranchId, &Branch)],
) -> Result<Branch, BranchId> {
    let Outcome::Open(mut first, mut last) = branch.outcome else { return Ok(branch) };
    if branch.is_cancelled() || branch.points.is_empty() {
        return Ok(branch);
    }
    let mut probes = meetings(forced, &branch, known);
    let count = branch.points.len();
    let mut at = |index: usize| {
        // A branch point lies on what the branch branches off.
        let is_branching = (index == 0 && first == Stop::Branching) || (index + 1 == count && last == Stop::Branching);
        if is_branching { None } else { identify(forced, &branch.points[index].state, known) }
    };
    let start = branch.special.iter().find(|special| special.kind == SpecialKind::Start).map(|special| special.index);
    let (begin, end) = match (start.filter(|&start| at(start).is_none()), at(0), at(count - 1)) {
        (Some(start), ..) => {
            // Where it crosses a known one it is on that at one point alone.
            let mut goes_on = |index: usize, next: Option<usize>| {
                at(index).is_some() && next.filter(|&next| next < count).is_none_or(|next| at(next).is_some())
            };
            let mut behind = |index: usize| goes_on(index, index.checked_sub(1));
            probes.sort_unstable();
            let before = probes.iter().copied().rev().find(|&index| index < start && behind(index));
            let begin = before.map_or(0, |known| known + boundary(start - known, |step| behind(known + step)));
            let mut ahead = |index: usize| goes_on(index, Some(index + 1));
            let after = probes.iter().copied().find(|&index| index > start && ahead(index));
            (begin, after.map_or(count, |known| start + boundary(known - start, |step| !ahead(start + step))))
        }
        (None, Some(id), Some(_)) => return Err(id),
        (None, None, None) => match start.and_then(at) {
            Some(id) => return Err(id),
            None => return Ok(branch),
        },
        (None, Some(_), None) => (boundary(count, |index| at(index).is_some()), count),
        (None, None, Some(_)) => (0, boundary(count, |index| at(index).is_none())),
    };
    if begin > 0 {
        first = Stop::Joined;
    }
    if end < count {
        last = Stop::Joined;
    }
    let kept = begin.saturating_sub(1)..(end + 1).min(count);
    branch.keep(kept);
    branch.outcome = Outcome::Open(first, last);
    Ok(branch)
}

/// Numbers of the points of a branch where it may be on known ones: its ends, and those beside the ends of open ones that lie on
/// it. Where one of them breaks off, its end need not lie on the other, which may have passed over the place; nor need that of a known one
/// on one that goes on beyond it, with steps that are long there: then places all along the branch as well.
fn meetings<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    branch: &Branch,
    known: &[(BranchId, &Branch)],
) -> Vec<usize> {
    let open = known.iter().filter(|(_, other)| !other.is_closed());
    let ends = open.flat_map(|(_, other)| [other.points.first(), other.points.last()]).flatten();
    let met = ends.filter_map(|end| forced.position_on(&end.state, branch)).flat_map(|before| [before, before + 1]);
    let last = branch.points.len() - 1;
    let breaks_off = branch.outcome.is_unfinished() || known.iter().any(|(_, other)| other.outcome.is_unfinished());
    let leaves = |stop: Stop| matches!(stop, Stop::FrequencyBound | Stop::AmplitudeBound);
    let goes_on = matches!(branch.outcome, Outcome::Open(first, last) if leaves(first) || leaves(last));
    let along = (1..PLACES).map(|place| place * last / PLACES).filter(|_| breaks_off || goes_on);
    met.chain(along).chain([0, last]).collect()
}

/// First of `count` indices for which a condition does not hold that holds up to there, for the first one at least.
fn boundary(count: usize, mut holds: impl FnMut(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, count);
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// The branch that a curve is, though no point that was looked at lies on it, if it is one: the closed curve with the same ends
/// and the same peak (a very narrow one turns too much from point to point to be met between them), such a one between branch
/// points, or the main branch that an open curve runs along from end to end and is no higher than within its range (what the steps
/// of one of the two have passed over is no branch of its own).
fn retraced<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    branch: &Branch,
    known: &[(BranchId, &Branch)],
) -> Option<BranchId> {
    if branch.is_cancelled() {
        return None;
    }
    let is_it = |(_, other): &&(BranchId, &Branch)| match (branch.is_closed(), other.is_closed()) {
        (true, true) => is_same_loop(forced, branch, other),
        (false, false) if branch.is_branched() || other.is_branched() => {
            branch.is_branched() && other.is_branched() && is_same_loop(forced, branch, other)
        }
        (false, false) => runs_along(forced, branch, other),
        _ => false,
    };
    known
        .iter()
        .filter(|(id, other)| {
            other.is_closed() || other.is_branched() || (id.is_main() && !other.outcome.is_unfinished())
        })
        .find(is_it)
        .map(|(id, _)| *id)
}

fn is_same_loop<'m, F: Formulation<'m>>(forced: &Forced<'m, F>, branch: &Branch, other: &Branch) -> bool {
    let ((low, high), (other_low, other_high)) = (branch.frequency_range(), other.frequency_range());
    let apart = (low - other_low).abs().max((high - other_high).abs());
    let is_near = apart <= SAME_ENDS * (high - low).max(f64::EPSILON * high);
    is_near && forced.distance(&branch.peak().state, &other.peak().state) < SAME_PEAK
}

fn runs_along<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, branch: &Branch, main: &Branch) -> bool {
    let ((low, high), highest) = (main.frequency_range(), main.peak().amplitude());
    let mut within = branch.points.iter().filter(|point| (low..=high).contains(&point.omega()));
    let ends = [main.points.first(), main.points.last()];
    within.all(|point| point.amplitude() <= (1.0 + HIGHER) * highest)
        && ends.iter().flatten().all(|end| forced.lies_on(&end.state, branch))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files;
    use crate::formulation::pressure::PressureForm;
    use crate::response::backbone::Backbone;
    use crate::response::level::Level;
    use crate::settings::Settings;
    use std::ops::ControlFlow;
    use std::path::Path;

    #[test]
    fn a_loop_that_is_traced_again_is_the_same_and_another_one_is_not() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/damper_two_isolas");
        let model = files::load(&folder).unwrap();
        let settings = Settings::default();
        let backbone = Backbone::compute(&model, &settings).unwrap();
        let level = Level::compute(&model, &settings, &backbone, 0.016).unwrap();
        let isolas: Vec<(BranchId, &Branch)> = level.branches().filter(|(_, branch)| branch.is_closed()).collect();
        let [(first, isola), (second, other)] = isolas[..] else { panic!("two isolas") };
        let reach = crate::response::forced::SearchRange::new(&settings, &backbone).unwrap();
        let mut forced: Forced<'_, PressureForm<'_>> = Forced::build(&model, &settings, reach, 0.016).unwrap();
        let begin = isola.points[isola.points.len() / 3].state.clone();
        let again = forced.branch_through(&begin, &mut |_| ControlFlow::Continue(())).unwrap();
        assert!(again.is_closed());
        assert_eq!(retraced(&mut forced, &again, &[(second, other), (first, isola)]), Some(first));
        assert_eq!(retraced(&mut forced, &again, &[(second, other)]), None);
    }
}
