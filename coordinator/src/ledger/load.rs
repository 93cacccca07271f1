//! How busy everybody is, for whoever watches over the system: queue, leases, workers, and when it will be over.

use super::cost::Cost;
use super::state::Ledger;
use protocol::from_worker::thread_of;
use protocol::ids::WorkerId;
use results::journal::{KINDS, TaskState, place_of_kind};
use solver::response::task::Task;
use std::collections::{HashMap, HashSet};
use std::time::Duration;

/// States of tasks, as [`Load::tasks`] counts them.
pub const STATES: [&str; 5] = ["waiting", "leased", "done", "skipped", "dead"];

/// A moment of a run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Load {
    /// Tasks by kind ([`KINDS`]) and state ([`STATES`]).
    pub tasks: [[usize; STATES.len()]; KINDS.len()],
    /// Tasks that can be handed out now.
    pub queue: usize,
    /// How long the one of them has waited that has waited longest.
    pub oldest_waiting: Option<Duration>,
    /// Tasks under way of which there are signs of life.
    pub leases: usize,
    /// Tasks under way whose workers have vanished, or have not been heard of since the coordinator was interrupted.
    pub silent_leases: usize,
    /// How long the oldest task under way has been so.
    pub oldest_lease: Option<Duration>,
    /// Workers present.
    pub workers: Vec<WorkerLoad>,
}

/// What a worker has done with its time.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkerLoad {
    /// Who.
    pub worker: WorkerId,
    /// Computing threads that have asked for work.
    pub threads: usize,
    /// Tasks under way.
    pub leases: usize,
    /// Tasks done.
    pub done: usize,
    /// Time that its threads had tasks, added up.
    pub busy: Duration,
    /// Time that its threads were there, added up.
    pub present: Duration,
}

fn state_of(state: &TaskState) -> usize {
    match state {
        TaskState::Waiting => 0,
        TaskState::Leased { .. } => 1,
        TaskState::Done(_) => 2,
        TaskState::Skipped => 3,
        TaskState::Dead => 4,
    }
}

impl Ledger {
    /// Adds up the time that workers are busy, from one call to the next.
    pub fn measure(&mut self, now: Duration) {
        let passed = now.saturating_sub(self.measured);
        self.measured = now;
        let is_wanted = self.chains.iter().any(|chain| !chain.is_finished()) || self.repeats.holders().next().is_some();
        for worker in self.workers.values_mut().filter(|worker| !worker.gone) {
            let present = passed * worker.threads.len() as u32;
            worker.present += present;
            worker.wanted += if is_wanted { present } else { Duration::ZERO };
        }
        let held = self.chains.iter().flat_map(|chain| chain.held.iter().filter_map(|&e| chain.entries[e].holder()));
        let holders = held.chain(self.repeats.holders().map(|(holder, _)| holder));
        // A thread that has one task in the works and another one at hand is busy once.
        let threads: HashSet<(WorkerId, u32)> =
            holders.map(|holder| (holder.worker.clone(), thread_of(holder.slot))).collect();
        for (worker, _) in threads {
            if let Some(worker) = self.workers.get_mut(&worker).filter(|worker| !worker.gone) {
                worker.busy += passed;
            }
        }
    }

    /// What computing the result of a task took.
    pub fn note_cost(&mut self, task: &Task, seconds: f64) {
        if seconds.is_finite() {
            let cost = &mut self.costs[place_of_kind(task)];
            *cost = cost.and(Cost { count: 1, seconds: seconds.max(0.0) });
        }
    }

    /// Computing threads of workers that are present.
    pub(super) fn threads(&self) -> usize {
        self.workers.values().filter(|worker| !worker.gone).map(|worker| worker.threads.len()).sum()
    }

    /// Whether there are more tasks to be handed out than computing threads.
    pub fn has_plenty(&self, now: Duration) -> bool {
        let threads = self.threads();
        let ready = self.chains.iter().flat_map(|chain| chain.ready.iter().map(|&e| &chain.entries[e]));
        ready.filter(|entry| entry.not_before <= now).take(threads + 1).count() > threads
    }

    /// How busy everybody is.
    pub fn load(&mut self, now: Duration) -> Load {
        let mut load = Load::default();
        let mut held: HashMap<&WorkerId, usize> = HashMap::new();
        for chain in &mut self.chains {
            for &e in &chain.ready {
                let entry = &mut chain.entries[e];
                if entry.not_before <= now {
                    load.queue += 1;
                    let waited = now.saturating_sub(*entry.ready_since.get_or_insert(now));
                    load.oldest_waiting = load.oldest_waiting.max(Some(waited));
                }
            }
        }
        for entry in self.chains.iter().flat_map(|chain| &chain.entries) {
            load.tasks[place_of_kind(&entry.task)][state_of(&entry.state)] += 1;
            let Some(holder) = entry.holder() else { continue };
            *held.entry(&holder.worker).or_default() += 1;
            load.oldest_lease = load.oldest_lease.max(Some(now.saturating_sub(entry.granted_at)));
            let is_gone = self.workers.get(&holder.worker).is_none_or(|worker| worker.gone);
            *(if is_gone || entry.orphaned { &mut load.silent_leases } else { &mut load.leases }) += 1;
        }
        let present = self.workers.iter().filter(|(_, worker)| !worker.gone);
        load.workers = present
            .map(|(id, worker)| WorkerLoad {
                worker: id.clone(),
                threads: worker.threads.len(),
                leases: held.get(id).copied().unwrap_or(0),
                done: worker.done,
                busy: worker.busy,
                present: worker.present,
            })
            .collect();
        load
    }
}
