//! A task of the ledger and its attempts.

use super::rules::Rules;
use protocol::from_worker::Lease;
use protocol::ids::{Attempt, TaskId, WorkerId};
use results::journal::{AttemptEnd, Change, Holder, TaskState};
use solver::response::task::Task;
use std::time::Duration;

#[derive(Debug)]
pub(super) struct TaskEntry {
    pub id: TaskId,
    /// The level that it is of, or that its curve starts from.
    pub level: usize,
    pub task: Task,
    pub state: TaskState,
    /// Attempts so far.
    pub attempts: u32,
    /// Why attempts failed.
    pub reasons: Vec<String>,
    /// Not handed out before.
    pub not_before: Duration,
    /// Under way when the coordinator was interrupted, and not heard of since: if nothing comes, that is no failure.
    pub orphaned: bool,
}

impl TaskEntry {
    pub fn new(id: TaskId, level: usize, task: Task) -> Self {
        Self {
            id,
            level,
            task,
            state: TaskState::Waiting,
            attempts: 0,
            reasons: Vec::new(),
            not_before: Duration::ZERO,
            orphaned: false,
        }
    }

    pub fn holder(&self) -> Option<&Holder> {
        match &self.state {
            TaskState::Leased { holder, .. } => Some(holder),
            _ => None,
        }
    }

    pub fn is_held(&self, lease: &Lease) -> bool {
        self.attempts == lease.attempt.0
            && self.holder().is_some_and(|holder| holder.worker == lease.worker && holder.slot == lease.slot)
    }

    pub fn is_expired(&self, now: Duration) -> bool {
        matches!(self.state, TaskState::Leased { deadline, .. } if deadline <= now)
    }

    /// Whether there is nothing left to do.
    pub fn is_settled(&self) -> bool {
        matches!(self.state, TaskState::Done(_) | TaskState::Skipped | TaskState::Dead)
    }

    pub fn renew(&mut self, until: Duration) {
        if let TaskState::Leased { deadline, .. } = &mut self.state {
            *deadline = until;
            self.orphaned = false;
        }
    }

    pub fn shorten(&mut self, worker: &WorkerId, until: Duration) {
        if let TaskState::Leased { holder, deadline } = &mut self.state
            && holder.worker == *worker
        {
            *deadline = (*deadline).min(until);
        }
    }

    pub fn grant(&mut self, holder: &Holder, deadline: Duration) -> Change {
        self.attempts += 1;
        self.orphaned = false;
        self.state = TaskState::Leased { holder: holder.clone(), deadline };
        Change::Granted { task: self.id.clone(), attempt: Attempt(self.attempts), holder: holder.clone() }
    }

    /// Ends the attempt under way without a result.
    pub fn end(&mut self, end: AttemptEnd, rules: &Rules, now: Duration) -> Vec<Change> {
        let (task, attempt) = (self.id.clone(), Attempt(self.attempts));
        match &end {
            AttemptEnd::Released | AttemptEnd::Superseded => {}
            AttemptEnd::Failed(reason) => self.reasons.push(reason.clone()),
            AttemptEnd::Expired => {
                let worker = self.holder().map_or_else(String::new, |holder| holder.worker.to_string());
                self.reasons.push(format!("{worker}: no sign of life"));
            }
        }
        let failed = !matches!(end, AttemptEnd::Released | AttemptEnd::Superseded);
        let failures = self.reasons.len() as u32;
        self.state = TaskState::Waiting;
        self.not_before = if failed { now + rules.backoff * 2u32.pow(failures.min(10) - 1) } else { now };
        let mut changes = vec![Change::Ended { task: task.clone(), attempt, end }];
        if failed && failures >= rules.max_failures {
            self.state = TaskState::Dead;
            changes.push(Change::Dead { task });
        }
        changes
    }

    /// Ends the attempt under way because a result came from another one.
    pub fn supersede(&mut self, lease: &Lease) -> Vec<Change> {
        if self.holder().is_none() || self.is_held(lease) {
            return Vec::new();
        }
        let (task, attempt) = (self.id.clone(), Attempt(self.attempts));
        vec![Change::Ended { task, attempt, end: AttemptEnd::Superseded }]
    }
}
