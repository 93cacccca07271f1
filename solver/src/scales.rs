//! Scales of the unknowns: every tolerance and arc length is measured in these units.

use crate::laws::LawKind;
use crate::model::Model;
use serde::{Deserialize, Serialize};

/// Reference length, frequency, modal amplitude and forcing amplitude (METHOD: ℓ, ω_ref, ℓ/φ).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    /// ℓ, m: the smallest positive contact gap.
    pub length: f64,
    /// ω_ref, rad/s: eigenfrequency of the tracked mode.
    pub frequency: f64,
    /// Modal amplitude ℓ/|φ|, kg^½·m, φ the tracked mode's component at the first monitored dof.
    pub modal: f64,
    /// Forcing amplitude whose linear resonance has modal amplitude 1.
    pub forcing: f64,
}

impl Scales {
    /// Scales of a model for the mode `tracked`.
    pub fn new(model: &Model, tracked: usize) -> Self {
        let gap = |law: &LawKind| match law {
            LawKind::Contact(contact) => contact.gap,
            LawKind::PenaltySpring(spring) => spring.gap,
            _ => 0.0,
        };
        let length = model.elements.iter().map(|e| gap(&e.law)).filter(|&g| g > 0.0).fold(f64::INFINITY, f64::min);
        let length = if length.is_finite() { length } else { 1.0 };
        let frequency = model.modes.frequencies[tracked];
        let phi = model.modes.shapes[(model.monitors[0], tracked)].abs();
        Self { length, frequency, modal: length / phi, forcing: 1.0 }
    }
}
