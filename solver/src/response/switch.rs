//! Switching branches: from where a branch crosses others onto these.

use crate::curve::identity::Identity;
use crate::curve::point::{direction_at, unit};
use crate::curve::problem::weighted;
use crate::curve::switch::{Crossing, SIDES};
use crate::formulation::Formulation;
use crate::formulation::state::State;
use crate::response::branch::{Branch, SpecialKind};
use crate::response::forced::Forced;

/// Relative distance from a branch point at which the Jacobian tells the tangent.
const APART: f64 = 1e-4;

/// What crosses a branch at one of its branch points.
#[derive(Default)]
pub(super) struct Crossed {
    /// Responses on it: one on either side, where one is found; the first one is what is traced, which leads to the other if both are of
    /// one curve.
    pub states: Vec<State>,
    /// Whether it is the branch that branches off there: motions that lose a symmetry turn in frequency where they leave those that have
    /// it, being images of each other on the two sides, and these go on.
    pub is_parent: bool,
}

/// What crosses a branch at its branch point of number `point`.
pub(super) fn beside<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, branch: &Branch, point: usize) -> Crossed {
    let mut indices = branch.special.iter().filter(|special| special.kind == SpecialKind::BranchPoint);
    let Some(index) = indices.nth(point).map(|special| special.index) else { return Crossed::default() };
    let ends = around(forced, branch, index);
    let Some(tangent) = tangent(forced, branch, ends) else { return Crossed::default() };
    let settings = forced.settings().continuation.newton;
    let problem = forced.problem();
    let points: Vec<Vec<f64>> = branch.points.iter().map(|point| problem.encode(&point.state)).collect();
    let points: Vec<&[f64]> = points.iter().map(|point| &point[..]).collect();
    let mut identity = Identity::default();
    let mut is_new =
        |problem: &mut F, y: &[f64]| identity.position(problem, &settings, &points, branch.is_closed(), y).is_none();
    let Some(crossing) = Crossing::at(problem, points[index], &tangent) else { return Crossed::default() };
    let found = SIDES.into_iter().filter_map(|side| crossing.beside(problem, &settings, side, &mut is_new));
    let found: Vec<Vec<f64>> = found.collect();
    let states: Vec<State> = found.iter().filter_map(|y| problem.decode(y).ok()).collect();
    let turns = |sides: [f64; 2]| {
        let [before, behind] = sides.map(|omega| omega - branch.points[index].omega());
        before * behind > 0.0
    };
    let is_parent = match &states[..] {
        [one, other] => turns(ends.map(|end| branch.points[end].omega())) && !turns([one.omega, other.omega]),
        _ => false,
    };
    Crossed { states, is_parent }
}

/// The nearest points before and behind one that are far enough from it for the Jacobian to tell the tangent.
fn around<'m, F: Formulation<'m>>(forced: &Forced<'m, F>, branch: &Branch, index: usize) -> [usize; 2] {
    let (points, count) = (&branch.points, branch.points.len());
    let is_far = |near: usize| forced.distance(&points[near].state, &points[index].state) > APART;
    let (behind, before): (Vec<usize>, Vec<usize>) = if branch.is_closed() {
        ((1..count).map(|i| (index + i) % count).collect(), (1..count).map(|i| (index + count - i) % count).collect())
    } else {
        ((index + 1..count).collect(), (0..index).rev().collect())
    };
    [before, behind].map(|way| way.into_iter().find(|&near| is_far(near)).unwrap_or(index))
}

/// The tangent of a branch at a point whose own Jacobian is as good as singular, so that what Newton's method has left over turns its null
/// direction: the mean of those at points before and behind it.
fn tangent<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, branch: &Branch, ends: [usize; 2]) -> Option<Vec<f64>> {
    let problem = forced.problem();
    let ends = ends.map(|index| problem.encode(&branch.points[index].state));
    let chord: Vec<f64> = ends[1].iter().zip(&ends[0]).map(|(to, from)| to - from).collect();
    let row = weighted(problem.metric(), &chord);
    let directions = ends.into_iter().filter_map(|y| direction_at(problem, y, &row));
    let sum = directions.reduce(|a, b| a.iter().zip(&b).map(|(a, b)| a + b).collect())?;
    Some(unit(problem.metric(), sum))
}
