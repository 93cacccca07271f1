//! Announcements and stored results.

use super::{amplitude, branch, counting, landing, motions, not_landed, points, program, task, work, worker};
use protocol::branch::BranchMessage;
use protocol::codec::{encode, sha256};
use protocol::critical::CriticalMessage;
use protocol::ids::{Attempt, TaskId};
use protocol::landings::LandingsMessage;
use protocol::to_everyone::{Done, StoredResult};
use solver::response::branch::{BranchKind, Outcome, Side, SpecialKind, SpecialPoint, Stop};
use solver::response::critical::{Corner, CriticalEvent, CriticalKind, Quantity};
use solver::response::task::{
    BranchEnd, BranchId, CarryPlace, DisturbPlace, FoldPlace, MarchPlace, Origin, SeedOutcome, SwitchPlace, Task,
    VerifyPlace,
};
use solver::settings::Stretch;
use solver::stability::disturbance::{Disturbance, Push};
use solver::stability::endings::Ending;
use solver::stability::polish::Reason;
use solver::stability::settling::{Motion, Settling};
use solver::stability::verification::{BifurcationPoint, MarchedOrbit, Verification, VerifiedPoint};
use solver::{BifurcationKind, End, Multiplier, Obstacle, Unresolved, Verdict};

/// An isola is announced.
pub fn done() -> Done {
    Done {
        sequence: 4,
        task: task(),
        amplitude: amplitude(),
        outcome: SeedOutcome::Found(BranchId::isola(0)),
        branch: Some(BranchId::isola(0)),
        size: encode(&result()).len() as u64,
        sha256: sha256(&encode(&result())),
    }
}

pub fn done_nothing() -> Done {
    Done {
        sequence: 5,
        task: TaskId::of_level("2.5", 4).unwrap(),
        amplitude: amplitude(),
        outcome: not_landed(),
        branch: None,
        size: encode(&result_nothing()).len() as u64,
        sha256: sha256(&encode(&result_nothing())),
    }
}

/// The result of [`done`].
pub fn result() -> StoredResult {
    StoredResult {
        curve: None,
        landings: None,
        verification: None,
        disturbance: None,
        settling: None,
        task: task(),
        attempt: Attempt(2),
        amplitude: amplitude(),
        work: work(),
        outcome: SeedOutcome::Found(BranchId::isola(0)),
        name: Some(BranchId::isola(0)),
        branch: Some(branch()),
        worker: worker(),
        program: program(),
        seconds: 1.5,
    }
}

pub fn result_nothing() -> StoredResult {
    StoredResult {
        curve: None,
        landings: None,
        verification: None,
        disturbance: None,
        settling: None,
        task: TaskId::of_level("2.5", 4).unwrap(),
        attempt: Attempt(1),
        amplitude: amplitude(),
        work: Task::Main(Side::Below),
        outcome: not_landed(),
        name: None,
        branch: None,
        worker: worker(),
        program: program(),
        seconds: 0.25,
    }
}

pub fn result_curve() -> StoredResult {
    StoredResult {
        curve: Some(CriticalMessage {
            quantity: Some(Quantity::Frequency),
            outcome: Outcome::Open(Stop::ForcingBound, Stop::PointBudget),
            grazing: [None, Some(1)],
            rejections: 2,
            events: vec![CriticalEvent { kind: CriticalKind::Birth, index: 1, doubled: Some((0.25, 1.5)) }],
            corners: vec![Corner { index: 2, element: 1 }],
            points: points(3),
        }),
        landings: None,
        verification: None,
        disturbance: None,
        settling: None,
        task: TaskId::new("fold-3").unwrap(),
        attempt: Attempt(1),
        amplitude: amplitude(),
        work: Task::Fold(FoldPlace::Branch { branch: BranchId::isola(0), fold: 1 }),
        outcome: SeedOutcome::OnCurve(0),
        name: None,
        branch: None,
        worker: worker(),
        program: program(),
        seconds: 0.5,
    }
}

pub fn result_carried() -> StoredResult {
    let place = CarryPlace { branch: BranchId::new(BranchKind::Open, 0), end: BranchEnd::Last };
    let curve = CriticalMessage {
        quantity: None,
        outcome: Outcome::Open(Stop::ForcingBound, Stop::ForcingBound),
        grazing: [None, None],
        rejections: 1,
        events: Vec::new(),
        corners: Vec::new(),
        points: points(2),
    };
    StoredResult {
        curve: Some(curve),
        task: TaskId::of_curve(4, Origin::Carry(place)),
        work: Task::Carry(place),
        outcome: SeedOutcome::OnCurve(1),
        ..result_curve()
    }
}

/// A branch that crosses another one, as that crosses it.
pub fn result_switched() -> StoredResult {
    let special = [(SpecialKind::Peak, 1), (SpecialKind::Start, 0), (SpecialKind::BranchPoint, 0)];
    let crossing = BranchMessage {
        kind: Some(BranchKind::Branched),
        outcome: Outcome::Closed,
        special: special.map(|(kind, index)| SpecialPoint { kind, index }).to_vec(),
        ..branch()
    };
    let id = BranchId::new(BranchKind::Branched, 0);
    StoredResult {
        task: TaskId::of_level("2.5", 5).unwrap(),
        work: Task::Switch(SwitchPlace { branch: BranchId::MAIN, point: 1 }),
        outcome: SeedOutcome::Found(id),
        name: Some(id),
        branch: Some(crossing),
        ..result()
    }
}

pub fn result_landings() -> StoredResult {
    StoredResult {
        landings: Some(LandingsMessage { motions: motions(2), distance: counting(&[2], 0.125) }),
        verification: None,
        disturbance: None,
        settling: None,
        curve: None,
        task: TaskId::of_level("2.5", 3).unwrap(),
        attempt: Attempt(1),
        amplitude: amplitude(),
        work: landing(),
        outcome: SeedOutcome::Landed(2),
        name: None,
        branch: None,
        worker: worker(),
        program: program(),
        seconds: 0.125,
    }
}

pub fn result_verification() -> StoredResult {
    let place = VerifyPlace { branch: BranchId::isola(0), stretch: Stretch::Whole };
    let pair = Multiplier { re: 0.25, im: 1.0 };
    let orbit = MarchedOrbit {
        omega: 2.5,
        amplitudes: vec![0.5, 0.125],
        distance: 0.0625,
        multipliers: vec![pair, Multiplier { im: -1.0, ..pair }],
        margin: 0.0009765625,
        impacts: 0.03125,
    };
    let point = |index, verdict, orbit| VerifiedPoint { index, at: index, verdict, reason: None, orbit };
    let none = VerifiedPoint { reason: Some(Reason::TooFar), ..point(2, Verdict::NoOrbitNearby, None) };
    let bifurcation = BifurcationPoint {
        kind: BifurcationKind::NeimarkSacker,
        omega: 2.25,
        amplitudes: vec![0.25, 0.0625],
        after: 0,
        at: 1,
        multiplier: pair,
        outside: [2, 0],
    };
    let unresolved = Unresolved { first: 1, last: 2, outside: [0, 1], reason: Obstacle::NoOrbit };
    StoredResult {
        landings: None,
        disturbance: None,
        settling: None,
        verification: Some(Verification {
            count: 3,
            is_closed: true,
            stretch: Stretch::Whole,
            spacing: 1,
            folds: vec![1],
            peak: 0,
            points: vec![point(0, Verdict::Unstable, Some(orbit)), none],
            bifurcations: vec![bifurcation],
            unresolved: vec![unresolved],
            end: End::Budget,
        }),
        curve: None,
        task: TaskId::of_verification("2.5", &place).unwrap(),
        attempt: Attempt(1),
        amplitude: amplitude(),
        work: Task::Verify(place),
        outcome: SeedOutcome::Verified(2),
        name: None,
        branch: None,
        worker: worker(),
        program: program(),
        seconds: 4.0,
    }
}

pub fn result_settling() -> StoredResult {
    let place = MarchPlace { branch: BranchId::isola(0), index: 7, omega: 2.5 };
    StoredResult {
        verification: None,
        settling: Some(Settling {
            index: 7,
            omega: 2.5,
            motion: Some(Motion::Periodic(2)),
            onto: None,
            amplitudes: vec![[0.25, 0.5], [0.0625, 0.125]],
            growth: None,
            periods: 96,
        }),
        task: TaskId::of_march("2.5", &place).unwrap(),
        work: Task::March(place),
        outcome: SeedOutcome::Marched(96),
        ..result_verification()
    }
}

pub fn result_disturbance() -> StoredResult {
    let place = DisturbPlace { branch: BranchId::isola(0), mode: 1, omega: 2.5 };
    let push = Push { phase: 1, size: 0.75, below: 0.5, ends: Ending::Elsewhere, is_confirmed: true };
    StoredResult {
        verification: None,
        disturbance: Some(Disturbance {
            omega: 2.5,
            mode: 1,
            monitor: 1,
            shape: 0.125,
            phases: 2,
            amplitudes: [vec![0.25, 0.0625], vec![2.25, 0.375]],
            sizes: vec![0.4375, 0.875],
            endings: vec![Ending::Back, Ending::Elsewhere, Ending::Back, Ending::Onto],
            push: Some(push),
            reason: None,
            from_rest: Some(Ending::Back),
        }),
        task: TaskId::of_disturbance("2.5", &place).unwrap(),
        work: Task::Disturb(place),
        outcome: SeedOutcome::Disturbed(4),
        ..result_verification()
    }
}
