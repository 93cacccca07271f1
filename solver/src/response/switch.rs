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

/// Responses on what crosses a branch at its branch point of number `point`: one on either side, where one is found; the first one is what
/// is traced, which leads to the other if both are of one curve.
pub(super) fn beside<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, branch: &Branch, point: usize) -> Vec<State> {
    let mut indices = branch.special.iter().filter(|special| special.kind == SpecialKind::BranchPoint);
    let Some(index) = indices.nth(point).map(|special| special.index) else { return Vec::new() };
    let Some(tangent) = tangent(forced, branch, index) else { return Vec::new() };
    let settings = forced.settings().continuation.newton;
    let problem = forced.problem();
    let points: Vec<Vec<f64>> = branch.points.iter().map(|point| problem.encode(&point.state)).collect();
    let points: Vec<&[f64]> = points.iter().map(|point| &point[..]).collect();
    let mut identity = Identity::default();
    let mut is_new =
        |problem: &mut F, y: &[f64]| identity.position(problem, &settings, &points, branch.is_closed(), y).is_none();
    let Some(crossing) = Crossing::at(problem, points[index], &tangent) else { return Vec::new() };
    let found = SIDES.into_iter().filter_map(|side| crossing.beside(problem, &settings, side, &mut is_new));
    let found: Vec<Vec<f64>> = found.collect();
    found.iter().filter_map(|y| problem.decode(y).ok()).collect()
}

/// The tangent of a branch at a point whose own Jacobian is as good as singular, so that what Newton's method has left over turns its null
/// direction: the mean of those at the nearest points before and behind it that are far enough away.
fn tangent<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, branch: &Branch, index: usize) -> Option<Vec<f64>> {
    let (points, count) = (&branch.points, branch.points.len());
    let at = &points[index].state;
    let far = |forced: &Forced<'m, F>, near: usize| forced.distance(&points[near].state, at) > APART;
    let (behind, before): (Vec<usize>, Vec<usize>) = if branch.is_closed() {
        ((1..count).map(|i| (index + i) % count).collect(), (1..count).map(|i| (index + count - i) % count).collect())
    } else {
        ((index + 1..count).collect(), (0..index).rev().collect())
    };
    let ends = [before, behind].map(|way| way.into_iter().find(|&near| far(forced, near)).unwrap_or(index));
    let problem = forced.problem();
    let ends = ends.map(|index| problem.encode(&points[index].state));
    let chord: Vec<f64> = ends[1].iter().zip(&ends[0]).map(|(to, from)| to - from).collect();
    let row = weighted(problem.metric(), &chord);
    let directions = ends.into_iter().filter_map(|y| direction_at(problem, y, &row));
    let sum = directions.reduce(|a, b| a.iter().zip(&b).map(|(a, b)| a + b).collect())?;
    Some(unit(problem.metric(), sum))
}
