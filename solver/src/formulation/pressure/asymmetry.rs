//! How far states are from being their own images by exchanges of equal parts of the structure.

use super::PressureForm;
use crate::formulation::state::State;

impl PressureForm<'_> {
    /// Of scaled modal amplitudes, by each exchange.
    pub(super) fn asymmetries_of(&self, scaled: &[f64]) -> Vec<f64> {
        if self.exchanges.is_empty() {
            return Vec::new();
        }
        let modal = scaled.iter().map(|s| s * self.system.scales.modal).collect();
        let state = State { modal, arguments: Vec::new(), ..self.current };
        let model = self.system.model;
        let motions = state.displacements(model);
        self.exchanges.iter().map(|exchange| exchange.asymmetry(model, &motions)).collect()
    }
}
