//! What is stored of a structure: its model, forcing levels, and the truth about each.

use crate::model::Model;
use serde::{Deserialize, Serialize};

/// A structure and the truth about it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Record {
    /// What its numbers were drawn from.
    pub number: u64,
    /// What it is.
    pub kind: Kind,
    /// The model.
    pub model: Model,
    /// Lowest and highest frequency of the study, rad/s.
    pub range: [f64; 2],
    /// The levels, by rising forcing amplitude.
    pub levels: Vec<Level>,
}

/// What makes a structure nonlinear.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Cubic and quintic springs.
    Springs,
    /// A light mass on a nonlinear spring, on a chain with a cubic spring.
    Absorber,
    /// An elastic stop on one side.
    Stop,
    /// A damper that is weaker at moderate velocities.
    Damper,
}

/// All that was found at a forcing amplitude.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Level {
    /// A.
    pub forcing: f64,
    /// Random starts tried.
    pub starts: usize,
    /// Peak of the main branch from the lowest frequency of the range on, `[rad/s, m]`; none if continuation did not
    /// come through.
    pub main: Option<[f64; 2]>,
    /// Closed branches within the range.
    pub isolas: Vec<Isola>,
    /// Branches that are neither closed nor the main one.
    pub open: usize,
    /// Whether there are so many branches that nobody can say whether these are all.
    pub crowded: bool,
}

/// A closed branch.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Isola {
    /// Which resonance it is.
    pub resonance: Resonance,
    /// Lowest and highest frequency, rad/s.
    pub omega: [f64; 2],
    /// Its peak, `[rad/s, m]`.
    pub peak: [f64; 2],
    /// Whether it is one of its own; kept apart otherwise.
    pub standing: Standing,
    /// Largest relative change of its ends, width and peak with twice the harmonics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub change: Option<f64>,
    /// Points next to which time integration has a periodic orbit, and points tried.
    pub marched: [usize; 2],
    /// Largest relative difference of amplitudes there.
    pub deviation: f64,
    /// Starts that met it.
    pub hits: usize,
}

impl Isola {
    /// Whether the product is measured by it.
    pub fn counts(&self) -> bool {
        self.standing == Standing::Isola
    }
}

/// What resonates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Resonance {
    /// The first mode, with the forcing.
    FirstMode,
    /// Another mode, with the forcing.
    OtherMode,
    /// A motion whose period is several of the forcing.
    SubHarmonic,
    /// A mode, with a multiple of the forcing's frequency.
    SuperHarmonic,
}

/// Whether a closed branch counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// An isola.
    Isola,
    /// It branches off motions that are more symmetric in space or time.
    Attached,
    /// With twice the harmonics it changes by more than 8 % or is no isola, or time integration has no orbits within 8 %
    /// next to half of the points tried, or it is narrower than a millionth of its frequency.
    Unresolved,
}
