//! The model as a message: with its modes, so that every worker computes in the same modal coordinates.

use crate::array::{Array, ArrayError};
use crate::codec::messages;
use serde::{Deserialize, Serialize};
use solver::linalg::Matrix;
use solver::structure::laws::LawKind;
use solver::structure::{Damping, Element, Forcing, Model, ModelData, ModelError, Modes};
use thiserror::Error;

/// A structure with its nonlinear elements, n dofs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelMessage {
    /// Name shown to people.
    pub name: String,
    /// Names of the dofs.
    pub dofs: Vec<String>,
    /// Mass matrix, kg: n × n.
    pub mass: Array,
    /// Stiffness matrix, N/m: n × n.
    pub stiffness: Array,
    /// Eigenfrequencies, rad/s: n.
    pub frequencies: Array,
    /// Mass-normalised mode shapes Φ, a column per mode: n × n.
    pub shapes: Array,
    /// Damping in modal coordinates, 1/s: n (diagonal) or n × n.
    pub damping: Array,
    /// Forcing shape s, N per unit of A: n.
    pub forcing: Array,
    /// Harmonic of the response that is forced.
    pub forcing_harmonic: usize,
    /// Nonlinear elements.
    pub elements: Vec<ElementMessage>,
    /// Monitored dofs, by index.
    pub monitors: Vec<usize>,
}

/// A nonlinear element.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ElementMessage {
    /// Name shown to people.
    pub name: String,
    /// (dof, coefficient) pairs of every argument.
    pub channels: Vec<Vec<(usize, f64)>>,
    /// Law with its parameters.
    pub law: LawKind,
}

messages! { ModelMessage => "model" }

/// Why a message is not a model.
#[derive(Debug, Error)]
pub enum ModelMessageError {
    /// An array does not fit.
    #[error(transparent)]
    Array(#[from] ArrayError),
    /// The numbers are there, but make no model.
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl From<&Model> for ModelMessage {
    fn from(model: &Model) -> Self {
        let n = model.size();
        let matrix = |m: &Matrix| Array::new([m.rows(), m.cols()], m.entries().iter().copied());
        Self {
            name: model.name().to_string(),
            dofs: model.dofs().to_vec(),
            mass: matrix(model.mass()),
            stiffness: matrix(model.stiffness()),
            frequencies: Array::new([n], model.modes().frequencies.iter().copied()),
            shapes: matrix(&model.modes().shapes),
            damping: match model.damping().uncoupled() {
                Some(rates) => Array::new([n], rates.iter().copied()),
                None => matrix(&model.damping().matrix()),
            },
            forcing: Array::new([n], model.forcing().shape.iter().copied()),
            forcing_harmonic: model.forcing().harmonic,
            elements: model.elements().iter().map(ElementMessage::from).collect(),
            monitors: model.monitors().to_vec(),
        }
    }
}

impl From<&Element> for ElementMessage {
    fn from(element: &Element) -> Self {
        Self { name: element.name.clone(), channels: element.channels.clone(), law: element.law.clone() }
    }
}

impl ModelMessage {
    /// The model.
    ///
    /// # Errors
    /// Arrays of another shape or type, and data that are no model.
    pub fn model(&self) -> Result<Model, ModelMessageError> {
        let n = self.dofs.len();
        let matrix = |array: &Array, name| -> Result<Matrix, ArrayError> {
            let values = array.values(name, &[n, n])?;
            Ok(Matrix::from_fn(n, n, |i, j| values[i * n + j]))
        };
        let damping = match self.damping.shape.len() {
            1 => Damping::Modal(self.damping.values("damping", &[n])?),
            _ => Damping::Full(matrix(&self.damping, "damping")?),
        };
        let element =
            |e: &ElementMessage| Element { name: e.name.clone(), channels: e.channels.clone(), law: e.law.clone() };
        let data = ModelData {
            name: self.name.clone(),
            dofs: self.dofs.clone(),
            mass: matrix(&self.mass, "mass")?,
            stiffness: matrix(&self.stiffness, "stiffness")?,
            modes: Modes {
                frequencies: self.frequencies.values("frequencies", &[n])?,
                shapes: matrix(&self.shapes, "shapes")?,
            },
            damping,
            forcing: Forcing { shape: self.forcing.values("forcing", &[n])?, harmonic: self.forcing_harmonic },
            elements: self.elements.iter().map(element).collect(),
            monitors: self.monitors.clone(),
        };
        Ok(Model::try_from(data)?)
    }
}
