//! The ledger of a run that goes on.

use super::rules::Rules;
use super::state::Ledger;
use protocol::to_worker::Known;
use results::journal::{Change, LevelPlan, StoredTask, TaskState};
use solver::response::task::{Brought, SeedOutcome};
use std::collections::HashMap;
use std::time::Duration;

/// Time that a worker takes at most to notice that its connection is gone and to connect again.
const RECONNECTION: Duration = Duration::from_secs(7);

impl Ledger {
    /// The ledger of a run that was interrupted: what was stored stays, in the order of the announcements. Tasks that were
    /// under way may still be: their workers have the time from `now` to connect again and to give a sign of life.
    /// The changes are what follows from the rest.
    pub fn restore(rules: Rules, plans: Vec<LevelPlan>, stored: Vec<StoredTask>, now: Duration) -> (Self, Vec<Change>) {
        let mut ledger = Self::new(rules, plans);
        let mut rest = HashMap::new();
        for task in stored {
            let Some(&(l, e)) = ledger.index.get(&task.id) else { continue };
            let level = &mut ledger.levels[l];
            let entry = &mut level.entries[e];
            (entry.attempts, entry.reasons) = (task.attempts, task.reasons);
            match task.state {
                TaskState::Done(outcome) => {
                    ledger.sequence += 1;
                    level.account.record(&entry.task, Brought::Nothing(outcome));
                    entry.state = TaskState::Done(outcome);
                    if let (true, SeedOutcome::Found(branch)) = (task.is_new_branch, outcome) {
                        level.branches.push(Known { branch, task: task.id });
                    }
                }
                state => {
                    rest.insert((l, e), state);
                }
            }
        }
        for ((l, e), state) in rest {
            let entry = &mut ledger.levels[l].entries[e];
            entry.orphaned = matches!(state, TaskState::Leased { .. });
            entry.state = match state {
                TaskState::Leased { holder, .. } => {
                    ledger.workers.entry(holder.worker.clone()).or_default().gone = true;
                    TaskState::Leased { holder, deadline: now + rules.grace.max(rules.lease / 3 + RECONNECTION) }
                }
                state => state,
            };
        }
        let changes = ledger.levels.iter_mut().flat_map(|level| level.settle()).collect();
        (ledger, changes)
    }
}
