//! Monitored dofs and their clearances.

use serde::Serialize;
use solver::structure::Model;
use solver::structure::laws::LawKind;

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
        model.elements().iter().find_map(|element| match &element.law {
            LawKind::Contact(law) => {
                matches!(element.channels[0][..], [(normal, _)] if normal == dof).then_some(law.gap)
            }
            _ => None,
        })
    };
    model.monitors().iter().map(|&dof| Monitor { name: model.dofs()[dof].clone(), gap: gap(dof) }).collect()
}
