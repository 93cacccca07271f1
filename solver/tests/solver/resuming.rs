//! Tasks that are interrupted and go on from their recorded steps: the same result to the last bit, for its share of the work.

use crate::branching::{before_a_stop, settings};
use crate::continuation::damped_chain;
use crate::support::study::{own, with_harmonics};
use solver::curve::record::{Recorder, Step};
use solver::files;
use solver::response::branch::{BranchPoint, Side};
use solver::response::interrupt::Interrupt;
use solver::response::scout::ScoutPlace;
use solver::response::seeds::{Landing, LandingMethod, Phase};
use solver::response::starts::StartPlace;
use solver::response::task::{BranchId, FoldPlace, SeedPlace, Task, TaskResult};
use solver::response::trace::{Given, execute};
use solver::response::windows::Window;
use solver::{Backbone, Branch, Forced, ModeChoice, Model, SearchRange, Settings};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{Arc, Mutex};

fn load(name: &str) -> Model {
    files::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name)).unwrap()
}

/// What tasks are carried out with.
struct Study {
    model: Model,
    settings: Settings,
    reach: SearchRange,
    forcing: f64,
}

/// What came of a task, and the steps that were computed for it.
struct Outcome {
    result: Option<TaskResult>,
    steps: Vec<Step>,
}

impl Outcome {
    fn result(&self) -> &TaskResult {
        self.result.as_ref().unwrap()
    }

    /// Every bit of the result: floating point numbers are printed so that they are read back without loss.
    fn bits(&self) -> String {
        format!("{:?}", self.result())
    }

    fn iterations(&self) -> usize {
        self.steps.iter().map(|step| step.point.iterations).sum()
    }

    fn branch(&self) -> &Branch {
        let TaskResult::Branch(branch) = self.result() else { panic!("no branch: {:?}", self.result()) };
        branch
    }
}

impl Study {
    fn new(name: &str, settings: Settings, forcing: f64) -> Self {
        Self::of(load(name), settings, forcing)
    }

    fn of(model: Model, settings: Settings, forcing: f64) -> Self {
        // More steps than anybody needs.
        let mut settings = settings;
        settings.continuation.max_step = settings.continuation.max_step.min(0.04);
        let backbone = Backbone::compute(&model, &settings).unwrap();
        let reach = SearchRange::new(&settings, &backbone).unwrap();
        Self { model, settings, reach, forcing }
    }

    /// Carries out a task from the steps recorded `before`, told so many points at most.
    fn execute(&self, task: &Task, given: &Given<'_>, before: Vec<Step>, points: usize) -> Outcome {
        let steps: Arc<Mutex<Vec<Step>>> = Arc::default();
        let (kept, first) = (steps.clone(), before.len());
        let recorder = Recorder::new(before, move |number, step| {
            let mut kept = kept.lock().unwrap();
            assert_eq!(number, first + kept.len());
            kept.push(step);
        });
        let mut forced = Forced::new(&self.model, &self.settings, self.reach, self.forcing).recorded(recorder);
        let mut told = 0;
        let mut observer = |_: &BranchPoint| {
            told += 1;
            if told > points { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let result = execute(&mut forced, task, given, &mut observer);
        let steps = steps.lock().unwrap().clone();
        Outcome { result, steps }
    }

    fn whole(&self, task: &Task, given: &Given<'_>) -> Outcome {
        self.execute(task, given, Vec::new(), usize::MAX)
    }

    /// Interrupts a task at several points, and goes on.
    fn interrupt(&self, task: &Task, given: &Given<'_>) {
        let whole = self.whole(task, given);
        let (count, all) = (whole.steps.len(), whole.iterations());
        println!("{task:?}: {count} steps, {} walks", whole.steps[count - 1].walk);
        assert!(count > 10, "{count} steps");
        for tenths in [1, 5, 9, 10] {
            let done = count * tenths / 10;
            let rest = self.execute(task, given, whole.steps[..done].to_vec(), usize::MAX);
            assert!(rest.bits() == whole.bits(), "interrupted after {done} of {count} steps");
            assert!(rest.steps == whole.steps[done..]);
            let before: usize = whole.steps[..done].iter().map(|step| step.point.iterations).sum();
            assert_eq!(rest.iterations(), all - before);
        }
        // Interrupted from outside, twice.
        let first = self.execute(task, given, Vec::new(), count / 3);
        assert!(first.result.is_none());
        let second = self.execute(task, given, first.steps.clone(), 2 * count / 3);
        assert!(second.result.is_none());
        let steps: Vec<Step> = first.steps.into_iter().chain(second.steps).collect();
        assert!(steps.len() > count / 2 && steps.len() < count, "{} of {count} steps", steps.len());
        assert!(self.execute(task, given, steps, usize::MAX).bits() == whole.bits());
    }
}

fn landing(branch: &Branch) -> Landing {
    Landing { state: branch.points[branch.points.len() / 3].state.clone(), distance: 0.0 }
}

fn seed() -> Task {
    let well = Window { mode: 0, first: 0, last: 0, best: 0, threshold: 0.0, omega: (1.0, 1.0) };
    Task::Seed(SeedPlace { window: 0, well, phase: Phase::First, method: LandingMethod::FullForcing })
}

#[test]
fn a_main_branch_that_hardens() {
    Study::new("duffing", Settings::default(), 0.05).interrupt(&Task::Main(Side::Below), &Given::default());
}

#[test]
fn main_branches_with_contact() {
    for (name, forcing, step) in
        [("impact_subharmonic", 0.5, 5e-3), ("two_masses_stop", 0.02, 5e-3), ("friction_mass", 1.0, 0.04)]
    {
        let mut settings = Settings::default();
        settings.continuation.max_step = step;
        Study::new(name, settings, forcing).interrupt(&Task::Main(Side::Below), &Given::default());
    }
}

#[test]
fn an_isola_with_contact_and_the_curve_of_its_folds() {
    let study = Study::new("impact_subharmonic", Settings::default(), 0.5);
    let backbone = Backbone::compute(&study.model, &study.settings).unwrap();
    let level = solver::Level::compute(&study.model, &study.settings, &backbone, study.forcing).unwrap();
    let isola = level.isolas().next().unwrap();
    let (landings, main) = ([landing(isola)], BranchId::MAIN);
    let known = [(main, level.main())];
    let given = Given { landings: &landings, known: &known, ..Given::default() };
    study.interrupt(&seed(), &given);
    let id = level.branches.iter().find(|(_, branch)| branch == isola).unwrap().0;
    let known = [(id, isola)];
    let given = Given { known: &known, ..Given::default() };
    study.interrupt(&Task::Fold(FoldPlace::Branch { branch: id, fold: 0 }), &given);
}

/// Its first walk leads round an isola, where a growing forcing leads to from rest; another enters the main branch elsewhere.
#[test]
fn a_main_branch_that_is_entered_twice() {
    let mut settings = Settings::default();
    settings.backbone.modes = ModeChoice::one(2);
    let study = Study::of(own("energy_sink"), settings, 0.19);
    let (task, given) = (Task::Main(Side::Below), Given::default());
    assert!(study.whole(&task, &given).steps.iter().any(|step| step.walk > 1));
    study.interrupt(&task, &given);
}

#[test]
fn a_branch_up_to_where_it_branches_off_the_main_one() {
    let study = Study::of(before_a_stop(2, 0.5, 2.0), settings(10, 0.9, 1.6), 3.0);
    let backbone = Backbone::compute(&study.model, &study.settings).unwrap();
    let level = solver::Level::compute(&study.model, &study.settings, &backbone, study.forcing).unwrap();
    let branched = level.branches().map(|(_, branch)| branch).find(|branch| branch.is_branched()).unwrap();
    let (landings, known) = ([landing(branched)], [(BranchId::MAIN, level.main())]);
    study.interrupt(&seed(), &Given { landings: &landings, known: &known, ..Given::default() });
}

/// Steps shrink until the corner, and grow again beyond it.
#[test]
fn a_main_branch_that_turns_a_sharp_corner() {
    let study = Study::of(damped_chain(), with_harmonics(5), 0.7596);
    let (task, given) = (Task::Main(Side::Below), Given::default());
    let whole = study.whole(&task, &given);
    let length = |i: &usize| whole.steps[*i].point.step;
    let corner = (0..whole.steps.len()).min_by(|a, b| length(a).total_cmp(&length(b))).unwrap();
    assert!(length(&corner) < 1e-6, "{}", length(&corner));
    for done in corner - 1..corner + 4 {
        let rest = study.execute(&task, &given, whole.steps[..done].to_vec(), usize::MAX);
        assert!(rest.bits() == whole.bits(), "interrupted after {done} steps, {corner} to the corner");
        assert!(rest.steps == whole.steps[done..]);
    }
    study.interrupt(&task, &given);
}

#[test]
fn a_scout_that_walks_many_branches() {
    let study = Study::new("duffing", Settings::default(), 0.05);
    study.interrupt(&Task::Scout(ScoutPlace { number: 0, batches: 1 }), &Given::default());
}

/// Steps of something else cost nothing but themselves: the result is the same, and nothing is recorded from there on.
#[test]
fn steps_of_another_task_are_not_taken() {
    let study = Study::new("duffing", Settings::default(), 0.05);
    let (task, given) = (Task::Main(Side::Below), Given::default());
    let whole = study.whole(&task, &given);
    let damage: [fn(&mut Vec<Step>); 4] = [
        |steps| steps[0].point.y.truncate(3),
        |steps| steps[0].point.tangent[0] = f64::NAN,
        |steps| steps.iter_mut().for_each(|step| step.walk += 1),
        |steps| steps.iter_mut().for_each(|step| step.walk = 0),
    ];
    for damage in damage {
        let mut steps = whole.steps.clone();
        damage(&mut steps);
        let again = study.execute(&task, &given, steps, usize::MAX);
        assert!(again.bits() == whole.bits());
        assert!(again.steps.is_empty());
    }
    assert!(whole.branch().points.len() > 10);
}

/// Where no points are told of, it is asked whether to go on as well.
#[test]
fn landings_are_interrupted() {
    let study = Study::new("duffing", Settings::default(), 0.05);
    let starts = Task::Start(StartPlace::random(0));
    let scout = Task::Scout(ScoutPlace { number: 0, batches: 1 });
    for task in [starts, scout, Task::Main(Side::Below)] {
        let interrupt = Interrupt::default();
        let build = || Forced::new(&study.model, &study.settings, study.reach, study.forcing);
        let mut forced = build().interrupted_by(interrupt.clone());
        interrupt.set();
        let mut told = 0;
        let mut observer = |_: &BranchPoint| {
            told += 1;
            ControlFlow::Break(())
        };
        assert!(execute(&mut forced, &task, &Given::default(), &mut observer).is_none());
        assert!(told <= 1);
    }
}
