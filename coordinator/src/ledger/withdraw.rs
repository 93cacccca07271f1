//! Results that two others contradict, taken back.
//!
//! What was refuted brought no branch and no curve. Whoever is handed the task again knows what was found meanwhile, so that a branch
//! is listed once, whoever finds it. Only what was made of the result stands in the way: without a main branch others are taken for
//! isolas, and branches begin at the responses that a landing brought. Such results stay, and are told as wrong.

use super::chain::{Chain, Record};
use super::state::Ledger;
use results::journal::{Change, TaskState};
use solver::response::account::Account;
use solver::response::task::{FoldPlace, Origin, SeedOutcome, Task};

/// Most workers that are wrong with a task before what the last of them said stays: something is wrong with the task.
const MOST: usize = 5;

impl Ledger {
    /// Takes back the result of entry `e` of chain `c`, which was refuted, unless something was made of it.
    pub(super) fn withdraw(&mut self, (c, e): (usize, usize)) -> Vec<Change> {
        let entry = &self.chains[c].entries[e];
        let is_left = entry.refuted.len() > MOST || !matches!(entry.state, TaskState::Done(_));
        if is_left || self.is_built_on(c, e) {
            return Vec::new();
        }
        self.sequence -= 1;
        let chain = &mut self.chains[c];
        let mut changes = chain.withdraw(e);
        changes.extend(chain.settle());
        changes
    }

    /// Whether something was made of the result of entry `e` of chain `c`, or is being made of it.
    fn is_built_on(&self, c: usize, e: usize) -> bool {
        let chain = &self.chains[c];
        let entry = &chain.entries[e];
        match (entry.task, &entry.state) {
            (Task::Main(_), _) => {
                chain.entries[e + 1..].iter().any(|later| later.task.is_ordered() && later.attempts() > 0)
            }
            (Task::Scout(scout), TaskState::Done(SeedOutcome::Landed(count))) => (0..*count).any(|fold| {
                let place = (entry.level, Origin::Fold(FoldPlace::Scout { scout, fold }));
                self.followed.contains(&place) || self.queue.contains(&place)
            }),
            (_, TaskState::Done(SeedOutcome::Landed(_))) => chain.leads_from(e),
            _ => false,
        }
    }
}

impl Chain {
    /// Whether a branch begins at what entry `e` landed on, or somebody looks for one there.
    fn leads_from(&self, e: usize) -> bool {
        let is_from = |task: &Task| match (task, &self.entries[e].task) {
            (Task::Seed(place), Task::Land(landing)) => place == landing,
            (Task::Begin(place), Task::Start(start)) => place.landing() == *start,
            _ => false,
        };
        let branches = self.level().map_or(&[][..], |level| &level.branches);
        let mut from = self.entries.iter().filter(|entry| is_from(&entry.task));
        from.any(|entry| entry.holder().is_some() || branches.iter().any(|branch| branch.known.task == entry.id))
    }

    /// Takes back what became of entry `e`, and with it that others were not needed.
    fn withdraw(&mut self, e: usize) -> Vec<Change> {
        let entry = &mut self.entries[e];
        (entry.lapsed, entry.orphaned, entry.known) = (false, false, None);
        entry.state = TaskState::Waiting;
        if let Task::Scout(scout) = entry.task {
            self.scouted.retain(|(place, _)| *place != scout);
        }
        let mut changes = vec![Change::Withdrawn { task: entry.id.clone() }];
        for entry in self.entries.iter_mut().filter(|entry| entry.state == TaskState::Skipped) {
            entry.state = TaskState::Waiting;
            changes.push(Change::Withdrawn { task: entry.id.clone() });
        }
        if let Record::Level(level) = &mut self.record {
            let windows = level.account.windows.iter().map(|account| account.window).collect();
            level.account = Account::new(windows);
            for entry in &self.entries {
                if let TaskState::Done(outcome) = entry.state {
                    level.account.record(&entry.task, outcome);
                }
            }
        }
        changes
    }
}
