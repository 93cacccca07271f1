//! Checked matrices and modes, and the last steps to a [`Model`].

use super::error::{ModelError, Place};
use super::layers::Layers;
use super::parts::{DampingParts, ForcingShape, ModelParts};
use super::{Damping, Element, Forcing, Model, Modes};
use crate::linalg::{LinalgError, Matrix, symmetric_eigen};
use crate::structure::laws::{Law, LawKind};

impl Model {
    /// Model from matrices at hand, checked like one that is read from a folder.
    pub fn new(parts: ModelParts) -> Result<Self, ModelError> {
        let origin = Layers::default();
        let ModelParts { name, dofs, mass, stiffness, damping, shape, harmonic, elements, monitors } = parts;
        let mass = (origin.place("matrices.mass"), mass);
        let stiffness = (origin.place("matrices.stiffness"), stiffness);
        Structure::new(dofs, mass, stiffness, &origin)?
            .complete(Rest { name, damping, shape, harmonic, elements, monitors }, &origin)
    }
}

/// Matrices that belong together, with their modes.
pub(super) struct Structure {
    pub dofs: Vec<String>,
    pub mass: Matrix,
    pub stiffness: Matrix,
    pub modes: Modes,
}

/// Everything else, with dof numbers instead of names.
pub(super) struct Rest {
    pub name: String,
    pub damping: DampingParts,
    pub shape: ForcingShape,
    pub harmonic: usize,
    pub elements: Vec<Element>,
    pub monitors: Vec<usize>,
}

impl Structure {
    /// Checks matrices and names, symmetrises, computes the modes.
    pub fn new(
        dofs: Vec<String>,
        (mass_place, mass): (Place, Matrix),
        (stiffness_place, stiffness): (Place, Matrix),
        origin: &Layers,
    ) -> Result<Self, ModelError> {
        let n = mass.rows();
        if n == 0 || n != mass.cols() {
            let expected = "but it must be square, with at least one dof".into();
            return Err(ModelError::Size { place: mass_place, rows: n, cols: mass.cols(), expected });
        }
        let mass = symmetric(&mass_place, mass, n)?;
        let stiffness = symmetric(&stiffness_place, stiffness, n)?;
        let dofs = if dofs.is_empty() { (1..=n).map(|i| format!("x{i}")).collect() } else { dofs };
        if dofs.len() != n {
            let remedy = format!("{} names for {n} dofs; give one name per row of the mass matrix", dofs.len());
            return Err(ModelError::value(origin.place("dofs"), format!("[{}]", dofs.join(", ")), remedy));
        }
        if let Some(name) = duplicate(dofs.iter()) {
            return Err(ModelError::Duplicate { place: origin.place("dofs"), what: "dof", name });
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
    /// Computed from the flexibility B K⁻¹ Bᵀ and its pseudo-inverse, so that the same direction may come twice (a stop
    /// on either side). Rigid-body modes, whose flexibility is infinite, are given the first flexible frequency.
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
        (0..m)
            .map(|c| (0..m).filter(|&k| values[k] > threshold).map(|k| vectors[(c, k)].powi(2) / values[k]).sum())
            .max_by(|a: &f64, b| a.total_cmp(b))
            .filter(|epsilon| epsilon.is_finite() && *epsilon > 0.0)
    }

    /// The model, once everything else is checked too.
    pub fn complete(mut self, rest: Rest, origin: &Layers) -> Result<Model, ModelError> {
        let n = self.size();
        let monitors = if rest.monitors.is_empty() { vec![0] } else { rest.monitors };
        check_monitors(&monitors, n, origin)?;
        self.orient(monitors[0]);
        let damping = self.damping(rest.damping, origin)?;
        let shape = self.force(rest.shape, origin)?;
        check_harmonic(rest.harmonic, origin)?;
        check_elements(&rest.elements, n, origin)?;
        Ok(Model {
            name: rest.name,
            dofs: self.dofs,
            mass: self.mass,
            stiffness: self.stiffness,
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

    fn damping(&self, parts: DampingParts, origin: &Layers) -> Result<Damping, ModelError> {
        let n = self.size();
        let frequencies = &self.modes.frequencies;
        match parts {
            DampingParts::Ratios(ratios) => {
                if ratios.len() != n {
                    let remedy = format!("{} ratios for {n} modes; give one for each", ratios.len());
                    return Err(ModelError::value(origin.place("damping.ratios"), format!("{ratios:?}"), remedy));
                }
                for &ratio in &ratios {
                    check_ratio(origin.place("damping.ratios"), ratio)?;
                }
                Ok(Damping::Modal(ratios.iter().zip(frequencies).map(|(xi, w)| 2.0 * xi * w).collect()))
            }
            DampingParts::Rayleigh { mass, stiffness } => {
                at_least_zero(origin.place("damping.rayleigh.mass"), mass, "1/s")?;
                at_least_zero(origin.place("damping.rayleigh.stiffness"), stiffness, "s")?;
                Ok(Damping::Modal(frequencies.iter().map(|w| mass + stiffness * w * w).collect()))
            }
            DampingParts::Matrix(matrix) => {
                let matrix = symmetric(&origin.place("matrices.damping"), matrix, n)?;
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

    fn force(&self, shape: ForcingShape, origin: &Layers) -> Result<Vec<f64>, ModelError> {
        let n = self.size();
        let mode = |number: usize, key| match number {
            1.. if number <= n => Ok(self.modes.shapes.column(number - 1)),
            _ => {
                let remedy = format!("there is no such mode; modes are numbered 1 to {n}");
                Err(ModelError::value(origin.place(key), number, remedy))
            }
        };
        let force = match shape {
            ForcingShape::Mode(number) => self.mass.mul_vec(&mode(number, "forcing.shape.mode")?),
            ForcingShape::ModeShape(number) => mode(number, "forcing.shape.mode_shape")?,
            ForcingShape::Vector(force) => force,
        };
        check_force(&force, &self.dofs, origin)?;
        Ok(force)
    }
}

/// Refuses a matrix that is not n × n, finite and symmetric to 1e-8; removes the asymmetry that is left.
pub(super) fn symmetric(place: &Place, matrix: Matrix, n: usize) -> Result<Matrix, ModelError> {
    let (rows, cols) = (matrix.rows(), matrix.cols());
    if rows != n || cols != n {
        let expected = format!("but the mass matrix is {n} × {n}; M, K and C must have the same size");
        return Err(ModelError::Size { place: place.clone(), rows, cols, expected });
    }
    if let Some(at) = matrix.entries().iter().position(|v| !v.is_finite()) {
        let (row, col) = (at / n + 1, at % n + 1);
        return Err(ModelError::NotFinite { place: place.clone(), row, col, value: matrix.entries()[at] });
    }
    let largest = matrix.entries().iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    for i in 0..n {
        for j in 0..i {
            let (value, mirrored) = (matrix[(i, j)], matrix[(j, i)]);
            if (value - mirrored).abs() > 1e-8 * largest {
                let (row, col) = (i + 1, j + 1);
                return Err(ModelError::NotSymmetric { place: place.clone(), row, col, value, mirrored });
            }
        }
    }
    Ok(Matrix::from_fn(n, n, |i, j| 0.5 * (matrix[(i, j)] + matrix[(j, i)])))
}

/// The first name that comes twice.
pub(super) fn duplicate<'a>(names: impl IntoIterator<Item = &'a String>) -> Option<String> {
    let mut seen = std::collections::HashSet::new();
    names.into_iter().find(|&name| !seen.insert(name)).cloned()
}

pub(super) fn check_ratio(place: Place, ratio: f64) -> Result<(), ModelError> {
    let remedy = "a damping ratio must be at least 0 and below 1 (0.01 is one percent of critical)";
    if (0.0..1.0).contains(&ratio) { Ok(()) } else { Err(ModelError::value(place, ratio, remedy)) }
}

pub(super) fn at_least_zero(place: Place, value: f64, unit: &str) -> Result<(), ModelError> {
    let ok = value.is_finite() && value >= 0.0;
    if ok {
        Ok(())
    } else {
        Err(ModelError::value(place, value, format!("must be finite, zero or positive{}", in_unit(unit))))
    }
}

pub(super) fn above_zero(place: Place, value: f64, unit: &str) -> Result<(), ModelError> {
    let ok = value.is_finite() && value > 0.0;
    if ok {
        Ok(())
    } else {
        Err(ModelError::value(place, value, format!("must be finite and positive{}", in_unit(unit))))
    }
}

pub(super) fn check_sense(place: Place, sense: f64) -> Result<(), ModelError> {
    let remedy = "must be 1 or -1: the sign of the sliding velocity along the first tangential direction";
    if sense.abs() == 1.0 { Ok(()) } else { Err(ModelError::value(place, sense, remedy)) }
}

fn in_unit(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(", in {unit}") }
}

/// Refuses a force that is not one finite number per dof, or zero.
pub(super) fn check_force(force: &[f64], dofs: &[String], origin: &Layers) -> Result<(), ModelError> {
    let (n, place) = (dofs.len(), origin.place("forcing.shape"));
    if force.len() != n {
        let value = format!("{} entries", force.len());
        return Err(ModelError::value(place, value, format!("give {n}, one per dof, in N")));
    }
    if let Some(i) = force.iter().position(|f| !f.is_finite()) {
        let value = format!("{} on dof `{}`", force[i], dofs[i]);
        return Err(ModelError::value(place, value, "a force must be a finite number, in N"));
    }
    if force.iter().all(|&f| f == 0.0) {
        return Err(ModelError::NoForce { place });
    }
    Ok(())
}

pub(super) fn check_harmonic(harmonic: usize, origin: &Layers) -> Result<(), ModelError> {
    if harmonic > 0 {
        return Ok(());
    }
    Err(ModelError::value(origin.place("forcing.harmonic"), 0, "the harmonic must be 1 or more"))
}

pub(super) fn check_monitors(monitors: &[usize], n: usize, origin: &Layers) -> Result<(), ModelError> {
    let place = || origin.place("monitors");
    if monitors.is_empty() {
        return Err(ModelError::value(place(), "[]", "name at least one dof"));
    }
    match monitors.iter().find(|&&dof| dof >= n) {
        None => Ok(()),
        Some(dof) if n == 0 => Err(ModelError::value(place(), dof, "there is no dof")),
        Some(dof) => Err(ModelError::value(place(), dof, format!("dofs count from 0 to {}", n - 1))),
    }
}

/// Refuses a name that comes twice, and elements that do not fit `n` dofs.
pub(super) fn check_elements(elements: &[Element], n: usize, origin: &Layers) -> Result<(), ModelError> {
    if let Some(name) = duplicate(elements.iter().map(|element| &element.name)) {
        return Err(ModelError::Duplicate { place: origin.place("elements"), what: "nonlinear element", name });
    }
    elements.iter().try_for_each(|element| check_element(element, n, origin))
}

fn check_element(element: &Element, n: usize, origin: &Layers) -> Result<(), ModelError> {
    let place = |key: &str| origin.place(format!("elements.{}.{key}", element.name));
    for channel in &element.channels {
        if let Some((dof, b)) = channel.iter().find(|(dof, b)| *dof >= n || !b.is_finite()) {
            let remedy = format!("expected a dof counted from 0 to {} and a finite coefficient", n - 1);
            return Err(ModelError::value(place("channels"), format!("({dof}, {b})"), remedy));
        }
    }
    // A second tangential direction may be missing; a first argument that never moves would switch the law off.
    if element.channels.first().is_none_or(|channel| channel.iter().all(|(_, b)| *b == 0.0)) {
        let remedy = "the law acts on no dof; give it one with a coefficient other than zero";
        return Err(ModelError::value(place("channels"), "[]", remedy));
    }
    let (given, needed) = (element.channels.len(), element.law.arguments());
    if given != needed {
        return Err(ModelError::value(place("channels"), given, format!("this law acts on {needed} displacements")));
    }
    check_law(&element.law, place)
}

/// Refuses parameters that are out of range; `place` finds the place of one.
pub(super) fn check_law(law: &LawKind, place: impl Fn(&str) -> Place) -> Result<(), ModelError> {
    law.validate().map_err(|e| ModelError::value(place(e.parameter), e.value, format!("expected {}", e.expected)))
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
        let origin = Layers::default();
        let mass = Matrix::diagonal(&vec![1.0; n]);
        Structure::new(vec![], (origin.place("m"), mass), (origin.place("k"), stiffness), &origin).unwrap()
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
        assert!(structure.condensed_stiffness(&[&[(1, 1.0)], &[(1, -1.0)]]).unwrap() > 0.0);
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
        let origin = Layers::default();
        let Damping::Modal(diagonal) = structure.damping(DampingParts::Matrix(proportional), &origin).unwrap() else {
            panic!("stiffness-proportional damping is modal");
        };
        for (d, w) in diagonal.iter().zip(&structure.modes.frequencies) {
            assert!((d - 0.1 * w * w).abs() < 1e-14);
        }
        let local = DampingParts::Matrix(Matrix::diagonal(&[0.1, 0.0, 0.0]));
        assert!(matches!(structure.damping(local, &origin).unwrap(), Damping::Full(_)));
    }
}
