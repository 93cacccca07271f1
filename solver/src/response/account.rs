//! The account of a level: what became of every seed of every window, and how many branches of each kind there are.

use crate::response::branch::BranchKind;
use crate::response::name::BranchId;
use crate::response::seeds::{LandingMethod, Phase};
use crate::response::starts::{StartPlace, StartWay};
use crate::response::task::{Brought, CrossingPlace, SeedOutcome, SeedPlace, Task};
use crate::response::windows::Window;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// A seed of a window and what became of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SeedAccount {
    /// Backbone index of the minimum of A* it stands for.
    pub minimum: usize,
    /// Which of the two phases.
    pub phase: Phase,
    /// How it was landed.
    #[serde(rename = "way")]
    pub method: LandingMethod,
    /// What became of it.
    pub outcome: SeedOutcome,
}

/// The account of a window.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WindowAccount {
    /// The window.
    pub window: Window,
    /// The seeds tried: both phases for every minimum of A* in the window; each that does not lead to a branch again by steps
    /// in the forcing.
    pub seeds: Vec<SeedAccount>,
}

impl WindowAccount {
    /// The branches found from the window or passing by it, without repetition; empty: predicted, not found.
    pub fn branches(&self) -> Vec<BranchId> {
        let mut list: Vec<BranchId> = Vec::new();
        for seed in &self.seeds {
            if let Some(id) = seed.outcome.branch()
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
    /// What became of the walks from the linear range, as far as they were tried.
    pub mains: Vec<SeedOutcome>,
    /// Every window with its seeds.
    pub windows: Vec<WindowAccount>,
    /// What became of the crossings of curves over the forcing amplitude.
    pub crossings: Vec<(CrossingPlace, SeedOutcome)>,
    /// What became of the batches of random starts.
    pub starts: Vec<(StartPlace, SeedOutcome)>,
    /// Number of branches of each kind.
    pub counts: BTreeMap<BranchKind, usize>,
}

impl Account {
    /// Nothing tried yet.
    pub fn new(windows: Vec<Window>) -> Self {
        let windows = windows.into_iter().map(|window| WindowAccount { window, seeds: Vec::new() }).collect();
        Self { mains: Vec::new(), windows, crossings: Vec::new(), starts: Vec::new(), counts: BTreeMap::new() }
    }

    /// Whether there is a main branch.
    pub fn has_main(&self) -> bool {
        self.counts.contains_key(&BranchKind::Main)
    }

    /// Whether a task is still of use: stepping in the forcing is not where the full forcing has led to a branch, a seed
    /// that did not land leads nowhere, and no seed is without a main branch to tell isolas from. Homotopies are where nothing else
    /// has led to a branch beside main ones. Landing with the full forcing and other random starts are of use whatever is known.
    pub fn needs(&self, task: &Task) -> bool {
        let is_without_main = !self.has_main() && !self.mains.is_empty();
        match task {
            Task::Start(place) => place.way == StartWay::Direct || self.is_only_by_homotopy(),
            Task::Main(_) | Task::Fold(_) | Task::Carry(_) | Task::Scout(_) => true,
            Task::Verify(_) | Task::Disturb(_) | Task::March(_) => true,
            Task::Land(SeedPlace { method: LandingMethod::FullForcing, .. }) => true,
            Task::Crossing(_) | Task::Switch(_) => !is_without_main,
            Task::Begin(place) => {
                let is_open = self.starts.iter().all(|(start, _)| start != place);
                !is_without_main && is_open && self.needs(&Task::Start(place.landing()))
            }
            Task::Land(place) => !is_without_main && !self.is_found(place),
            // What did not land has its outcome.
            Task::Seed(place) => {
                !is_without_main && !self.is_found(place) && self.outcomes(place, place.method).count() == 0
            }
        }
    }

    /// Whether no branch but main ones is known, or homotopies have led to all of them.
    fn is_only_by_homotopy(&self) -> bool {
        let beside_main = |kind: &BranchKind| *kind != BranchKind::Main;
        let known: usize = self.counts.iter().filter(|(kind, _)| beside_main(kind)).map(|(_, count)| count).sum();
        let led = self.starts.iter().filter_map(|(place, outcome)| match (place.way, outcome) {
            (StartWay::Homotopy, SeedOutcome::Found(id)) if beside_main(&id.kind) => Some(*id),
            _ => None,
        });
        known == led.collect::<BTreeSet<_>>().len()
    }

    /// What became of a seed, landed by one of the methods.
    fn outcomes(&self, place: &SeedPlace, method: LandingMethod) -> impl Iterator<Item = SeedOutcome> {
        let seeds = self.windows[place.window].seeds.iter();
        let (minimum, phase) = (place.well.best, place.phase);
        seeds.filter(move |s| s.minimum == minimum && s.phase == phase && s.method == method).map(|seed| seed.outcome)
    }

    /// Whether a seed has led to a branch with the full forcing.
    fn is_found(&self, place: &SeedPlace) -> bool {
        let mut outcomes = self.outcomes(place, LandingMethod::FullForcing);
        outcomes.any(|outcome| matches!(outcome, SeedOutcome::Found(_)))
    }

    /// What becomes of a task of the level that brought this, a new branch with its name; `None` if no task of a level brings it.
    pub fn outcome(&self, brought: &Brought) -> Option<SeedOutcome> {
        match brought {
            Brought::Branch { kind, .. } => Some(SeedOutcome::Found(BranchId::new(*kind, self.count(*kind)))),
            Brought::Nothing(outcome) => Some(*outcome),
            Brought::Landings(0) | Brought::Curve(_) => None,
            Brought::Verification(..) | Brought::Disturbance(_) | Brought::Settling(_) => None,
            Brought::Landings(count) => Some(SeedOutcome::Landed(*count)),
        }
    }

    /// Takes down what became of a task of the level.
    pub fn record(&mut self, task: &Task, outcome: SeedOutcome) {
        // A name that was given before counts as well: the account may be of a run that goes on.
        if let SeedOutcome::Found(BranchId { kind, number }) = outcome {
            let count = self.counts.entry(kind).or_default();
            *count = (*count).max(number + 1);
        }
        match task {
            Task::Main(_) => self.mains.push(outcome),
            // What is done with landings is known when their branches are.
            Task::Land(_) | Task::Start(_) if matches!(outcome, SeedOutcome::Landed(_)) => {}
            Task::Land(SeedPlace { window, well, phase, method })
            | Task::Seed(SeedPlace { window, well, phase, method }) => {
                self.windows[*window].seeds.push(SeedAccount {
                    minimum: well.best,
                    phase: *phase,
                    method: *method,
                    outcome,
                });
            }
            Task::Crossing(place) => self.crossings.push((*place, outcome)),
            Task::Start(place) | Task::Begin(place) => self.starts.push((*place, outcome)),
            Task::Fold(_) | Task::Carry(_) | Task::Scout(_) | Task::Switch(_) => {}
            Task::Verify(_) | Task::Disturb(_) | Task::March(_) => {}
        }
    }

    /// Number of branches of a kind.
    pub fn count(&self, kind: BranchKind) -> usize {
        self.counts.get(&kind).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::branch::Side;

    #[test]
    fn numbers_count_by_kind_and_seeds_need_a_main_branch() {
        let well = Window { mode: 0, first: 3, last: 9, best: 5, threshold: 0.5, omega: (1.0, 2.0) };
        let place = SeedPlace { window: 0, well, phase: Phase::Second, method: LandingMethod::FullForcing };
        let mut account = Account::new(vec![place.well]);
        let (below, above) = (Task::Main(Side::Below), Task::Main(Side::Above));
        account.record(&below, SeedOutcome::OutOfBounds);
        assert!(!account.needs(&Task::Seed(place)) && account.needs(&above));
        let found = |kind, number| SeedOutcome::Found(BranchId::new(kind, number));
        let record = |account: &mut Account, task: &Task, kind| {
            let outcome = account.outcome(&Brought::branch(kind)).unwrap();
            account.record(task, outcome);
            outcome
        };
        assert_eq!(record(&mut account, &above, BranchKind::Main), found(BranchKind::Main, 0));
        let work = Task::Seed(place);
        assert!(account.needs(&work));
        for (kind, number) in
            [(BranchKind::Isola, 0), (BranchKind::Cut, 0), (BranchKind::Isola, 1), (BranchKind::Main, 1)]
        {
            assert_eq!(record(&mut account, &work, kind), found(kind, number));
        }
        // Of a run that goes on.
        account.record(&work, found(BranchKind::Open, 2));
        assert_eq!(record(&mut account, &work, BranchKind::Open), found(BranchKind::Open, 3));
        assert_eq!(account.outcome(&Brought::Curve([1.0].into())), None);
    }
}
