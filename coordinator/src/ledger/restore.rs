//! The ledger of a run that goes on.

use super::rules::Rules;
use super::state::Ledger;
use super::task::TaskEntry;
use results::journal::{AddedTask, Change, LevelPlan, StoredTask, TaskState};
use solver::response::task::{CrossingPlace, Task};
use std::collections::HashMap;
use std::time::Duration;

impl Ledger {
    /// The ledger of a run that was interrupted: what was stored stays, in the order of the announcements. Tasks that were
    /// under way may still be: their workers have the time from `now` to connect again and to give a sign of life.
    /// The changes are what follows from the rest.
    pub fn restore(
        rules: Rules,
        levels: Vec<LevelPlan>,
        added: &[AddedTask],
        stored: Vec<StoredTask>,
        now: Duration,
    ) -> (Self, Vec<Change>) {
        let mut ledger = Self::new(rules, levels);
        ledger.restore_added(added);
        let (mut rest, mut claims) = (HashMap::new(), Vec::new());
        for task in stored {
            let Some(&(c, e)) = ledger.index.get(&task.id) else { continue };
            let entry = &mut ledger.chains[c].entries[e];
            (entry.holders, entry.troubles) = (task.holders, task.troubles);
            ledger.restore_evidence((c, e), &task.evidence);
            claims.extend(ledger.restore_claim((c, e), &task.evidence, &task.state, task.brought.as_ref()));
            match task.state {
                TaskState::Done(outcome) => {
                    ledger.sequence += 1;
                    ledger.finish(c, e, outcome, task.brought.as_ref());
                }
                state => {
                    rest.insert((c, e), state);
                }
            }
        }
        for ((c, e), state) in rest {
            let entry = &mut ledger.chains[c].entries[e];
            entry.orphaned = matches!(state, TaskState::Leased { .. });
            entry.state = match state {
                TaskState::Leased { holder, .. } => {
                    let worker = ledger.workers.entry(holder.worker.clone()).or_default();
                    worker.gone = true;
                    worker.chains.insert(holder.slot, c);
                    TaskState::Leased { holder, deadline: now + rules.reconnection() }
                }
                state => state,
            };
        }
        let mut changes: Vec<Change> = ledger.chains.iter_mut().flat_map(|chain| chain.settle()).collect();
        changes.extend(ledger.extend());
        ledger.restore_claims(claims, now);
        (ledger, changes)
    }

    /// The tasks that were added over all levels, and how far what was found has been looked at.
    fn restore_added(&mut self, added: &[AddedTask]) {
        for AddedTask { id, amplitude, task } in added {
            let Some(l) = self.levels().position(|(_, level)| level.amplitude.text == *amplitude) else { continue };
            if let Some(origin) = task.origin() {
                self.followed.insert((l, origin));
            }
            let c = match task {
                Task::Fold(_) | Task::Carry(_) => self.curves(),
                Task::Verify(place) => {
                    self.verified.insert((l, *place));
                    self.verifications()
                }
                Task::Disturb(_) => self.verifications(),
                Task::March(place) => {
                    self.marched.insert((l, place.branch, place.index));
                    self.verifications()
                }
                _ => continue,
            };
            self.index.insert(id.clone(), (c, self.chains[c].entries.len()));
            self.chains[c].entries.push(TaskEntry::new(id.clone(), l, *task));
        }
        // Levels that were added are crossed by curves that were looked at before.
        let crossings = self.entries().filter_map(|entry| match entry.task {
            Task::Crossing(CrossingPlace { curve, segment }) => Some((entry.level, curve, segment)),
            _ => None,
        });
        self.crossings = crossings.collect();
        let switches = self.entries().filter_map(|entry| match entry.task {
            Task::Switch(place) => Some((entry.level, place)),
            _ => None,
        });
        self.switched = switches.collect();
    }
}
