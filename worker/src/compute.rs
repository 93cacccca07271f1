//! The thread that computes: one task after the other, and nothing else.

use crate::checkpoints::Unsent;
use protocol::branch::TaskResultMessage;
use protocol::codec::encode;
use protocol::from_worker::{Lease, Progress, SubmitRequest};
use protocol::orbits::OrbitsMessage;
use solver::curve::record::{Recorder, Step};
use solver::response::branch::{Branch, BranchPoint};
use solver::response::critical::CriticalCurve;
use solver::response::forced::{Forced, SearchRange};
use solver::response::interrupt::Interrupt;
use solver::response::orders::{Order, Orders};
use solver::response::seeds::{Landing, Seed};
use solver::response::task::{BranchId, DisturbPlace, MarchPlace, SeedOutcome, Task, TaskResult, VerifyPlace};
use solver::response::trace::{Given, execute};
use solver::stability::disturbance::{DisturbSettings, disturb};
use solver::stability::settling::{SettleSettings, settle};
use solver::stability::shooting::Orbit;
use solver::stability::verification::verify_with_orbits;
use solver::structure::Model;
use std::any::Any;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::Instant;
use tokio::sync::oneshot;

/// A task with everything that it needs.
pub struct Job {
    /// Under which lease.
    pub lease: Lease,
    /// Forcing amplitude.
    pub amplitude: f64,
    /// Order of the motions, if it is not the first one.
    pub order: Option<usize>,
    /// Within which frequencies and amplitudes branches are followed.
    pub reach: SearchRange,
    /// What is to be done.
    pub work: Task,
    /// Where from.
    pub seeds: Vec<Seed>,
    /// Of a seed: what it landed on.
    pub landings: Arc<[Landing]>,
    /// Branches of the level found before.
    pub known: Vec<(BranchId, Arc<Branch>)>,
    /// Fold curves found before.
    pub curves: Vec<(usize, Arc<CriticalCurve>)>,
    /// Steps that earlier attempts took.
    pub before: Vec<Step>,
    /// Most bytes of steps that are kept for later ones.
    pub most: usize,
}

/// What comes of a job.
pub enum Computed {
    /// A result.
    Finished(Box<Finished>),
    /// Stopped from outside.
    Stopped,
    /// It could not be carried out.
    Failed(String),
}

/// A result, as it is sent and as it is.
pub struct Finished {
    /// The message of the result, encoded.
    pub payload: Vec<u8>,
    /// What is new.
    pub finding: TaskResult,
    /// In words.
    pub summary: String,
}

/// What a job under way shares with whoever waits for it.
#[derive(Debug, Default)]
pub struct Watch {
    stop: Interrupt,
    progress: Mutex<Option<Progress>>,
    unsent: Arc<Unsent>,
}

impl Watch {
    /// Asks the job to stop; heard at its next point, and between the starts and steps of a landing.
    pub fn stop(&self) {
        self.stop.set();
    }

    /// Where its branch is.
    pub fn progress(&self) -> Option<Progress> {
        *self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Its steps that are still to be sent.
    pub fn unsent(&self) -> &Arc<Unsent> {
        &self.unsent
    }

    fn visit(&self, point: &BranchPoint) -> ControlFlow<()> {
        self.note(point.omega(), point.amplitude())
    }

    /// One more point, or motion, of this frequency and amplitude.
    fn note(&self, omega: f64, amplitude: f64) -> ControlFlow<()> {
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        let points = progress.map_or(0, |progress| progress.points) + 1;
        *progress = Some(Progress { points, omega, amplitude });
        if self.stop.is_set() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

enum Request {
    Compute(Box<Job>, Arc<Watch>, oneshot::Sender<Computed>),
    Report(oneshot::Sender<()>),
}

/// A computing thread.
pub struct Computer {
    requests: mpsc::Sender<Request>,
}

impl Computer {
    /// Starts the thread of a slot. It ends when it is idle and the [`Computer`] is gone.
    pub fn start(slot: u32, orders: Orders) -> std::io::Result<Self> {
        let (requests, inbox) = mpsc::channel();
        let run = move || {
            for request in inbox {
                match request {
                    Request::Compute(mut job, watch, reply) => {
                        let _ = reply.send(guarded(&orders, &mut job, &watch));
                    }
                    Request::Report(reply) => {
                        let _ = reply.send(());
                    }
                }
            }
        };
        std::thread::Builder::new().name(format!("slot-{slot}")).spawn(run)?;
        Ok(Self { requests })
    }

    /// Computes a job. Not waiting for the answer does not stop it: see [`Watch::stop`].
    pub async fn compute(&self, job: Job, watch: Arc<Watch>) -> Computed {
        let (reply, computed) = oneshot::channel();
        let request = Request::Compute(Box::new(job), watch, reply);
        let gone = || Computed::Failed("the computing thread is gone".into());
        if self.requests.send(request).is_err() {
            return gone();
        }
        computed.await.unwrap_or_else(|_| gone())
    }

    /// Waits until nothing is computed any more.
    pub async fn idle(&self) {
        let (reply, report) = oneshot::channel();
        if self.requests.send(Request::Report(reply)).is_ok() {
            let _ = report.await;
        }
    }
}

/// A panic is a failure of its job, not of the worker.
fn guarded(orders: &Orders, job: &mut Job, watch: &Watch) -> Computed {
    let Some(order) = orders.get(job.order) else {
        return Computed::Failed(format!("motions of order {} are not looked for", job.order.unwrap_or_default()));
    };
    catch_unwind(AssertUnwindSafe(|| compute(order, job, watch)))
        .unwrap_or_else(|panic| Computed::Failed(format!("panicked: {}", message(&*panic))))
}

fn compute(Order { model, settings, .. }: &Order, job: &mut Job, watch: &Watch) -> Computed {
    if watch.stop.is_set() {
        return Computed::Stopped;
    }
    let started = Instant::now();
    match &job.work {
        Task::Verify(place) => return verified(model, job, place, watch),
        Task::Disturb(place) => return disturbed(model, job, place, watch),
        Task::March(place) => return marched(model, job, place, watch),
        _ => {}
    }
    // New for every job: a result must not depend on what this thread computed before.
    let (unsent, most) = (watch.unsent.clone(), job.most);
    let keep = move |number, step| unsent.add(number, step, most);
    let recorder = Recorder::new(std::mem::take(&mut job.before), keep);
    let mut forced =
        Forced::new(model, settings, job.reach, job.amplitude).recorded(recorder).interrupted_by(watch.stop.clone());
    let known: Vec<(BranchId, &Branch)> = job.known.iter().map(|(id, branch)| (*id, &**branch)).collect();
    let mut observer = |point: &BranchPoint| watch.visit(point);
    let curves: Vec<(usize, &CriticalCurve)> = job.curves.iter().map(|(number, curve)| (*number, &**curve)).collect();
    let given = Given { seeds: &job.seeds, landings: &job.landings, known: &known, curves: &curves };
    let Some(finding) = execute(&mut forced, &job.work, &given, &mut observer) else {
        return Computed::Stopped;
    };
    let payload = payload(job, started, TaskResultMessage::from(&finding));
    let summary = match &finding {
        TaskResult::Landings(landings) => format!("landed on {}", SeedOutcome::Landed(landings.len())),
        TaskResult::Branch(branch) => format!("{} points, {}", branch.points.len(), branch.outcome),
        TaskResult::Curve(curve) => {
            format!("curve of {}s, {} points, {}", curve.of(), curve.points.len(), curve.outcome)
        }
        TaskResult::Nothing(outcome) => format!("nothing new: {outcome}"),
    };
    Computed::Finished(Box::new(Finished { payload, finding, summary }))
}

/// The stability of a branch.
fn verified(model: &Model, job: &Job, place: &VerifyPlace, watch: &Watch) -> Computed {
    let started = Instant::now();
    let Some((_, branch)) = job.known.iter().find(|(id, _)| *id == place.branch) else {
        return Computed::Failed(format!("the branch to verify, {}, is not among those named", place.branch));
    };
    let Some((found, orbits)) = verify_with_orbits(model, branch, place.stretch, &mut |point| watch.visit(point))
    else {
        return Computed::Stopped;
    };
    let outcome = SeedOutcome::Verified(found.points.len());
    let payload = payload_with(job, started, TaskResultMessage::Verification(found), &orbits);
    Computed::Finished(Box::new(Finished {
        payload,
        finding: TaskResult::Nothing(outcome),
        summary: outcome.to_string(),
    }))
}

/// Where pushes onto a branch end.
fn disturbed(model: &Model, job: &Job, place: &DisturbPlace, watch: &Watch) -> Computed {
    let started = Instant::now();
    let mut branch = job.known.iter().filter(|(id, _)| *id == place.branch).map(|(_, branch)| &**branch);
    let mains: Vec<&Branch> = job.known.iter().filter(|(id, _)| id.is_main()).map(|(_, branch)| &**branch).collect();
    let Some(branch) = branch.next() else {
        return Computed::Failed(format!("the branch to be pushed onto, {}, is not among those named", place.branch));
    };
    let settings = DisturbSettings::default();
    let mut observer = |amplitude: f64| watch.note(place.omega, amplitude);
    let Some(found) = disturb(model, &settings, &mains, branch, place, &mut observer) else {
        return Computed::Stopped;
    };
    let outcome = SeedOutcome::Disturbed(found.endings.len());
    let payload = payload(job, started, TaskResultMessage::Disturbance(found));
    Computed::Finished(Box::new(Finished {
        payload,
        finding: TaskResult::Nothing(outcome),
        summary: outcome.to_string(),
    }))
}

/// What an unstable motion turns into.
fn marched(model: &Model, job: &Job, place: &MarchPlace, watch: &Watch) -> Computed {
    let started = Instant::now();
    let known: Vec<(BranchId, &Branch)> = job.known.iter().map(|(id, branch)| (*id, &**branch)).collect();
    let branch = known.iter().find(|(id, branch)| *id == place.branch && place.index < branch.points.len());
    let Some((_, branch)) = branch else {
        return Computed::Failed(format!("the branch to march from, {}, is not among those named", place.branch));
    };
    let mut observer = |omega: f64, amplitude: f64| watch.note(omega, amplitude);
    let Some(found) = settle(model, &SettleSettings::default(), &known, branch, place, &mut observer) else {
        return Computed::Stopped;
    };
    let outcome = SeedOutcome::Marched(found.periods);
    let payload = payload(job, started, TaskResultMessage::Settling(found));
    Computed::Finished(Box::new(Finished {
        payload,
        finding: TaskResult::Nothing(outcome),
        summary: outcome.to_string(),
    }))
}

/// The message of a result, encoded.
fn payload(job: &Job, started: Instant, finding: TaskResultMessage) -> Vec<u8> {
    payload_with(job, started, finding, &[])
}

/// The same with the orbits that it is told of.
fn payload_with(job: &Job, started: Instant, finding: TaskResultMessage, orbits: &[Orbit]) -> Vec<u8> {
    encode(&SubmitRequest {
        lease: job.lease.clone(),
        program: protocol::PROGRAM.into(),
        seconds: started.elapsed().as_secs_f64(),
        next: true,
        orbits: OrbitsMessage::new(orbits),
        finding,
    })
}

fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("without a message")
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::ids::{Attempt, TaskId, WorkerId};
    use solver::files;
    use solver::formulation::state::State;
    use solver::response::branch::Side;
    use solver::response::seeds::{LandingMethod, Phase};
    use solver::response::task::SeedPlace;
    use solver::response::windows::Window;
    use solver::settings::Settings;
    use std::path::Path;

    fn computer() -> Computer {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/duffing");
        Computer::start(0, Orders::of(&files::load(&folder).unwrap(), &Settings::default())).unwrap()
    }

    fn main() -> Job {
        let (task, worker) = (TaskId::new("1-0").unwrap(), WorkerId::new("w").unwrap());
        Job {
            lease: Lease { task, attempt: Attempt(1), worker, slot: 0 },
            amplitude: 0.01,
            order: None,
            reach: SearchRange { frequency: (0.9, 1.1), amplitude: 10.0, natural: None, forcing: None },
            work: Task::Main(Side::Below),
            seeds: Vec::new(),
            landings: [].into(),
            known: Vec::new(),
            curves: Vec::new(),
            before: Vec::new(),
            most: usize::MAX,
        }
    }

    /// A seed without a motion, which whoever prepares jobs refuses.
    fn impossible() -> Job {
        let state = State { harmonics: 0, omega: 1.0, decay: 0.0, forcing: 1.0, arguments: vec![], modal: vec![] };
        let well = Window { mode: 0, first: 0, last: 0, best: 0, threshold: 0.0, omega: (1.0, 1.0) };
        let place = SeedPlace { window: 0, well, phase: Phase::First, method: LandingMethod::FullForcing };
        Job { work: Task::Land(place), seeds: vec![Seed { state, place: 0.0, phase: Phase::First }], ..main() }
    }

    #[tokio::test]
    async fn a_panic_is_a_failure_and_the_thread_lives_on() {
        let computer = computer();
        match computer.compute(impossible(), Arc::default()).await {
            Computed::Failed(reason) => assert!(reason.starts_with("panicked: "), "{reason}"),
            _ => panic!("carried out"),
        }
        let Computed::Finished(finished) = computer.compute(main(), Arc::default()).await else { panic!("failed") };
        assert!(matches!(finished.finding, TaskResult::Branch(branch) if branch.points.len() > 10));
    }

    #[tokio::test]
    async fn what_is_stopped_before_it_begins_is_not_begun() {
        let watch = Arc::new(Watch::default());
        watch.stop();
        assert!(matches!(computer().compute(main(), watch.clone()).await, Computed::Stopped));
        assert_eq!(watch.progress(), None);
    }

    #[tokio::test]
    async fn results_do_not_depend_on_what_was_computed_before() {
        let computer = computer();
        let mut branches = Vec::new();
        for amplitude in [0.01, 0.05, 0.01] {
            let job = Job { amplitude, ..main() };
            let Computed::Finished(finished) = computer.compute(job, Arc::default()).await else { panic!("failed") };
            branches.push(finished.finding);
        }
        assert_eq!(branches[0], branches[2]);
        assert_ne!(branches[0], branches[1]);
    }
}
