//! A model built in code.

use super::assembly::{DampingSource, ForcingSource, Rest, Structure};
use super::error::{ModelError, Place};
use super::laws::{Contact, Law, LawKind};
use super::validation::check_channels;
use super::{Element, Model};
use crate::linalg::Matrix;

/// Damping ratio of every mode unless another damping is given.
pub const DEFAULT_RATIO: f64 = 0.01;

/// A dof, by name or counted from 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Dof {
    /// By name.
    Name(String),
    /// Counted from 0.
    Index(usize),
}

impl From<&str> for Dof {
    fn from(name: &str) -> Self {
        Self::Name(name.into())
    }
}

impl From<usize> for Dof {
    fn from(index: usize) -> Self {
        Self::Index(index)
    }
}

/// A relative displacement bᵀx that a law takes as an argument: a dof, or pairs of a dof and its coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel(Vec<(Dof, f64)>);

impl From<&str> for Channel {
    fn from(name: &str) -> Self {
        Self(vec![(name.into(), 1.0)])
    }
}

impl From<usize> for Channel {
    fn from(index: usize) -> Self {
        Self(vec![(index.into(), 1.0)])
    }
}

impl<D: Into<Dof>, const N: usize> From<[(D, f64); N]> for Channel {
    fn from(terms: [(D, f64); N]) -> Self {
        Self(terms.into_iter().map(|(dof, b)| (dof.into(), b)).collect())
    }
}

impl<D: Into<Dof>> From<Vec<(D, f64)>> for Channel {
    fn from(terms: Vec<(D, f64)>) -> Self {
        Self(terms.into_iter().map(|(dof, b)| (dof.into(), b)).collect())
    }
}

#[derive(Debug, Clone)]
enum Damping {
    Ratio(f64),
    Other(DampingSource),
}

#[derive(Debug, Clone)]
enum Force {
    Shape(ForcingSource),
    Dofs(Vec<(Dof, f64)>),
}

#[derive(Debug, Clone)]
enum PartLaw {
    Given(LawKind),
    /// A rigid contact that takes the default of ε.
    Stop {
        gap: f64,
    },
}

#[derive(Debug, Clone)]
struct Part {
    name: String,
    law: PartLaw,
    channels: Vec<Channel>,
}

impl Part {
    /// The displacements of its law, by numbers of dofs.
    fn resolved(&self, structure: &Structure) -> Result<Vec<Vec<(usize, f64)>>, ModelError> {
        let term = |(dof, b): &(Dof, f64)| match dof {
            Dof::Name(dof) => Ok((structure.dof(dof, || format!("elements.{}.channels", self.name))?, *b)),
            Dof::Index(index) => Ok((*index, *b)),
        };
        let channels = self.channels.iter().map(|Channel(terms)| terms.iter().map(term).collect());
        let channels = channels.collect::<Result<Vec<Vec<_>>, ModelError>>()?;
        let arguments = match &self.law {
            PartLaw::Given(law) => law.arguments(),
            PartLaw::Stop { .. } => 1,
        };
        check_channels(&self.name, &channels, arguments, structure.size())?;
        Ok(channels)
    }

    fn is_rigid(&self) -> bool {
        match &self.law {
            PartLaw::Given(law) => law.rigid().is_some(),
            PartLaw::Stop { .. } => true,
        }
    }
}

/// A [`Model`] in the making, from [`Model::builder`]. SI units. What is not given has the default of model files: dofs
/// `x1` … `xn`, a damping ratio of 0.01, a force on mode 1 alone, harmonic 1, the first dof monitored.
///
/// A Duffing oscillator, ẍ + 0.02 ẋ + x + 0.5 x³ = A cos ωt:
///
/// ```
/// use solver::structure::Model;
/// use solver::structure::laws::{PolynomialSpring, Term};
///
/// let cubic = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 0.5 }] };
/// let model = Model::builder("Duffing")
///     .mass([[1.0]])
///     .stiffness([[1.0]])
///     .damping_ratio(0.01)
///     .force("x1", 1.0)
///     .element("cubic spring", cubic, ["x1"])
///     .build()?;
/// assert_eq!(model.modes().frequencies, [1.0]);
/// # Ok::<(), solver::structure::ModelError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ModelBuilder {
    name: String,
    dofs: Vec<String>,
    mass: Option<Matrix>,
    stiffness: Option<Matrix>,
    damping: Damping,
    force: Force,
    harmonic: usize,
    parts: Vec<Part>,
    monitors: Vec<Dof>,
}

impl Model {
    /// Starts a model of this name, shown to people.
    pub fn builder(name: impl Into<String>) -> ModelBuilder {
        ModelBuilder {
            name: name.into(),
            dofs: Vec::new(),
            mass: None,
            stiffness: None,
            damping: Damping::Ratio(DEFAULT_RATIO),
            force: Force::Shape(ForcingSource::Mode(1)),
            harmonic: 1,
            parts: Vec::new(),
            monitors: Vec::new(),
        }
    }
}

impl ModelBuilder {
    /// Mass matrix, n × n, symmetric positive definite, kg.
    #[must_use]
    pub fn mass(self, mass: impl Into<Matrix>) -> Self {
        Self { mass: Some(mass.into()), ..self }
    }

    /// Stiffness matrix, n × n, symmetric positive semi-definite, N/m.
    #[must_use]
    pub fn stiffness(self, stiffness: impl Into<Matrix>) -> Self {
        Self { stiffness: Some(stiffness.into()), ..self }
    }

    /// Names of the n dofs, in the order of the matrices.
    #[must_use]
    pub fn dofs(self, names: impl IntoIterator<Item: Into<String>>) -> Self {
        Self { dofs: names.into_iter().map(Into::into).collect(), ..self }
    }

    /// The same damping ratio ξ for every mode, 0 ≤ ξ < 1. The last damping given counts.
    #[must_use]
    pub fn damping_ratio(self, ratio: f64) -> Self {
        Self { damping: Damping::Ratio(ratio), ..self }
    }

    /// Damping ratios ξ_j, one per mode: C = M Φ diag(2 ξ_j ω_j) Φᵀ M.
    #[must_use]
    pub fn damping_ratios(self, ratios: impl Into<Vec<f64>>) -> Self {
        Self { damping: Damping::Other(DampingSource::Ratios(ratios.into())), ..self }
    }

    /// C = `mass` · M + `stiffness` · K, in 1/s and s, neither below zero.
    #[must_use]
    pub fn rayleigh(self, mass: f64, stiffness: f64) -> Self {
        Self { damping: Damping::Other(DampingSource::Rayleigh { mass, stiffness }), ..self }
    }

    /// Symmetric damping matrix C, n × n, N·s/m.
    #[must_use]
    pub fn damping_matrix(self, damping: impl Into<Matrix>) -> Self {
        Self { damping: Damping::Other(DampingSource::Matrix(damping.into())), ..self }
    }

    /// A force on a dof, N per unit of A, beside those on other dofs. The last kind of forcing given counts.
    #[must_use]
    pub fn force(mut self, dof: impl Into<Dof>, force: f64) -> Self {
        match &mut self.force {
            Force::Dofs(forces) => forces.push((dof.into(), force)),
            other => *other = Force::Dofs(vec![(dof.into(), force)]),
        }
        self
    }

    /// The n entries of the forcing shape s, N per unit of A.
    #[must_use]
    pub fn force_shape(self, shape: impl Into<Vec<f64>>) -> Self {
        Self { force: Force::Shape(ForcingSource::Vector(shape.into())), ..self }
    }

    /// s = M Φ_j: forces mode j alone; j counts from 1.
    #[must_use]
    pub fn force_mode(self, number: usize) -> Self {
        Self { force: Force::Shape(ForcingSource::Mode(number)), ..self }
    }

    /// Harmonic m of the response that is forced, ≥ 1: f = A s cos(mωt).
    #[must_use]
    pub fn harmonic(self, harmonic: usize) -> Self {
        Self { harmonic, ..self }
    }

    /// A law, with a displacement for each of its arguments: `["x1"]`, `[[("x1", 1.0), ("x2", -1.0)]]`.
    #[must_use]
    pub fn element(
        mut self,
        name: impl Into<String>,
        law: impl Into<LawKind>,
        channels: impl IntoIterator<Item: Into<Channel>>,
    ) -> Self {
        let channels = channels.into_iter().map(Into::into).collect();
        self.parts.push(Part { name: name.into(), law: PartLaw::Given(law.into()), channels });
        self
    }

    /// A rigid stop without friction behind a gap (m, zero or above). Its numerical stiffness is that of model files: the
    /// largest diagonal entry of the stiffness condensed on the normals of all contacts.
    #[must_use]
    pub fn stop(mut self, name: impl Into<String>, normal: impl Into<Channel>, gap: f64) -> Self {
        self.parts.push(Part { name: name.into(), law: PartLaw::Stop { gap }, channels: vec![normal.into()] });
        self
    }

    /// Reports a dof, beside those reported already; the first one is the one that plots and bounds use.
    #[must_use]
    pub fn monitor(mut self, dof: impl Into<Dof>) -> Self {
        self.monitors.push(dof.into());
        self
    }

    /// The model.
    ///
    /// # Errors
    /// Whatever a model file would be refused for, with the key of the file, the value, and what would be right.
    pub fn build(self) -> Result<Model, ModelError> {
        let given = |matrix: Option<Matrix>, key: &str| {
            matrix.ok_or_else(|| ModelError::missing(Place::key(key), "every model needs this matrix"))
        };
        let (mass, stiffness) = (given(self.mass, "matrices.mass")?, given(self.stiffness, "matrices.stiffness")?);
        let structure = Structure::new(self.dofs, mass, stiffness)?;
        let damping = match self.damping {
            Damping::Ratio(ratio) => DampingSource::Ratios(vec![ratio; structure.size()]),
            Damping::Other(source) => source,
        };
        let shape = match self.force {
            Force::Shape(source) => source,
            Force::Dofs(forces) => ForcingSource::Vector(shape(&structure, &forces)?),
        };
        let find = |dof: &Dof| match dof {
            Dof::Name(name) => structure.dof(name, || "monitors".into()),
            Dof::Index(index) => Ok(*index),
        };
        let monitors = self.monitors.iter().map(find).collect::<Result<_, _>>()?;
        let elements = elements(&structure, self.parts)?;
        structure.complete(Rest { name: self.name, damping, shape, harmonic: self.harmonic, elements, monitors })
    }
}

/// The forcing shape that has these entries; those of one dof are added.
fn shape(structure: &Structure, forces: &[(Dof, f64)]) -> Result<Vec<f64>, ModelError> {
    let n = structure.size();
    let mut shape = vec![0.0; n];
    for (dof, force) in forces {
        let at = match dof {
            Dof::Name(name) => structure.dof(name, || format!("forcing.shape.dofs.{name}"))?,
            Dof::Index(index) if *index < n => *index,
            Dof::Index(index) => {
                let remedy = format!("dofs count from 0 to {}", n - 1);
                return Err(ModelError::value(Place::key("forcing.shape.dofs"), index, remedy));
            }
        };
        shape[at] += force;
    }
    Ok(shape)
}

/// The elements with dof numbers, and with ε where it is not given.
fn elements(structure: &Structure, parts: Vec<Part>) -> Result<Vec<Element>, ModelError> {
    let channels: Vec<_> = parts.iter().map(|part| part.resolved(structure)).collect::<Result<_, _>>()?;
    let mut epsilon = f64::NAN;
    if parts.iter().any(|part| matches!(part.law, PartLaw::Stop { .. })) {
        let rigid = parts.iter().zip(&channels).filter(|(part, _)| part.is_rigid());
        let normals: Vec<&[(usize, f64)]> = rigid.map(|(_, channels)| channels[0].as_slice()).collect();
        epsilon = structure.default_epsilon(&normals)?;
    }
    let element = |(Part { name, law, .. }, channels)| {
        let law = match law {
            PartLaw::Given(law) => law,
            PartLaw::Stop { gap } => Contact { gap, epsilon, friction: None }.into(),
        };
        Element { name, channels, law }
    };
    Ok(parts.into_iter().zip(channels).map(element).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::laws::{PolynomialSpring, Term};

    fn two_masses() -> ModelBuilder {
        let model = Model::builder("two masses").mass([[1.0, 0.0], [0.0, 1.0]]).stiffness([[2.0, -1.0], [-1.0, 2.0]]);
        model.dofs(["root", "tip"])
    }

    fn cubic() -> PolynomialSpring {
        PolynomialSpring { terms: vec![Term { power: 3, coefficient: 1.0 }] }
    }

    #[test]
    fn dofs_are_named_or_counted_and_forces_on_them_add_up() {
        let model = two_masses()
            .force("tip", 2.0)
            .force(0, 1.0)
            .force("tip", 0.5)
            .element("between", cubic(), [[("root", 1.0), ("tip", -1.0)]])
            .element("ground", cubic(), [1])
            .monitor("tip")
            .build()
            .unwrap();
        assert_eq!((model.forcing().shape.as_slice(), model.monitors()), (&[1.0, 2.5][..], &[1][..]));
        assert_eq!(model.elements()[0].channels, [[(0, 1.0), (1, -1.0)]]);
        assert_eq!(model.elements()[1].channels, [[(1, 1.0)]]);
        // The default of model files, 1 % of critical.
        assert!((model.damping().diagonal(0) - 0.02).abs() < 1e-15);
    }

    #[test]
    fn a_stop_is_as_stiff_as_the_structure_behind_it() {
        let model = two_masses().stop("stop", "tip", 0.1).build().unwrap();
        let contact = model.contacts().next().unwrap();
        assert!((contact.law.epsilon - 1.5).abs() < 1e-14 && contact.law.gap == 0.1);
        assert_eq!((contact.first, model.arguments()), (0, 1));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let says = |builder: ModelBuilder, parts: &[&str]| {
            let error = builder.build().unwrap_err().to_string();
            assert!(parts.iter().all(|part| error.contains(part)), "{error}");
        };
        says(Model::builder("none"), &["`matrices.mass` is not given"]);
        says(two_masses().force("top", 1.0), &["forcing.shape.dofs.top", "did you mean `tip`"]);
        says(two_masses().force(2, 1.0), &["`forcing.shape.dofs` = 2", "0 to 1"]);
        says(two_masses().monitor("top"), &["`monitors`", "did you mean `tip`"]);
        says(two_masses().stop("stop", "top", 0.0), &["elements.stop.channels", "did you mean `tip`"]);
        says(two_masses().stop("stop", 2, 0.0), &["elements.stop.channels", "(2, 1)", "0 to 1"]);
        says(two_masses().stop("stop", "tip", -1.0), &["`elements.stop.gap` = -1", "zero or above"]);
        says(two_masses().damping_ratio(1.0), &["`damping.ratios` = 1", "below 1"]);
        let twice = two_masses().stop("stop", "tip", 0.0).element("stop", cubic(), ["tip"]);
        says(twice, &["`elements`", "`stop`", "twice"]);
    }
}
