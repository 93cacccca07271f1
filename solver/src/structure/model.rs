//! The model: what all of the numerics ask.

use super::laws::{Law, LawKind, RigidContact};
use crate::linalg::Matrix;
use num_complex::Complex64;

/// A linear structure with nonlinear elements and one forcing shape, n dofs. It is always valid.
#[derive(Debug, Clone)]
pub struct Model {
    pub(super) name: String,
    pub(super) dofs: Vec<String>,
    pub(super) mass: Matrix,
    pub(super) stiffness: Matrix,
    pub(super) modes: Modes,
    pub(super) damping: Damping,
    pub(super) damped: Vec<Option<DampedMode>>,
    pub(super) forcing: Forcing,
    pub(super) elements: Vec<Element>,
    pub(super) monitors: Vec<usize>,
}

/// Undamped linear modes.
#[derive(Debug, Clone)]
pub struct Modes {
    /// Eigenfrequencies ω_j, ascending, rad/s.
    pub frequencies: Vec<f64>,
    /// Mass-normalised mode shapes Φ, n × n, one column per mode.
    pub shapes: Matrix,
}

/// A mode of which the forcing has less than this share of what it has of another is not driven.
const DRIVEN: f64 = 1e-9;

/// Eigenfrequencies below this share of the highest one are those of rigid-body modes.
const RIGID: f64 = 1e-6;

impl Modes {
    /// Whether mode `j`, from 0, moves the structure without deforming it, as far as eigenfrequencies tell.
    ///
    /// # Panics
    /// If there is no such mode.
    pub fn is_rigid(&self, j: usize) -> bool {
        self.frequencies[j] <= RIGID * self.frequencies[self.frequencies.len() - 1]
    }

    /// The lowest mode that deforms the structure, from 0.
    pub fn lowest_deforming(&self) -> Option<usize> {
        (0..self.frequencies.len()).find(|&j| !self.is_rigid(j))
    }

    /// Displacement bᵀΦ_j along dofs with factors in every mode, kg^-½.
    pub fn along<'m>(&'m self, direction: &'m [(usize, f64)]) -> impl Iterator<Item = f64> + 'm {
        (0..self.frequencies.len()).map(move |j| direction.iter().map(|&(dof, b)| b * self.shapes[(dof, j)]).sum())
    }
}

/// Damping in modal coordinates, Ĉ = Φᵀ C Φ.
#[derive(Debug, Clone)]
pub enum Damping {
    /// Diagonal: 2 ξ_j ω_j per mode, 1/s.
    Modal(Vec<f64>),
    /// Full n × n matrix, 1/s.
    Full(Matrix),
}

/// A free motion that oscillates while it decays, Re y exp(λt), λ = −decay + i omega.
#[derive(Debug, Clone, PartialEq)]
pub struct DampedMode {
    /// Frequency, rad/s, above zero.
    pub omega: f64,
    /// Decay rate, 1/s; negative where it grows.
    pub decay: f64,
    /// Shape y, n modal amplitudes, the mode's own −i.
    pub shape: Vec<Complex64>,
}

impl DampedMode {
    /// |λ|, rad/s.
    pub fn natural(&self) -> f64 {
        self.omega.hypot(self.decay)
    }

    /// Damping ratio, −Re λ / |λ|.
    pub fn ratio(&self) -> f64 {
        self.decay / self.natural()
    }
}

/// Share of the largest entry of a matrix that is rounding.
const ROUNDING: f64 = 1e-12;

impl Damping {
    /// The diagonal of Ĉ, if nothing couples the modes.
    pub fn uncoupled(&self) -> Option<&[f64]> {
        match self {
            Self::Modal(rates) => Some(rates),
            Self::Full(_) => None,
        }
    }

    /// Ĉ_jj, 1/s.
    pub fn diagonal(&self, j: usize) -> f64 {
        self.entry(j, j)
    }

    /// Ĉ_jj of every mode, 1/s; of a matrix zero where that is no more than rounding of its largest entry.
    pub fn rates(&self) -> Vec<f64> {
        match self {
            Self::Modal(rates) => rates.clone(),
            Self::Full(matrix) => {
                let largest = self.entries().map(|(_, _, entry)| entry.abs()).fold(0.0, f64::max);
                let rounded = |rate: f64| if rate.abs() > ROUNDING * largest { rate } else { 0.0 };
                (0..matrix.rows()).map(|j| rounded(matrix[(j, j)])).collect()
            }
        }
    }

    /// Ĉ_ij, 1/s.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        match self {
            Self::Modal(rates) if i == j => rates[i],
            Self::Modal(_) => 0.0,
            Self::Full(matrix) => matrix[(i, j)],
        }
    }

    /// The entries (i, j, Ĉ_ij) that can differ from zero, row by row.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let (n, coupled) = match self {
            Self::Modal(rates) => (rates.len(), false),
            Self::Full(matrix) => (matrix.rows(), true),
        };
        let columns = move |i| if coupled { 0..n } else { i..i + 1 };
        (0..n).flat_map(move |i| columns(i).map(move |j| (i, j, self.entry(i, j))))
    }

    /// Ĉ as a matrix, n × n.
    pub fn matrix(&self) -> Matrix {
        match self {
            Self::Modal(rates) => Matrix::diagonal(rates),
            Self::Full(matrix) => matrix.clone(),
        }
    }

    /// Ĉ v, v a velocity in modal coordinates.
    pub fn times(&self, v: &[f64]) -> Vec<f64> {
        match self {
            Self::Modal(rates) => rates.iter().zip(v).map(|(c, v)| c * v).collect(),
            Self::Full(matrix) => matrix.mul_vec(v),
        }
    }

    /// (Ĉ y)_j of complex modal amplitudes.
    pub fn row_times(&self, j: usize, y: &[Complex64]) -> Complex64 {
        match self {
            Self::Modal(rates) => rates[j] * y[j],
            Self::Full(matrix) => matrix.row(j).iter().zip(y).map(|(c, y)| c * y).sum(),
        }
    }
}

/// External force f(t) = A s cos(mωt).
#[derive(Debug, Clone)]
pub struct Forcing {
    /// Shape s, n entries, N per unit of the dimensionless amplitude A.
    pub shape: Vec<f64>,
    /// Harmonic m of the response that the forcing acts on, ≥ 1.
    pub harmonic: usize,
}

/// A nonlinear element: a law acting on relative displacements.
#[derive(Debug, Clone)]
pub struct Element {
    /// Name shown to people (a contact node, say).
    pub name: String,
    /// One relative displacement bᵀx per argument of the law: (dof, coefficient) pairs.
    /// A force on an argument acts on the structure along the same b.
    pub channels: Vec<Vec<(usize, f64)>>,
    /// The law.
    pub law: LawKind,
}

/// A rigid contact of a model.
#[derive(Debug, Clone, Copy)]
pub struct ContactElement<'m> {
    /// The element.
    pub element: &'m Element,
    /// What its law is made of.
    pub law: RigidContact<'m>,
    /// Number of its first argument, its normal, among the arguments of all laws.
    pub first: usize,
}

impl Model {
    /// The same structure with its force on another harmonic of the motion, from 1.
    #[must_use]
    pub(crate) fn with_force_on(&self, harmonic: usize) -> Self {
        let mut model = self.clone();
        model.forcing.harmonic = harmonic;
        model
    }

    /// Number of dofs n, 1 or more.
    pub fn size(&self) -> usize {
        self.dofs.len()
    }

    /// Name shown to people.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Names of the n dofs.
    pub fn dofs(&self) -> &[String] {
        &self.dofs
    }

    /// Mass matrix M, n × n, kg.
    pub fn mass(&self) -> &Matrix {
        &self.mass
    }

    /// Stiffness matrix K, n × n, N/m.
    pub fn stiffness(&self) -> &Matrix {
        &self.stiffness
    }

    /// Linear modes of (K, M).
    pub fn modes(&self) -> &Modes {
        &self.modes
    }

    /// Damping in modal coordinates.
    pub fn damping(&self) -> &Damping {
        &self.damping
    }

    /// The free motion of every mode with its damping, as far as it oscillates.
    pub fn damped_modes(&self) -> &[Option<DampedMode>] {
        &self.damped
    }

    /// Where mode `j` resonates, |λ|, rad/s, and how fast its free motion decays, −Re λ, 1/s; of one that does not oscillate what they would
    /// be if nothing coupled it.
    ///
    /// # Panics
    /// If there is no such mode.
    pub fn resonance(&self, j: usize) -> (f64, f64) {
        match (&self.damping, &self.damped[j]) {
            (Damping::Full(_), Some(motion)) => (motion.natural(), motion.decay),
            _ => (self.modes.frequencies[j], 0.5 * self.damping.diagonal(j)),
        }
    }

    /// Forcing shape and harmonic.
    pub fn forcing(&self) -> &Forcing {
        &self.forcing
    }

    /// Shape of the forcing in modal coordinates Φᵀs, n entries, N/kg^½ per unit of A.
    pub fn modal_force(&self) -> Vec<f64> {
        self.modes.shapes.transpose().mul_vec(&self.forcing.shape)
    }

    /// Modes that vibrate and that the force drives, from 0, ascending.
    pub fn driven(&self) -> Vec<usize> {
        let force = self.modal_force();
        let largest = force.iter().fold(0.0_f64, |largest, f| largest.max(f.abs()));
        let is_driven = |&mode: &usize| !self.modes.is_rigid(mode) && force[mode].abs() > DRIVEN * largest;
        (0..self.size()).filter(is_driven).collect()
    }

    /// The mode that is followed first unless it is chosen, from 0: the lowest that deforms the structure and that the force drives, or
    /// the lowest that deforms it if the force drives none.
    pub fn primary_mode(&self) -> Option<usize> {
        self.driven().first().copied().or_else(|| self.modes.lowest_deforming())
    }

    /// Nonlinear elements.
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// Dofs whose amplitude is reported, one or more; the first one is the one that plots and bounds use.
    pub fn monitors(&self) -> &[usize] {
        &self.monitors
    }

    /// Number of arguments of all laws.
    pub fn arguments(&self) -> usize {
        self.elements.iter().map(|element| element.law.arguments()).sum()
    }

    /// The elements, each with the number of its first argument among the arguments of all laws.
    pub fn numbered(&self) -> impl Iterator<Item = (usize, &Element)> {
        self.elements.iter().scan(0, |next, element| {
            let first = *next;
            *next += element.law.arguments();
            Some((first, element))
        })
    }

    /// The rigid contacts, in the order of the elements.
    pub fn contacts(&self) -> impl Iterator<Item = ContactElement<'_>> {
        let contact = |(first, element): (usize, _)| {
            let element: &Element = element;
            element.law.rigid().map(|law| ContactElement { element, law, first })
        };
        self.numbered().filter_map(contact)
    }
}
