//! Structures whose place is not determined.

use super::touch::shape;
use solver::structure::laws::LawKind;
use solver::structure::{Element, Model};

/// Share of the largest argument that is rounding.
const ROUNDING: f64 = 1e-9;

/// Of structures that move as a rigid body, and that only contacts, stops, sliders or dampers may hold: where these let go the same
/// motion goes on anywhere. A sentence.
pub(super) fn undetermined(model: &Model) -> Option<String> {
    let rigid: Vec<usize> = (0..model.size()).filter(|&mode| model.modes().is_rigid(mode)).collect();
    let moves = |element: &Element, mode: usize| {
        let shape = shape(model, element);
        let largest = shape.iter().fold(0.0_f64, |largest, b| largest.max(b.abs()));
        shape[mode].abs() > ROUNDING * largest
    };
    // A polynomial resists wherever the structure is.
    let holds = |mode: usize| {
        let mut springs = model.elements().iter().filter(|element| matches!(element.law, LawKind::PolynomialSpring(_)));
        springs.any(|element| moves(element, mode))
    };
    let free = rigid.into_iter().find(|&mode| !holds(mode))?;
    Some(format!(
        "nothing resists the rigid-body motion of mode {} at every place: wherever contacts, stops and sliders let go, the same motion \
         goes on at any mean position, and which one is listed, with its amplitude, is arbitrary; how it deforms is not. Hold it \
         by a soft spring",
        free + 1
    ))
}
