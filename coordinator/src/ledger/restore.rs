//! The ledger of a run that goes on.

use super::entry::State;
use super::{Ledger, LevelPlan, Record, Rules};
use protocol::ids::TaskId;
use protocol::to_worker::Known;
use solver::task::{BranchId, SeedOutcome};
use std::collections::HashMap;
use std::time::Duration;

/// Time that a worker takes at most to notice that its connection is gone and to connect again.
const RECONNECTION: Duration = Duration::from_secs(7);

/// A task as the store has it.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredTask {
    /// Task.
    pub id: TaskId,
    /// State; the deadline of a lease does not count.
    pub state: State,
    /// Whether its result is a new branch.
    pub is_new_branch: bool,
    /// Attempts so far.
    pub attempts: u32,
    /// Why attempts failed, since it was last taken from the dead list.
    pub reasons: Vec<String>,
}

impl Ledger {
    /// The ledger of a run that was interrupted: what was stored stays, in the order of the announcements. Tasks that were
    /// under way may still be: their workers have the time from `now` to connect again and to give a sign of life.
    /// The records are what follows from the rest.
    pub fn restore(rules: Rules, plans: Vec<LevelPlan>, stored: Vec<StoredTask>, now: Duration) -> (Self, Vec<Record>) {
        let mut ledger = Self::new(rules, plans);
        let mut rest = HashMap::new();
        for task in stored {
            let Some(&(l, e)) = ledger.index.get(&task.id) else { continue };
            let level = &mut ledger.levels[l];
            let entry = &mut level.entries[e];
            (entry.attempts, entry.reasons) = (task.attempts, task.reasons);
            match task.state {
                State::Done(outcome) => {
                    ledger.sequence += 1;
                    level.account.record(&entry.task, Some(outcome));
                    entry.state = State::Done(outcome);
                    if let (true, SeedOutcome::Found(branch)) = (task.is_new_branch, outcome) {
                        level.branches.push(Known { branch, task: task.id });
                        if let BranchId::Isola(number) = branch {
                            level.account.isolas = level.account.isolas.max(number + 1);
                        }
                    }
                }
                state => {
                    rest.insert((l, e), state);
                }
            }
        }
        for ((l, e), state) in rest {
            let entry = &mut ledger.levels[l].entries[e];
            entry.orphaned = matches!(state, State::Leased { .. });
            entry.state = match state {
                State::Leased { holder, .. } => {
                    ledger.workers.entry(holder.worker.clone()).or_default().gone = true;
                    State::Leased { holder, deadline: now + rules.grace.max(rules.lease / 3 + RECONNECTION) }
                }
                state => state,
            };
        }
        let records = ledger.levels.iter_mut().flat_map(|level| level.settle()).collect();
        (ledger, records)
    }
}
