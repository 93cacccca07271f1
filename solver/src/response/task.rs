//! The work of a forcing level in pieces: each task continues one branch, and knows the branches found before it.

use crate::curve::problem::Failure;
use crate::formulation::Formulation;
use crate::formulation::modal::Modal;
use crate::formulation::state::State;
use crate::response::backbone::Backbone;
use crate::response::branch::{Branch, BranchKind, BranchPoint, Observer, Outcome, Side, SpecialPoint, Stop};
use crate::response::forced::Forced;
use crate::response::forcing::Unreached;
pub use crate::response::name::BranchId;
use crate::response::seeds::{LandingFailure, Phase, Seed, Way, candidates, land};
use crate::response::windows::{Window, windows};
use serde::de::{Deserializer, Error, IgnoredAny, MapAccess, Visitor};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};

/// Where a task starts from: a well of a window, with phase and way of landing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SeedPlace {
    /// Number of the window within its level, from 0.
    pub window: usize,
    /// The well: the part of the window around one minimum of A*.
    pub well: Window,
    /// Which of the two phases.
    pub phase: Phase,
    /// How it is landed.
    pub way: Way,
}

/// One piece of work: continues one branch at one forcing amplitude. Messages say `"main"` for the main branch from below,
/// `{"main": "above"}` for the one from above, and `{"seed": …}`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Task {
    /// The main branch, from one of the frequency bounds.
    Main(Side),
    /// The branch that a seed of a window leads to, unless it is known.
    Seed(SeedPlace),
}

impl Task {
    /// Seeds to start from, the most promising first; none for the main branch.
    pub fn seeds(&self, modal: &Modal, backbone: &Backbone, forcing: f64) -> Vec<Seed> {
        match self {
            Task::Main(_) => Vec::new(),
            Task::Seed(SeedPlace { well, phase, way, .. }) => candidates(modal, backbone, well, *phase, *way, forcing),
        }
    }
}

impl Serialize for Task {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Task::Main(Side::Below) => serializer.serialize_unit_variant("Task", 0, "main"),
            Task::Main(side) => serializer.serialize_newtype_variant("Task", 0, "main", side),
            Task::Seed(place) => serializer.serialize_newtype_variant("Task", 1, "seed", place),
        }
    }
}

impl<'de> Deserialize<'de> for Task {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TaskVisitor)
    }
}

struct TaskVisitor;

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum TaskKind {
    Main,
    Seed,
}

impl<'de> Visitor<'de> for TaskVisitor {
    type Value = Task;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("\"main\", or a map of `main` or `seed`")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Task, E> {
        if text == "main" { Ok(Task::Main(Side::Below)) } else { Err(E::unknown_variant(text, &["main"])) }
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Task, M::Error> {
        let task = match map.next_key()? {
            Some(TaskKind::Main) => Task::Main(map.next_value()?),
            Some(TaskKind::Seed) => Task::Seed(map.next_value()?),
            None => return Err(M::Error::invalid_length(0, &self)),
        };
        if map.next_key::<IgnoredAny>()?.is_some() {
            return Err(M::Error::invalid_length(2, &self));
        }
        Ok(task)
    }
}

/// What became of a task.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SeedOutcome {
    /// It lies on this branch.
    Found(BranchId),
    /// It did not lead to a forced response.
    NotLanded(LandingFailure),
    /// It landed, but no branch could be started there.
    NotTraced(Unreached),
    /// It lies outside the bounds within which branches are followed.
    OutOfBounds,
}

impl std::fmt::Display for SeedOutcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            SeedOutcome::Found(id) => write!(f, "{id}"),
            SeedOutcome::NotLanded(failure) => write!(f, "{failure}"),
            SeedOutcome::NotTraced(failure) => write!(f, "landed, but no branch starts there: {failure}"),
            SeedOutcome::OutOfBounds => write!(f, "outside the frequency or amplitude bounds"),
        }
    }
}

/// The result of a task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// A branch that was not known.
    Branch(Branch),
    /// No new branch, and why.
    Nothing(SeedOutcome),
}

impl Finding {
    /// The same without the branch itself.
    pub fn brought(&self) -> Brought {
        match self {
            Finding::Branch(branch) => Brought::Branch(branch.kind),
            Finding::Nothing(outcome) => Brought::Nothing(*outcome),
        }
    }
}

/// What a task brought, without the branch itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Brought {
    /// A branch of this kind that was not known.
    Branch(BranchKind),
    /// No new branch, and why.
    Nothing(SeedOutcome),
}

/// Carries out a task: `seeds` are those of [`Task::seeds`], `known` the branches found at this level before it. `None`
/// if `observer` breaks.
pub fn carry_out<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    task: &Task,
    seeds: &[Seed],
    known: &[(BranchId, &Branch)],
    observer: &mut Observer<'_>,
) -> Option<Finding> {
    let finding = match task {
        Task::Main(side) => enter(forced, *side, known, observer)
            .unwrap_or_else(|failure| Finding::Nothing(SeedOutcome::NotTraced(failure))),
        Task::Seed(SeedPlace { way, .. }) => follow(forced, seeds, *way, known, observer),
    };
    let Finding::Branch(mut branch) = finding else { return Some(finding) };
    if branch.is_cancelled() {
        return None;
    }
    let mut is_cancelled = false;
    forced.certify(&mut branch, &mut |point| {
        let flow = observer(point);
        is_cancelled |= flow.is_break();
        flow
    });
    (!is_cancelled).then_some(Finding::Branch(branch))
}

/// Traces the main branch from a side, unless it is known.
fn enter<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    side: Side,
    known: &[(BranchId, &Branch)],
    observer: &mut Observer<'_>,
) -> Result<Finding, Unreached> {
    for (id, branch) in known.iter().filter(|(id, _)| id.is_main()) {
        if ends_ordinarily(forced, branch, side) {
            return Ok(Finding::Nothing(SeedOutcome::Found(*id)));
        }
    }
    let branch = forced.main_branch(side, observer)?;
    let (low, high) = forced.reach().frequency;
    let is_inside = |point: &BranchPoint| point.omega() > low * (1.0 + 1e-6) && point.omega() < high * (1.0 - 1e-6);
    Ok(match unknown_part(forced, branch, known) {
        // Beyond the range the one that is known goes on as well; where they meet does not count.
        Ok(branch) if branch.is_joined() && !inner(&branch.points).iter().any(is_inside) => {
            Finding::Nothing(SeedOutcome::Found(known[0].0))
        }
        Ok(branch) => Finding::Branch(branch),
        Err(id) => Finding::Nothing(SeedOutcome::Found(id)),
    })
}

/// Points between the ends.
fn inner(points: &[BranchPoint]) -> &[BranchPoint] {
    points.get(1..points.len().saturating_sub(1)).unwrap_or_default()
}

/// What of an open branch is not part of a known one, from where it leaves that to where it comes to it.
///
/// # Errors
/// The known branch, if both ends lie on it.
fn unknown_part<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    mut branch: Branch,
    known: &[(BranchId, &Branch)],
) -> Result<Branch, BranchId> {
    let Outcome::Open(mut first, mut last) = branch.outcome else { return Ok(branch) };
    if branch.is_cancelled() || branch.points.is_empty() {
        return Ok(branch);
    }
    let mut at = |index: usize| identify(forced, &branch.points[index].state, known);
    let count = branch.points.len();
    let (begin, end) = match (at(0), at(count - 1)) {
        (Some(id), Some(_)) => return Err(id),
        (None, None) => return Ok(branch),
        (Some(_), None) => (boundary(count, |index| at(index).is_some()), count),
        (None, Some(_)) => (0, boundary(count, |index| at(index).is_none())),
    };
    if begin > 0 {
        first = Stop::Joined;
    }
    if end < count {
        last = Stop::Joined;
    }
    branch.outcome = Outcome::Open(first, last);
    branch.points.truncate(end + usize::from(end < count));
    branch.points.drain(..begin.saturating_sub(1));
    let shift = begin.saturating_sub(1);
    let special = branch.special.iter().filter(|s| (begin..end).contains(&s.index));
    branch.special = special.map(|s| SpecialPoint { index: s.index - shift, ..*s }).collect();
    Ok(branch)
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

/// Whether a main branch ends at the other side of the range with the response that one from there would begin with.
fn ends_ordinarily<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, branch: &Branch, side: Side) -> bool {
    let (low, high) = forced.reach().frequency;
    let Some(last) = branch.points.last() else { return false };
    let is_there = match side {
        Side::Below => last.omega() < low * (1.0 + 1e-6),
        Side::Above => last.omega() > high * (1.0 - 1e-6),
    };
    is_there && matches!(branch.outcome, Outcome::Open(_, Stop::FrequencyBound)) && forced.is_ordinary(&last.state)
}

/// Traces the branch that seeds lead to, unless it is known.
fn follow<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    seeds: &[Seed],
    way: Way,
    known: &[(BranchId, &Branch)],
    observer: &mut Observer<'_>,
) -> Finding {
    let mut nothing = SeedOutcome::NotLanded(LandingFailure::NotConverged(Failure::Diverged.into()));
    let mut nearest = f64::INFINITY;
    for seed in seeds {
        let landing = match land(forced, seed, way) {
            Ok(landing) => landing,
            Err(failure) if nearest == f64::INFINITY => {
                nothing = SeedOutcome::NotLanded(LandingFailure::NotConverged(failure));
                continue;
            }
            Err(_) => continue,
        };
        // What is not known yet is what seeds are for, wherever it lies.
        let outcome = match identify(forced, &landing.state, known) {
            Some(id) if landing.is_near() => SeedOutcome::Found(id),
            Some(_) => SeedOutcome::NotLanded(LandingFailure::Far(landing.distance)),
            None if !forced.contains(&landing.state) => SeedOutcome::OutOfBounds,
            None => match forced.branch_through(&landing.state, observer) {
                Ok(branch) => {
                    let branch = named(forced, branch, known);
                    return match unknown_part(forced, branch, known) {
                        Ok(branch) => Finding::Branch(branch),
                        Err(id) => Finding::Nothing(SeedOutcome::Found(id)),
                    };
                }
                Err(failure) => SeedOutcome::NotTraced(failure.into()),
            },
        };
        if landing.distance < nearest {
            (nothing, nearest) = (outcome, landing.distance);
        }
    }
    Finding::Nothing(nothing)
}

/// A new branch, of the kind that it has in view of those known: a piece of a known curve is what that is, and as long as a
/// main branch goes on where it ends, nobody knows whether an open curve is detached from it.
fn named<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, branch: Branch, known: &[(BranchId, &Branch)]) -> Branch {
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
fn identify<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    state: &State,
    known: &[(BranchId, &Branch)],
) -> Option<BranchId> {
    known.iter().find(|(_, branch)| forced.lies_on(state, branch)).map(|(id, _)| *id)
}

/// The tasks of a level, in the order in which they are carried out: the main branch from below and from above; then,
/// window by window, both phases of every well at fixed frequency, and the same by steps in the forcing.
pub fn plan(backbone: &Backbone, forcing: f64) -> (Vec<Window>, Vec<Task>) {
    let windows = windows(backbone, forcing);
    let mut tasks = vec![Task::Main(Side::Below), Task::Main(Side::Above)];
    for (number, window) in windows.iter().enumerate() {
        let wells = window.wells(backbone);
        for way in [Way::FixedFrequency, Way::SteppedForcing] {
            for well in &wells {
                for phase in [Phase::First, Phase::Second] {
                    tasks.push(Task::Seed(SeedPlace { window: number, well: *well, phase, way }));
                }
            }
        }
    }
    (windows, tasks)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seed() -> SeedPlace {
        let well = Window { first: 3, last: 9, best: 5, threshold: 0.5, omega: (1.0, 2.0) };
        SeedPlace { window: 0, well, phase: Phase::Second, way: Way::FixedFrequency }
    }

    #[test]
    fn tasks_of_before_read_and_are_written_as_before() {
        for (task, form) in [
            (Task::Main(Side::Below), r#""main""#.to_string()),
            (Task::Main(Side::Above), r#"{"main":"above"}"#.to_string()),
            (Task::Seed(seed()), format!(r#"{{"seed":{}}}"#, serde_json::to_string(&seed()).unwrap())),
        ] {
            assert_eq!(serde_json::to_string(&task).unwrap(), form);
            assert_eq!(serde_json::from_str::<Task>(&form).unwrap(), task);
        }
        for form in [r#""seed""#, "{}", r#"{"main":"above","seed":1}"#, r#"{"main":"left"}"#, r#"{"march":1}"#] {
            assert!(serde_json::from_str::<Task>(form).is_err(), "{form}");
        }
    }
}
