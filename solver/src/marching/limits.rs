//! How long a time step may be.

use super::local::LocalLaw;
use super::squares;
use crate::structure::Model;
use crate::structure::laws::Law;

/// Least number of steps in one period of the response. Where forces are functions of the motion errors fall with the square of
/// the step, and folds a thousandth above the birth of their isola need them small. Before rigid stops the impacts of the marcher
/// are others than those of the balance whatever the step, and on finer grids Newton's method comes to fewer orbits; of models of
/// more than [`LARGE`] modes a period takes its time.
pub fn least_steps(model: &Model) -> usize {
    let is_rigid = model.elements().iter().any(|element| element.law.rigid().is_some());
    if is_rigid || model.size() > LARGE { 512 } else { 2048 }
}

/// See [`least_steps`].
const LARGE: usize = 150;

/// Longest stable time step: 2/ω_max, with the stiffness that laws can add (ω_max² grows by at most k bᵀM⁻¹b), and the
/// inverse of the rate at which explicit dampers act.
pub fn stability_limit(model: &Model, laws: &[LocalLaw]) -> f64 {
    let mut square = squares(model).into_iter().fold(0.0, f64::max);
    let mut rate = 0.0;
    for law in laws {
        let (stiffness, damping) = law.steepest();
        square += stiffness;
        rate += damping;
    }
    (2.0 / square.sqrt()).min(1.0 / rate)
}
