//! Switching branches: from where a branch crosses others onto these.
//!
//! Along a branch the determinant of the Jacobian bordered by the tangent changes its sign where another branch crosses (H. B. Keller,
//! Applications of Bifurcation Theory, 359–384, 1977). There the Jacobian has two null directions. One is the tangent; the other one is taken
//! from the Jacobian at states beside the curve, whose null direction lies in the plane of both: no second derivatives are asked for.

use crate::curve::newton::{Constraint, Newton};
use crate::curve::point::{direction_at, unit};
use crate::curve::problem::{Problem, inner, norm, weighted};
use crate::formulation::Formulation;
use crate::formulation::state::State;
use crate::response::branch::{Branch, SpecialKind};
use crate::response::forced::Forced;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Relative distance from a branch point at which the Jacobian tells the tangent.
const APART: f64 = 1e-4;

/// How far beside the curve the Jacobian is asked, as a share of the motion.
const ASIDE: f64 = 1e-3;

/// How many states beside the curve are tried.
const TRIES: u64 = 4;

/// Least sine of the angle between tangent and null direction there, for the second null direction to be told by it.
const TOLD: f64 = 1e-2;

/// How far along the second null direction the other branch is looked for, as shares of the motion, in this order.
const SHARES: [f64; 5] = [0.03, 0.1, 0.01, 0.3, 0.003];

/// How far from there it may be met, as a share of the way.
const NEAR: f64 = 2.0;

/// Responses on what crosses a branch at its branch point of number `point`: one on either side, where one is found; the first one is what
/// is traced, which leads to the other if both are of one curve.
pub(super) fn beside<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, branch: &Branch, point: usize) -> Vec<State> {
    let mut indices = branch.special.iter().filter(|special| special.kind == SpecialKind::BranchPoint);
    let Some(index) = indices.nth(point).map(|special| special.index) else { return Vec::new() };
    let from = forced.problem().encode(&branch.points[index].state);
    let Some(tangent) = tangent(forced, branch, index) else { return Vec::new() };
    let problem = forced.problem();
    let Some(across) = second_null_direction(problem, &from, &tangent) else { return Vec::new() };
    let ways = [1.0, -1.0].map(|sign| across.iter().map(|entry| sign * entry).collect::<Vec<f64>>());
    ways.iter().filter_map(|way| landed(forced, branch, &from, way)).collect()
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

/// The null direction of the Jacobian at a branch point that is normal to the tangent, of unit length.
fn second_null_direction<P: Problem>(problem: &mut P, y: &[f64], tangent: &[f64]) -> Option<Vec<f64>> {
    let row = weighted(problem.metric(), tangent);
    let motion = problem.motion_metric().len();
    let size = ASIDE * norm(problem.motion_metric(), y);
    (0..TRIES).find_map(|seed| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut aside: Vec<f64> = (0..y.len()).map(|_| random.gen_range(-1.0..1.0)).collect();
        aside[motion..].fill(0.0);
        let length = norm(problem.metric(), &aside);
        let beside = y.iter().zip(&aside).map(|(y, aside)| y + size / length * aside).collect();
        let direction = direction_at(problem, beside, &row)?;
        let cosine = inner(problem.metric(), &direction, tangent);
        let normal: Vec<f64> = direction.iter().zip(tangent).map(|(direction, t)| direction - cosine * t).collect();
        let sine = norm(problem.metric(), &normal);
        (sine > TOLD).then(|| normal.iter().map(|entry| entry / sine).collect())
    })
}

/// A response this way from a branch point, in a plane normal to the way, that does not lie on the branch.
fn landed<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    branch: &Branch,
    from: &[f64],
    way: &[f64],
) -> Option<State> {
    let settings = forced.settings().continuation.newton;
    SHARES.into_iter().find_map(|share| {
        let problem = forced.problem();
        let length = share * norm(problem.motion_metric(), from);
        let row = weighted(problem.metric(), way);
        let predicted: Vec<f64> = from.iter().zip(way).map(|(from, way)| from + length * way).collect();
        let mut y = predicted.clone();
        let constraint = Constraint::Hyperplane { row: &row, origin: &predicted };
        Newton::default().solve(problem, &mut y, constraint, &settings).ok()?;
        let missed: Vec<f64> = y.iter().zip(&predicted).map(|(y, predicted)| y - predicted).collect();
        let is_near = norm(problem.metric(), &missed) <= NEAR * length;
        let state = is_near.then(|| problem.decode(&y).ok())??;
        (!forced.lies_on(&state, branch)).then_some(state)
    })
}
