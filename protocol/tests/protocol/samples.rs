//! One small sample of every message; numbers are such that no two places can be confused.

mod endings;
mod results;

pub use endings::outcomes;
pub use results::{
    done, done_nothing, result, result_carried, result_curve, result_disturbance, result_landings, result_nothing,
    result_settling, result_switched, result_verification,
};

use protocol::VERSION;
use protocol::array::Array;
use protocol::backbone::BackboneMessage;
use protocol::branch::{BranchMessage, TaskResultMessage};
use protocol::codec::Message;
use protocol::columns::Columns;
use protocol::control::{ControlReply, ControlRequest};
use protocol::curve::{Motions, Points, Seeds, Size};
use protocol::from_worker::{
    CheckpointRequest, FailRequest, Lease, LeaseRequest, Progress, ReleaseRequest, RenewRequest, SubmitRequest,
};
use protocol::ids::{Attempt, RunId, TaskId, WorkerId};
use protocol::model::{ElementMessage, ModelMessage};
use protocol::orbits::OrbitsMessage;
use protocol::pieces::{Piece, PieceReply};
use protocol::steps::Steps;
use protocol::to_everyone::{
    Amplitude, Counts, LevelStatus, LevelWindows, Manifest, SeedMessage, Stage, StalledTask, Status, WindowsMessage,
    WorkerStatus,
};
use protocol::to_worker::{
    Acknowledgement, Checkpoint, CheckpointReply, Grant, Known, KnownCurve, LeaseReply, RenewReply, SubmitReply,
};
use solver::curve::continuation::{CurvePoint, Rejection};
use solver::curve::problem::Failure;
use solver::curve::record::{Ahead, Step};
use solver::response::branch::{BranchKind, Certificate, Outcome, SpecialKind, SpecialPoint, Standing, Stop};
use solver::response::certificate::{Change, Doubled};
use solver::response::forced::SearchRange;
use solver::response::modes::{LeftOut, ModesFollowed};
use solver::response::seeds::{LandingFailure, LandingMethod, Phase};
use solver::response::task::{BranchId, SeedOutcome, SeedPlace, Task};
use solver::response::windows::Window;
use solver::settings::Settings;
use solver::stability::shooting::Orbit;
use solver::structure::laws::{Contact, Friction, Jenkins, LawKind, PenaltySpring, PolynomialDamper, PolynomialSpring};
use solver::structure::laws::{TanhFriction, Term};
use std::fmt::Debug;

/// What is done with every sample.
pub trait Visit {
    /// With one, which is frozen in files of this name: the message's, and after a hyphen the variant's.
    fn visit<M: Message + PartialEq + Debug>(&mut self, file: &str, sample: &M);
}

/// Visits all samples.
pub fn all(visitor: &mut impl Visit) {
    visitor.visit("manifest", &manifest());
    visitor.visit("model", &model());
    visitor.visit("backbone", &backbone());
    visitor.visit("windows", &windows());
    visitor.visit("seed", &seed());
    visitor.visit("done", &done());
    visitor.visit("done_nothing", &done_nothing());
    visitor.visit("result", &result());
    visitor.visit("result_nothing", &result_nothing());
    visitor.visit("result_curve", &result_curve());
    visitor.visit("result_carried", &result_carried());
    visitor.visit("result_switched", &result_switched());
    visitor.visit("result_landings", &result_landings());
    visitor.visit("result_verification", &result_verification());
    visitor.visit("result_disturbance", &result_disturbance());
    visitor.visit("result_settling", &result_settling());
    visitor.visit("status", &status());
    visitor.visit("progress", &progress());
    visitor.visit("lease_request", &lease_request());
    visitor.visit("renew_request", &RenewRequest { lease: lease(), progress: Some(progress()) });
    visitor.visit("submit_request", &submit_request(TaskResultMessage::Branch(branch())));
    let next = SubmitRequest { next: true, ..submit_request(TaskResultMessage::Nothing(not_landed())) };
    visitor.visit("submit_request_next", &next);
    let orbits = Orbit { omega: 1.25, forcing: 60.0, steps: 4096, state: vec![0.5, -0.25] };
    let orbits = OrbitsMessage::new(&[orbits.clone(), Orbit { steps: 4100, ..orbits }]);
    let verification = result_verification().verification.expect("it is one");
    let verified = SubmitRequest { orbits, ..submit_request(TaskResultMessage::Verification(verification)) };
    visitor.visit("submit_request_verification", &verified);
    visitor.visit("submit_request_nothing", &submit_request(TaskResultMessage::Nothing(not_landed())));
    visitor.visit("checkpoint_request", &CheckpointRequest { lease: lease(), steps: steps() });
    visitor.visit("steps", &steps());
    visitor.visit("checkpoint", &Checkpoint { task: task(), parts: vec![steps()] });
    visitor.visit("checkpoint_reply-kept", &CheckpointReply::Kept);
    visitor.visit("checkpoint_reply-busy", &CheckpointReply::Busy);
    visitor.visit("checkpoint_reply-enough", &CheckpointReply::Enough);
    visitor.visit("checkpoint_reply-lost", &CheckpointReply::Lost);
    visitor.visit("piece", &Piece { message: "a1b2-0".into(), number: 2, size: 150_000 });
    visitor.visit("piece_reply-taken", &PieceReply::Taken);
    visitor.visit("piece_reply-busy", &PieceReply::Busy);
    visitor.visit("piece_reply-missing", &PieceReply::Missing);
    visitor.visit("fail_request", &FailRequest { lease: lease(), reason: "out of memory".into() });
    visitor.visit("release_request", &ReleaseRequest { lease: lease() });
    visitor.visit("lease_reply-grant", &LeaseReply::Grant(grant()));
    visitor.visit("lease_reply-wait", &LeaseReply::Wait { retry_ms: 250 });
    visitor.visit("lease_reply-drained", &LeaseReply::Drained);
    visitor.visit("lease_reply-stop", &LeaseReply::Stop { reason: "another version".into() });
    visitor.visit("renew_reply-ok", &RenewReply::Ok);
    visitor.visit("renew_reply-lost", &RenewReply::Lost);
    visitor.visit("renew_reply-cancel", &RenewReply::Cancel);
    visitor.visit("submit_reply-accepted", &SubmitReply::Accepted);
    visitor.visit("submit_reply-next", &SubmitReply::Next(Box::new(grant())));
    visitor.visit("submit_reply-duplicate", &SubmitReply::Duplicate { agrees: true });
    visitor.visit("submit_reply-busy", &SubmitReply::Busy { retry_ms: 500 });
    visitor.visit("submit_reply-rejected", &SubmitReply::Rejected { why: "no such task".into() });
    visitor.visit("acknowledgement-ok", &Acknowledgement::Ok);
    visitor.visit("acknowledgement-lost", &Acknowledgement::Lost);
    visitor.visit("control_request-cancel", &ControlRequest::Cancel);
    visitor.visit("control_request-retry_dead", &ControlRequest::RetryDead);
    visitor.visit("control_reply", &ControlReply { message: "cancelled".into() });
}

fn run() -> RunId {
    RunId::new("damper-1").unwrap()
}

fn task() -> TaskId {
    TaskId::of_level("2.5", 3).unwrap()
}

fn worker() -> WorkerId {
    WorkerId::new("host-77").unwrap()
}

fn amplitude() -> Amplitude {
    Amplitude { text: "2.5".into(), value: 2.5 }
}

fn program() -> String {
    "0.1.0".into()
}

pub fn lease() -> Lease {
    Lease { task: task(), attempt: Attempt(2), worker: worker(), slot: 1 }
}

fn progress() -> Progress {
    Progress { points: 300, omega: 1.25, amplitude: 0.5 }
}

fn reach() -> SearchRange {
    SearchRange { frequency: (0.75, 1.5), amplitude: 8.0, natural: None, forcing: None }
}

fn modes() -> ModesFollowed {
    let left_out = vec![(2, LeftOut::TooMany), (3, LeftOut::NotStarted("singular".into()))];
    ModesFollowed { followed: vec![0, 1], left_out }
}

/// Array whose numbers count up by a quarter.
fn counting(shape: &[usize], first: f64) -> Array {
    Array::new(shape, (0..shape.iter().product()).map(|i| first + 0.25 * i as f64))
}

/// Numbers of [`model`] that the shapes of the other samples depend on.
pub const SIZE: Size = Size { channels: 9, modes: 2, monitors: 1, contacts: 2 };

/// p motions of the model, H = 1.
fn motions(count: usize) -> Motions {
    Motions {
        harmonics: 1,
        omega: counting(&[count], 1.0),
        decay: counting(&[count], 0.0),
        forcing: counting(&[count], 2.5),
        argument: counting(&[count, SIZE.channels, 2, 2], 10.0),
        modal: counting(&[count, SIZE.modes, 2, 2], -1.0),
    }
}

/// p points of the model.
fn points(count: usize) -> Points {
    Points {
        motions: motions(count),
        columns: Columns::from_iter([
            ("amplitude", counting(&[count, SIZE.monitors], 3.0)),
            ("rms", counting(&[count, SIZE.monitors], 2.0)),
            ("contact", counting(&[count, SIZE.contacts], 0.125)),
            ("residual", counting(&[count], 1e-13)),
            ("high_harmonics", counting(&[count], 1e-3)),
            ("iterations", Array::new([count], (0..count).map(|i| 2.0 + i as f64))),
        ]),
    }
}

/// What became of a seed, as deep as it goes.
fn not_landed() -> SeedOutcome {
    let failure = Failure::NotConverged { iterations: 10, residual: 0.00151 };
    SeedOutcome::NotLanded(LandingFailure::NotConverged(failure.into()))
}

/// A branch of two points.
pub fn branch() -> BranchMessage {
    let failure = Failure::NotConverged { iterations: 10, residual: 0.00151 };
    let stalled = Stop::Stalled(Rejection::Newton(failure));
    BranchMessage {
        kind: Some(BranchKind::Isola),
        amplitude: 2.5,
        outcome: Outcome::Open(Stop::FrequencyBound, stalled),
        special: vec![
            SpecialPoint { kind: SpecialKind::Start, index: 0 },
            SpecialPoint { kind: SpecialKind::Peak, index: 1 },
            SpecialPoint { kind: SpecialKind::Fold, index: 1 },
        ],
        rejections: 4,
        peak_standing: Some(Standing::AtLeast),
        certificate: Some(Certificate {
            penetration: Some(0.125),
            pressure_beyond: None,
            doubled: Some(Doubled { amplitude: 0.375, shift: 1e-3, range: Some((0.5, 0.625)) }),
            elsewhere: Some(Change { omega: 1.125, share: Some(0.0625) }),
            contact_omega: Some((0.5, 0.75)),
            slowest_sliding: Some(0.875),
        }),
        points: points(2),
    }
}

/// The manifest of a run under way.
pub fn manifest() -> Manifest {
    Manifest {
        protocol: VERSION,
        program: program(),
        run: run(),
        name: "nonlinear damper".into(),
        model_sha256: protocol::codec::sha256(&protocol::codec::encode(&model())),
        settings: Settings::default(),
        reach: Some(reach()),
        modes: Some(modes()),
        amplitudes: vec![Amplitude { text: "1e-3".into(), value: 1e-3 }, amplitude()],
        monitors: vec!["tip".into()],
        stage: Stage::Sweep,
        lease_ms: 30_000,
        max_result_bytes: 1 << 28,
        units: Some("mm,Hz".into()),
    }
}

/// Every law once; two dofs.
pub fn model() -> ModelMessage {
    let friction = Some(Friction { coefficient: 0.15, radius: 0.25, sense: -1.0 });
    let laws = [
        ("node", LawKind::Contact(Contact { gap: 1e-3, epsilon: 2e6, friction })),
        ("stop", LawKind::Contact(Contact { gap: 2e-3, epsilon: 3e6, friction: None })),
        ("elastic stop", LawKind::PenaltySpring(PenaltySpring { stiffness: 5.0, gap: 0.5 })),
        ("spring", LawKind::PolynomialSpring(PolynomialSpring { terms: vec![Term { power: 3, coefficient: 0.75 }] })),
        ("damper", LawKind::PolynomialDamper(PolynomialDamper { terms: vec![Term { power: 5, coefficient: -0.5 }] })),
        ("dry friction", LawKind::TanhFriction(TanhFriction { limit: 6.0, velocity: 0.125 })),
        ("slider", LawKind::Jenkins(Jenkins { stiffness: 7.0, limit: 1.5 })),
    ];
    let element = |(name, law): (&str, LawKind)| {
        let channels = if name == "node" {
            vec![vec![(0, 1.0)], vec![(1, -1.0)], vec![(0, 0.5), (1, 0.5)]]
        } else {
            vec![vec![(1, 1.0)]]
        };
        ElementMessage { name: name.into(), channels, law }
    };
    ModelMessage {
        name: "two masses".into(),
        dofs: vec!["root".into(), "tip".into()],
        mass: counting(&[2, 2], 1.0),
        stiffness: counting(&[2, 2], 100.0),
        frequencies: counting(&[2], 10.0),
        shapes: counting(&[2, 2], -1.0),
        damping: counting(&[2], 0.5),
        forcing: counting(&[2], 0.25),
        forcing_harmonic: 1,
        elements: laws.into_iter().map(element).collect(),
        monitors: vec![1],
    }
}

/// A backbone of three points, the last one with an infinite threshold.
pub fn backbone() -> BackboneMessage {
    BackboneMessage {
        mode: 0,
        outcome: Outcome::Open(Stop::Start, Stop::AmplitudeBound),
        crossing: vec![Outcome::Open(Stop::Branching, Stop::FrequencyBound)],
        rejections: 2,
        points: points(3),
        columns: Columns::from_iter([
            ("r_lin", counting(&[3], 1.0)),
            ("r_nl", counting(&[3], -2.0)),
            ("work_per_amplitude", counting(&[3], 3.0)),
            ("certificate", counting(&[3], 1e-9)),
            ("threshold", Array::new([3], [0.5, 0.25, f64::INFINITY])),
            ("arc", counting(&[3], 0.0)),
            ("contributions", Array::new([3, 2], [1.0, 0.0, 0.75, 0.25, 0.5, 0.5])),
            ("piece", Array::new([3], [0.0, 0.0, 1.0])),
        ]),
    }
}

fn window() -> Window {
    Window { mode: 1, first: 40, last: 300, best: 70, threshold: 1.75, omega: (0.875, 1.125) }
}

fn windows() -> WindowsMessage {
    let none = LevelWindows { amplitude: Amplitude { text: "1e-3".into(), value: 1e-3 }, windows: Vec::new() };
    WindowsMessage { levels: vec![none, LevelWindows { amplitude: amplitude(), windows: vec![window()] }] }
}

fn place() -> SeedPlace {
    SeedPlace { window: 0, well: window(), phase: Phase::Second, method: LandingMethod::SteppedForcing }
}

fn work() -> Task {
    Task::Seed(place())
}

fn landing() -> Task {
    Task::Land(place())
}

fn seeds() -> Seeds {
    Seeds { motions: motions(1), place: Array::new([1], [70.5]), phase: Some(Phase::Second) }
}

fn seed() -> SeedMessage {
    SeedMessage { task: task(), amplitude: amplitude(), work: work(), seeds: seeds() }
}

pub fn status() -> Status {
    Status {
        run: run(),
        name: "nonlinear damper".into(),
        stage: Stage::Sweep,
        backbone: Some(progress()),
        tasks: Counts { done: 4, skipped: 2, running: 1, waiting: 5, dead: 3, branches: 6 },
        levels: 2,
        levels_done: 1,
        active: vec![LevelStatus {
            amplitude: "2.5".into(),
            done: 3,
            total: 9,
            branches: 2,
            progress: Some(progress()),
        }],
        workers: vec![WorkerStatus { worker: worker(), tasks: vec![task()], done: 4, progress: None }],
        stalled: vec![StalledTask { task: task(), worker: worker(), seconds: 900.0 }],
        sequence: 4,
        elapsed: 12.5,
        eta: Some(30.0),
    }
}

fn lease_request() -> LeaseRequest {
    LeaseRequest { protocol: VERSION, program: program(), worker: worker(), slot: 1 }
}

fn submit_request(finding: TaskResultMessage) -> SubmitRequest {
    SubmitRequest { lease: lease(), program: program(), seconds: 1.5, next: false, orbits: None, finding }
}

pub fn grant() -> Grant {
    Grant {
        curves: vec![KnownCurve { number: 0, task: TaskId::new("fold-3").unwrap() }],
        task: task(),
        attempt: Attempt(2),
        ttl_ms: 30_000,
        amplitude: 2.5,
        order: None,
        reach: reach(),
        work: work(),
        seeds: seeds(),
        landing: Some(TaskId::of_level("2.5", 3).unwrap()),
        known: vec![
            Known { branch: BranchId::MAIN, task: TaskId::of_level("2.5", 0).unwrap() },
            Known { branch: BranchId::isola(0), task: TaskId::of_level("2.5", 1).unwrap() },
        ],
        checkpoint: 12,
    }
}

/// Two steps of a state of three numbers.
pub fn walked() -> Vec<Step> {
    let step = |i: usize| Step {
        walk: 1,
        point: CurvePoint {
            y: vec![0.25, -0.5, 1.0 + i as f64],
            tangent: vec![0.0, -0.0, 1.0],
            iterations: 3,
            factorisations: 1 + i,
            residual: 5e-13,
            orientation: -1.0,
            step: 0.125,
        },
        ahead: Ahead { step: 0.25, longest: f64::INFINITY, is_narrow: i == 1, rejections: 4, is_refreshed: i == 0 },
        memory: vec![0.75],
    };
    vec![step(0), step(1)]
}

fn steps() -> Steps {
    Steps::new("0f".into(), 12, &walked())
}
