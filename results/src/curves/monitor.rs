//! Monitored dofs and their clearances.

use serde::Serialize;
use solver::structure::Model;
use solver::structure::laws::Law;

/// A monitored dof.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Monitor {
    /// Name.
    pub name: String,
    /// Its clearance, m, to a casing that it is normal to, or to the nearest stop either way.
    pub gap: Option<f64>,
}

/// Monitored dofs, with their clearances where they alone move towards a casing or a stop.
pub fn monitors(model: &Model) -> Vec<Monitor> {
    let gap = |dof: usize| {
        let clearances = model.elements().iter().filter_map(|element| match element.channels[0][..] {
            [(own, factor)] if own == dof && factor != 0.0 => Some(element.law.clearance()? / factor.abs()),
            _ => None,
        });
        // A stop that is pressed at rest has none.
        clearances.filter(|gap| *gap > 0.0).reduce(f64::min)
    };
    model.monitors().iter().map(|&dof| Monitor { name: model.dofs()[dof].clone(), gap: gap(dof) }).collect()
}
