//! What the force does on the modes.

use solver::structure::Model;

/// A force that does less work than this share on all modes that vibrate drives none of them.
pub(super) const DRIVEN: f64 = 1e-9;

/// What a force of its shape does on a mode: its share of modal amplitude.
pub(super) fn work(model: &Model, j: usize) -> f64 {
    let (modes, shape) = (model.modes(), &model.forcing().shape);
    (0..model.size()).map(|dof| modes.shapes[(dof, j)] * shape[dof]).sum::<f64>().abs()
}

/// Modes that vibrate and that the force drives, from 0.
pub(super) fn driven(model: &Model) -> impl Iterator<Item = usize> + '_ {
    let largest = (0..model.size()).map(|mode| work(model, mode)).fold(0.0, f64::max);
    (0..model.size()).filter(move |&mode| !model.modes().is_rigid(mode) && work(model, mode) > DRIVEN * largest)
}
