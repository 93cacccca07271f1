//! Orbits of the time marcher: what a verification was told of, for whoever checks it. They are not stored.

use crate::array::{Array, ArrayError};
use serde::{Deserialize, Serialize};
use solver::stability::shooting::Orbit;

/// Orbits, one after the other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OrbitsMessage {
    /// Time steps in a period of each.
    pub steps: Vec<usize>,
    /// State of each at t = 0, as the marcher has it: one row an orbit.
    pub states: Array,
}

impl OrbitsMessage {
    /// Of these orbits; `None` if there are none.
    pub fn new(orbits: &[Orbit]) -> Option<Self> {
        let numbers = orbits.first()?.state.len();
        let values = orbits.iter().flat_map(|orbit| orbit.state.iter().copied());
        let steps = orbits.iter().map(|orbit| orbit.steps).collect();
        Some(Self { steps, states: Array::new([orbits.len(), numbers], values) })
    }

    /// Number of orbits.
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// One of them, which has this frequency and forcing amplitude.
    ///
    /// # Errors
    /// If it is not there, or its numbers are not finite.
    pub fn orbit(&self, number: usize, omega: f64, forcing: f64) -> Result<Orbit, ArrayError> {
        let (name, count) = ("states", self.steps.len());
        let numbers = self.states.shape.get(1).copied().unwrap_or_default();
        let values = self.states.finite(name, &[count, numbers])?;
        let state = values.chunks_exact(numbers.max(1)).nth(number).ok_or(ArrayError::Missing { name })?.to_vec();
        Ok(Orbit { omega, forcing, steps: self.steps[number], state })
    }
}
