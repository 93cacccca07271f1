//! A model as plain data, modes and all: how it travels, is stored, and is changed.

use super::damped::damped_modes;
use super::error::{ModelError, Place};
use super::validation::{check_elements, check_force, check_harmonic, check_monitors, duplicate};
use super::{Damping, Element, Forcing, Model, Modes};
use crate::linalg::Matrix;

/// Everything a [`Model`] holds. Modes and damping are taken as they are: a model that is restored computes in the same
/// modal coordinates as the one that the data came from.
#[derive(Debug, Clone)]
pub struct ModelData {
    /// Name shown to people.
    pub name: String,
    /// Names of the n dofs.
    pub dofs: Vec<String>,
    /// Mass matrix M, n × n, kg.
    pub mass: Matrix,
    /// Stiffness matrix K, n × n, N/m.
    pub stiffness: Matrix,
    /// Linear modes of (K, M).
    pub modes: Modes,
    /// Damping in modal coordinates.
    pub damping: Damping,
    /// Forcing shape and harmonic.
    pub forcing: Forcing,
    /// Nonlinear elements.
    pub elements: Vec<Element>,
    /// Reported dofs, counted from 0, one or more.
    pub monitors: Vec<usize>,
}

impl From<Model> for ModelData {
    fn from(model: Model) -> Self {
        let Model { name, dofs, mass, stiffness, modes, damping, damped: _, forcing, elements, monitors } = model;
        Self { name, dofs, mass, stiffness, modes, damping, forcing, elements, monitors }
    }
}

impl TryFrom<ModelData> for Model {
    type Error = ModelError;

    /// The model of these data.
    ///
    /// # Errors
    /// Sizes that do not fit together, numbers that are not finite, names given twice, and elements, monitored dofs or a
    /// forcing that [`ModelBuilder`](super::ModelBuilder) would refuse. That the modes are those of the matrices is not checked.
    fn try_from(data: ModelData) -> Result<Self, ModelError> {
        let n = data.dofs.len();
        check_monitors(&data.monitors, n)?;
        check_square(&data.mass, n, "matrices.mass")?;
        check_square(&data.stiffness, n, "matrices.stiffness")?;
        check_square(&data.modes.shapes, n, "modes.shapes")?;
        check_list(&data.modes.frequencies, n, "modes.frequencies")?;
        match &data.damping {
            Damping::Modal(rates) => check_list(rates, n, "damping")?,
            Damping::Full(matrix) => check_square(matrix, n, "damping")?,
        }
        if let Some(name) = duplicate(data.dofs.iter()) {
            return Err(ModelError::Duplicate { place: Place::key("dofs"), what: "dof", name });
        }
        check_force(&data.forcing.shape, &data.dofs)?;
        check_harmonic(data.forcing.harmonic)?;
        check_elements(&data.elements, n)?;
        let ModelData { name, dofs, mass, stiffness, modes, damping, forcing, elements, monitors } = data;
        let damped = damped_modes(&modes, &damping);
        Ok(Self { name, dofs, mass, stiffness, modes, damping, damped, forcing, elements, monitors })
    }
}

fn check_square(matrix: &Matrix, n: usize, key: &str) -> Result<(), ModelError> {
    let (rows, cols) = (matrix.rows(), matrix.cols());
    if rows != n || cols != n {
        let expected = format!("but there are {n} dofs");
        return Err(ModelError::Size { place: Place::key(key), rows, cols, expected });
    }
    match matrix.entries().iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(at) => {
            let (row, col) = (at / n + 1, at % n + 1);
            Err(ModelError::NotFinite { place: Place::key(key), row, col, value: matrix.entries()[at] })
        }
    }
}

fn check_list(values: &[f64], n: usize, key: &str) -> Result<(), ModelError> {
    if values.len() != n {
        let value = format!("{} numbers", values.len());
        return Err(ModelError::value(Place::key(key), value, format!("give {n}, one per mode")));
    }
    match values.iter().find(|v| !v.is_finite()) {
        None => Ok(()),
        Some(value) => Err(ModelError::value(Place::key(key), value, "every number must be finite")),
    }
}
