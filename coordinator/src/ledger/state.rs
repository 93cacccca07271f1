//! What every event changes.

use super::answers::{Accepted, Granted, Leased, Submitted};
use super::chain::{Chain, Curve, LevelRecord};
use super::cost::Cost;
use super::repeats::{Repeated, Repeats};
use super::rules::Rules;
use super::task::TaskEntry;
use super::worker::Worker;
use protocol::from_worker::{Lease, Progress, thread_of};
use protocol::ids::{Attempt, TaskId, WorkerId};
use protocol::to_worker::{Known, KnownCurve};
use results::journal::{AttemptEnd, Change, Holder, KINDS, LevelPlan, TaskState};
use solver::response::task::{
    BranchId, Brought, CarryPlace, CrossingPlace, DisturbPlace, FoldPlace, Origin, SeedOutcome, SwitchPlace, Task,
    VerifyPlace,
};
use std::collections::{BTreeMap, HashMap, HashSet, VecDeque};
use std::time::Duration;

/// The ledger of a run.
#[derive(Debug)]
pub struct Ledger {
    pub(super) rules: Rules,
    /// The levels in the order of the study, then the curves over all of them, and last the verifications.
    pub(super) chains: Vec<Chain>,
    /// Chains in the order in which they are begun: the largest forcing, which takes longest, first. Without verifications,
    /// which nothing waits for.
    pub(super) order: Vec<usize>,
    pub(super) index: HashMap<TaskId, (usize, usize)>,
    pub(super) workers: BTreeMap<WorkerId, Worker>,
    /// Of every level the number of branches of which it was looked at what of them is followed over the forcing.
    pub(super) unfolded: Vec<usize>,
    /// Where curves over the forcing start, with their levels, that have tasks.
    pub(super) followed: HashSet<(usize, Origin)>,
    /// Where they start that wait for tasks.
    pub(super) queue: VecDeque<(usize, Origin)>,
    /// Branches that have a task that verifies them, with their levels.
    pub(super) verified: HashSet<(usize, VerifyPlace)>,
    /// Points of branches from which unstable motions have a task that marches them, with the numbers of their levels.
    pub(super) marched: HashSet<(usize, BranchId, usize)>,
    /// Crossings of curves that had tasks when this process began: level, curve and segment.
    pub(super) crossings: HashSet<(usize, usize, usize)>,
    /// Branch points of branches that have tasks, with the numbers of their levels.
    pub(super) switched: HashSet<(usize, SwitchPlace)>,
    /// Number of curves whose crossings were looked at since this process began.
    pub(super) crossed: usize,
    /// Number of announcements so far.
    pub(super) sequence: u64,
    pub(super) cancelled: bool,
    /// Until when nobody is blamed for not being heard of: it is this side that could not be reached.
    pub(super) forbearance: Duration,
    /// Results that are repeated.
    pub(super) repeats: Repeats,
    /// What tasks have cost, by kind.
    pub(super) costs: [Cost; KINDS.len()],
    /// Until when it is added up how busy workers are.
    pub(super) measured: Duration,
}

impl Ledger {
    /// The ledger of a run that begins. Task ids follow from amplitudes and places: see [`TaskId::of_level`].
    pub fn new(rules: Rules, plans: Vec<LevelPlan>) -> Self {
        let mut chains: Vec<Chain> = plans.into_iter().enumerate().map(|(l, plan)| Chain::of_level(plan, l)).collect();
        let value = |&l: &usize| chains[l].level().map_or(0.0, |level| level.amplitude.value);
        let mut order: Vec<usize> = (0..chains.len()).collect();
        order.sort_by(|a, b| value(b).total_cmp(&value(a)));
        order.push(chains.len());
        chains.extend([Chain::of_curves(), Chain::of_verifications()]);
        let place = |(c, chain): (usize, &Chain)| -> Vec<(TaskId, (usize, usize))> {
            chain.entries.iter().enumerate().map(|(e, entry)| (entry.id.clone(), (c, e))).collect()
        };
        let index = chains.iter().enumerate().flat_map(place).collect();
        let (workers, followed, queue, verified, marched) = Default::default();
        let unfolded = vec![0; chains.len()];
        let (crossings, switched, crossed, sequence, cancelled, forbearance, repeats, costs, measured) =
            Default::default();
        Self {
            rules,
            chains,
            order,
            index,
            workers,
            unfolded,
            followed,
            queue,
            verified,
            marched,
            crossings,
            switched,
            crossed,
            sequence,
            cancelled,
            forbearance,
            repeats,
            costs,
            measured,
        }
    }

    /// The levels, in the order of the study.
    pub(super) fn levels(&self) -> impl Iterator<Item = (&Chain, &LevelRecord)> {
        self.chains.iter().filter_map(|chain| Some((chain, chain.level()?)))
    }

    /// Place of the chain of curves.
    pub(super) fn curves(&self) -> usize {
        self.chains.len() - 2
    }

    /// Place of the chain of verifications.
    pub(super) fn verifications(&self) -> usize {
        self.chains.len() - 1
    }

    /// Order of the motions of a task, if it is not the first one.
    pub(super) fn order_of(&self, task: &TaskId) -> Option<usize> {
        let &(c, e) = self.index.get(task)?;
        self.chains[self.chains[c].entries[e].level].level()?.amplitude.order()
    }

    /// Whether a curve on which entry `e` of chain `c` is said to lie is one of the same order of motions.
    fn is_of_order(&self, (c, e): (usize, usize), brought: &Brought) -> bool {
        let Brought::Nothing(SeedOutcome::OnCurve(number)) = brought else { return true };
        let curve = self.chains[self.curves()].curves().get(*number);
        curve.is_none_or(|curve| self.order_of(&curve.known.task) == self.order_of(&self.chains[c].entries[e].id))
    }

    /// What is handed out with entry `e` of chain `c`; of one that is done what was handed out then.
    pub(super) fn granted(&self, c: usize, e: usize) -> Granted {
        let entry = &self.chains[c].entries[e];
        let level = self.chains[entry.level].level().expect("tasks are of levels");
        let (branches, curves) = entry.known.unwrap_or((usize::MAX, usize::MAX));
        let branches = level.branches.iter().take(branches).map(|branch| &branch.known);
        let curves = self.chains[self.curves()].curves().iter().take(curves);
        let curves = curves.filter(|curve| self.order_of(&curve.known.task) == level.amplitude.order());
        let (known, curves): (Vec<Known>, Vec<KnownCurve>) = match entry.task {
            Task::Land(_) | Task::Start(_) | Task::Scout(_) => Default::default(),
            Task::Main(_) | Task::Seed(_) | Task::Begin(_) | Task::March(_) | Task::Switch(_) => {
                (branches.cloned().collect(), Vec::new())
            }
            Task::Fold(FoldPlace::Scout { .. }) => (Vec::new(), near(curves, &entry.task, level)),
            Task::Fold(FoldPlace::Branch { branch, .. }) | Task::Carry(CarryPlace { branch, .. }) => {
                let own = branches.filter(|known| known.branch == branch).cloned().collect();
                (own, near(curves, &entry.task, level))
            }
            Task::Verify(VerifyPlace { branch, .. }) => {
                (branches.filter(|known| known.branch == branch).cloned().collect(), Vec::new())
            }
            Task::Disturb(DisturbPlace { branch, .. }) => {
                let matters = |known: &&Known| known.branch == branch || known.branch.is_main();
                (branches.filter(matters).cloned().collect(), Vec::new())
            }
            Task::Crossing(CrossingPlace { curve, .. }) => {
                let own = curves.filter(|known| known.known.number == curve);
                (branches.cloned().collect(), own.map(|c| c.known.clone()).collect())
            }
        };
        Granted {
            task: entry.id.clone(),
            attempt: Attempt(entry.attempts()),
            amplitude: level.amplitude.clone(),
            work: entry.task,
            landing: self.landing(c, e),
            known,
            curves,
            checkpoint: 0,
        }
    }

    /// The task whose landings entry `e` of chain `c` starts from.
    fn landing(&self, c: usize, e: usize) -> Option<TaskId> {
        let entry = &self.chains[c].entries[e];
        let found = match entry.task {
            Task::Fold(FoldPlace::Scout { scout, .. }) => {
                self.chains[entry.level].entries.iter().find(|entry| entry.task == Task::Scout(scout))
            }
            _ => self.chains[c].landing(e).map(|landing| &self.chains[c].entries[landing]),
        };
        found.map(|entry| entry.id.clone())
    }

    /// Hands out a task to a computing thread; one that holds a task gets the same again.
    pub fn lease(&mut self, worker: &WorkerId, slot: u32, now: Duration) -> (Leased, Vec<Change>) {
        let known = self.workers.entry(worker.clone()).or_default();
        known.gone = false;
        known.threads.insert(thread_of(slot));
        if self.cancelled {
            return (Leased::Stop, Vec::new());
        }
        if let Some(reasons) = self.refusals(worker) {
            return (Leased::Unwelcome(reasons.to_vec()), Vec::new());
        }
        let holder = Holder { worker: worker.clone(), slot };
        let mut changes = self.tick(now);
        if let Some((c, e)) = self.held_by(&holder) {
            let deadline = now + self.rules.lease;
            self.chains[c].entries[e].renew(deadline);
            return (Leased::Grant(self.granted(c, e)), changes);
        }
        if let Some((repeat, granted)) = self.repeat_for(&holder, now) {
            changes.extend(granted);
            return (Leased::Grant(repeat), changes);
        }
        let Some((c, e)) = self.choose(&holder, now) else {
            let leased = if self.is_finished() { Leased::Drained } else { Leased::Wait };
            return (leased, changes);
        };
        changes.push(self.chains[c].grant(e, &holder, now, now + self.rules.lease));
        self.workers.entry(worker.clone()).or_default().chains.insert(slot, c);
        (Leased::Grant(self.granted(c, e)), changes)
    }

    /// The task to hand out: of the chain that this thread worked on last; or one that others wait for, of a chain that was
    /// begun or of the next one; or a landing; or a verification.
    fn choose(&self, holder: &Holder, now: Duration) -> Option<(usize, usize)> {
        let last = self.workers.get(&holder.worker).and_then(|worker| worker.chains.get(&holder.slot)).copied();
        let offer = |c: usize, ordered| self.chains[c].offer(&holder.worker, now, ordered).map(|e| (c, e));
        let begun = || self.order.iter().copied().filter(|&c| self.chains[c].is_begun());
        let all = || self.order.iter().copied();
        last.filter(|&c| c != self.verifications())
            .and_then(|c| offer(c, false))
            .or_else(|| begun().find_map(|c| offer(c, true)))
            .or_else(|| all().find_map(|c| offer(c, true)))
            .or_else(|| all().find_map(|c| offer(c, false)))
            .or_else(|| self.verification(&holder.worker, now))
    }

    /// The verification to hand out.
    fn verification(&self, worker: &WorkerId, now: Duration) -> Option<(usize, usize)> {
        let c = self.verifications();
        self.chains[c].offer_verification(worker, now).map(|e| (c, e))
    }

    /// Number of tasks that can be handed out, with those that are to be repeated once more since they are doubtful.
    pub fn offered_now(&self, now: Duration) -> usize {
        let ready = self.chains.iter().flat_map(|chain| chain.ready.iter().map(|&e| &chain.entries[e]));
        ready.filter(|entry| entry.not_before <= now).count() + self.doubts()
    }

    /// What a thread holds: of the chain that it got its last task from.
    pub(super) fn held_by(&self, holder: &Holder) -> Option<(usize, usize)> {
        let c = *self.workers.get(&holder.worker)?.chains.get(&holder.slot)?;
        let chain = &self.chains[c];
        chain.held.iter().find(|&&e| chain.entries[e].holder() == Some(holder)).map(|&e| (c, e))
    }

    /// The entry that a lease is for, if it is still valid.
    pub(super) fn valid(&self, lease: &Lease) -> Option<(usize, usize)> {
        let &(c, e) = self.index.get(&lease.task)?;
        self.chains[c].entries[e].is_held(lease).then_some((c, e))
    }

    /// Whether a task is under way under this lease.
    pub fn is_held(&self, lease: &Lease) -> bool {
        self.valid(lease).is_some()
    }

    /// Where the branch of a task under way is: for people, no sign of life.
    pub fn note(&mut self, task: &TaskId, progress: Progress, now: Duration) {
        let Some(&(c, e)) = self.index.get(task) else { return };
        let entry = &mut self.chains[c].entries[e];
        let is_number = progress.omega.is_finite() && progress.amplitude.is_finite();
        let worker = entry.holder().and_then(|holder| self.workers.get_mut(&holder.worker)).filter(|_| is_number);
        let Some(worker) = worker else { return };
        if worker.progress.insert(task.clone(), progress) != Some(progress) {
            entry.moved_at = now;
        }
    }

    /// A result: what the task brought. The first result of a task counts, whoever it comes from.
    pub fn submit(&mut self, lease: &Lease, brought: &Brought) -> (Submitted, Vec<Change>) {
        let Some(&(c, e)) = self.index.get(&lease.task) else { return (Submitted::Unknown, Vec::new()) };
        let chain = &mut self.chains[c];
        if !chain.entries[e].was_granted(lease) {
            return (Submitted::NeverGranted, Vec::new());
        }
        if matches!(chain.entries[e].state, TaskState::Done(_) | TaskState::Skipped) {
            return match self.repeated(lease, brought) {
                Some(Repeated { agrees, granted_at, changes }) => (Submitted::Repeated { agrees, granted_at }, changes),
                None => (Submitted::Duplicate, Vec::new()),
            };
        }
        // Of what was withdrawn: a result that was compared, once more.
        if chain.entries[e].compared.contains(&lease.attempt) {
            return (Submitted::Duplicate, Vec::new());
        }
        if !chain.takes(e, lease) {
            return (Submitted::Late, Vec::new());
        }
        let Some(outcome) = chain.outcome(e, brought) else { return (Submitted::Foreign, Vec::new()) };
        if !self.is_of_order((c, e), brought) {
            return (Submitted::Foreign, Vec::new());
        }
        let chain = &mut self.chains[c];
        let mut changes = chain.entries[e].supersede(lease);
        self.finish(c, e, outcome, Some(brought));
        self.sequence += 1;
        let (task, attempt) = (lease.task.clone(), lease.attempt);
        changes.push(Change::Done { task, attempt, outcome, sequence: self.sequence });
        self.claim((c, e), lease, brought);
        changes.extend(self.chains[c].settle());
        let entry = &self.chains[c].entries[e];
        let (work, level) = (entry.task, entry.level);
        let worker = self.workers.entry(lease.worker.clone()).or_default();
        worker.done += 1;
        worker.progress.remove(&lease.task);
        changes.extend(self.extend());
        let amplitude = self.chains[level].level().expect("tasks are of levels").amplitude.clone();
        (Submitted::Accepted(Accepted { outcome, sequence: self.sequence, amplitude, work }), changes)
    }

    /// Takes down what became of entry `e` of chain `c`, and what was known then.
    pub(super) fn finish(&mut self, c: usize, e: usize, outcome: SeedOutcome, brought: Option<&Brought>) {
        let level = self.chains[c].entries[e].level;
        let branches = self.chains[level].level().map_or(0, |level| level.branches.len());
        let curves = self.chains[self.curves()].curves().len();
        self.chains[c].entries[e].known = Some((branches, curves));
        self.chains[c].finish(e, outcome, brought);
    }

    /// A task that could not be carried out. False if it was not this worker's any more.
    pub fn fail(&mut self, lease: &Lease, reason: &str, now: Duration) -> (bool, Vec<Change>) {
        self.end(lease, AttemptEnd::Failed(format!("{}: {reason}", lease.worker)), now)
    }

    /// A task given back.
    pub fn release(&mut self, lease: &Lease, now: Duration) -> (bool, Vec<Change>) {
        self.end(lease, AttemptEnd::Released, now)
    }

    pub(super) fn end(&mut self, lease: &Lease, end: AttemptEnd, now: Duration) -> (bool, Vec<Change>) {
        let Some((c, e)) = self.valid(lease) else {
            let changes = self.end_repeat(lease, end);
            return (changes.is_some(), changes.unwrap_or_default());
        };
        let changes = self.end_at(c, e, end, now);
        (true, changes)
    }

    pub(super) fn end_at(&mut self, c: usize, e: usize, end: AttemptEnd, now: Duration) -> Vec<Change> {
        let entry = &mut self.chains[c].entries[e];
        if let Some(worker) = entry.holder().and_then(|holder| self.workers.get_mut(&holder.worker)) {
            worker.progress.remove(&entry.id);
        }
        let mut changes = entry.end(end, &self.rules, now);
        changes.extend(self.chains[c].settle());
        changes.extend(self.extend());
        changes
    }

    /// Hands out nothing any more.
    pub fn cancel(&mut self) {
        self.cancelled = true;
    }

    /// Puts the tasks of the dead list back.
    pub fn retry_dead(&mut self) -> Vec<Change> {
        self.chains.iter_mut().flat_map(Chain::revive).collect()
    }

    /// Whether no task is left to hand out or to wait for, and nothing doubtful that somebody can decide; what else nobody repeats so
    /// far is not repeated any more.
    pub fn is_finished(&self) -> bool {
        self.has_nothing_left() && self.repeats.holders().next().is_none() && !self.has_doubts()
    }

    /// Whether no task is left but what is being repeated.
    pub(super) fn has_nothing_left(&self) -> bool {
        self.chains.iter().all(Chain::is_finished)
    }

    /// Whether nothing is left to do but to verify what was found.
    pub(super) fn has_searched(&self) -> bool {
        self.order.iter().all(|&c| self.chains[c].is_finished())
    }

    pub(super) fn entries(&self) -> impl Iterator<Item = &TaskEntry> {
        self.chains.iter().flat_map(|chain| &chain.entries)
    }

    /// Dead tasks with what has gone wrong.
    pub fn dead(&self) -> Vec<(TaskId, Vec<String>)> {
        let dead = self.entries().filter(|entry| entry.state == TaskState::Dead);
        dead.map(|entry| (entry.id.clone(), entry.troubles.reasons.clone())).collect()
    }
}

/// The curves that what a task follows may lie on.
fn near<'c>(curves: impl Iterator<Item = &'c Curve>, task: &Task, level: &LevelRecord) -> Vec<KnownCurve> {
    let (forcing, quantity) = (task.forcing(level.amplitude.value), task.origin().map(Origin::quantity));
    let near = curves.filter(|curve| Some(curve.quantity) == quantity && curve.reaches(forcing));
    near.map(|curve| curve.known.clone()).collect()
}
