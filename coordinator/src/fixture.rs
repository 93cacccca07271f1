//! Small runs for tests, computed for real.

use crate::ledger::{AttemptEnd, Granted, Leased, Ledger, LevelPlan, Record, Rules, Submitted};
use crate::store::{Change, RunHeader, Store};
use protocol::backbone::BackboneMessage;
use protocol::branch::BranchMessage;
use protocol::codec::{encode, sha256};
use protocol::from_worker::Lease;
use protocol::ids::{RunId, TaskId, WorkerId};
use protocol::model::ModelMessage;
use protocol::to_everyone::{Amplitude, StoredResult};
use solver::backbone::Backbone;
use solver::branch::{Branch, BranchPoint};
use solver::forced::{Forced, Reach};
use solver::model::Model;
use solver::settings::Settings;
use solver::task::{BranchId, Finding, SeedOutcome, carry_out, plan};
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

/// A study with its backbone.
pub(crate) struct Study {
    pub model: Model,
    pub settings: Settings,
    pub backbone: Backbone,
    pub reach: Reach,
    pub plans: Vec<LevelPlan>,
    amplitudes: Vec<Amplitude>,
}

fn quiet(_: &BranchPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

impl Study {
    /// Of a model of the repository, all dofs monitored, along its highest mode.
    pub fn new(model: &str, harmonics: usize, amplitudes: &[&str]) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(model);
        let mut model = Model::load(&folder).unwrap();
        model.monitors = (0..model.size()).collect();
        let mut settings = Settings::default();
        settings.harmonics.count = harmonics;
        settings.harmonics.samples = 64;
        settings.backbone.mode = model.size();
        let backbone = Backbone::compute(&model, &settings, &mut quiet).unwrap();
        let reach = Reach::new(&settings, &backbone).unwrap();
        let amplitude = |text: &&str| Amplitude { text: text.to_string(), value: text.parse().unwrap() };
        let amplitudes: Vec<Amplitude> = amplitudes.iter().map(amplitude).collect();
        let level = |amplitude: &Amplitude| {
            let (windows, tasks) = plan(&backbone, amplitude.value);
            LevelPlan { amplitude: amplitude.clone(), windows, tasks }
        };
        let plans = amplitudes.iter().map(level).collect();
        Self { model, settings, backbone, reach, plans, amplitudes }
    }

    /// The damper with an isola at the second of two levels.
    pub fn damper() -> Self {
        Self::new("nonlinear_damper", 3, &["3e-3", "0.006"])
    }

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

    /// A run in `dir` whose tasks are ready to be handed out.
    pub fn begin(&self, dir: &Path) -> (Store, Sweep<'_>) {
        let mut store = Store::create(dir, &self.header()).unwrap();
        store.set_backbone(&BackboneMessage::from(&self.backbone), &self.reach, &self.plans).unwrap();
        let ledger = Ledger::new(Rules::default(), self.plans.clone());
        (store, Sweep { study: self, ledger, branches: HashMap::new(), results: Vec::new() })
    }

    /// A finished run in `dir`.
    pub fn finished(&self, dir: &Path) -> (Store, Vec<StoredResult>) {
        let (mut store, mut sweep) = self.begin(dir);
        while sweep.step(&mut store) {}
        (store, sweep.results)
    }
}

/// A sweep under way, with one worker.
pub(crate) struct Sweep<'s> {
    pub study: &'s Study,
    pub ledger: Ledger,
    /// Branches found, by task.
    pub branches: HashMap<TaskId, Branch>,
    pub results: Vec<StoredResult>,
}

pub(crate) fn worker() -> WorkerId {
    WorkerId::new("worker-1").unwrap()
}

pub(crate) fn commit(store: &mut Store, records: &[Record]) {
    store.commit(&records.iter().map(Change::Record).collect::<Vec<_>>()).unwrap();
}

impl Sweep<'_> {
    /// Takes a task.
    pub fn lease(&mut self, store: &mut Store, slot: u32, now: Duration) -> Option<(Granted, Lease)> {
        let (leased, records) = self.ledger.lease(&worker(), slot, now);
        commit(store, &records);
        let Leased::Grant(granted) = leased else { return None };
        let lease = Lease { task: granted.task.clone(), attempt: granted.attempt, worker: worker(), slot };
        Some((granted, lease))
    }

    /// Takes a task and fails at it.
    pub fn fail(&mut self, store: &mut Store, reason: &str, now: Duration) -> TaskId {
        let (granted, lease) = self.lease(store, 0, now).unwrap();
        let (held, records) = self.ledger.fail(&lease, reason, now);
        assert!(held && matches!(&records[0], Record::Ended { end: AttemptEnd::Failed(_), .. }));
        commit(store, &records);
        granted.task
    }

    /// Carries out a task; false if there is none left.
    pub fn step(&mut self, store: &mut Store) -> bool {
        let Some((granted, lease)) = self.lease(store, 0, Duration::from_secs(1000)) else { return false };
        let result = self.compute(&granted, &lease);
        let bytes = encode(&result.0);
        let (sha, size) = (sha256(&bytes), bytes.len() as u64);
        let mut changes: Vec<Change<'_>> = result.1.iter().map(Change::Record).collect();
        changes.push(Change::Result { result: &result.0, sequence: self.ledger.sequence(), size, sha256: &sha });
        store.commit(&changes).unwrap();
        self.results.push(result.0);
        true
    }

    fn compute(&mut self, granted: &Granted, lease: &Lease) -> (StoredResult, Vec<Record>) {
        let study = self.study;
        let mut forced = Forced::new(&study.model, &study.settings, study.reach, granted.amplitude.value);
        let seeds = granted.work.seeds(&forced.problem, &study.backbone, granted.amplitude.value);
        let known: Vec<(BranchId, &Branch)> =
            granted.known.iter().map(|known| (known.branch, &self.branches[&known.task])).collect();
        let finding = carry_out(&mut forced, &granted.work, &seeds, &known, &mut quiet).unwrap();
        let (branch, outcome) = match finding {
            Finding::Branch(branch) => (Some(branch), None),
            Finding::Nothing(outcome) => (None, Some(outcome)),
        };
        let (Submitted::Accepted(accepted), records) = self.ledger.submit(lease, outcome) else { panic!("accepted") };
        let name = match accepted.outcome {
            SeedOutcome::Found(id) if branch.is_some() => Some(id),
            _ => None,
        };
        let result = StoredResult {
            task: granted.task.clone(),
            attempt: granted.attempt,
            amplitude: accepted.amplitude,
            work: accepted.work,
            outcome: accepted.outcome,
            name,
            branch: branch.as_ref().map(BranchMessage::from),
            worker: worker(),
            program: "0.1.0".into(),
            seconds: 0.25,
        };
        if let Some(branch) = branch {
            self.branches.insert(granted.task.clone(), branch);
        }
        (result, records)
    }
}
