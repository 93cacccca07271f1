//! A task and a level of the ledger.

use super::{AttemptEnd, Granted, LevelPlan, Record, Rules};
use protocol::from_worker::Lease;
use protocol::ids::{Attempt, TaskId, WorkerId};
use protocol::to_everyone::Amplitude;
use protocol::to_worker::Known;
use solver::task::{Account, SeedOutcome, Task};
use std::time::Duration;

/// A computing thread of a worker.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Holder {
    /// Worker.
    pub worker: WorkerId,
    /// Thread, from 0.
    pub slot: u32,
}

/// State of a task.
#[derive(Debug, Clone, PartialEq)]
pub enum State {
    /// To be handed out in its turn.
    Waiting,
    /// Handed out.
    Leased {
        /// To whom.
        holder: Holder,
        /// Until when.
        deadline: Duration,
    },
    /// Result stored.
    Done(SeedOutcome),
    /// Not needed.
    Skipped,
    /// Given up.
    Dead,
}

#[derive(Debug)]
pub(super) struct Entry {
    pub id: TaskId,
    pub task: Task,
    pub state: State,
    /// Attempts so far.
    pub attempts: u32,
    /// Why attempts failed.
    pub reasons: Vec<String>,
    /// Not handed out before.
    pub not_before: Duration,
    /// Under way when the coordinator was interrupted, and not heard of since: if nothing comes, that is no failure.
    pub orphaned: bool,
}

impl Entry {
    pub fn holder(&self) -> Option<&Holder> {
        match &self.state {
            State::Leased { holder, .. } => Some(holder),
            _ => None,
        }
    }

    pub fn is_held(&self, lease: &Lease) -> bool {
        self.attempts == lease.attempt.0
            && self.holder().is_some_and(|holder| holder.worker == lease.worker && holder.slot == lease.slot)
    }

    pub fn is_expired(&self, now: Duration) -> bool {
        matches!(self.state, State::Leased { deadline, .. } if deadline <= now)
    }

    /// Whether there is nothing left to do.
    pub fn is_settled(&self) -> bool {
        matches!(self.state, State::Done(_) | State::Skipped | State::Dead)
    }

    pub fn renew(&mut self, until: Duration) {
        if let State::Leased { deadline, .. } = &mut self.state {
            *deadline = until;
            self.orphaned = false;
        }
    }

    pub fn shorten(&mut self, worker: &WorkerId, until: Duration) {
        if let State::Leased { holder, deadline } = &mut self.state
            && holder.worker == *worker
        {
            *deadline = (*deadline).min(until);
        }
    }

    pub fn grant(&mut self, holder: &Holder, deadline: Duration) -> Record {
        self.attempts += 1;
        self.orphaned = false;
        self.state = State::Leased { holder: holder.clone(), deadline };
        Record::Granted {
            task: self.id.clone(),
            attempt: Attempt(self.attempts),
            worker: holder.worker.clone(),
            slot: holder.slot,
        }
    }

    /// Ends the attempt under way without a result.
    pub fn end(&mut self, end: AttemptEnd, rules: &Rules, now: Duration) -> Vec<Record> {
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
        self.state = State::Waiting;
        self.not_before = if failed { now + rules.backoff * 2u32.pow(failures.min(10) - 1) } else { now };
        let mut records = vec![Record::Ended { task: task.clone(), attempt, end }];
        if failed && failures >= rules.max_failures {
            self.state = State::Dead;
            records.push(Record::Dead { task });
        }
        records
    }

    /// Ends the attempt under way because a result came from another one.
    pub fn supersede(&mut self, lease: &Lease) -> Vec<Record> {
        if self.holder().is_none() || self.is_held(lease) {
            return Vec::new();
        }
        let (task, attempt) = (self.id.clone(), Attempt(self.attempts));
        vec![Record::Ended { task, attempt, end: AttemptEnd::Superseded }]
    }
}

#[derive(Debug)]
pub(super) struct Level {
    pub amplitude: Amplitude,
    pub account: Account,
    pub entries: Vec<Entry>,
    pub branches: Vec<Known>,
    /// The first task that is not settled: the only one that may be handed out or under way.
    pub next: Option<usize>,
}

impl Level {
    pub fn new(plan: LevelPlan) -> Self {
        let entry = |(index, task): (usize, Task)| Entry {
            id: TaskId::of_level(&plan.amplitude.text, index).expect("amplitudes are numbers"),
            task,
            state: State::Waiting,
            attempts: 0,
            reasons: Vec::new(),
            not_before: Duration::ZERO,
            orphaned: false,
        };
        let entries: Vec<Entry> = plan.tasks.into_iter().enumerate().map(entry).collect();
        let next = (!entries.is_empty()).then_some(0);
        Self { account: Account::new(plan.windows), amplitude: plan.amplitude, entries, branches: Vec::new(), next }
    }

    /// Whether a task can be handed out.
    pub fn offers(&self, now: Duration) -> bool {
        self.next.is_some_and(|e| {
            let entry = &self.entries[e];
            entry.state == State::Waiting && entry.not_before <= now
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

    /// Takes down what became of a task (`None`: it found a new branch) and names a new branch.
    pub fn finish(&mut self, e: usize, outcome: Option<SeedOutcome>) -> SeedOutcome {
        let is_new = outcome.is_none();
        let entry = &mut self.entries[e];
        let outcome = self.account.record(&entry.task, outcome);
        entry.state = State::Done(outcome);
        if let (true, SeedOutcome::Found(branch)) = (is_new, outcome) {
            self.branches.push(Known { branch, task: entry.id.clone() });
        }
        outcome
    }

    /// Whether a result of entry `e` fits what is known: it comes from who holds it, or nobody went on without it.
    pub fn takes(&self, e: usize, lease: &Lease) -> bool {
        self.entries[e].is_held(lease) || self.entries[e + 1..].iter().all(|later| later.attempts == 0)
    }

    /// Moves on to the next task that is needed. Without its main branch a level waits: seeds would find that one, and
    /// nobody could tell it from an isola.
    pub fn settle(&mut self) -> Vec<Record> {
        let mut records = Vec::new();
        // What is under way is waited for, whatever came back before it.
        self.next = self.entries.iter().position(|entry| entry.holder().is_some());
        if self.next.is_some() {
            return records;
        }
        if self.entries.first().is_some_and(|main| main.state == State::Dead) {
            return records;
        }
        for (e, entry) in self.entries.iter_mut().enumerate() {
            if entry.is_settled() {
                continue;
            }
            if entry.state == State::Waiting && !self.account.needs(&entry.task) {
                entry.state = State::Skipped;
                records.push(Record::Skipped { task: entry.id.clone() });
                continue;
            }
            self.next = Some(e);
            break;
        }
        records
    }

    /// Puts dead tasks back.
    pub fn revive(&mut self) -> Vec<Record> {
        let mut records = Vec::new();
        for entry in self.entries.iter_mut().filter(|entry| entry.state == State::Dead) {
            entry.state = State::Waiting;
            entry.reasons.clear();
            entry.not_before = Duration::ZERO;
            records.push(Record::Revived { task: entry.id.clone() });
        }
        records.extend(self.settle());
        records
    }
}
