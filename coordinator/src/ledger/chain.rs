//! Tasks in their order. Those that have to know what others found are carried out one after the other; landings go on beside
//! them, and each is waited for by the seed that it is of.

use super::task::TaskEntry;
use protocol::from_worker::Lease;
use protocol::ids::{TaskId, WorkerId};
use protocol::to_everyone::Amplitude;
use protocol::to_worker::{Known, KnownCurve};
use results::journal::{Change, Holder, LevelPlan, TaskState, Troubles};
use solver::response::account::Account;
use solver::response::critical::{Quantity, crossed};
use solver::response::scout::ScoutPlace;
use solver::response::seeds::LandingMethod;
use solver::response::starts::{StartPlace, StartWay};
use solver::response::task::{
    BranchId, Brought, MarchPlace, Origin, SeedOutcome, SeedPlace, SwitchPlace, Task, VerifyPlace,
};
use solver::settings::Stretch;
use std::sync::Arc;
use std::time::Duration;

/// What can be done with a task that waits.
enum Turn {
    /// It can be handed out.
    Ready,
    /// It is the next one, and waits for its landing.
    Waits,
    /// Others come first, or it cannot be carried out.
    Blocked,
    /// It need not be carried out.
    Needless,
}

/// Tasks in their order.
#[derive(Debug)]
pub(super) struct Chain {
    pub record: Record,
    pub entries: Vec<TaskEntry>,
    /// Tasks that may be handed out: the one that others wait for first, then landings in their order.
    pub ready: Vec<usize>,
    /// Tasks under way.
    pub held: Vec<usize>,
    /// Batches of starts that led to a new branch, and may lead to another one.
    pub rounds: Vec<StartPlace>,
    /// Folds that scouts met, by their numbers, not yet considered.
    pub scouted: Vec<(ScoutPlace, usize)>,
    /// Branch points of branches that were found, not yet considered.
    pub crossed: Vec<SwitchPlace>,
    /// Branches that were found and not yet considered for verification.
    pub unverified: Vec<BranchId>,
    /// Unstable motions that were found, with the numbers of their levels, and not yet considered for marching.
    pub unsettled: Vec<(usize, MarchPlace)>,
}

/// What the tasks of a chain found.
#[derive(Debug)]
pub(super) enum Record {
    /// The branches of a forcing level.
    Level(LevelRecord),
    /// Curves over all levels.
    Curves(Vec<Curve>),
    /// What nothing follows from: what marching says of branches.
    Marched,
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

/// A curve over the forcing that was found.
#[derive(Debug)]
pub(super) struct Curve {
    pub known: KnownCurve,
    /// What has an extremum along it; nothing at fixed frequency.
    pub quantity: Option<Quantity>,
    /// Forcing amplitudes of its points.
    pub forcing: Arc<[f64]>,
}

impl Curve {
    /// Whether it may have a point at a forcing amplitude.
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
        let mut chain = Self::of(Record::Level(LevelRecord { amplitude, account, branches: Vec::new() }));
        for (index, task) in plan.tasks.into_iter().enumerate() {
            let id = TaskId::of_level(&plan.amplitude.text, index).expect("amplitudes are numbers");
            chain.entries.push(TaskEntry::new(id, level, task));
        }
        // Nothing is known yet that would make a task superfluous.
        chain.settle();
        chain
    }

    /// The tasks that follow curves over all levels.
    pub fn of_curves() -> Self {
        Self::of(Record::Curves(Vec::new()))
    }

    /// The tasks that verify branches of all levels.
    pub fn of_verifications() -> Self {
        Self::of(Record::Marched)
    }

    fn of(record: Record) -> Self {
        let (entries, ready, held, rounds, scouted, crossed, unverified, unsettled) = Default::default();
        Self { record, entries, ready, held, rounds, scouted, crossed, unverified, unsettled }
    }

    /// What a level is known by; `None` for the curves and for verifications.
    pub fn level(&self) -> Option<&LevelRecord> {
        match &self.record {
            Record::Level(level) => Some(level),
            Record::Curves(_) | Record::Marched => None,
        }
    }

    /// The curves that were found; none of a level.
    pub fn curves(&self) -> &[Curve] {
        match &self.record {
            Record::Curves(curves) => curves,
            Record::Level(_) | Record::Marched => &[],
        }
    }

    /// The first task that can be handed out to a worker; `ordered`: that others wait for.
    pub fn offer(&self, worker: &WorkerId, now: Duration, ordered: bool) -> Option<usize> {
        let is_offered = |entry: &TaskEntry| (!ordered || entry.task.is_ordered()) && entry.is_offered(worker, now);
        self.ready.iter().copied().find(|&e| is_offered(&self.entries[e]))
    }

    /// The verification to hand out: of a whole branch before those of pieces, which take less, so that none begins when all others are
    /// done.
    pub fn offer_verification(&self, worker: &WorkerId, now: Duration) -> Option<usize> {
        let is_whole =
            |e: usize| matches!(self.entries[e].task, Task::Verify(VerifyPlace { stretch: Stretch::Whole, .. }));
        let whole = self.ready.iter().copied().find(|&e| is_whole(e) && self.entries[e].is_offered(worker, now));
        whole.or_else(|| self.offer(worker, now, false))
    }

    pub fn is_begun(&self) -> bool {
        self.entries.first().is_none_or(|first| first.attempts() > 0)
    }

    /// Whether no task is left to hand out or to wait for.
    pub fn is_finished(&self) -> bool {
        self.ready.is_empty() && self.held.is_empty()
    }

    /// Whether all branches of a level are known: of its tasks at most scouts are left, which bring none.
    pub fn has_branches(&self) -> bool {
        let mut left = self.ready.iter().chain(&self.held);
        left.all(|&e| matches!(self.entries[e].task, Task::Scout(_)))
    }

    /// Hands out entry `e`.
    pub fn grant(&mut self, e: usize, holder: &Holder, now: Duration, deadline: Duration) -> Change {
        self.ready.retain(|&ready| ready != e);
        self.held.push(e);
        self.entries[e].grant(holder, now, deadline)
    }

    /// The landing that the seed of entry `e` starts from, or the starts that it is the branch of.
    pub fn landing(&self, e: usize) -> Option<usize> {
        let landing = match self.entries[e].task {
            Task::Seed(place) => Task::Land(place),
            Task::Begin(place) => Task::Start(place.landing()),
            _ => return None,
        };
        self.entries[..e].iter().rposition(|entry| entry.task == landing)
    }

    /// What becomes of entry `e`, which brought this; `None` if such a task does not bring such a thing.
    pub fn outcome(&self, e: usize, brought: &Brought) -> Option<SeedOutcome> {
        match (&self.record, brought) {
            (_, Brought::Nothing(outcome)) => Some(*outcome).filter(|outcome| self.is_known(outcome)),
            (Record::Level(level), brought) => level.account.outcome(brought),
            (Record::Curves(curves), Brought::Curve(_)) => Some(SeedOutcome::OnCurve(curves.len())),
            (Record::Marched, Brought::Verification(count, _)) => Some(SeedOutcome::Verified(*count)),
            (Record::Marched, Brought::Disturbance(count)) => Some(SeedOutcome::Disturbed(*count)),
            (Record::Marched, Brought::Settling(count)) => Some(SeedOutcome::Marched(*count)),
            (Record::Curves(_) | Record::Marched, _) => None,
        }
        .filter(|outcome| match self.entries[e].task {
            Task::Land(_) | Task::Start(_) => matches!(outcome, SeedOutcome::Landed(_) | SeedOutcome::NotLanded(_)),
            Task::Scout(_) => matches!(outcome, SeedOutcome::Landed(_) | SeedOutcome::NoFold),
            Task::Fold(_) | Task::Carry(_) => !matches!(outcome, SeedOutcome::Found(_)) && !is_of_others(outcome),
            Task::Main(_) | Task::Seed(_) | Task::Crossing(_) | Task::Begin(_) | Task::Switch(_) => {
                !matches!(outcome, SeedOutcome::OnCurve(_)) && !is_of_others(outcome)
            }
            Task::Verify(_) => matches!(outcome, SeedOutcome::Verified(_)),
            Task::Disturb(_) => matches!(outcome, SeedOutcome::Disturbed(_)),
            Task::March(_) => matches!(outcome, SeedOutcome::Marched(_)),
        })
    }

    /// Whether what a task without anything new of its own refers to is there.
    fn is_known(&self, outcome: &SeedOutcome) -> bool {
        match (&self.record, outcome) {
            (_, outcome) if is_marched(outcome) => false,
            (_, SeedOutcome::Landed(_)) => false,
            (Record::Level(level), SeedOutcome::Found(id) | SeedOutcome::Passing(id, _)) => {
                level.branches.iter().any(|b| b.known.branch == *id)
            }
            (Record::Curves(curves), SeedOutcome::OnCurve(number)) => *number < curves.len(),
            _ => true,
        }
    }

    /// Takes down what became of entry `e`, and what it brought if that is new.
    pub fn finish(&mut self, e: usize, outcome: SeedOutcome, brought: Option<&Brought>) {
        if let (Task::Begin(place), Some(Brought::Branch { .. })) = (self.entries[e].task, brought) {
            let next = StartPlace { round: place.round + 1, ..place };
            if self.entries.iter().all(|entry| entry.task != Task::Begin(next)) {
                self.rounds.push(next);
            }
        }
        if let (Task::Scout(scout), SeedOutcome::Landed(count)) = (self.entries[e].task, outcome) {
            self.scouted.extend((0..count).map(|fold| (scout, fold)));
        }
        let entry = &mut self.entries[e];
        let task = entry.id.clone();
        match (&mut self.record, outcome, brought) {
            (Record::Level(level), outcome, brought) => {
                level.account.record(&entry.task, outcome);
                if let (SeedOutcome::Found(branch), Some(Brought::Branch { folds, branch_points, .. })) =
                    (outcome, brought)
                {
                    level.branches.push(Branch { known: Known { branch, task }, folds: *folds });
                    self.crossed.extend((0..*branch_points).map(|point| SwitchPlace { branch, point }));
                    self.unverified.push(branch);
                }
            }
            (Record::Curves(curves), SeedOutcome::OnCurve(number), Some(Brought::Curve(forcing))) => {
                let quantity = entry.task.origin().and_then(Origin::quantity);
                curves.push(Curve { known: KnownCurve { number, task }, quantity, forcing: forcing.clone() });
            }
            (Record::Marched, _, Some(Brought::Verification(_, unsettled))) => {
                // What is around a peak is looked at again with all of the branch.
                if let Task::Verify(VerifyPlace { branch, stretch: Stretch::Whole }) = entry.task {
                    let place = |&(index, omega): &(usize, f64)| (entry.level, MarchPlace { branch, index, omega });
                    self.unsettled.extend(unsettled.iter().map(place));
                }
            }
            (Record::Curves(_) | Record::Marched, ..) => {}
        }
        entry.state = TaskState::Done(outcome);
    }

    /// Whether a result of entry `e` fits what is known: it comes from who holds it, or nobody went on without it.
    pub fn takes(&self, e: usize, lease: &Lease) -> bool {
        let entry = &self.entries[e];
        let is_before = |later: &TaskEntry| !later.task.is_ordered() || rank(&later.task) < rank(&entry.task);
        let mut later = self.entries[e + 1..].iter().filter(|later| !is_before(later));
        let is_last = match entry.task {
            // Others come before it in the list, and after it in turn; they wait for it unless it is given up.
            Task::Switch(_) => entry.state != TaskState::Dead,
            _ => later.all(|later| later.attempts() == 0),
        };
        entry.is_held(lease) || !entry.task.is_ordered() || is_last
    }

    /// Finds the tasks that can be handed out, and those that are not needed any more. Where a main branch was given up and
    /// none is known a level waits: seeds would find that one, and nobody could tell it from an isola.
    pub fn settle(&mut self) -> Vec<Change> {
        let mut changes = Vec::new();
        self.ready.clear();
        self.held = (0..self.entries.len()).filter(|&e| self.entries[e].holder().is_some()).collect();
        // What is under way is waited for, whatever came back before it.
        let mut taken = self.waits_for_main() || self.held.iter().any(|&e| self.entries[e].task.is_ordered());
        let mut landings = Vec::new();
        let mut order: Vec<usize> = (0..self.entries.len()).collect();
        order.sort_by_key(|&e| rank(&self.entries[e].task));
        for e in order {
            if self.entries[e].state != TaskState::Waiting {
                continue;
            }
            match self.turn(e, taken) {
                Turn::Needless => {
                    self.entries[e].state = TaskState::Skipped;
                    changes.push(Change::Skipped { task: self.entries[e].id.clone() });
                }
                Turn::Ready if self.entries[e].task.is_ordered() => {
                    self.ready.push(e);
                    taken = true;
                }
                Turn::Ready => landings.push(e),
                Turn::Waits => taken = true,
                Turn::Blocked => {}
            }
        }
        self.ready.append(&mut landings);
        changes
    }

    /// What can be done with entry `e`, which waits; `taken`: it is the turn of one before it.
    fn turn(&self, e: usize, taken: bool) -> Turn {
        let task = &self.entries[e].task;
        let is_needed = |task| self.level().is_none_or(|level| level.account.needs(task));
        match task {
            Task::Land(place) if place.method == LandingMethod::SteppedForcing && !self.is_decided(e, place) => {
                Turn::Blocked
            }
            Task::Start(place) if place.way == StartWay::Homotopy && !self.is_reached(e) => Turn::Blocked,
            _ if !task.is_ordered() && is_needed(task) => Turn::Ready,
            _ if !task.is_ordered() => Turn::Needless,
            _ if taken => Turn::Blocked,
            _ if !is_needed(task) => Turn::Needless,
            _ => match self.landing(e).map(|landing| &self.entries[landing]) {
                Some(landing) if landing.state == TaskState::Dead => Turn::Blocked,
                Some(landing) if !landing.is_settled() => Turn::Waits,
                _ => Turn::Ready,
            },
        }
    }

    /// Whether it is known what became of a seed with the full forcing, of which entry `e` is the other way, or nothing will be.
    fn is_decided(&self, e: usize, place: &SeedPlace) -> bool {
        let full = SeedPlace { method: LandingMethod::FullForcing, ..*place };
        let mut before = self.entries[..e].iter();
        before.clone().filter(|entry| entry.task == Task::Seed(full)).all(TaskEntry::is_settled)
            || before.any(|entry| entry.task == Task::Land(full) && entry.state == TaskState::Dead)
    }

    /// Whether what came before entry `e` is known. Others of its kind wait for nothing of each other.
    fn is_reached(&self, e: usize) -> bool {
        let is_homotopy = |task: &Task| matches!(task, Task::Begin(place) if place.way == StartWay::Homotopy);
        let mut before = self.entries[..e].iter().filter(|entry| entry.task.is_ordered() && !is_homotopy(&entry.task));
        before.all(TaskEntry::is_settled)
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
            entry.troubles = Troubles::default();
            entry.lapsed = false;
            entry.not_before = Duration::ZERO;
            changes.push(Change::Revived { task: entry.id.clone() });
        }
        changes.extend(self.settle());
        changes
    }
}

/// Which tasks come first: main branches, then what crosses branches that are known, so that it is not taken for detached where other
/// tasks come upon it.
fn rank(task: &Task) -> u8 {
    match task {
        Task::Main(_) => 0,
        Task::Switch(_) => 1,
        _ => 2,
    }
}

/// Whether a landing, a scout or a task that marches came to it.
fn is_of_others(outcome: &SeedOutcome) -> bool {
    matches!(outcome, SeedOutcome::Landed(_) | SeedOutcome::NoFold) || is_marched(outcome)
}

/// Whether a task that marches came to it.
fn is_marched(outcome: &SeedOutcome) -> bool {
    matches!(outcome, SeedOutcome::Verified(_) | SeedOutcome::Disturbed(_) | SeedOutcome::Marched(_))
}
