//! What every event changes.

use super::answers::{Accepted, Leased, Submitted};
use super::level::LevelTasks;
use super::rules::Rules;
use super::task::TaskEntry;
use super::worker::Worker;
use protocol::from_worker::{Lease, Progress};
use protocol::ids::{TaskId, WorkerId};
use protocol::to_worker::RenewReply;
use results::journal::{AttemptEnd, Change, Holder, LevelPlan, TaskState};
use solver::response::task::Brought;
use std::collections::{BTreeMap, HashMap};
use std::time::Duration;

/// The ledger of a run.
#[derive(Debug)]
pub struct Ledger {
    pub(super) rules: Rules,
    pub(super) levels: Vec<LevelTasks>,
    /// Levels in the order in which they are begun: the largest forcing, which takes longest, first.
    pub(super) order: Vec<usize>,
    pub(super) index: HashMap<TaskId, (usize, usize)>,
    pub(super) workers: BTreeMap<WorkerId, Worker>,
    /// Number of announcements so far.
    pub(super) sequence: u64,
    cancelled: bool,
}

impl Ledger {
    /// The ledger of a run that begins. Task ids follow from amplitudes and places: see [`TaskId::of_level`].
    pub fn new(rules: Rules, plans: Vec<LevelPlan>) -> Self {
        let levels: Vec<LevelTasks> = plans.into_iter().map(LevelTasks::new).collect();
        let mut order: Vec<usize> = (0..levels.len()).collect();
        order.sort_by(|&a, &b| levels[b].amplitude.value.total_cmp(&levels[a].amplitude.value));
        let place = |(l, level): (usize, &LevelTasks)| -> Vec<(TaskId, (usize, usize))> {
            level.entries.iter().enumerate().map(|(e, entry)| (entry.id.clone(), (l, e))).collect()
        };
        let index = levels.iter().enumerate().flat_map(place).collect();
        Self { rules, levels, order, index, workers: BTreeMap::new(), sequence: 0, cancelled: false }
    }

    /// Hands out a task to a computing thread; one that holds a task gets the same again.
    pub fn lease(&mut self, worker: &WorkerId, slot: u32, now: Duration) -> (Leased, Vec<Change>) {
        self.workers.entry(worker.clone()).or_default().gone = false;
        if self.cancelled {
            return (Leased::Stop, Vec::new());
        }
        let holder = Holder { worker: worker.clone(), slot };
        let mut changes = self.tick(now);
        if let Some((l, e)) = self.held_by(&holder) {
            let deadline = now + self.rules.lease;
            self.levels[l].entries[e].renew(deadline);
            return (Leased::Grant(self.levels[l].granted(e)), changes);
        }
        let Some(l) = self.choose(&holder, now) else {
            let leased = if self.is_finished() { Leased::Drained } else { Leased::Wait(self.pause(now)) };
            return (leased, changes);
        };
        let e = self.levels[l].next.expect("a level is chosen for the task that it offers");
        let entry = &mut self.levels[l].entries[e];
        changes.push(entry.grant(&holder, now + self.rules.lease));
        self.workers.entry(worker.clone()).or_default().levels.insert(slot, l);
        (Leased::Grant(self.levels[l].granted(e)), changes)
    }

    /// The level to take a task from: the one this thread worked on last, or one that was begun, or the next one.
    fn choose(&self, holder: &Holder, now: Duration) -> Option<usize> {
        let last = self.workers.get(&holder.worker).and_then(|worker| worker.levels.get(&holder.slot)).copied();
        if let Some(l) = last
            && self.levels[l].offers(now)
        {
            return Some(l);
        }
        let open = || self.order.iter().copied().filter(|&l| self.levels[l].offers(now));
        open().find(|&l| self.levels[l].is_begun()).or_else(|| open().next())
    }

    /// How long nothing new can be expected, short enough to hear of a task that ends.
    fn pause(&self, now: Duration) -> Duration {
        let backoff = self.levels.iter().filter_map(|level| level.next.map(|e| level.entries[e].not_before));
        let next = backoff.filter(|&time| time > now).min().map_or(Duration::from_millis(100), |time| time - now);
        next.clamp(Duration::from_millis(20), Duration::from_millis(100))
    }

    fn held_by(&self, holder: &Holder) -> Option<(usize, usize)> {
        let held = |level: &LevelTasks| level.next.filter(|&e| level.entries[e].holder() == Some(holder));
        self.levels.iter().enumerate().find_map(|(l, level)| held(level).map(|e| (l, e)))
    }

    /// The entry that a lease is for, if it is still valid.
    fn valid(&self, lease: &Lease) -> Option<(usize, usize)> {
        let &(l, e) = self.index.get(&lease.task)?;
        self.levels[l].entries[e].is_held(lease).then_some((l, e))
    }

    /// A sign of life.
    pub fn renew(&mut self, lease: &Lease, progress: Option<Progress>, now: Duration) -> RenewReply {
        let worker = self.workers.entry(lease.worker.clone()).or_default();
        worker.gone = false;
        let Some((l, e)) = self.valid(lease) else { return RenewReply::Lost };
        if self.cancelled {
            return RenewReply::Cancel;
        }
        self.levels[l].entries[e].renew(now + self.rules.lease);
        if let Some(progress) = progress {
            self.note(&lease.task, progress);
        }
        RenewReply::Ok
    }

    /// Where the branch of a task under way is: for people, no sign of life.
    pub fn note(&mut self, task: &TaskId, progress: Progress) {
        let Some(&(l, e)) = self.index.get(task) else { return };
        let holder = self.levels[l].entries[e].holder();
        if let Some(worker) = holder.and_then(|holder| self.workers.get_mut(&holder.worker)) {
            worker.progress.insert(task.clone(), progress);
        }
    }

    /// A result: what the task brought. The first result of a task counts, whoever it comes from.
    pub fn submit(&mut self, lease: &Lease, brought: Brought) -> (Submitted, Vec<Change>) {
        let Some(&(l, e)) = self.index.get(&lease.task) else { return (Submitted::Unknown, Vec::new()) };
        let level = &mut self.levels[l];
        if matches!(level.entries[e].state, TaskState::Done(_) | TaskState::Skipped) {
            return (Submitted::Duplicate, Vec::new());
        }
        if !level.takes(e, lease) {
            return (Submitted::Late, Vec::new());
        }
        let mut changes = level.entries[e].supersede(lease);
        let outcome = level.finish(e, brought);
        self.sequence += 1;
        let (task, attempt) = (lease.task.clone(), lease.attempt);
        changes.push(Change::Done { task, attempt, outcome, sequence: self.sequence });
        changes.extend(level.settle());
        let worker = self.workers.entry(lease.worker.clone()).or_default();
        worker.done += 1;
        worker.progress.remove(&lease.task);
        let (amplitude, work) = (level.amplitude.clone(), level.entries[e].task);
        (Submitted::Accepted(Accepted { outcome, sequence: self.sequence, amplitude, work }), changes)
    }

    /// A task that could not be carried out. False if it was not this worker's any more.
    pub fn fail(&mut self, lease: &Lease, reason: &str, now: Duration) -> (bool, Vec<Change>) {
        self.end(lease, AttemptEnd::Failed(format!("{}: {reason}", lease.worker)), now)
    }

    /// A task given back.
    pub fn release(&mut self, lease: &Lease, now: Duration) -> (bool, Vec<Change>) {
        self.end(lease, AttemptEnd::Released, now)
    }

    fn end(&mut self, lease: &Lease, end: AttemptEnd, now: Duration) -> (bool, Vec<Change>) {
        let Some((l, e)) = self.valid(lease) else { return (false, Vec::new()) };
        let changes = self.end_at(l, e, end, now);
        (true, changes)
    }

    fn end_at(&mut self, l: usize, e: usize, end: AttemptEnd, now: Duration) -> Vec<Change> {
        let entry = &mut self.levels[l].entries[e];
        if let Some(worker) = entry.holder().and_then(|holder| self.workers.get_mut(&holder.worker)) {
            worker.progress.remove(&entry.id);
        }
        let mut changes = entry.end(end, &self.rules, now);
        changes.extend(self.levels[l].settle());
        changes
    }

    /// A worker vanished from the bus: its leases are shortened, until it gives a sign of life.
    pub fn worker_gone(&mut self, worker: &WorkerId, now: Duration) {
        let Some(known) = self.workers.get_mut(worker) else { return };
        known.gone = true;
        for level in &mut self.levels {
            if let Some(e) = level.next {
                level.entries[e].shorten(worker, now + self.rules.grace);
            }
        }
    }

    /// Leases that ran out.
    pub fn tick(&mut self, now: Duration) -> Vec<Change> {
        let expired = |level: &LevelTasks| level.next.filter(|&e| level.entries[e].is_expired(now));
        let places: Vec<(usize, usize)> =
            self.levels.iter().enumerate().filter_map(|(l, level)| expired(level).map(|e| (l, e))).collect();
        let end = |orphaned| if orphaned { AttemptEnd::Released } else { AttemptEnd::Expired };
        places.into_iter().flat_map(|(l, e)| self.end_at(l, e, end(self.levels[l].entries[e].orphaned), now)).collect()
    }

    /// Hands out nothing any more.
    pub fn cancel(&mut self) {
        self.cancelled = true;
    }

    /// Puts the tasks of the dead list back.
    pub fn retry_dead(&mut self) -> Vec<Change> {
        self.levels.iter_mut().flat_map(LevelTasks::revive).collect()
    }

    /// Whether no task is left to hand out or to wait for.
    pub fn is_finished(&self) -> bool {
        self.levels.iter().all(|level| level.next.is_none())
    }

    pub(super) fn entries(&self) -> impl Iterator<Item = &TaskEntry> {
        self.levels.iter().flat_map(|level| &level.entries)
    }

    /// Dead tasks with the reasons of their failures.
    pub fn dead(&self) -> Vec<(TaskId, Vec<String>)> {
        let dead = self.entries().filter(|entry| entry.state == TaskState::Dead);
        dead.map(|entry| (entry.id.clone(), entry.reasons.clone())).collect()
    }
}
