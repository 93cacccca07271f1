//! The tasks of a level, one after the other.

use super::answers::Granted;
use super::task::TaskEntry;
use protocol::from_worker::Lease;
use protocol::ids::{Attempt, TaskId};
use protocol::to_everyone::Amplitude;
use protocol::to_worker::Known;
use results::journal::{Change, LevelPlan, TaskState};
use solver::response::account::Account;
use solver::response::task::{Brought, SeedOutcome, Task};
use std::time::Duration;

#[derive(Debug)]
pub(super) struct LevelTasks {
    pub amplitude: Amplitude,
    pub account: Account,
    pub entries: Vec<TaskEntry>,
    pub branches: Vec<Known>,
    /// The first task that is not settled: the only one that may be handed out or under way.
    pub next: Option<usize>,
}

impl LevelTasks {
    pub fn new(plan: LevelPlan) -> Self {
        let entry = |(index, task): (usize, Task)| TaskEntry {
            id: TaskId::of_level(&plan.amplitude.text, index).expect("amplitudes are numbers"),
            task,
            state: TaskState::Waiting,
            attempts: 0,
            reasons: Vec::new(),
            not_before: Duration::ZERO,
            orphaned: false,
        };
        let entries: Vec<TaskEntry> = plan.tasks.into_iter().enumerate().map(entry).collect();
        let next = (!entries.is_empty()).then_some(0);
        Self { account: Account::new(plan.windows), amplitude: plan.amplitude, entries, branches: Vec::new(), next }
    }

    /// Whether a task can be handed out.
    pub fn offers(&self, now: Duration) -> bool {
        self.next.is_some_and(|e| {
            let entry = &self.entries[e];
            entry.state == TaskState::Waiting && entry.not_before <= now
        })
    }

    pub fn is_begun(&self) -> bool {
        self.next.is_none_or(|e| e > 0) || self.entries[0].attempts > 0
    }

    pub fn granted(&self, e: usize) -> Granted {
        let entry = &self.entries[e];
        Granted {
            task: entry.id.clone(),
            attempt: Attempt(entry.attempts),
            amplitude: self.amplitude.clone(),
            work: entry.task,
            known: self.branches.clone(),
        }
    }

    /// Takes down what a task brought and names a new branch.
    pub fn finish(&mut self, e: usize, brought: Brought) -> SeedOutcome {
        let is_new = matches!(brought, Brought::Branch(_));
        let entry = &mut self.entries[e];
        let outcome = self.account.record(&entry.task, brought);
        entry.state = TaskState::Done(outcome);
        if let (true, SeedOutcome::Found(branch)) = (is_new, outcome) {
            self.branches.push(Known { branch, task: entry.id.clone() });
        }
        outcome
    }

    /// Whether a result of entry `e` fits what is known: it comes from who holds it, or nobody went on without it.
    pub fn takes(&self, e: usize, lease: &Lease) -> bool {
        self.entries[e].is_held(lease) || self.entries[e + 1..].iter().all(|later| later.attempts == 0)
    }

    /// Moves on to the next task that is needed. Where a main branch was given up and none is known a level waits: seeds
    /// would find that one, and nobody could tell it from an isola.
    pub fn settle(&mut self) -> Vec<Change> {
        let mut changes = Vec::new();
        // What is under way is waited for, whatever came back before it.
        self.next = self.entries.iter().position(|entry| entry.holder().is_some());
        if self.next.is_some() {
            return changes;
        }
        let mut mains = self.entries.iter().filter(|entry| matches!(entry.task, Task::Main(_)));
        let is_waited_for = mains.clone().all(TaskEntry::is_settled) && mains.any(|main| main.state == TaskState::Dead);
        if is_waited_for && !self.account.has_main() {
            return changes;
        }
        for (e, entry) in self.entries.iter_mut().enumerate() {
            if entry.is_settled() {
                continue;
            }
            if entry.state == TaskState::Waiting && !self.account.needs(&entry.task) {
                entry.state = TaskState::Skipped;
                changes.push(Change::Skipped { task: entry.id.clone() });
                continue;
            }
            self.next = Some(e);
            break;
        }
        changes
    }

    /// Puts dead tasks back.
    pub fn revive(&mut self) -> Vec<Change> {
        let mut changes = Vec::new();
        for entry in self.entries.iter_mut().filter(|entry| entry.state == TaskState::Dead) {
            entry.state = TaskState::Waiting;
            entry.reasons.clear();
            entry.not_before = Duration::ZERO;
            changes.push(Change::Revived { task: entry.id.clone() });
        }
        changes.extend(self.settle());
        changes
    }
}
