//! The equations of motion `M x″ + C x′ + K x + Σ β f(βᵀx, βᵀx′) = A s cos(mωt)` in numbers.

use crate::model::{Law, Model, dof};
use faer::{Mat, Side};
use std::collections::BTreeMap;

/// A structure with n dofs.
#[derive(Debug, Clone)]
pub struct Structure {
    /// Masses, the diagonal of M, kg.
    pub mass: Vec<f64>,
    /// K, N/m.
    pub stiffness: Mat<f64>,
    /// C, N·s/m: the same ratio in every mode.
    pub damping: Mat<f64>,
    /// That ratio.
    pub ratio: f64,
    /// Eigenfrequencies, rad/s, ascending.
    pub frequencies: Vec<f64>,
    /// Mode shapes in the columns, mass-normalised.
    pub shapes: Mat<f64>,
    /// s, N.
    pub forcing: Vec<f64>,
    /// m.
    pub harmonic: usize,
    /// The dof whose amplitude is reported.
    pub monitor: usize,
    /// Directions β and laws.
    pub elements: Vec<(Vec<f64>, Law)>,
}

impl Structure {
    /// Of a model with a diagonal mass matrix.
    ///
    /// # Panics
    /// If K is not symmetric positive definite: models are drawn with that.
    pub fn new(model: &Model) -> Self {
        let n = model.matrices.mass.len();
        let mass: Vec<f64> = (0..n).map(|i| model.matrices.mass[i][i]).collect();
        let stiffness = Mat::from_fn(n, n, |i, j| model.matrices.stiffness[i][j]);
        let scaled = Mat::from_fn(n, n, |i, j| stiffness[(i, j)] / (mass[i] * mass[j]).sqrt());
        let eigen = scaled.self_adjoint_eigen(Side::Lower).expect("stiffness matrices are finite");
        let frequencies: Vec<f64> = (0..n).map(|j| eigen.S().column_vector()[j].sqrt()).collect();
        let shapes = Mat::from_fn(n, n, |i, j| eigen.U()[(i, j)] / mass[i].sqrt());
        let ratio = model.damping.default_ratio;
        let damping = Mat::from_fn(n, n, |i, j| {
            let modes = (0..n).map(|l| shapes[(i, l)] * 2.0 * ratio * frequencies[l] * shapes[(j, l)]);
            mass[i] * modes.sum::<f64>() * mass[j]
        });
        let elements =
            model.laws.iter().map(|element| (vector(&element.coefficients, n), element.law.clone())).collect();
        let monitor = (0..n).position(|i| model.monitors.first() == Some(&dof(i))).unwrap_or(0);
        let (forcing, harmonic) = (vector(&model.forcing.shape.dofs, n), model.forcing.harmonic);
        Self { mass, stiffness, damping, ratio, frequencies, shapes, forcing, harmonic, monitor, elements }
    }

    /// Number of dofs n.
    pub fn size(&self) -> usize {
        self.mass.len()
    }

    /// Whether every motion has a mirror image.
    pub fn is_odd(&self) -> bool {
        self.elements.iter().all(|(_, law)| law.is_odd())
    }
}

fn vector(coefficients: &BTreeMap<String, f64>, n: usize) -> Vec<f64> {
    (0..n).map(|i| coefficients.get(&dof(i)).copied().unwrap_or(0.0)).collect()
}
