//! Structures whose laws are all odd: with every motion its mirror image, half a period of the forcing later, is a response.
//! Most motions are their own images; those that are not branch off them, or are isolas of their own.

use crate::curve::problem::{Failure, inner};
use crate::curve::walk::{interpolate, relative_distance};
use crate::formulation::Formulation;
use crate::formulation::state::State;
use crate::response::branch::{Branch, BranchPoint};
use crate::response::forced::Forced;

/// Relative distance of a motion from its mirror image from which on it is asymmetric.
const ASYMMETRIC: f64 = 1e-6;

/// The mirror images among the images of a state.
fn mirrors<'m, F: Formulation<'m>>(problem: &F) -> impl Iterator<Item = usize> + use<'m, F> {
    let is_symmetric = problem.system().is_symmetric;
    (0..problem.images()).filter(move |index| is_symmetric && index % 2 == 1)
}

/// Whether a motion differs from all its mirror images.
pub(super) fn is_asymmetric<'m, F: Formulation<'m>>(problem: &F, state: &State) -> bool {
    let (y, metric) = (problem.encode(state), problem.motion_metric());
    let distances = mirrors(problem).map(|index| relative_distance(metric, &problem.image(&y, index), &y));
    distances.reduce(f64::min).is_some_and(|distance| distance > ASYMMETRIC)
}

/// Whether a branch of asymmetric motions branches off others: it passes through a symmetric motion to its own mirror image, or
/// ends next to one, where it cannot be followed.
pub(super) fn is_attached<'m, F: Formulation<'m>>(problem: &F, branch: &Branch) -> bool {
    let is_passed = |index: usize| {
        let asymmetry = |point: &BranchPoint| -> Vec<f64> {
            let y = problem.encode(&point.state);
            problem.image(&y, index).iter().zip(&y).map(|(image, y)| image - y).collect()
        };
        let list: Vec<Vec<f64>> = branch.points.iter().map(asymmetry).collect();
        list.windows(2).any(|pair| inner(problem.motion_metric(), &pair[0], &pair[1]) < 0.0)
    };
    branch.points.iter().any(|point| is_asymmetric(problem, &point.state))
        && (branch.outcome.is_unfinished() || mirrors(problem).any(is_passed))
}

/// The response halfway between an asymmetric motion and its mirror image, at its own frequency.
///
/// # Errors
/// If Newton's method fails.
pub(super) fn symmetrised<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, state: &State) -> Result<State, Failure> {
    let problem = forced.problem();
    let y = problem.encode(state);
    let middle = interpolate(&y, &problem.image(&y, 1), 0.5);
    let middle = problem.decode(&middle).map_err(|_| Failure::Singular)?;
    forced.converge(&middle)
}
