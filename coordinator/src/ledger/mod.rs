//! Who computes what: the state machine of a run, without clock, network or disk.
//!
//! Every event returns its answer and the [`Record`]s that have to be on disk before the answer is given. Tasks of a level
//! are handed out one after the other in their order, levels in parallel, so that what is found does not depend on how many
//! workers there are. Times are durations since an origin of the caller's choice.

mod entry;
mod record;
mod restore;
mod status;
#[cfg(test)]
mod tests;

pub use entry::{Holder, State};
pub use record::{AttemptEnd, Record};
pub use restore::StoredTask;

use entry::{Entry, Level};
use protocol::from_worker::{Lease, Progress};
use protocol::ids::{Attempt, TaskId, WorkerId};
use protocol::to_everyone::Amplitude;
use protocol::to_worker::{Known, RenewReply};
use solver::task::{SeedOutcome, Task};
use solver::windows::Window;
use std::collections::{BTreeMap, HashMap};
use std::time::Duration;

/// Times and limits.
#[derive(Debug, Clone, Copy)]
pub struct Rules {
    /// A task without a sign of life for so long is handed out again.
    pub lease: Duration,
    /// What a lease is shortened to when its worker vanishes from the bus.
    pub grace: Duration,
    /// Attempts that may fail before a task is given up.
    pub max_failures: u32,
    /// Pause after a task's first failure; doubled after each further one.
    pub backoff: Duration,
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            lease: Duration::from_secs(15),
            grace: Duration::from_secs(5),
            max_failures: 3,
            backoff: Duration::from_secs(1),
        }
    }
}

/// The work of one forcing level.
#[derive(Debug, Clone)]
pub struct LevelPlan {
    /// Forcing amplitude.
    pub amplitude: Amplitude,
    /// Windows.
    pub windows: Vec<Window>,
    /// Tasks, in order.
    pub tasks: Vec<Task>,
}

/// A worker as the ledger knows it.
#[derive(Debug, Clone, Default)]
struct Worker {
    gone: bool,
    done: usize,
    /// The level that each computing thread worked on last.
    levels: HashMap<u32, usize>,
    progress: HashMap<TaskId, Progress>,
}

/// Answer to a request for work.
#[derive(Debug, Clone, PartialEq)]
pub enum Leased {
    /// This task.
    Grant(Granted),
    /// Nothing now; after so long there may be.
    Wait(Duration),
    /// Nothing any more.
    Drained,
    /// The run was cancelled.
    Stop,
}

/// A task handed out.
#[derive(Debug, Clone, PartialEq)]
pub struct Granted {
    /// Task.
    pub task: TaskId,
    /// Which attempt at it.
    pub attempt: Attempt,
    /// Forcing amplitude.
    pub amplitude: Amplitude,
    /// What is to be done.
    pub work: Task,
    /// Branches of the level found before.
    pub known: Vec<Known>,
}

/// Answer to a result.
#[derive(Debug, Clone, PartialEq)]
pub enum Submitted {
    /// First result of its task.
    Accepted(Accepted),
    /// There is one already.
    Duplicate,
    /// The task was given up and its level went on: its branch may have been found by another one.
    Late,
    /// No such task in this run.
    Unknown,
}

/// A result to be stored.
#[derive(Debug, Clone, PartialEq)]
pub struct Accepted {
    /// What became of the task, with a new branch named.
    pub outcome: SeedOutcome,
    /// Number of the announcement.
    pub sequence: u64,
    /// Forcing amplitude.
    pub amplitude: Amplitude,
    /// What was to be done.
    pub work: Task,
}

/// The ledger of a run.
#[derive(Debug)]
pub struct Ledger {
    rules: Rules,
    levels: Vec<Level>,
    /// Levels in the order in which they are begun: the largest forcing, which takes longest, first.
    order: Vec<usize>,
    index: HashMap<TaskId, (usize, usize)>,
    workers: BTreeMap<WorkerId, Worker>,
    sequence: u64,
    cancelled: bool,
}

impl Ledger {
    /// The ledger of a run that begins. Task ids follow from amplitudes and places: see [`TaskId::of_level`].
    pub fn new(rules: Rules, plans: Vec<LevelPlan>) -> Self {
        let levels: Vec<Level> = plans.into_iter().map(Level::new).collect();
        let mut order: Vec<usize> = (0..levels.len()).collect();
        order.sort_by(|&a, &b| levels[b].amplitude.value.total_cmp(&levels[a].amplitude.value));
        let place = |(l, level): (usize, &Level)| -> Vec<(TaskId, (usize, usize))> {
            level.entries.iter().enumerate().map(|(e, entry)| (entry.id.clone(), (l, e))).collect()
        };
        let index = levels.iter().enumerate().flat_map(place).collect();
        Self { rules, levels, order, index, workers: BTreeMap::new(), sequence: 0, cancelled: false }
    }

    /// Hands out a task to a computing thread; one that holds a task gets the same again.
    pub fn lease(&mut self, worker: &WorkerId, slot: u32, now: Duration) -> (Leased, Vec<Record>) {
        self.workers.entry(worker.clone()).or_default().gone = false;
        if self.cancelled {
            return (Leased::Stop, Vec::new());
        }
        let holder = Holder { worker: worker.clone(), slot };
        let mut records = self.tick(now);
        if let Some((l, e)) = self.held_by(&holder) {
            let deadline = now + self.rules.lease;
            self.levels[l].entries[e].renew(deadline);
            return (Leased::Grant(self.levels[l].granted(e)), records);
        }
        let Some(l) = self.choose(&holder, now) else {
            let leased = if self.is_finished() { Leased::Drained } else { Leased::Wait(self.pause(now)) };
            return (leased, records);
        };
        let e = self.levels[l].next.expect("a level is chosen for the task that it offers");
        let entry = &mut self.levels[l].entries[e];
        records.push(entry.grant(&holder, now + self.rules.lease));
        self.workers.entry(worker.clone()).or_default().levels.insert(slot, l);
        (Leased::Grant(self.levels[l].granted(e)), records)
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
        let held = |level: &Level| level.next.filter(|&e| level.entries[e].holder() == Some(holder));
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

    /// A result: what became of the task, `None` if it found a new branch. The first result of a task counts, whoever it
    /// comes from.
    pub fn submit(&mut self, lease: &Lease, outcome: Option<SeedOutcome>) -> (Submitted, Vec<Record>) {
        let Some(&(l, e)) = self.index.get(&lease.task) else { return (Submitted::Unknown, Vec::new()) };
        let level = &mut self.levels[l];
        if matches!(level.entries[e].state, State::Done(_) | State::Skipped) {
            return (Submitted::Duplicate, Vec::new());
        }
        if !level.takes(e, lease) {
            return (Submitted::Late, Vec::new());
        }
        let mut records = level.entries[e].supersede(lease);
        let outcome = level.finish(e, outcome);
        self.sequence += 1;
        let (task, attempt) = (lease.task.clone(), lease.attempt);
        records.push(Record::Done { task, attempt, outcome, sequence: self.sequence });
        records.extend(level.settle());
        let worker = self.workers.entry(lease.worker.clone()).or_default();
        worker.done += 1;
        worker.progress.remove(&lease.task);
        let (amplitude, work) = (level.amplitude.clone(), level.entries[e].task);
        (Submitted::Accepted(Accepted { outcome, sequence: self.sequence, amplitude, work }), records)
    }

    /// A task that could not be carried out. False if it was not this worker's any more.
    pub fn fail(&mut self, lease: &Lease, reason: &str, now: Duration) -> (bool, Vec<Record>) {
        self.end(lease, AttemptEnd::Failed(format!("{}: {reason}", lease.worker)), now)
    }

    /// A task given back.
    pub fn release(&mut self, lease: &Lease, now: Duration) -> (bool, Vec<Record>) {
        self.end(lease, AttemptEnd::Released, now)
    }

    fn end(&mut self, lease: &Lease, end: AttemptEnd, now: Duration) -> (bool, Vec<Record>) {
        let Some((l, e)) = self.valid(lease) else { return (false, Vec::new()) };
        let records = self.end_at(l, e, end, now);
        (true, records)
    }

    fn end_at(&mut self, l: usize, e: usize, end: AttemptEnd, now: Duration) -> Vec<Record> {
        let entry = &mut self.levels[l].entries[e];
        if let Some(worker) = entry.holder().and_then(|holder| self.workers.get_mut(&holder.worker)) {
            worker.progress.remove(&entry.id);
        }
        let mut records = entry.end(end, &self.rules, now);
        records.extend(self.levels[l].settle());
        records
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
    pub fn tick(&mut self, now: Duration) -> Vec<Record> {
        let expired = |level: &Level| level.next.filter(|&e| level.entries[e].is_expired(now));
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
    pub fn retry_dead(&mut self) -> Vec<Record> {
        self.levels.iter_mut().flat_map(Level::revive).collect()
    }

    /// Whether no task is left to hand out or to wait for.
    pub fn is_finished(&self) -> bool {
        self.levels.iter().all(|level| level.next.is_none())
    }

    fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.levels.iter().flat_map(|level| &level.entries)
    }

    /// Dead tasks with the reasons of their failures.
    pub fn dead(&self) -> Vec<(TaskId, Vec<String>)> {
        let dead = self.entries().filter(|entry| entry.state == State::Dead);
        dead.map(|entry| (entry.id.clone(), entry.reasons.clone())).collect()
    }
}
