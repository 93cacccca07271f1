//! Points of a curve as arrays: what branches and the backbone share. Seeds are such points as well.

use crate::array::{Array, ArrayError};
use crate::columns::Columns;
pub use crate::size::Size;
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use solver::formulation::harmonics::width;
use solver::formulation::state::State;
use solver::response::branch::BranchPoint;
use solver::response::columns;
use solver::response::seeds::{Phase, Seed};

/// p periodic motions of one truncation H.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Motions {
    /// Number of harmonics H.
    pub harmonics: usize,
    /// ω, rad/s: p.
    pub omega: Array,
    /// ζ, 1/s: p.
    pub decay: Array,
    /// Forcing amplitude A: p.
    pub forcing: Array,
    /// Harmonics of the laws' arguments: p × channels × (H + 1) × 2 (re, im). Contact normals: predicted pressure, N;
    /// everything else: relative displacement, m.
    pub argument: Array,
    /// Harmonics of the modal amplitudes: p × modes × (H + 1) × 2, kg^½·m; displacements are x = Φ y.
    pub modal: Array,
}

impl Motions {
    /// Of states of one truncation.
    pub fn new<'s>(states: impl ExactSizeIterator<Item = &'s State> + Clone) -> Self {
        let count = states.len();
        let first = states.clone().next();
        let harmonics = first.map_or(0, |state| state.harmonics);
        let nc = width(harmonics);
        let channels = first.map_or(0, |state| state.arguments.len() / nc);
        let modes = first.map_or(0, |state| state.modal.len() / nc);
        let column = |of: fn(&State) -> f64| Array::new([count], states.clone().map(of));
        Self {
            harmonics,
            omega: column(|state| state.omega),
            decay: column(|state| state.decay),
            forcing: column(|state| state.forcing),
            argument: Array::harmonics(&[count, channels], harmonics, states.clone().map(|s| &s.arguments[..])),
            modal: Array::harmonics(&[count, modes], harmonics, states.clone().map(|s| &s.modal[..])),
        }
    }

    /// Number of motions p.
    pub fn len(&self) -> usize {
        self.omega.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.omega.is_empty()
    }

    /// The states, for a model of so many channels and modes.
    ///
    /// # Errors
    /// Arrays of other shapes than such a model has, and values that are not finite.
    pub fn states(&self, channels: usize, modes: usize) -> Result<Vec<State>, ArrayError> {
        let (count, harmonics) = (self.len(), self.harmonics);
        let omega = self.omega.finite("omega", &[count])?;
        let decay = self.decay.finite("decay", &[count])?;
        let forcing = self.forcing.finite("forcing", &[count])?;
        let argument = self.argument.series("argument", &[count, channels], harmonics)?;
        let modal = self.modal.series("modal", &[count, modes], harmonics)?;
        let part = |values: &[f64], i: usize, width: usize| values[i * width..(i + 1) * width].to_vec();
        let nc = width(harmonics);
        let state = |i: usize| State {
            harmonics,
            omega: omega[i],
            decay: decay[i],
            forcing: forcing[i],
            arguments: part(&argument, i, channels * nc),
            modal: part(&modal, i, modes * nc),
        };
        Ok((0..count).map(state).collect())
    }
}

/// p points of a curve.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Points {
    /// The motions.
    pub motions: Motions,
    /// What else is known of every point: [`columns::of_points`].
    #[serde(flatten, deserialize_with = "columns_of_points")]
    pub columns: Columns,
}

/// As with columns that are flattened, whose number is not known to those who derive it: all of them would be held in between.
impl Serialize for Points {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(1 + self.columns.iter().count()))?;
        map.serialize_entry("motions", &self.motions)?;
        self.columns.iter().try_for_each(|(name, array)| map.serialize_entry(name, array))?;
        map.end()
    }
}

fn columns_of_points<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Columns, D::Error> {
    Columns::read(deserializer, columns::of_points())
}

impl Points {
    /// Of points of one curve.
    pub fn new<'p>(points: impl ExactSizeIterator<Item = &'p BranchPoint> + Clone) -> Self {
        Self {
            motions: Motions::new(points.clone().map(|point| &point.state)),
            columns: Columns::new(columns::of_points(), points.map(|point| &point.values)),
        }
    }

    /// Number of points p.
    pub fn len(&self) -> usize {
        self.motions.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.motions.is_empty()
    }

    /// The points, for a model of this size.
    ///
    /// # Errors
    /// Those of [`Motions::states`], and columns of other shapes.
    pub fn points(&self, size: &Size) -> Result<Vec<BranchPoint>, ArrayError> {
        let rows = self.columns.rows(columns::of_points(), self.len(), size)?;
        let states = self.motions.states(size.channels, size.modes)?;
        Ok(states.into_iter().zip(rows).map(|(state, values)| BranchPoint { state, values }).collect())
    }
}

/// Seeds of a task, the most promising first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Seeds {
    /// Predicted motions, each with the frequency and the forcing it is landed from.
    pub motions: Motions,
    /// Place on the backbone: index of a point, and between points the share of the way to the next: p.
    pub place: Array,
    /// Which of the two phases; `None` if there are no seeds (the main branch).
    pub phase: Option<Phase>,
}

impl Seeds {
    /// Of the seeds of one task.
    pub fn new(seeds: &[Seed]) -> Self {
        Self {
            motions: Motions::new(seeds.iter().map(|seed| &seed.state)),
            place: Array::new([seeds.len()], seeds.iter().map(|seed| seed.place)),
            phase: seeds.first().map(|seed| seed.phase),
        }
    }

    /// The seeds, for a model of this size.
    ///
    /// # Errors
    /// Those of [`Motions::states`], and places that are not one for each seed.
    pub fn seeds(&self, size: &Size) -> Result<Vec<Seed>, ArrayError> {
        let Some(phase) = self.phase else { return Ok(Vec::new()) };
        let states = self.motions.states(size.channels, size.modes)?;
        let places = self.place.values("place", &[states.len()])?;
        Ok(states.into_iter().zip(places).map(|(state, place)| Seed { state, place, phase }).collect())
    }
}
