//! Forced responses that seeds landed on, as a message.

use crate::array::{Array, ArrayError};
use crate::curve::{Motions, Size};
use serde::{Deserialize, Serialize};
use solver::response::seeds::Landing;

/// p forced responses, in the order of their seeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LandingsMessage {
    /// The responses.
    pub motions: Motions,
    /// Relative distance of each from its seed: p.
    pub distance: Array,
}

impl From<&[Landing]> for LandingsMessage {
    fn from(landings: &[Landing]) -> Self {
        Self {
            motions: Motions::new(landings.iter().map(|landing| &landing.state)),
            distance: Array::new([landings.len()], landings.iter().map(|landing| landing.distance)),
        }
    }
}

impl LandingsMessage {
    /// The responses, for a model of this size.
    ///
    /// # Errors
    /// If an array has another shape, or numbers that are not finite.
    pub fn landings(&self, size: &Size) -> Result<Vec<Landing>, ArrayError> {
        let states = self.motions.states(size.channels, size.modes)?;
        let distances = self.distance.finite("distance", &[states.len()])?;
        Ok(states.into_iter().zip(distances).map(|(state, distance)| Landing { state, distance }).collect())
    }
}
