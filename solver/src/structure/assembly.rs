//! Checked matrices and modes, and the last steps to a [`Model`].

use super::damped::damped_modes;
use super::error::{ModelError, Place};
use super::validation::{at_least_zero, check_elements, check_force, check_harmonic, check_monitors, check_ratio};
use super::validation::{duplicate, symmetric};
use super::{Damping, Element, Forcing, Model, Modes};
use crate::linalg::{LinalgError, Matrix, symmetric_eigen};

/// The ways to give damping.
#[derive(Debug, Clone)]
pub(crate) enum DampingSource {
    /// Modal damping ratios ξ_j, 0 ≤ ξ < 1, one per mode: C = M Φ diag(2 ξ_j ω_j) Φᵀ M.
    Ratios(Vec<f64>),
    /// C = mass · M + stiffness · K, in 1/s and s.
    Rayleigh { mass: f64, stiffness: f64 },
    /// Symmetric n × n matrix C, N·s/m.
    Matrix(Matrix),
}

/// The ways to give the forcing shape s, in N per unit of amplitude; modes count from 1.
#[derive(Debug, Clone)]
pub(crate) enum ForcingSource {
    /// s = M Φ_j: forces mode j alone.
    Mode(usize),
    /// s = Φ_j.
    ModeShape(usize),
    /// The n entries of s.
    Vector(Vec<f64>),
}

/// Matrices that belong together, with their modes.
pub(crate) struct Structure {
    pub dofs: Vec<String>,
    pub mass: Matrix,
    pub stiffness: Matrix,
    pub modes: Modes,
}

/// Everything else, with dof numbers instead of names.
pub(crate) struct Rest {
    pub name: String,
    pub damping: DampingSource,
    pub shape: ForcingSource,
    pub harmonic: usize,
    pub elements: Vec<Element>,
    pub monitors: Vec<usize>,
}

impl Structure {
    /// Checks matrices and names, symmetrises, computes the modes.
    ///
    /// # Errors
    /// Matrices of other sizes, not finite, not symmetric or not definite; names that are too few, too many or given twice.
    pub fn new(dofs: Vec<String>, mass: Matrix, stiffness: Matrix) -> Result<Self, ModelError> {
        let (mass_place, stiffness_place) = (Place::key("matrices.mass"), Place::key("matrices.stiffness"));
        let n = mass.rows();
        if n == 0 || n != mass.cols() {
            let expected = "but it must be square, with at least one dof".into();
            return Err(ModelError::Size { place: mass_place, rows: n, cols: mass.cols(), expected });
        }
        // Names and stiffness agree: it is the mass that is wrong.
        if dofs.len() != n && dofs.len() == stiffness.rows() {
            let expected = format!("but `dofs` names {0}, and the stiffness matrix is {0} × {0}", dofs.len());
            return Err(ModelError::Size { place: mass_place, rows: n, cols: n, expected });
        }
        let mass = symmetric("matrices.mass", mass, n)?;
        let stiffness = symmetric("matrices.stiffness", stiffness, n)?;
        let dofs = if dofs.is_empty() { (1..=n).map(|i| format!("x{i}")).collect() } else { dofs };
        if dofs.len() != n {
            let remedy = format!("{} names for {n} dofs; give one name per row of the mass matrix", dofs.len());
            return Err(ModelError::value(Place::key("dofs"), format!("[{}]", dofs.join(", ")), remedy));
        }
        if let Some(name) = duplicate(dofs.iter()) {
            return Err(ModelError::Duplicate { place: Place::key("dofs"), what: "dof", name });
        }
        let (values, shapes) = symmetric_eigen(&stiffness, &mass).map_err(|error| match error {
            LinalgError::NotPositiveDefinite(minor) => ModelError::MassNotPositive {
                place: mass_place,
                minor,
                dof: dofs[minor - 1].clone(),
                diagonal: mass[(minor - 1, minor - 1)],
            },
            _ => ModelError::NoModes { place: stiffness_place.clone() },
        })?;
        if values.iter().chain(shapes.entries()).any(|v| !v.is_finite()) {
            return Err(ModelError::NoModes { place: stiffness_place });
        }
        let largest = values.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
        if let Some(&value) = values.iter().find(|&&v| v < -1e-9 * largest) {
            return Err(ModelError::StiffnessNegative { place: stiffness_place, value, largest });
        }
        let frequencies = values.iter().map(|v| v.max(0.0).sqrt()).collect();
        Ok(Self { dofs, mass, stiffness, modes: Modes { frequencies, shapes } })
    }

    /// Number of dofs.
    pub fn size(&self) -> usize {
        self.dofs.len()
    }

    /// Largest diagonal entry of the stiffness condensed statically on the displacements bᵀx, N/m.
    ///
    /// Computed from the flexibility F = B K⁻¹ Bᵀ and its pseudo-inverse, but no entry less than 1/F_cc, the stiffness condensed on that
    /// direction alone: where directions depend on each other, as those of a stop on either side or of a ring of stops, the pseudo-inverse
    /// shares it out among them. Rigid-body modes, whose flexibility is infinite, are given the first flexible frequency.
    pub fn condensed_stiffness(&self, directions: &[&[(usize, f64)]]) -> Option<f64> {
        let Modes { frequencies, shapes } = &self.modes;
        let highest = frequencies.last().copied().unwrap_or(0.0);
        let first = *frequencies.iter().find(|&&w| w > 1e-6 * highest)?;
        let modal = Matrix::from_fn(directions.len(), self.size(), |c, j| {
            let displacement: f64 = directions[c].iter().map(|&(i, b)| b * shapes[(i, j)]).sum();
            displacement / frequencies[j].max(first)
        });
        let flexibility = modal.matmul(&modal.transpose());
        let m = directions.len();
        let (values, vectors) = symmetric_eigen(&flexibility, &Matrix::diagonal(&vec![1.0; m])).ok()?;
        let threshold = 1e-12 * values.last()?;
        let shared = |c: usize| -> f64 {
            (0..m).filter(|&k| values[k] > threshold).map(|k| vectors[(c, k)].powi(2) / values[k]).sum()
        };
        let alone = |c: usize| if flexibility[(c, c)] > threshold { 1.0 / flexibility[(c, c)] } else { 0.0 };
        (0..m)
            .map(|c| shared(c).max(alone(c)))
            .max_by(|a: &f64, b| a.total_cmp(b))
            .filter(|epsilon| epsilon.is_finite() && *epsilon > 0.0)
    }

    /// Numerical stiffness of rigid contacts that do not give their own, N/m: the stiffness condensed on all normals.
    ///
    /// # Errors
    /// If the normals meet no stiffness.
    pub fn default_epsilon(&self, normals: &[&[(usize, f64)]]) -> Result<f64, ModelError> {
        self.condensed_stiffness(normals).ok_or_else(|| {
            let remedy = "no default can be derived, the contact normals meet no stiffness; give a value in N/m";
            ModelError::missing(Place::key("contact.epsilon"), remedy)
        })
    }

    /// The dof of this name; `key` is where it is asked for.
    ///
    /// # Errors
    /// If there is none, with the names that look like it.
    pub fn dof(&self, name: &str, key: impl FnOnce() -> String) -> Result<usize, ModelError> {
        let known = || self.dofs.iter().map(String::as_str);
        let place = || Place::key(key());
        known().position(|dof| dof == name).ok_or_else(|| ModelError::unknown(place(), "dof", name, known()))
    }

    /// The model, once everything else is checked too.
    ///
    /// # Errors
    /// Damping, forcing, elements or monitored dofs that do not fit, or are out of their range.
    pub fn complete(mut self, rest: Rest) -> Result<Model, ModelError> {
        let n = self.size();
        let monitors = if rest.monitors.is_empty() { vec![0] } else { rest.monitors };
        check_monitors(&monitors, n)?;
        self.orient(monitors[0]);
        let damping = self.damping(rest.damping)?;
        let shape = self.force(rest.shape)?;
        check_harmonic(rest.harmonic)?;
        check_elements(&rest.elements, n)?;
        Ok(Model {
            name: rest.name,
            dofs: self.dofs,
            mass: self.mass,
            stiffness: self.stiffness,
            damped: damped_modes(&self.modes, &damping),
            modes: self.modes,
            damping,
            forcing: Forcing { shape, harmonic: rest.harmonic },
            elements: rest.elements,
            monitors,
        })
    }

    /// Gives every mode the sign that makes `dof` positive, or its largest component if `dof` hardly moves: results
    /// must not depend on what an eigenvalue routine happens to return.
    fn orient(&mut self, dof: usize) {
        let shapes = &mut self.modes.shapes;
        for j in 0..shapes.cols() {
            let phi = shapes.column(j);
            let largest = phi.iter().copied().fold(0.0_f64, |a, b| if b.abs() > a.abs() { b } else { a });
            let reference = if phi[dof].abs() > 1e-6 * largest.abs() { phi[dof] } else { largest };
            if reference < 0.0 {
                for i in 0..shapes.rows() {
                    shapes[(i, j)] = -shapes[(i, j)];
                }
            }
        }
    }

    fn damping(&self, parts: DampingSource) -> Result<Damping, ModelError> {
        let n = self.size();
        let frequencies = &self.modes.frequencies;
        match parts {
            DampingSource::Ratios(ratios) => {
                if ratios.len() != n {
                    let remedy = format!("{} ratios for {n} modes; give one for each", ratios.len());
                    return Err(ModelError::value(Place::key("damping.ratios"), format!("{ratios:?}"), remedy));
                }
                for &ratio in &ratios {
                    check_ratio(Place::key("damping.ratios"), ratio)?;
                }
                Ok(Damping::Modal(ratios.iter().zip(frequencies).map(|(xi, w)| 2.0 * xi * w).collect()))
            }
            DampingSource::Rayleigh { mass, stiffness } => {
                at_least_zero(Place::key("damping.rayleigh.mass"), mass, "1/s")?;
                at_least_zero(Place::key("damping.rayleigh.stiffness"), stiffness, "s")?;
                Ok(Damping::Modal(frequencies.iter().map(|w| mass + stiffness * w * w).collect()))
            }
            DampingSource::Matrix(matrix) => {
                let matrix = symmetric("matrices.damping", matrix, n)?;
                let shapes = &self.modes.shapes;
                let modal = shapes.transpose().matmul(&matrix.matmul(shapes));
                let diagonal: Vec<f64> = (0..n).map(|j| modal[(j, j)]).collect();
                let largest = diagonal.iter().fold(0.0_f64, |a, d| a.max(d.abs()));
                // Round-off of the two products is far below this, couplings that matter are far above.
                let diagonalised = (0..n).all(|i| (0..n).all(|j| i == j || modal[(i, j)].abs() <= 1e-12 * largest));
                Ok(if diagonalised { Damping::Modal(diagonal) } else { Damping::Full(modal) })
            }
        }
    }

    fn force(&self, shape: ForcingSource) -> Result<Vec<f64>, ModelError> {
        let n = self.size();
        let mode = |number: usize, key| match number {
            1.. if number <= n => Ok(self.modes.shapes.column(number - 1)),
            _ => {
                let remedy = format!("there is no such mode; modes are numbered 1 to {n}");
                Err(ModelError::value(Place::key(key), number, remedy))
            }
        };
        let force = match shape {
            ForcingSource::Mode(number) => self.mass.mul_vec(&mode(number, "forcing.shape.mode")?),
            ForcingSource::ModeShape(number) => mode(number, "forcing.shape.mode_shape")?,
            ForcingSource::Vector(force) => force,
        };
        check_force(&force, &self.dofs)?;
        Ok(force)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::dot;

    fn chain(n: usize) -> Structure {
        let stiffness = Matrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        });
        Structure::new(vec![], Matrix::diagonal(&vec![1.0; n]), stiffness).unwrap()
    }

    #[test]
    fn stiffness_condensed_on_one_dof_is_a_schur_complement() {
        // Two springs of stiffness 1 on the right of the last mass in series with one each: 1 + 1/2 for n = 2.
        let structure = chain(2);
        let epsilon = structure.condensed_stiffness(&[&[(1, 1.0)]]).unwrap();
        assert!((epsilon - 1.5).abs() < 1e-14);
        // On all dofs nothing is condensed, and a stop on either side of one dof is not singular.
        let epsilon = structure.condensed_stiffness(&[&[(0, 1.0)], &[(1, 1.0)]]).unwrap();
        assert!((epsilon - 2.0).abs() < 1e-14);
        // A stop on either side is as stiff as one alone.
        let both = structure.condensed_stiffness(&[&[(1, 1.0)], &[(1, -1.0)]]).unwrap();
        let alone = structure.condensed_stiffness(&[&[(1, 1.0)]]).unwrap();
        assert!((both / alone - 1.0).abs() < 1e-12, "{both} {alone}");
        // And so are a ring of stops about two dofs that are alike, and a direction that comes with another factor, in any order.
        let isotropic = Structure::new(vec![], Matrix::diagonal(&[1.0; 2]), Matrix::diagonal(&[3.0; 2])).unwrap();
        let ring: Vec<Vec<(usize, f64)>> = (0..8)
            .map(|stop| std::f64::consts::TAU * f64::from(stop) / 8.0)
            .map(|angle| vec![(0, angle.cos()), (1, angle.sin())])
            .collect();
        let ring: Vec<&[(usize, f64)]> = ring.iter().map(Vec::as_slice).collect();
        assert!((isotropic.condensed_stiffness(&ring).unwrap() - 3.0).abs() < 1e-12);
        let once: &[(usize, f64)] = &[(0, 1.0)];
        let twice: &[(usize, f64)] = &[(0, 2.0)];
        for order in [[once, twice], [twice, once]] {
            assert!((isotropic.condensed_stiffness(&order).unwrap() - 3.0).abs() < 1e-12);
        }
    }

    #[test]
    fn modes_are_oriented_by_the_monitored_dof() {
        let mut structure = chain(3);
        structure.orient(1);
        // Dof 1 is a node of the second mode: its largest component decides.
        for j in [0, 2] {
            assert!(structure.modes.shapes[(1, j)] > 0.0);
        }
        let second = structure.modes.shapes.column(1);
        assert!(second[1].abs() < 1e-12);
        assert!(dot(&second, &structure.mass.mul_vec(&second)) > 0.999);
    }

    #[test]
    fn a_damping_matrix_is_modal_only_if_the_modes_diagonalise_it() {
        let structure = chain(3);
        let proportional = Matrix::from_fn(3, 3, |i, j| 0.1 * structure.stiffness[(i, j)]);
        let Damping::Modal(diagonal) = structure.damping(DampingSource::Matrix(proportional)).unwrap() else {
            panic!("stiffness-proportional damping is modal");
        };
        for (d, w) in diagonal.iter().zip(&structure.modes.frequencies) {
            assert!((d - 0.1 * w * w).abs() < 1e-14);
        }
        let local = DampingSource::Matrix(Matrix::diagonal(&[0.1, 0.0, 0.0]));
        assert!(matches!(structure.damping(local).unwrap(), Damping::Full(_)));
    }
}
