//! Monitored dofs and their clearances.

use serde::Serialize;
use solver::structure::Model;

/// A monitored dof.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Monitor {
    /// Name.
    pub name: String,
    /// Its clearance to the casing, m, if it is normal to it.
    pub gap: Option<f64>,
}

/// Monitored dofs, with their clearances where they are normal to the casing.
pub fn monitors(model: &Model) -> Vec<Monitor> {
    let gap = |dof: usize| {
        let at_dof = |channels: &[Vec<(usize, f64)>]| matches!(channels[0][..], [(normal, _)] if normal == dof);
        model.contacts().find(|contact| at_dof(&contact.element.channels)).map(|contact| contact.law.gap)
    };
    model.monitors().iter().map(|&dof| Monitor { name: model.dofs()[dof].clone(), gap: gap(dof) }).collect()
}
