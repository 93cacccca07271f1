//! Ends of a branch at branch points, where motions turn into their own images: no folds, whatever their frequency does.

use super::bifurcation::{Bifurcation, BifurcationKind};
use super::multipliers::Multiplier;
use super::polish::Polished;
use crate::response::branch::{Branch, BranchPoint, Outcome, Stop};

/// Relative distances of frequency and amplitude within which marching has the branch point at which a branch ends.
const AT_END: (f64, f64) = (1e-3, 0.01);

/// One in so many points of a branch is next to its begin, and as many next to its end.
const NEXT_TO_END: usize = 10;

/// Distance from 1 within which the orbit at an end has the multiplier that is 1 at a branch point.
const SINGULAR: f64 = 1e-2;

/// The bifurcations of a branch, in the order of the arc, with one branch point where it begins or ends at one: what was found there, or
/// else what the orbit is that was `polished` at this end, if it was.
pub(super) fn with_ends<'p>(
    branch: &Branch,
    mut found: Vec<Bifurcation>,
    polished: impl Fn(usize) -> Option<&'p Polished>,
) -> Vec<Bifurcation> {
    let Outcome::Open(begins, ends) = branch.outcome else { return found };
    let last = branch.points.len() - 1;
    for (_, end) in [(begins, 0), (ends, last)].into_iter().filter(|(stop, _)| *stop == Stop::Branching) {
        let is_there = |found: &Bifurcation| {
            let is_alike = matches!(found.kind, BifurcationKind::Fold | BifurcationKind::BranchPoint);
            is_alike && found.after.abs_diff(end) <= last / NEXT_TO_END && is_at(found, &branch.points[end])
        };
        let (there, others): (Vec<_>, Vec<_>) = found.into_iter().partition(is_there);
        let told = there.into_iter().next().or_else(|| of_orbit(polished(end)?, end.min(last.saturating_sub(1))));
        let branch_point = told.map(|found| Bifurcation { kind: BifurcationKind::BranchPoint, ..found });
        found = others.into_iter().chain(branch_point).collect();
    }
    found.sort_by_key(|found| found.after);
    found
}

/// Whether a bifurcation has the frequency and the amplitude of a point.
fn is_at(found: &Bifurcation, end: &BranchPoint) -> bool {
    let is_near = |at: f64, end: f64, distance: f64| (at / end - 1.0).abs() < distance;
    let amplitude = found.amplitudes.first().is_none_or(|&found| is_near(found, end.amplitude(), AT_END.1));
    is_near(found.omega, end.omega(), AT_END.0) && amplitude
}

/// The branch point at an end, behind the point `after`, if the orbit there has a multiplier next to 1.
fn of_orbit(polished: &Polished, after: usize) -> Option<Bifurcation> {
    let from_one = |multiplier: &&Multiplier| (multiplier.re - 1.0).hypot(multiplier.im);
    let multiplier = polished.multipliers.iter().min_by(|a, b| from_one(a).total_cmp(&from_one(b)))?;
    let outside = polished.multipliers.iter().filter(|multiplier| multiplier.modulus() > 1.0 + polished.margin).count();
    (from_one(&multiplier) < SINGULAR).then(|| Bifurcation {
        kind: BifurcationKind::BranchPoint,
        omega: polished.orbit.omega,
        amplitudes: polished.amplitudes.clone(),
        after,
        multiplier: *multiplier,
        outside: [outside; 2],
        width: 0.0,
        orbit: polished.orbit.clone(),
    })
}
