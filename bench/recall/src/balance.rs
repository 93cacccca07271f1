//! Harmonic balance of a structure: residual and Jacobian, all dofs kept.
//!
//! The unknown y holds, dof by dof, the coefficients of 1, cos τ, sin τ, cos 2τ, … (τ = ωt), in m, and ω in rad/s at
//! the end.

use crate::model::Law;
use crate::quadrature::{Nodes, dot, norm};
use crate::structure::Structure;
use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::{Col, Mat};
use std::borrow::Cow;

/// Instants a period, times the number of harmonics, at which polynomials up to the seventh power are integrated
/// exactly.
const INSTANTS: usize = 8;

/// Instants, times the number of harmonics, of the grid on which arcs of contact are found.
const GRID: usize = 32;

/// The balance at one forcing amplitude.
#[derive(Debug, Clone)]
pub struct Balance<'s> {
    /// The structure.
    pub structure: &'s Structure,
    /// Forcing amplitude A.
    pub forcing: f64,
    harmonics: usize,
    even: Nodes,
    grid: Nodes,
}

/// Residual of the balance with its derivatives.
#[derive(Debug, Clone)]
pub struct Evaluation {
    /// R, N.
    pub residual: Vec<f64>,
    /// ∂R/∂y, a column more than rows.
    pub jacobian: Mat<f64>,
}

/// Least residual, of the forces at work, that rounding allows to ask for.
const CONVERGED: f64 = 1e-11;

impl<'s> Balance<'s> {
    /// With harmonics 0 to `harmonics`.
    pub fn new(structure: &'s Structure, harmonics: usize, forcing: f64) -> Self {
        let even = Nodes::even(INSTANTS * harmonics, harmonics);
        Self { structure, forcing, harmonics, even, grid: Nodes::even(GRID * harmonics, harmonics) }
    }

    /// Number of harmonics H.
    pub fn harmonics(&self) -> usize {
        self.harmonics
    }

    /// Coefficients of a series, 2H + 1.
    pub fn width(&self) -> usize {
        2 * self.harmonics + 1
    }

    /// Number of equations.
    pub fn size(&self) -> usize {
        self.structure.size() * self.width()
    }

    /// Series of a sum of displacements.
    pub fn series(&self, y: &[f64], direction: &[f64]) -> Vec<f64> {
        let mut series = vec![0.0; self.width()];
        for (own, factor) in y.chunks(self.width()).zip(direction) {
            series.iter_mut().zip(own).for_each(|(sum, own)| *sum += factor * own);
        }
        series
    }

    /// Largest absolute value of a series over a period.
    pub fn largest(&self, series: &[f64]) -> f64 {
        (0..self.grid.weights.len()).map(|q| dot(self.grid.at(q), series).abs()).fold(0.0, f64::max)
    }

    /// Residual and Jacobian at y.
    pub fn evaluate(&self, y: &[f64]) -> Evaluation {
        let size = self.size();
        let mut at = Evaluation { residual: vec![0.0; size], jacobian: Mat::zeros(size, size + 1) };
        self.add_linear(y, &mut at);
        for (direction, law) in &self.structure.elements {
            self.add_element(y, direction, law, &mut at);
        }
        at
    }

    /// Scaled residual at or below which y has converged.
    pub fn is_converged(&self, y: &[f64], residual: &[f64]) -> bool {
        let size = self.size();
        let highest = self.structure.frequencies.last().copied().unwrap_or(1.0);
        norm(residual) <= CONVERGED * (self.forcing + highest * highest * norm(&y[..size]))
    }

    fn add_linear(&self, y: &[f64], at: &mut Evaluation) {
        let (n, width, size, omega) = (self.structure.size(), self.width(), self.size(), y[self.size()]);
        for i in 0..n {
            for l in 0..n {
                let stiffness = self.structure.stiffness[(i, l)];
                let damping = self.structure.damping[(i, l)];
                let mass = if i == l { self.structure.mass[i] } else { 0.0 };
                let (rows, x) = (i * width, &y[l * width..(l + 1) * width]);
                at.residual[rows] += stiffness * x[0];
                at.jacobian[(rows, l * width)] += stiffness;
                for k in 1..=self.harmonics {
                    let rate = k as f64 * omega;
                    let (own, cross) = (stiffness - rate * rate * mass, rate * damping);
                    let (own_rate, cross_rate) = (-2.0 * k as f64 * rate * mass, k as f64 * damping);
                    let (c, s) = (2 * k - 1, 2 * k);
                    at.residual[rows + c] += own * x[c] + cross * x[s];
                    at.residual[rows + s] += own * x[s] - cross * x[c];
                    at.jacobian[(rows + c, l * width + c)] += own;
                    at.jacobian[(rows + c, l * width + s)] += cross;
                    at.jacobian[(rows + s, l * width + s)] += own;
                    at.jacobian[(rows + s, l * width + c)] -= cross;
                    at.jacobian[(rows + c, size)] += own_rate * x[c] + cross_rate * x[s];
                    at.jacobian[(rows + s, size)] += own_rate * x[s] - cross_rate * x[c];
                }
            }
            at.residual[i * width + 2 * self.structure.harmonic - 1] -= self.forcing * self.structure.forcing[i];
        }
    }

    fn add_element(&self, y: &[f64], direction: &[f64], law: &Law, at: &mut Evaluation) {
        let (width, size, omega) = (self.width(), self.size(), y[self.size()]);
        let series = self.series(y, direction);
        let nodes = match law.gap() {
            Some(gap) => Cow::Owned(Nodes::beyond(gap, &series, &self.grid)),
            None => Cow::Borrowed(&self.even),
        };
        let mut force = vec![0.0; width];
        let mut by_omega = vec![0.0; width];
        let mut by_series = vec![0.0; width * width];
        for (q, &weight) in nodes.weights.iter().enumerate() {
            let (basis, slopes) = (nodes.at(q), nodes.slope_at(q));
            let turning = dot(slopes, &series);
            let (f, by_u, by_v) = law.respond(dot(basis, &series), omega * turning);
            let gradient: Vec<f64> =
                basis.iter().zip(slopes).map(|(basis, slope)| by_u * basis + by_v * omega * slope).collect();
            for j in 0..width {
                let projection = weight * basis[j] / std::f64::consts::PI * if j == 0 { 0.5 } else { 1.0 };
                force[j] += projection * f;
                by_omega[j] += projection * by_v * turning;
                let row = &mut by_series[j * width..(j + 1) * width];
                row.iter_mut().zip(&gradient).for_each(|(sum, gradient)| *sum += projection * gradient);
            }
        }
        for (i, &to) in direction.iter().enumerate().filter(|(_, to)| **to != 0.0) {
            for j in 0..width {
                at.residual[i * width + j] += to * force[j];
                at.jacobian[(i * width + j, size)] += to * by_omega[j];
                for (l, &from) in direction.iter().enumerate().filter(|(_, from)| **from != 0.0) {
                    for k in 0..width {
                        at.jacobian[(i * width + j, l * width + k)] += to * from * by_series[j * width + k];
                    }
                }
            }
        }
    }
}

/// A factorised Jacobian, bordered by a row.
#[derive(Debug)]
pub struct Bordered(PartialPivLu<f64>);

impl Bordered {
    /// With the row that makes the system square.
    pub fn new(jacobian: &Mat<f64>, row: &[f64]) -> Self {
        let size = row.len();
        let matrix = Mat::from_fn(size, size, |i, j| if i + 1 < size { jacobian[(i, j)] } else { row[j] });
        Self(matrix.partial_piv_lu())
    }

    /// Solution for a right-hand side (`rest` belongs to the row); none where the matrix is singular.
    pub fn solve(&self, residual: Option<&[f64]>, rest: f64, size: usize) -> Option<Vec<f64>> {
        let mut right = Col::from_fn(size + 1, |i| if i < size { residual.map_or(0.0, |r| -r[i]) } else { rest });
        self.0.solve_in_place(&mut right);
        let solution: Vec<f64> = right.iter().copied().collect();
        solution.iter().all(|value| value.is_finite()).then_some(solution)
    }

    /// Unit tangent, on the side of the row.
    pub fn tangent(&self, size: usize) -> Option<Vec<f64>> {
        let tangent = self.solve(None, 1.0, size)?;
        let length = norm(&tangent);
        Some(tangent.into_iter().map(|t| t / length).collect())
    }
}
