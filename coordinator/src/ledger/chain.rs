//! Tasks that are carried out one after the other: each may depend on what those before it found.

use super::task::TaskEntry;
use protocol::from_worker::Lease;
use protocol::ids::TaskId;
use protocol::to_everyone::Amplitude;
use protocol::to_worker::{Known, KnownCurve};
use results::journal::{Change, LevelPlan, TaskState};
use solver::response::account::Account;
use solver::response::critical::crossed;
use solver::response::task::{Brought, SeedOutcome, Task};
use std::sync::Arc;
use std::time::Duration;

/// Tasks in their order.
#[derive(Debug)]
pub(super) struct Chain {
    pub record: Record,
    pub entries: Vec<TaskEntry>,
    /// The first task that is not settled: the only one that may be handed out or under way.
    pub next: Option<usize>,
}

/// What the tasks of a chain found.
#[derive(Debug)]
pub(super) enum Record {
    /// The branches of a forcing level.
    Level(LevelRecord),
    /// Curves over all levels.
    Curves(Vec<Curve>),
}

#[derive(Debug)]
pub(super) struct LevelRecord {
    pub amplitude: Amplitude,
    pub account: Account,
    pub branches: Vec<Branch>,
}

/// A branch that was found.
#[derive(Debug)]
pub(super) struct Branch {
    pub known: Known,
    pub folds: usize,
}

/// A fold curve that was found.
#[derive(Debug)]
pub(super) struct Curve {
    pub known: KnownCurve,
    /// Forcing amplitudes of its points.
    pub forcing: Arc<[f64]>,
}

impl Curve {
    /// Whether it may have a fold at a forcing amplitude.
    pub fn reaches(&self, amplitude: f64) -> bool {
        let range = |(low, high): (f64, f64), a: &f64| (low.min(*a), high.max(*a));
        let (low, high) = self.forcing.iter().fold((f64::INFINITY, f64::NEG_INFINITY), range);
        // Between points a curve may go a little further than at them.
        (0.9 * low..=1.1 * high).contains(&amplitude)
    }

    /// The points before its crossings of a level.
    pub fn crossings(&self, amplitude: f64) -> impl Iterator<Item = usize> {
        crossed(&self.forcing, amplitude)
    }
}

impl Chain {
    /// The tasks of level number `level`.
    pub fn of_level(plan: LevelPlan, level: usize) -> Self {
        let amplitude = plan.amplitude.clone();
        let account = Account::new(plan.windows);
        let mut chain = Self {
            record: Record::Level(LevelRecord { amplitude, account, branches: Vec::new() }),
            entries: Vec::new(),
            next: None,
        };
        for (index, task) in plan.tasks.into_iter().enumerate() {
            let id = TaskId::of_level(&plan.amplitude.text, index).expect("amplitudes are numbers");
            chain.append(TaskEntry::new(id, level, task));
        }
        chain
    }

    /// The tasks that follow curves over all levels.
    pub fn of_curves() -> Self {
        Self { record: Record::Curves(Vec::new()), entries: Vec::new(), next: None }
    }

    /// Adds a task at the end.
    pub fn append(&mut self, entry: TaskEntry) {
        self.entries.push(entry);
        self.next.get_or_insert(self.entries.len() - 1);
    }

    /// What a level is known by; `None` for the curves.
    pub fn level(&self) -> Option<&LevelRecord> {
        match &self.record {
            Record::Level(level) => Some(level),
            Record::Curves(_) => None,
        }
    }

    /// The curves that were found; none of a level.
    pub fn curves(&self) -> &[Curve] {
        match &self.record {
            Record::Level(_) => &[],
            Record::Curves(curves) => curves,
        }
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

    /// What becomes of entry `e`, which brought this; `None` if such a task does not bring such a thing.
    pub fn outcome(&self, e: usize, brought: &Brought) -> Option<SeedOutcome> {
        match (&self.record, brought) {
            (Record::Level(level), brought) => level.account.outcome(brought),
            (Record::Curves(curves), Brought::Curve(_)) => Some(SeedOutcome::OnCurve(curves.len())),
            (Record::Curves(_), Brought::Nothing(outcome)) => Some(*outcome),
            (Record::Curves(_), Brought::Branch { .. }) => None,
        }
        .filter(|outcome| match self.entries[e].task {
            Task::Fold(_) => !matches!(outcome, SeedOutcome::Found(_)),
            Task::Main(_) | Task::Seed(_) | Task::Crossing(_) => !matches!(outcome, SeedOutcome::OnCurve(_)),
        })
    }

    /// Takes down what became of entry `e`, and what it brought if that is new.
    pub fn finish(&mut self, e: usize, outcome: SeedOutcome, brought: Option<&Brought>) {
        let entry = &mut self.entries[e];
        let task = entry.id.clone();
        match (&mut self.record, outcome, brought) {
            (Record::Level(level), outcome, brought) => {
                level.account.record(&entry.task, outcome);
                if let (SeedOutcome::Found(branch), Some(Brought::Branch { folds, .. })) = (outcome, brought) {
                    level.branches.push(Branch { known: Known { branch, task }, folds: *folds });
                }
            }
            (Record::Curves(curves), SeedOutcome::OnCurve(number), Some(Brought::Curve(forcing))) => {
                curves.push(Curve { known: KnownCurve { number, task }, forcing: forcing.clone() });
            }
            (Record::Curves(_), ..) => {}
        }
        entry.state = TaskState::Done(outcome);
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
        if self.next.is_some() || self.waits_for_main() {
            return changes;
        }
        for (e, entry) in self.entries.iter_mut().enumerate() {
            if entry.is_settled() {
                continue;
            }
            let is_needed = match &self.record {
                Record::Level(level) => level.account.needs(&entry.task),
                Record::Curves(_) => true,
            };
            if entry.state == TaskState::Waiting && !is_needed {
                entry.state = TaskState::Skipped;
                changes.push(Change::Skipped { task: entry.id.clone() });
                continue;
            }
            self.next = Some(e);
            break;
        }
        changes
    }

    fn waits_for_main(&self) -> bool {
        let mut mains = self.entries.iter().filter(|entry| matches!(entry.task, Task::Main(_)));
        let is_given_up = mains.clone().all(TaskEntry::is_settled) && mains.any(|main| main.state == TaskState::Dead);
        is_given_up && self.level().is_some_and(|level| !level.account.has_main())
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
