//! Structures whose laws are all odd: with every motion its mirror image, half a period of the forcing later, is a response.
//! Most motions are their own images; those that are not branch off them, or are isolas of their own.

use crate::curve::problem::{Failure, inner};
use crate::curve::walk::{interpolate, relative_distance};
use crate::formulation::Formulation;
use crate::formulation::state::State;
use crate::response::branch::{Branch, BranchPoint, Outcome, Stop};
use crate::response::forced::Forced;

/// Relative distance of a motion from its mirror image from which on it is asymmetric.
const ASYMMETRIC: f64 = 1e-6;

/// Of the largest asymmetry along a branch, the share below which its end lies next to a symmetric motion.
const NEXT_TO: f64 = 0.05;

/// The mirror images among the images of a state.
fn mirrors<'m, F: Formulation<'m>>(problem: &F) -> impl Iterator<Item = usize> + use<'m, F> {
    let is_symmetric = problem.system().is_symmetric;
    (0..problem.images()).filter(move |index| is_symmetric && index % 2 == 1)
}

/// A state and that of its mirror images which it is nearest to, with their relative distance; none without symmetry.
fn mirrored<'m, F: Formulation<'m>>(problem: &F, state: &State) -> Option<(Vec<f64>, Vec<f64>, f64)> {
    let (y, metric) = (problem.encode(state), problem.motion_metric());
    let images = mirrors(problem).map(|index| problem.image(&y, index));
    let images = images.map(|image| (relative_distance(metric, &image, &y), image));
    let (distance, image) = images.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((y, image, distance))
}

/// Relative distance of a motion from its nearest mirror image.
fn asymmetry<'m, F: Formulation<'m>>(problem: &F, state: &State) -> f64 {
    mirrored(problem, state).map_or(0.0, |(_, _, distance)| distance)
}

/// Whether a branch of asymmetric motions branches off others: it passes through a symmetric motion to its own mirror image, or
/// stops next to one, where it cannot be followed.
pub(super) fn is_attached<'m, F: Formulation<'m>>(problem: &F, branch: &Branch) -> bool {
    let (Some(first), Some(last)) = (branch.points.first(), branch.points.last()) else { return false };
    let largest = branch.points.iter().map(|point| asymmetry(problem, &point.state)).fold(0.0, f64::max);
    if largest < ASYMMETRIC || branch.is_cancelled() {
        return false;
    }
    let stops = match branch.outcome {
        Outcome::Open(from, to) => [(from, first), (to, last)].map(|(stop, end)| (is_stop(stop), end)),
        Outcome::Closed => [(false, first), (false, last)],
    };
    let is_next_to = |end: &BranchPoint| asymmetry(problem, &end.state) < NEXT_TO * largest;
    if stops.into_iter().any(|(is_stop, end)| is_stop && is_next_to(end)) {
        return true;
    }
    mirrors(problem).any(|index| {
        let away = |point: &BranchPoint| -> Vec<f64> {
            let y = problem.encode(&point.state);
            problem.image(&y, index).iter().zip(&y).map(|(image, y)| image - y).collect()
        };
        let list: Vec<Vec<f64>> = branch.points.iter().map(away).collect();
        list.windows(2).any(|pair| inner(problem.motion_metric(), &pair[0], &pair[1]) < 0.0)
    })
}

/// Whether a curve goes on where it ends like this.
fn is_stop(stop: Stop) -> bool {
    matches!(stop, Stop::Stalled(_) | Stop::Reversed | Stop::Joined)
}

/// The response halfway between an asymmetric motion and its nearest mirror image, at its own frequency.
///
/// # Errors
/// If Newton's method fails, or there is no mirror image.
pub(super) fn symmetrised<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, state: &State) -> Result<State, Failure> {
    let problem = forced.problem();
    let (y, image, _) = mirrored(problem, state).ok_or(Failure::Diverged)?;
    let middle = problem.decode(&interpolate(&y, &image, 0.5)).map_err(|_| Failure::Singular)?;
    forced.converge(&middle)
}
