//! The ledger in numbers, for people.

use super::chain::{Chain, LevelRecord};
use super::state::Ledger;
use super::worker::Worker;
use protocol::from_worker::Progress;
use protocol::ids::{TaskId, WorkerId};
use protocol::to_everyone::{Counts, LevelStatus, WorkerStatus};
use results::journal::TaskState;

impl Ledger {
    /// Tasks by state.
    pub fn counts(&self) -> Counts {
        let mut counts = Counts::default();
        for entry in self.entries() {
            match entry.state {
                TaskState::Waiting => counts.waiting += 1,
                TaskState::Leased { .. } => counts.running += 1,
                TaskState::Done(_) => counts.done += 1,
                TaskState::Skipped => counts.skipped += 1,
                TaskState::Dead => counts.dead += 1,
            }
        }
        counts.branches = self.levels().map(|(_, level)| level.branches.len()).sum();
        counts
    }

    /// Number of announcements so far.
    pub fn sequence(&self) -> u64 {
        self.sequence
    }

    /// Number of levels, and of those without a task to hand out or to wait for.
    pub fn progress_of_levels(&self) -> (usize, usize) {
        (self.levels().count(), self.levels().filter(|(chain, _)| chain.is_finished()).count())
    }

    /// Levels under way.
    pub fn active(&self) -> Vec<LevelStatus> {
        let active = self.order.iter().filter_map(|&c| Some((&self.chains[c], self.chains[c].level()?)));
        let active = active.filter(|(chain, _)| !chain.is_finished() && chain.is_begun());
        active.map(|(chain, level)| self.level_status(chain, level)).collect()
    }

    fn level_status(&self, chain: &Chain, level: &LevelRecord) -> LevelStatus {
        let ordered = chain.held.iter().map(|&e| &chain.entries[e]).find(|entry| entry.task.is_ordered());
        LevelStatus {
            amplitude: level.amplitude.text.clone(),
            done: chain.entries.iter().filter(|entry| entry.is_settled()).count(),
            total: chain.entries.len(),
            branches: level.branches.len(),
            progress: ordered.and_then(|entry| self.progress(&entry.holder()?.worker, &entry.id)),
        }
    }

    fn progress(&self, worker: &WorkerId, task: &TaskId) -> Option<Progress> {
        self.workers.get(worker)?.progress.get(task).copied()
    }

    /// Workers present.
    pub fn workers(&self) -> Vec<WorkerStatus> {
        let present = self.workers.iter().filter(|(_, worker)| !worker.gone);
        present.map(|(id, worker)| self.worker_status(id, worker)).collect()
    }

    fn worker_status(&self, id: &WorkerId, worker: &Worker) -> WorkerStatus {
        let held = self.entries().filter(|entry| entry.holder().is_some_and(|holder| holder.worker == *id));
        let mut tasks: Vec<TaskId> = held.map(|entry| entry.id.clone()).collect();
        let repeated = self.repeats.holders().filter(|(holder, _)| holder.worker == *id);
        tasks.extend(repeated.map(|(_, (c, e))| self.chains[c].entries[e].id.clone()));
        let progress = tasks.first().and_then(|task| worker.progress.get(task).copied());
        WorkerStatus { worker: id.clone(), tasks, done: worker.done, progress }
    }
}
