//! What the force does on the modes.

use solver::structure::Model;

/// A force that does less work than this share on all modes that vibrate drives none of them.
const DRIVEN: f64 = 1e-9;

/// The force's shape in modal coordinates, N/kg^½ per unit of A.
pub(super) fn projection(model: &Model) -> Vec<f64> {
    model.modes().shapes.transpose().mul_vec(&model.forcing().shape)
}

/// Modes that vibrate and that the force drives, from 0.
pub(super) fn driven(model: &Model) -> Vec<usize> {
    let work = projection(model);
    let largest = work.iter().fold(0.0_f64, |largest, work| largest.max(work.abs()));
    let is_driven = |&mode: &usize| !model.modes().is_rigid(mode) && work[mode].abs() > DRIVEN * largest;
    (0..model.size()).filter(is_driven).collect()
}
