//! What acts on a structure at rest, or on its smallest motions: there the matrices alone do not tell the response.

use solver::structure::laws::{Law, LawKind};
use solver::structure::{Element, Model};

/// Elastic stops that are pressed at rest, with their gaps, m.
pub fn pressed_at_rest(model: &Model) -> impl Iterator<Item = (&Element, f64)> {
    model.elements().iter().filter_map(|element| match &element.law {
        LawKind::PenaltySpring(spring) if spring.gap < 0.0 => Some((element, spring.gap)),
        _ => None,
    })
}

/// Elements that act on the smallest motions: joints that stick, friction, linear terms; stops that are pressed at rest are not among them.
pub fn acting_at_rest(model: &Model) -> impl Iterator<Item = &Element> {
    let acts = |law: &LawKind| law.clearance().is_none() && (law.stiffness_bound() > 0.0 || law.damping_bound() > 0.0);
    model.elements().iter().filter(move |element| acts(&element.law))
}
