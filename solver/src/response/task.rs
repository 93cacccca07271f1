//! The work of a forcing level in pieces: each task continues one branch, and knows the branches found before it.

use crate::formulation::Formulation;
use crate::formulation::modal::Modal;
use crate::formulation::state::State;
use crate::response::backbone::Backbone;
use crate::response::branch::{Branch, Observer};
use crate::response::forced::Forced;
use crate::response::forcing::Unreached;
use crate::response::seeds::{LandingFailure, Phase, Seed, Way, candidates, land};
use crate::response::windows::{Window, windows};
use serde::{Deserialize, Serialize};

/// Names a branch of a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BranchId {
    /// The main branch.
    Main,
    /// Isola number i, from 0.
    Isola(usize),
}

impl std::fmt::Display for BranchId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            BranchId::Main => write!(f, "main"),
            BranchId::Isola(index) => write!(f, "isola {}", index + 1),
        }
    }
}

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

/// One piece of work: continues one branch at one forcing amplitude.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Task {
    /// The main branch, from the lower frequency bound.
    Main,
    /// The branch that a seed of a window leads to, unless it is known.
    Seed(SeedPlace),
}

impl Task {
    /// Seeds to start from, the most promising first; none for the main branch.
    pub fn seeds(&self, modal: &Modal, backbone: &Backbone, forcing: f64) -> Vec<Seed> {
        match self {
            Task::Main => Vec::new(),
            Task::Seed(SeedPlace { well, phase, way, .. }) => candidates(modal, backbone, well, *phase, *way, forcing),
        }
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
        Task::Main => match forced.main_branch(observer) {
            Ok(branch) => Finding::Branch(branch),
            Err(failure) => Finding::Nothing(SeedOutcome::NotTraced(failure)),
        },
        Task::Seed(SeedPlace { way, .. }) => follow(forced, seeds, *way, known, observer),
    };
    let cancelled = matches!(&finding, Finding::Branch(branch) if branch.is_cancelled());
    (!cancelled).then_some(finding)
}

/// Traces the branch that seeds lead to, unless it is known.
fn follow<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    seeds: &[Seed],
    way: Way,
    known: &[(BranchId, &Branch)],
    observer: &mut Observer<'_>,
) -> Finding {
    let landing = match land(forced, seeds, way) {
        Ok(landing) => landing,
        Err(failure) => return Finding::Nothing(SeedOutcome::NotLanded(LandingFailure::NotConverged(failure))),
    };
    let state = &landing.state;
    match identify(forced, state, known) {
        Some(id) if landing.is_near() => return Finding::Nothing(SeedOutcome::Found(id)),
        Some(_) => return Finding::Nothing(SeedOutcome::NotLanded(LandingFailure::Far(landing.distance))),
        None => {}
    }
    if !forced.contains(state) {
        return Finding::Nothing(SeedOutcome::OutOfBounds);
    }
    let branch = match forced.branch_through(state, observer) {
        Ok(branch) => branch,
        Err(failure) => return Finding::Nothing(SeedOutcome::NotTraced(failure.into())),
    };
    // A known branch that ended too early is met from its other side.
    if !branch.is_closed() && !branch.is_cancelled() {
        let ends = [branch.points.first(), branch.points.last()];
        if let Some(id) = ends.into_iter().flatten().find_map(|end| identify(forced, &end.state, known)) {
            return Finding::Nothing(SeedOutcome::Found(id));
        }
    }
    Finding::Branch(branch)
}

/// The branch that a converged state lies on, if it is known.
fn identify<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    state: &State,
    known: &[(BranchId, &Branch)],
) -> Option<BranchId> {
    known.iter().find(|(_, branch)| forced.lies_on(state, branch)).map(|(id, _)| *id)
}

/// The tasks of a level, in the order in which they are carried out: the main branch; then, window by window, both
/// phases of every well at fixed frequency, and the same by steps in the forcing.
pub fn plan(backbone: &Backbone, forcing: f64) -> (Vec<Window>, Vec<Task>) {
    let windows = windows(backbone, forcing);
    let mut tasks = vec![Task::Main];
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

/// A seed of a window and what became of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SeedAccount {
    /// Backbone index of the minimum of A* it stands for.
    pub minimum: usize,
    /// Which of the two phases.
    pub phase: Phase,
    /// How it was landed.
    pub way: Way,
    /// What became of it.
    pub outcome: SeedOutcome,
}

/// The account of a window.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WindowAccount {
    /// The window.
    pub window: Window,
    /// The seeds tried: both phases for every minimum of A* in the window; if none of them leads to a branch, the same by
    /// steps in the forcing.
    pub seeds: Vec<SeedAccount>,
}

impl WindowAccount {
    /// The branches found from the window, without repetition; empty: predicted, not found.
    pub fn branches(&self) -> Vec<BranchId> {
        let mut list: Vec<BranchId> = Vec::new();
        for seed in &self.seeds {
            if let SeedOutcome::Found(id) = seed.outcome
                && !list.contains(&id)
            {
                list.push(id);
            }
        }
        list
    }
}

/// What is known of a level while its tasks are carried out, without the branches themselves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Account {
    /// What became of the main branch; `None` as long as it was not tried.
    pub main: Option<SeedOutcome>,
    /// Every window with its seeds.
    pub windows: Vec<WindowAccount>,
    /// Number of isolas.
    pub isolas: usize,
}

impl Account {
    /// Nothing tried yet.
    pub fn new(windows: Vec<Window>) -> Self {
        let windows = windows.into_iter().map(|window| WindowAccount { window, seeds: Vec::new() }).collect();
        Self { main: None, windows, isolas: 0 }
    }

    /// Whether a task is still of use: stepping in the forcing is not where fixed frequencies have led to a branch, and no
    /// seed is without a main branch to tell isolas from.
    pub fn needs(&self, task: &Task) -> bool {
        let has_main = !matches!(self.main, Some(outcome) if outcome != SeedOutcome::Found(BranchId::Main));
        if matches!(task, Task::Seed(_)) && !has_main {
            return false;
        }
        let Task::Seed(SeedPlace { window, way: Way::SteppedForcing, .. }) = task else { return true };
        let found =
            |seed: &SeedAccount| seed.way == Way::FixedFrequency && matches!(seed.outcome, SeedOutcome::Found(_));
        !self.windows[*window].seeds.iter().any(found)
    }

    /// Takes down what became of a task (`None`: it found a new branch); returns this with the branch named.
    pub fn record(&mut self, task: &Task, outcome: Option<SeedOutcome>) -> SeedOutcome {
        let name = |isolas: &mut usize| {
            *isolas += 1;
            BranchId::Isola(*isolas - 1)
        };
        match task {
            Task::Main => {
                let outcome = outcome.unwrap_or(SeedOutcome::Found(BranchId::Main));
                self.main = Some(outcome);
                outcome
            }
            Task::Seed(SeedPlace { window, well, phase, way }) => {
                let outcome = outcome.unwrap_or_else(|| SeedOutcome::Found(name(&mut self.isolas)));
                let seed = SeedAccount { minimum: well.best, phase: *phase, way: *way, outcome };
                self.windows[*window].seeds.push(seed);
                outcome
            }
        }
    }
}
