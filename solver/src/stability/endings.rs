//! Where motions end: on one of two orbits of a frequency, or on neither.

use super::nearby::{distance, images};
use super::shooting::Orbit;
use crate::marching::{Marching, MarchingError};
use crate::structure::Model;
use serde::{Deserialize, Serialize};

/// A motion has ended on an orbit within this share of the distance of the two orbits: they are stable, and what is as near is
/// drawn in.
pub(super) const NEAR: f64 = 0.05;
/// The same of the motions that a result rests on, which may take [`PATIENCE`] times as long.
pub(super) const SURE: f64 = 0.005;
const PATIENCE: usize = 4;

/// Where a motion ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// On the main motion again.
    Back,
    /// On the branch.
    Onto,
    /// On neither within [`DisturbSettings::periods`](super::disturbance::DisturbSettings::periods), or it could not be marched.
    Elsewhere,
}

impl Ending {
    const ALL: [Self; 3] = [Self::Back, Self::Onto, Self::Elsewhere];

    /// Its name, as in messages and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Back => "back",
            Self::Onto => "onto",
            Self::Elsewhere => "elsewhere",
        }
    }

    /// The one of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|ending| ending.name() == name)
    }
}

/// The stable orbits that motions at a frequency may end on.
pub(super) struct Ends<'m> {
    model: &'m Model,
    omega: f64,
    /// Images of each orbit.
    known: Vec<(Ending, Vec<Vec<f64>>)>,
    /// The distance of the two orbits; of one, its distance from rest.
    between: f64,
}

impl<'m> Ends<'m> {
    /// A main orbit and one of the branch. `None` if neither is known.
    ///
    /// # Errors
    /// If one cannot be marched.
    pub fn new(model: &'m Model, main: Option<&Orbit>, target: Option<&Orbit>) -> Result<Option<Self>, MarchingError> {
        let known = [(Ending::Back, main), (Ending::Onto, target)];
        let known = known.into_iter().filter_map(|(ending, orbit)| Some((ending, orbit?)));
        let known: Vec<(Ending, &Orbit)> = known.collect();
        let Some(&(_, first)) = known.first() else { return Ok(None) };
        let listed = known.iter().map(|(ending, orbit)| Ok((*ending, images(model, orbit)?)));
        let listed = listed.collect::<Result<Vec<_>, MarchingError>>()?;
        let rest = [vec![0.0; first.state.len()]];
        let others = listed.get(1).map_or(&rest[..], |(_, images)| images);
        let between = distance(model, first.omega, &first.state, others);
        Ok(Some(Self { model, omega: first.omega, known: listed, between }))
    }

    /// Marches on, for so many periods at most, until the motion has come within a share `near` of the orbits' distance to one of
    /// them, and says which. Also the largest |x| of the first monitored dof in its last period, m; zero of a motion that begins
    /// there.
    pub fn of(&self, marching: &mut Marching<'_>, periods: usize, near: f64) -> (Ending, f64) {
        let mut amplitude = 0.0;
        for _ in 0..if near < NEAR { PATIENCE } else { 1 } * periods {
            let state = marching.state();
            let is_there = |images: &[Vec<f64>]| distance(self.model, self.omega, &state, images) < near * self.between;
            if let Some((ending, _)) = self.known.iter().find(|(_, images)| is_there(images)) {
                return (*ending, amplitude);
            }
            let Ok(period) = marching.period() else { return (Ending::Elsewhere, f64::NAN) };
            amplitude = period.max[0];
        }
        (Ending::Elsewhere, amplitude)
    }
}
