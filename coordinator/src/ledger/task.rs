//! A task of the ledger and its attempts.

use super::rules::Rules;
use protocol::from_worker::Lease;
use protocol::ids::{Attempt, TaskId, WorkerId};
use results::journal::{AttemptEnd, Change, Holder, TaskState, Troubles};
use solver::response::task::Task;
use std::time::Duration;

#[derive(Debug)]
pub(super) struct TaskEntry {
    pub id: TaskId,
    /// The level that it is of, or that its curve starts from.
    pub level: usize,
    pub task: Task,
    pub state: TaskState,
    /// To whom it was handed out so far, one an attempt.
    pub holders: Vec<Holder>,
    /// What has gone wrong.
    pub troubles: Troubles,
    /// Not handed out before.
    pub not_before: Duration,
    /// Since when it could be handed out, as far as somebody has looked.
    pub ready_since: Option<Duration>,
    /// When it was last handed out.
    pub granted_at: Duration,
    /// When it last got on, as far as its worker has told.
    pub moved_at: Duration,
    /// Its last attempt ended because there was no sign of life.
    pub lapsed: bool,
    /// Of one that is done: number of branches, and of curves, that were known.
    pub known: Option<(usize, usize)>,
    /// Attempts whose results were compared with others: they do not count for themselves, should they come again.
    pub compared: Vec<Attempt>,
    /// Workers whose results were refuted: it is not handed out to them any more.
    pub refuted: Vec<WorkerId>,
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
            holders: Vec::new(),
            troubles: Troubles::default(),
            not_before: Duration::ZERO,
            ready_since: None,
            granted_at: Duration::ZERO,
            moved_at: Duration::ZERO,
            lapsed: false,
            known: None,
            compared: Vec::new(),
            refuted: Vec::new(),
            orphaned: false,
        }
    }

    pub fn holder(&self) -> Option<&Holder> {
        match &self.state {
            TaskState::Leased { holder, .. } => Some(holder),
            _ => None,
        }
    }

    /// Whether a worker may have it, as far as time and what it said before go.
    pub fn is_offered(&self, worker: &WorkerId, now: Duration) -> bool {
        self.not_before <= now && !self.refuted.contains(worker)
    }

    /// Attempts so far.
    pub fn attempts(&self) -> u32 {
        self.holders.len() as u32
    }

    /// Whether it was handed out to this worker under this number.
    pub fn was_granted(&self, lease: &Lease) -> bool {
        let holder = (lease.attempt.0 as usize).checked_sub(1).and_then(|before| self.holders.get(before));
        holder.is_some_and(|holder| holder.worker == lease.worker && holder.slot == lease.slot)
    }

    pub fn is_held(&self, lease: &Lease) -> bool {
        self.attempts() == lease.attempt.0
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

    /// Not before then.
    pub fn extend(&mut self, until: Duration) {
        if let TaskState::Leased { deadline, .. } = &mut self.state {
            *deadline = (*deadline).max(until);
        }
    }

    pub fn shorten(&mut self, worker: &WorkerId, until: Duration) {
        if let TaskState::Leased { holder, deadline } = &mut self.state
            && holder.worker == *worker
        {
            *deadline = (*deadline).min(until);
        }
    }

    pub fn grant(&mut self, holder: &Holder, now: Duration, deadline: Duration) -> Change {
        self.holders.push(holder.clone());
        (self.orphaned, self.lapsed) = (false, false);
        (self.ready_since, self.granted_at, self.moved_at) = (None, now, now);
        self.state = TaskState::Leased { holder: holder.clone(), deadline };
        Change::Granted { task: self.id.clone(), attempt: Attempt(self.attempts()), holder: holder.clone() }
    }

    /// Ends the attempt under way without a result.
    pub fn end(&mut self, end: AttemptEnd, rules: &Rules, now: Duration) -> Vec<Change> {
        let (task, attempt) = (self.id.clone(), Attempt(self.attempts()));
        if let Some(Holder { worker, .. }) = self.holders.last() {
            self.troubles.note(worker, &end);
        }
        let failed = matches!(end, AttemptEnd::Failed(_) | AttemptEnd::Refused(_));
        let lapsed = end == AttemptEnd::Expired;
        let failures = self.troubles.failures + self.troubles.refused.len() as u32;
        // Whoever gives no sign of life may be heard of again as long as nobody else has the task.
        self.lapsed = lapsed || self.orphaned;
        self.state = TaskState::Waiting;
        self.not_before = if failed { now + rules.backoff * 2u32.pow(failures.clamp(1, 10) - 1) } else { now };
        let mut changes = vec![Change::Ended { task: task.clone(), attempt, end }];
        if (failed && failures >= rules.max_failures) || (lapsed && self.troubles.lapses >= rules.max_lapses) {
            self.state = TaskState::Dead;
            changes.push(Change::Dead { task });
        }
        changes
    }

    /// Takes up the attempt of which there was no sign of life.
    pub fn adopt(&mut self, until: Duration) -> Option<Change> {
        let holder = self.holders.last().filter(|_| self.lapsed && self.state == TaskState::Waiting)?.clone();
        // Of one that a coordinator's interruption ended nothing was taken down.
        if !self.orphaned {
            self.troubles.forget_lapse();
        }
        self.lapsed = false;
        self.state = TaskState::Leased { holder, deadline: until };
        Some(Change::Adopted { task: self.id.clone(), attempt: Attempt(self.attempts()) })
    }

    /// Ends the attempt under way because a result came from another one.
    pub fn supersede(&mut self, lease: &Lease) -> Vec<Change> {
        if self.holder().is_none() || self.is_held(lease) {
            return Vec::new();
        }
        let (task, attempt) = (self.id.clone(), Attempt(self.attempts()));
        vec![Change::Ended { task, attempt, end: AttemptEnd::Superseded }]
    }
}
