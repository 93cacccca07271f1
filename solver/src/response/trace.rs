//! Carrying out a task: landing, tracing, telling what is new from what is known.

use crate::curve::problem::Failure;
use crate::formulation::Formulation;
use crate::formulation::state::State;
use crate::response::branch::{Branch, BranchKind, BranchPoint, Observer, Outcome, Side, Stop};
use crate::response::follow::follow as follow_over_forcing;
use crate::response::forced::Forced;
use crate::response::forcing::Unreached;
pub use crate::response::given::Given;
use crate::response::known::{identify, named, new_part, unknown_part};
use crate::response::lineage::{parent_first, whole_main};
use crate::response::name::BranchId;
use crate::response::passing::passing;
use crate::response::scout::scout;
use crate::response::seeds::{Landing, LandingFailure, LandingMethod, land_all};
use crate::response::starts;
use crate::response::switch::{Crossed, beside};
use crate::response::task::{CrossingPlace, SeedOutcome, SeedPlace, SwitchPlace, Task, TaskResult};
use std::ops::ControlFlow;

/// Carries out a task; of one that marches nothing, which takes no balance. `None` if `observer` breaks, or the
/// task is interrupted.
pub fn execute<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    task: &Task,
    given: &Given<'_>,
    observer: &mut Observer<'_>,
) -> Option<TaskResult> {
    let Given { seeds, landings, known, .. } = *given;
    let finding = match task {
        Task::Main(side) => enter(forced, *side, known, observer)
            .unwrap_or_else(|failure| TaskResult::Nothing(SeedOutcome::NotTraced(failure))),
        Task::Land(place) => land_all(forced, seeds, place.method, place.well.mode).map_or_else(
            |failure| TaskResult::Nothing(SeedOutcome::NotLanded(LandingFailure::NotConverged(failure))),
            |landings| landed(forced, landings),
        ),
        Task::Seed(place) => match follow(forced, place, landings, known, observer) {
            // Only once all else has been tried: what is not known yet is what seeds are for.
            TaskResult::Nothing(failed @ SeedOutcome::NotLanded(_))
                if place.method == LandingMethod::SteppedForcing =>
            {
                let passing = passing(forced, seeds, &place.well, known);
                TaskResult::Nothing(passing.map_or(failed, |(id, distance)| SeedOutcome::Passing(id, distance)))
            }
            finding => finding,
        },
        Task::Fold(_) | Task::Carry(_) => return follow_over_forcing(forced, task, given, observer),
        Task::Crossing(place) => cross(forced, place, given, observer),
        Task::Switch(place) => switch(forced, place, given, observer),
        Task::Start(place) => starts::land(forced, place).map_or_else(
            |failure| TaskResult::Nothing(SeedOutcome::NotLanded(LandingFailure::NotConverged(failure.into()))),
            |landings| landed(forced, landings),
        ),
        Task::Begin(_) => begin(forced, landings, known, observer),
        Task::Scout(place) => {
            let mut begin = |forced: &mut Forced<'m, F>, landings: &[Landing], known: &[(BranchId, &Branch)]| {
                match begin(forced, landings, known, observer) {
                    TaskResult::Branch(branch) if branch.is_cancelled() => ControlFlow::Break(()),
                    TaskResult::Branch(branch) => ControlFlow::Continue(Some(branch)),
                    // Starts that lead to nothing new take their time as well: a point that was told before is told again.
                    _ => match known.iter().find_map(|(_, branch)| branch.points.first()) {
                        Some(point) if observer(point).is_break() => ControlFlow::Break(()),
                        _ => ControlFlow::Continue(None),
                    },
                }
            };
            match scout(forced, place, &mut begin)? {
                folds if folds.is_empty() => TaskResult::Nothing(SeedOutcome::NoFold),
                folds => TaskResult::Landings(folds),
            }
        }
        Task::Verify(_) => TaskResult::Nothing(SeedOutcome::Verified(0)),
        Task::Disturb(_) => TaskResult::Nothing(SeedOutcome::Disturbed(0)),
        Task::March(_) => TaskResult::Nothing(SeedOutcome::Marched(0)),
    };
    // What an interrupted landing has come to is no result.
    if forced.interrupt().is_set() {
        return None;
    }
    let TaskResult::Branch(mut branch) = finding else { return Some(finding) };
    if branch.is_cancelled() {
        return None;
    }
    let mut is_cancelled = false;
    forced.certify(&mut branch, &mut |point| {
        let flow = observer(point);
        is_cancelled |= flow.is_break();
        flow
    });
    (!is_cancelled).then_some(TaskResult::Branch(branch))
}

/// What of landings is of the order that is looked for.
fn landed<'m, F: Formulation<'m>>(forced: &Forced<'m, F>, landings: Vec<Landing>) -> TaskResult {
    let own: Vec<Landing> = landings.into_iter().filter(|landing| !forced.is_shorter(&landing.state)).collect();
    match own.is_empty() {
        true => TaskResult::Nothing(SeedOutcome::NotLanded(LandingFailure::Shorter)),
        false => TaskResult::Landings(own),
    }
}

/// Traces the main branch from a side; if that is known, what a growing forcing leads to from rest, if it is something else.
fn enter<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    side: Side,
    known: &[(BranchId, &Branch)],
    observer: &mut Observer<'_>,
) -> Result<TaskResult, Unreached> {
    let is_whole = |(id, branch): &&(BranchId, &Branch)| id.is_main() && ends_ordinarily(forced, branch, side);
    if let Some((id, _)) = known.iter().find(is_whole) {
        // What the main branch was not entered by, since it lies on a curve that closes.
        let grown = forced.grown_from_rest(Side::Below);
        return Ok(match grown.map(|state| branch_from(forced, &state, known, observer)) {
            Some(TaskResult::Branch(branch)) if branch.kind != BranchKind::Main => TaskResult::Branch(branch),
            _ => TaskResult::Nothing(SeedOutcome::Found(*id)),
        });
    }
    let branch = forced.main_branch(side, observer)?;
    if branch.kind != BranchKind::Main {
        return Ok(new_part(forced, branch, known));
    }
    let (low, high) = forced.reach().frequency;
    let is_inside = |point: &BranchPoint| point.omega() > low * (1.0 + 1e-6) && point.omega() < high * (1.0 - 1e-6);
    // One step may lead from bound to bound.
    let is_within = |point: &BranchPoint| (low * (1.0 - 1e-6)..=high * (1.0 + 1e-6)).contains(&point.omega());
    Ok(match unknown_part(forced, branch, known) {
        // Beyond the range the one that is known goes on as well; where they meet does not count.
        Ok(branch) if branch.is_joined() && !inner(&branch.points).iter().any(is_inside) => {
            TaskResult::Nothing(SeedOutcome::Found(known[0].0))
        }
        // It turned back before it came into the range.
        Ok(branch) if !branch.outcome.is_unfinished() && !branch.points.iter().any(is_within) => {
            TaskResult::Nothing(SeedOutcome::OutOfBounds)
        }
        Ok(branch) => TaskResult::Branch(branch),
        Err(id) => TaskResult::Nothing(SeedOutcome::Found(id)),
    })
}

/// Points between the ends.
fn inner(points: &[BranchPoint]) -> &[BranchPoint] {
    points.get(1..points.len().saturating_sub(1)).unwrap_or_default()
}

/// Traces the branch through where a curve crosses the level, unless it is known.
fn cross<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    place: &CrossingPlace,
    given: &Given<'_>,
    observer: &mut Observer<'_>,
) -> TaskResult {
    let forcing = forced.forcing();
    let curve = given.curves.iter().find(|(number, _)| *number == place.curve).map(|(_, curve)| *curve);
    let crossing = curve.and_then(|curve| {
        let mut critical = forced.like(curve).ok()?;
        Some(critical.crossing_at(curve, place.segment, forcing))
    });
    match crossing.unwrap_or(Err(Failure::Diverged)) {
        Ok(state) if forced.is_shorter(&state) => TaskResult::Nothing(SeedOutcome::NotLanded(LandingFailure::Shorter)),
        Ok(state) => {
            let found = branch_from(forced, &State { forcing, ..state }, given.known, observer);
            parent_first(forced, found, given.known, false, observer)
        }
        Err(failure) => TaskResult::Nothing(SeedOutcome::NotLanded(LandingFailure::NotConverged(failure.into()))),
    }
}

/// Traces the first branch that crosses a known one at a branch point of that and is not known.
fn switch<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    place: &SwitchPlace,
    given: &Given<'_>,
    observer: &mut Observer<'_>,
) -> TaskResult {
    let crossed = given.branch(place.branch);
    let Crossed { states, is_parent } =
        crossed.map_or_else(Crossed::default, |branch| beside(forced, branch, place.point));
    // An isola may be what branches off another one, which was not known.
    let is_parent = is_parent && place.branch.kind == BranchKind::Isola;
    let mut nothing = SeedOutcome::NotLanded(LandingFailure::NotConverged(Failure::Diverged.into()));
    for state in &states {
        if forced.is_shorter(state) {
            nothing = SeedOutcome::NotLanded(LandingFailure::Shorter);
            continue;
        }
        match branch_from(forced, state, given.known, observer) {
            TaskResult::Nothing(outcome) => nothing = outcome,
            TaskResult::Branch(branch) if is_parent => return TaskResult::Branch(branch),
            TaskResult::Branch(branch) => return TaskResult::Branch(branch.branching_off()),
            found => return found,
        }
    }
    TaskResult::Nothing(nothing)
}

/// The branch through a converged state, unless it is known; of one beyond the bounds of the study the first part within them
/// that is not.
fn branch_from<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    state: &State,
    known: &[(BranchId, &Branch)],
    observer: &mut Observer<'_>,
) -> TaskResult {
    if forced.contains(state) {
        return branch_through(forced, state, known, observer);
    }
    part_within(forced, state, known, &mut Vec::new(), observer)
}

/// Of the branch through a converged state beyond the bounds of the study the first part within its range that is not known;
/// `walked`: branches of which it is known that they have none, and this one if so.
fn part_within<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    state: &State,
    known: &[(BranchId, &Branch)],
    walked: &mut Vec<Branch>,
    observer: &mut Observer<'_>,
) -> TaskResult {
    let mut nothing = SeedOutcome::OutOfBounds;
    if walked.iter().any(|branch| forced.lies_on(state, branch)) {
        return TaskResult::Nothing(nothing);
    }
    let branch = match forced.branch_beyond(state, observer) {
        Ok(branch) if branch.is_cancelled() => return TaskResult::Branch(branch),
        Ok(branch) => branch,
        Err(failure) => return TaskResult::Nothing(SeedOutcome::NotTraced(failure.into())),
    };
    for state in forced.within_range(&branch) {
        match branch_through(forced, &state, known, observer) {
            TaskResult::Nothing(outcome) => nothing = outcome,
            found => return found,
        }
    }
    walked.push(branch);
    TaskResult::Nothing(nothing)
}

/// The branch through a converged state within the bounds of the study, unless it is known.
fn branch_through<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    state: &State,
    known: &[(BranchId, &Branch)],
    observer: &mut Observer<'_>,
) -> TaskResult {
    if let Some(id) = identify(forced, state, known) {
        return TaskResult::Nothing(SeedOutcome::Found(id));
    }
    let branch = match forced.branch_through(state, observer) {
        Ok(branch) => named(forced, branch, known),
        Err(failure) => return TaskResult::Nothing(SeedOutcome::NotTraced(failure.into())),
    };
    new_part(forced, branch, known)
}

/// Whether a main branch ends at the other side of the range with the response that one from there would begin with.
fn ends_ordinarily<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, branch: &Branch, side: Side) -> bool {
    let ((low, high), given) = (forced.reach().frequency, forced.settings().frequency);
    let Some(last) = branch.points.last() else { return false };
    let (bound, is_given, beyond) = match side {
        Side::Below => (low, given.min.is_some(), 1.0 - last.omega() / low),
        Side::Above => (high, given.max.is_some(), last.omega() / high - 1.0),
    };
    let is_there = beyond > -1e-6 && matches!(branch.outcome, Outcome::Open(_, Stop::FrequencyBound));
    // At a bound that nobody gave, or as far beyond as it has been before, a main branch is cut only if it goes on to the ordinary
    // response.
    let earlier = &branch.points[..branch.points.len().saturating_sub(2)];
    let is_at = |omega: f64| (last.omega() - omega).abs() < 1e-6 * omega;
    let is_cut = !is_given && (is_at(bound) || earlier.iter().any(|point| is_at(point.omega())));
    is_there && (is_cut || forced.is_ordinary(&last.state))
}

/// Whether a response on a main branch is what is predicted, however far from the prediction: a window that begins at rest is of the
/// resonance that a main branch passes, where much damping makes another shape of it. Only once all else has been tried.
fn is_of_main(place: &SeedPlace, landing: &Landing) -> bool {
    place.method == LandingMethod::SteppedForcing
        && place.well.first == 0
        && place.well.about().contains(&landing.state.omega)
}

/// Traces the branch through the first landing that lies on no known one.
fn follow<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    place: &SeedPlace,
    landings: &[Landing],
    known: &[(BranchId, &Branch)],
    observer: &mut Observer<'_>,
) -> TaskResult {
    let mut nothing = SeedOutcome::NotLanded(LandingFailure::NotConverged(Failure::Diverged.into()));
    let (mut nearest, mut beyond) = (f64::INFINITY, Vec::new());
    for landing in landings {
        // What is not known yet is what seeds are for, wherever it lies.
        let outcome = match identify(forced, &landing.state, known) {
            Some(id) if landing.is_near() || (id.is_main() && is_of_main(place, landing)) => SeedOutcome::Found(id),
            Some(_) => SeedOutcome::NotLanded(LandingFailure::Far(landing.distance)),
            None if forced.contains(&landing.state) => match forced.branch_through(&landing.state, observer) {
                Ok(branch) => {
                    // Of a curve that was come upon by a wrong step nothing is known but that it is closed.
                    if branch.is_closed() && identify(forced, &branch.points[0].state, known).is_some() {
                        return TaskResult::Nothing(SeedOutcome::NotLanded(LandingFailure::Far(landing.distance)));
                    }
                    let branch = named(forced, branch, known);
                    let found = new_part(forced, branch, known);
                    return parent_first(forced, found, known, false, observer);
                }
                Err(failure) => SeedOutcome::NotTraced(failure.into()),
            },
            // What begins beyond the bounds may lead through them.
            None => match part_within(forced, &landing.state, known, &mut beyond, observer) {
                TaskResult::Nothing(outcome) => outcome,
                found => return found,
            },
        };
        if landing.distance < nearest {
            (nothing, nearest) = (outcome, landing.distance);
        }
    }
    TaskResult::Nothing(nothing)
}

/// Traces the first branch through what random starts led to that is neither known nor what a main branch is beyond the range in
/// which it was followed.
fn begin<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    landings: &[Landing],
    known: &[(BranchId, &Branch)],
    observer: &mut Observer<'_>,
) -> TaskResult {
    let mut nothing = SeedOutcome::OutOfBounds;
    let mut passed: Vec<Branch> = Vec::new();
    for Landing { state, .. } in landings {
        if let Some(id) = identify(forced, state, known) {
            nothing = SeedOutcome::Found(id);
            continue;
        }
        if passed.iter().any(|branch| forced.lies_on(state, branch)) {
            continue;
        }
        let branch = match forced.branch_through(state, observer) {
            Ok(branch) => named(forced, branch, known),
            Err(failure) => {
                nothing = SeedOutcome::NotTraced(failure.into());
                continue;
            }
        };
        if branch.is_cancelled() {
            return TaskResult::Branch(branch);
        }
        nothing = match (branch.kind, whole_main(known)) {
            (BranchKind::Main, Some(id)) => SeedOutcome::Found(id),
            _ => match new_part(forced, branch.clone(), known) {
                TaskResult::Nothing(outcome) => outcome,
                // A further round brings the branch itself.
                found => return parent_first(forced, found, known, true, observer),
            },
        };
        passed.push(branch);
    }
    TaskResult::Nothing(nothing)
}
