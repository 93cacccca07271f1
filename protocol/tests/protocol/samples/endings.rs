//! How curves and tasks end.

use solver::curve::continuation::Rejection;
use solver::curve::problem::Failure;
use solver::response::branch::{BranchKind, Outcome, Stop};
use solver::response::forcing::Unreached;
use solver::response::seeds::LandingFailure;
use solver::response::task::{BranchId, SeedOutcome, Unfollowed};

/// Every way in which a curve or a task can end.
pub fn outcomes() -> (Vec<Outcome>, Vec<SeedOutcome>) {
    let failures = [
        Failure::NotConverged { iterations: 10, residual: 0.00151 },
        Failure::NotConverged { iterations: 7, residual: 2.49e15 },
        Failure::Diverged,
        Failure::Singular,
    ];
    let rejections = failures.map(Rejection::Newton).into_iter();
    let stalled =
        rejections.chain([Rejection::Angle(0.876), Rejection::Orientation, Rejection::Distance]).map(Stop::Stalled);
    let others = [
        Stop::Start,
        Stop::Rest,
        Stop::Closed,
        Stop::FrequencyBound,
        Stop::AmplitudeBound,
        Stop::ForcingBound,
        Stop::PointBudget,
        Stop::Reversed,
        Stop::Joined,
        Stop::Branching,
        Stop::Cancelled,
    ];
    let open = others.into_iter().chain(stalled).map(|stop| Outcome::Open(Stop::Start, stop));
    let unreached = failures.map(Unreached::from).into_iter().chain([Unreached::OutOfReach]);
    let landing = unreached
        .clone()
        .map(LandingFailure::NotConverged)
        .chain([LandingFailure::Far(1.376), LandingFailure::Shorter]);
    let mut seeds = vec![SeedOutcome::OutOfBounds];
    let others = BranchKind::ALL.map(|kind| BranchId::new(kind, 1));
    let names = [BranchId::MAIN, BranchId::isola(0), BranchId::isola(11)].into_iter().chain(others);
    seeds.extend(names.map(SeedOutcome::Found));
    seeds.extend(landing.map(SeedOutcome::NotLanded));
    seeds.extend(unreached.map(SeedOutcome::NotTraced));
    seeds.push(SeedOutcome::NoFold);
    seeds.extend([1, 7].map(SeedOutcome::Landed));
    seeds.push(SeedOutcome::OnCurve(1));
    let unfollowed = failures.map(Unfollowed::from).into_iter().chain([Unfollowed::Unsupported, Unfollowed::Elsewhere]);
    seeds.extend(unfollowed.map(SeedOutcome::NotFollowed));
    seeds.push(SeedOutcome::Passing(BranchId::isola(2), 0.217));
    (open.chain([Outcome::Closed]).collect(), seeds)
}
