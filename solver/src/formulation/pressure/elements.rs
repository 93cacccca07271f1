//! Nonlinear elements and their channels as the pressure form sees them.

use crate::formulation::modal::Modal;
use crate::formulation::scales::Scales;
use crate::structure::Model;
use crate::structure::laws::{Law, LawKind, MAX_ARGUMENTS};
use std::ops::Range;

/// A nonlinear element as the pressure form sees it.
pub(super) struct BoundElement {
    pub law: LawKind,
    /// Its channels.
    pub channels: Range<usize>,
    pub is_contact: bool,
    /// For each force, one more than the last argument it depends on.
    pub reach: [usize; MAX_ARGUMENTS],
    pub active: bool,
}

/// Row constants of a channel: residual = a − δ f − s x + c, divided by the scale of a.
#[derive(Debug, Clone, Copy)]
pub(super) struct Channel {
    /// s: ε for a contact normal, 1 otherwise.
    pub gain: f64,
    /// δ: 1 for a contact normal, 0 otherwise.
    pub feedback: f64,
    /// c: ε × gap for a contact normal, 0 otherwise (harmonic 0).
    pub offset: f64,
    /// Scale of the argument.
    pub scale: f64,
}

/// Elements and their channels as the pressure form sees them.
pub(super) fn bound_elements(model: &Model, modal: &Modal, scales: &Scales) -> (Vec<BoundElement>, Vec<Channel>) {
    let (mut elements, mut channels) = (Vec::new(), Vec::new());
    for element in model.elements() {
        let count = element.law.arguments();
        let is_contact = element.law.rigid().is_some();
        let pattern = element.law.pattern();
        let depends = |i: usize, j: &usize| pattern.du[i][*j] || pattern.dv[i][*j];
        let reach = std::array::from_fn(|i| (0..count).rev().find(|j| depends(i, j)).map_or(0, |j| j + 1));
        let range = channels.len()..channels.len() + count;
        channels.extend(range.clone().map(|u| {
            let (gain, offset) = modal.open(u);
            let feedback = if is_contact && u == range.start { 1.0 } else { 0.0 };
            Channel { gain, feedback, offset, scale: gain * scales.length }
        }));
        elements.push(BoundElement { law: element.law.clone(), channels: range, is_contact, reach, active: false });
    }
    (elements, channels)
}
