//! Small runs for tests, computed for real.

use crate::journal::{AcceptedResult, AddedTask, AttemptEnd, Change, Holder, LevelPlan, SweepPlan};
use crate::store::{RunHeader, Store};
use protocol::backbone::BackboneMessage;
use protocol::branch::BranchMessage;
use protocol::codec::{encode, sha256};
use protocol::curve::Size;
use protocol::digest::Digest;
use protocol::ids::{Attempt, RunId, TaskId, WorkerId};
use protocol::landings::LandingsMessage;
use protocol::model::ModelMessage;
use protocol::to_everyone::{Amplitude, Stage, StoredResult};
use solver::files;
use solver::response::account::Account;
use solver::response::backbone::Backbone;
use solver::response::branch::{Branch, BranchKind, BranchPoint, Outcome, Stop};
use solver::response::forced::{Forced, SearchRange};
use solver::response::modes::{Backbones, LeftOut};
use solver::response::seeds::Landing;
use solver::response::task::{BranchId, MarchPlace, SeedOutcome, Task, TaskResult, VerifyPlace, plan};
use solver::response::trace::{Given, execute};
use solver::settings::{ModeChoice, NumberList, Settings, Stretch};
use solver::stability::settling::{SettleSettings, Settling, settle};
use solver::stability::verification::{Verification, verify};
use solver::structure::{Model, ModelData};
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

/// A study with its backbone.
pub struct Study {
    /// Model.
    pub model: Model,
    /// Numerics.
    pub settings: Settings,
    /// Backbone of the primary mode.
    pub backbone: Backbone,
    /// Backbones of further modes.
    pub further: Vec<Backbone>,
    /// Bounds of branches.
    pub reach: SearchRange,
    /// Work of every level.
    pub plans: Vec<LevelPlan>,
    amplitudes: Vec<Amplitude>,
}

fn quiet(_: &BranchPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

impl Study {
    /// Of a model of the repository, all dofs monitored, along its highest mode.
    pub fn new(model: &str, harmonics: usize, amplitudes: &[&str]) -> Self {
        Self::of_modes(model, harmonics, amplitudes, 1)
    }

    /// The same along so many of its highest modes, the highest one first.
    pub fn of_modes(model: &str, harmonics: usize, amplitudes: &[&str], count: usize) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(model);
        let model = files::load(&folder).unwrap();
        let monitors = (0..model.size()).collect();
        let model = Model::try_from(ModelData { monitors, ..model.into() }).unwrap();
        let mut settings = Settings::default();
        settings.harmonics.count = harmonics;
        settings.harmonics.samples = 64;
        let modes: Vec<usize> = (1..=model.size()).rev().take(count).collect();
        settings.backbone.modes = ModeChoice::These(NumberList::new(&modes).unwrap());
        let mut backbones = Backbones::compute(&model, &settings).unwrap().list;
        let reach = SearchRange::over(&settings, &backbones[0], &backbones[1..], 0.0).unwrap();
        let amplitude = |text: &&str| Amplitude { text: text.to_string(), value: text.parse().unwrap() };
        let amplitudes: Vec<Amplitude> = amplitudes.iter().map(amplitude).collect();
        let level = |amplitude: &Amplitude| {
            let (windows, tasks) = plan(&backbones, amplitude.value, &settings.frequency, 0);
            LevelPlan { amplitude: amplitude.clone(), windows, tasks }
        };
        let plans: Vec<LevelPlan> = amplitudes.iter().map(level).collect();
        let further = backbones.split_off(1);
        let backbone = backbones.remove(0);
        Self { model, settings, backbone, further, reach, plans, amplitudes }
    }

    /// The damper with an isola at the second of two levels.
    pub fn damper() -> Self {
        Self::new("nonlinear_damper", 3, &["3e-3", "0.006"])
    }

    /// What does not change in the course of its run.
    pub fn header(&self) -> RunHeader {
        let model = ModelMessage::from(&self.model);
        RunHeader {
            run: RunId::new("test-1").unwrap(),
            name: "test".into(),
            study_file: "study.toml".into(),
            overrides: vec![("amplitudes".into(), "3e-3,0.006".into())],
            study: "model = \"damper\"\n".into(),
            model_sha256: sha256(&encode(&model)),
            model,
            settings: self.settings,
            amplitudes: self.amplitudes.clone(),
            program: "0.1.0".into(),
            created: "2026-01-01T00:00:00Z".into(),
            namespace: "isola".into(),
        }
    }

    /// All backbones.
    pub fn backbones(&self) -> Vec<Backbone> {
        std::iter::once(&self.backbone).chain(&self.further).cloned().collect()
    }

    /// What its sweep consists of.
    pub fn plan(&self) -> SweepPlan {
        let is_followed = |mode: &usize| self.backbones().iter().any(|backbone| backbone.mode == *mode);
        let others = (0..self.model.size()).filter(|mode| !is_followed(mode));
        SweepPlan {
            backbone: BackboneMessage::from(&self.backbone),
            further: self.further.iter().map(BackboneMessage::from).collect(),
            orders: Vec::new(),
            left_out: others.map(|mode| (mode, LeftOut::NotListed)).collect(),
            reach: self.reach,
            levels: self.plans.clone(),
            added: Vec::new(),
        }
    }

    /// A run in `dir` whose tasks are ready to be handed out.
    pub fn begin(&self, dir: &Path) -> (Store, Sweep<'_>) {
        let mut store = Store::create(dir, &self.header()).unwrap();
        store.commit(&[Change::Planned(Arc::new(self.plan())), Change::Stage(Stage::Sweep)]).unwrap();
        (store, Sweep::new(self))
    }

    /// A finished run in `dir`.
    pub fn finished(&self, dir: &Path) -> (Store, Vec<StoredResult>) {
        let (mut store, mut sweep) = self.begin(dir);
        while sweep.step(&mut store) {}
        (store, sweep.results)
    }

    /// Verifies the branch of one of the results of a finished run and stores what marching says.
    pub fn verify(&self, store: &mut Store, found: &StoredResult) -> Verification {
        let branch = found.branch.as_ref().unwrap().branch(&Size::of(&self.model)).unwrap();
        let place = VerifyPlace { branch: found.name.unwrap(), stretch: Stretch::Whole };
        let verification = verify(&self.model, &branch, place.stretch, &mut quiet).unwrap();
        let task = TaskId::of_verification(&found.amplitude.text, &place).unwrap();
        let outcome = SeedOutcome::Verified(verification.points.len());
        let result = marched(found, task, Task::Verify(place), outcome);
        commit_marched(store, StoredResult { verification: Some(verification.clone()), ..result });
        verification
    }

    /// Marches on from a point of a branch of a finished run, and stores what that comes to.
    pub fn march(&self, store: &mut Store, found: &StoredResult, index: usize) -> Settling {
        let branch = found.branch.as_ref().unwrap().branch(&Size::of(&self.model)).unwrap();
        let id = found.name.unwrap();
        let place = MarchPlace { branch: id, index, omega: branch.points[index].omega() };
        let known = [(id, &branch)];
        let (settings, model) = (SettleSettings::default(), &self.model);
        let settling =
            settle(model, &settings, &known, &branch, &place, &mut |_, _| ControlFlow::Continue(())).unwrap();
        let task = TaskId::of_march(&found.amplitude.text, &place).unwrap();
        let outcome = SeedOutcome::Marched(settling.periods);
        let result =
            StoredResult { settling: Some(settling.clone()), ..marched(found, task, Task::March(place), outcome) };
        commit_marched(store, result);
        settling
    }

    /// A finished run in `dir` whose branches beside the main ones leave through the amplitude bound.
    pub fn finished_with_cuts(&self, dir: &Path) -> (Store, Vec<StoredResult>) {
        let cut = |finding| match finding {
            TaskResult::Branch(branch) if branch.kind != BranchKind::Main => {
                let outcome = Outcome::Open(Stop::FrequencyBound, Stop::AmplitudeBound);
                TaskResult::Branch(Branch { kind: BranchKind::of_detached(&outcome, true), outcome, ..branch })
            }
            other => other,
        };
        let (mut store, mut sweep) = self.begin(dir);
        while sweep.step_with(&mut store, cut) {}
        (store, sweep.results)
    }
}

/// The one worker.
pub fn worker() -> WorkerId {
    WorkerId::new("worker-1").unwrap()
}

/// A task handed out.
#[derive(Debug, Clone)]
pub struct Granted {
    /// Task.
    pub task: TaskId,
    /// Which attempt at it.
    pub attempt: Attempt,
    level: usize,
    work: Task,
}

/// A sweep under way, with one worker that takes level after level, the largest forcing first, and task after task.
pub struct Sweep<'s> {
    /// What is computed.
    pub study: &'s Study,
    /// Branches found, by task.
    pub branches: HashMap<TaskId, Branch>,
    /// Results so far.
    pub results: Vec<StoredResult>,
    levels: Vec<Turn>,
    /// What seeds landed on, by level; asked for by the task after.
    landings: HashMap<usize, Vec<Landing>>,
    attempts: HashMap<TaskId, u32>,
}

/// Where a level is.
struct Turn {
    account: Account,
    next: usize,
    known: Vec<(BranchId, TaskId)>,
}

impl<'s> Sweep<'s> {
    fn new(study: &'s Study) -> Self {
        let turn = |plan: &LevelPlan| Turn { account: Account::new(plan.windows.clone()), next: 0, known: Vec::new() };
        let levels = study.plans.iter().map(turn).collect();
        let (branches, results, landings, attempts) = Default::default();
        Self { study, branches, results, levels, landings, attempts }
    }

    /// Takes the next task that is needed.
    pub fn lease(&mut self, store: &mut Store, slot: u32) -> Option<Granted> {
        let mut changes = Vec::new();
        let Some((level, e)) = self.next(&mut changes) else {
            store.commit(&changes).unwrap();
            return None;
        };
        let plan = &self.study.plans[level];
        let task = TaskId::of_level(&plan.amplitude.text, e).unwrap();
        let attempt = self.attempts.entry(task.clone()).or_default();
        *attempt += 1;
        let granted = Granted { task, attempt: Attempt(*attempt), level, work: plan.tasks[e] };
        let (task, attempt) = (granted.task.clone(), granted.attempt);
        changes.push(Change::Granted { task, attempt, holder: Holder { worker: worker(), slot } });
        store.commit(&changes).unwrap();
        Some(granted)
    }

    /// Level and place of the next task that is needed; those before it are skipped.
    fn next(&mut self, changes: &mut Vec<Change>) -> Option<(usize, usize)> {
        let plans = &self.study.plans;
        let mut order: Vec<usize> = (0..plans.len()).collect();
        order.sort_by(|&a, &b| plans[b].amplitude.value.total_cmp(&plans[a].amplitude.value));
        for level in order {
            let (turn, plan) = (&mut self.levels[level], &plans[level]);
            while let Some(task) = plan.tasks.get(turn.next) {
                if turn.account.needs(task) {
                    return Some((level, turn.next));
                }
                changes.push(Change::Skipped { task: TaskId::of_level(&plan.amplitude.text, turn.next).unwrap() });
                turn.next += 1;
            }
        }
        None
    }

    /// Takes a task and fails at it.
    pub fn fail(&mut self, store: &mut Store, reason: &str) -> TaskId {
        let Granted { task, attempt, .. } = self.lease(store, 0).unwrap();
        let end = AttemptEnd::Failed(format!("{}: {reason}", worker()));
        store.commit(&[Change::Ended { task: task.clone(), attempt, end }]).unwrap();
        task
    }

    /// Carries out a task; false if there is none left.
    pub fn step(&mut self, store: &mut Store) -> bool {
        self.step_with(store, |finding| finding)
    }

    /// The same, with something else found.
    fn step_with(&mut self, store: &mut Store, change: impl Fn(TaskResult) -> TaskResult) -> bool {
        let Some(granted) = self.lease(store, 0) else { return false };
        let finding = change(self.compute(&granted));
        let changes = self.accept(&granted, finding);
        store.commit(&changes).unwrap();
        true
    }

    fn compute(&self, granted: &Granted) -> TaskResult {
        let (study, amplitude) = (self.study, self.study.plans[granted.level].amplitude.value);
        let mut forced = Forced::new(&study.model, &study.settings, study.reach, amplitude);
        let seeds = granted.work.seeds(forced.modal(), &study.backbones(), amplitude);
        let known = self.levels[granted.level].known.iter();
        let known: Vec<(BranchId, &Branch)> = known.map(|(id, task)| (*id, &self.branches[task])).collect();
        let landings = self.landings.get(&granted.level).map_or(&[][..], |landings| landings);
        let given = Given { seeds: &seeds, landings, known: &known, curves: &[] };
        execute(&mut forced, &granted.work, &given, &mut quiet).unwrap()
    }

    /// Takes down what became of a task: what is to be stored.
    pub fn accept(&mut self, granted: &Granted, finding: TaskResult) -> Vec<Change> {
        let turn = &mut self.levels[granted.level];
        let outcome = turn.account.outcome(&finding.brought()).unwrap();
        turn.account.record(&granted.work, outcome);
        let (branch, landings) = match finding {
            TaskResult::Landings(landings) => (None, Some(landings)),
            TaskResult::Branch(branch) => (Some(branch), None),
            TaskResult::Curve(_) | TaskResult::Nothing(_) => (None, None),
        };
        turn.next += 1;
        let name = match outcome {
            SeedOutcome::Found(id) if branch.is_some() => Some(id),
            _ => None,
        };
        turn.known.extend(name.map(|name| (name, granted.task.clone())));
        let result = StoredResult {
            task: granted.task.clone(),
            attempt: granted.attempt,
            amplitude: self.study.plans[granted.level].amplitude.clone(),
            work: granted.work,
            outcome,
            name,
            branch: branch.as_ref().map(BranchMessage::from),
            curve: None,
            landings: landings.as_deref().map(LandingsMessage::from),
            verification: None,
            disturbance: None,
            settling: None,
            worker: worker(),
            program: "0.1.0".into(),
            seconds: 0.25,
        };
        self.landings.extend(landings.map(|landings| (granted.level, landings)));
        if let Some(branch) = branch {
            self.branches.insert(granted.task.clone(), branch);
        }
        self.results.push(result.clone());
        let (task, attempt, sequence) = (granted.task.clone(), granted.attempt, self.results.len() as u64);
        vec![Change::Done { task, attempt, outcome, sequence }, Change::Result(accepted(result, sequence))]
    }
}

/// The result of a task that marches from a branch, without what it found.
fn marched(found: &StoredResult, task: TaskId, work: Task, outcome: SeedOutcome) -> StoredResult {
    StoredResult { branch: None, name: None, attempt: Attempt(1), task, work, outcome, ..found.clone() }
}

/// Adds the task of a result to a finished run, and the result.
fn commit_marched(store: &mut Store, result: StoredResult) {
    let (task, attempt, outcome) = (result.task.clone(), result.attempt, result.outcome);
    let added = AddedTask { id: task.clone(), amplitude: result.amplitude.text.clone(), task: result.work };
    let sequence = store.done().unwrap().len() as u64 + 1;
    let done = Change::Done { task, attempt, outcome, sequence };
    store.commit(&[Change::Added(vec![added]), done, Change::Result(accepted(result, sequence))]).unwrap();
}

/// A result as it is stored.
pub fn accepted(result: StoredResult, sequence: u64) -> AcceptedResult {
    let digest = Digest::of(&result);
    AcceptedResult { result: Box::new(result), sequence, digest }
}
