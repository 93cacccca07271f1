//! From raw settings to a checked [`Model`]: files are read, names become dof numbers, defaults are filled in.

use super::config::{Config, ContactConfig, DampingConfig, DirectionConfig, LawConfig, MatrixConfig, ModesConfig};
use super::config::{NodeConfig, ShapeConfig};
use super::layers::Layers;
use super::matrix_market;
use crate::linalg::Matrix;
use crate::structure::assembly::{DampingSource, ForcingSource, Rest, Structure};
use crate::structure::laws::{Contact, Friction, Law};
use crate::structure::validation::{
    above_zero, at_least_zero, check_law, check_ratio, check_sense, duplicate, symmetric,
};
use crate::structure::{Element, Model, ModelError, Place};
use std::collections::BTreeMap;
use std::path::Path;

/// Why a contact needs a gap.
const NO_GAP: &str = "; where a contact just touches at rest every motion is nonlinear, however small, and no backbone begins: a small gap says \
                      the same";

type Direction = Vec<(usize, f64)>;

/// Builds the model that `config`, read from the folder `dir`, describes.
pub(super) fn build(dir: &Path, config: Config, origin: &Layers) -> Result<Model, ModelError> {
    let (mass_place, mass) = matrix(dir, &config.matrices.mass, origin, "matrices.mass")?;
    let (stiffness_place, stiffness) = matrix(dir, &config.matrices.stiffness, origin, "matrices.stiffness")?;
    let find = |key: &str| match key {
        "matrices.mass" => mass_place.clone(),
        "matrices.stiffness" => stiffness_place.clone(),
        _ => origin.place(key),
    };
    let structure = Structure::new(config.dofs.unwrap_or_default(), mass, stiffness);
    let structure = structure.map_err(|error| error.located(find))?;
    let builder = Builder { origin, structure };
    let damping = match &config.matrices.damping {
        Some(source) => {
            builder.no_other_damping(&config.damping)?;
            let (place, matrix) = matrix(dir, source, origin, "matrices.damping")?;
            let matrix = symmetric("matrices.damping", matrix, builder.structure.size());
            DampingSource::Matrix(matrix.map_err(|error| error.located(|_| place))?)
        }
        None => builder.damping(config.damping)?,
    };
    let shape = builder.shape(config.forcing.shape)?;
    let mut elements = builder.contacts(&config.contact)?;
    for (i, law) in config.laws.into_iter().enumerate() {
        elements.push(builder.law(law, i)?);
    }
    if let Some(name) = duplicate(elements.iter().map(|element| &element.name)) {
        // The second one is at fault; contact nodes come first.
        let last = elements.iter().rposition(|element| element.name == name).unwrap_or(0);
        let key = match last.checked_sub(config.contact.nodes.len()) {
            None => format!("contact.nodes[{last}].name"),
            Some(law) => format!("laws[{law}].name"),
        };
        return Err(ModelError::Duplicate { place: origin.place(key), what: "nonlinear element", name });
    }
    let monitors = match config.monitors {
        None => vec![],
        Some(names) if names.is_empty() => {
            return Err(ModelError::value(
                origin.place("monitors"),
                "[]",
                "name at least one dof, or leave the key out",
            ));
        }
        Some(names) => names
            .iter()
            .enumerate()
            .map(|(i, name)| builder.dof(name, || format!("monitors[{i}]")))
            .collect::<Result<_, _>>()?,
    };
    let folder = dir.canonicalize().unwrap_or_else(|_| dir.to_path_buf());
    let folder = folder.file_name().map_or_else(|| "model".into(), |name| name.to_string_lossy().into_owned());
    let name = config.name.unwrap_or(folder);
    let rest = Rest { name, damping, shape, harmonic: config.forcing.harmonic, elements, monitors };
    builder.structure.complete(rest).map_err(|error| error.located(|key| origin.place(key)))
}

/// Reads a matrix; its place names the file that holds it.
fn matrix(dir: &Path, source: &MatrixConfig, origin: &Layers, key: &str) -> Result<(Place, Matrix), ModelError> {
    match source {
        MatrixConfig::File(name) => {
            let file = dir.join(name);
            let place = origin.place_in(file.clone(), key);
            let text = std::fs::read_to_string(&file).map_err(|source| ModelError::Read {
                place: place.clone(),
                source,
                remedy: match origin.given(key) {
                    true => format!("put `{name}` beside model.toml, or name another Matrix Market file there"),
                    false => {
                        format!("{key} is not given, and this is its default: give its rows, or the name of a file")
                    }
                },
            })?;
            Ok((place, matrix_market::parse(&file, &text)?))
        }
        MatrixConfig::Rows(rows) => {
            let place = origin.place(key);
            let cols = rows.first().map_or(0, Vec::len);
            if let Some(i) = rows.iter().position(|row| row.len() != cols) {
                let has =
                    |row: &[f64]| if row.len() == 1 { "1 entry".into() } else { format!("{} entries", row.len()) };
                let (first, other, number) = (has(&rows[0]), has(&rows[i]), i + 1);
                let message = format!("row {number} has {other}, but row 1 has {first}; give rows of the same length");
                return Err(ModelError::Type { place, message });
            }
            let matrix = Matrix::from_fn(rows.len(), cols, |i, j| rows[i][j]);
            Ok((place, matrix))
        }
    }
}

struct Builder<'a> {
    origin: &'a Layers,
    structure: Structure,
}

impl Builder<'_> {
    fn dof(&self, name: &str, key: impl Fn() -> String) -> Result<usize, ModelError> {
        self.structure.dof(name, key).map_err(|error| {
            let error = error.located(|key| self.origin.place(key));
            if self.origin.given("dofs") { error } else { error.hinted("`dofs` is not given: it names them") }
        })
    }

    fn combination(&self, terms: &BTreeMap<String, f64>, key: &str) -> Result<Direction, ModelError> {
        let mut direction = Vec::with_capacity(terms.len());
        for (name, &b) in terms {
            if !b.is_finite() || b == 0.0 {
                let remedy = "a coefficient must be a finite number other than zero";
                return Err(ModelError::value(self.origin.place(format!("{key}.{name}")), b, remedy));
            }
            direction.push((self.dof(name, || format!("{key}.{name}"))?, b));
        }
        if direction.is_empty() {
            return Err(ModelError::value(self.origin.place(key), "{}", "name at least one dof, like {x1 = 1}"));
        }
        Ok(direction)
    }

    fn direction(&self, config: &DirectionConfig, key: &str) -> Result<Direction, ModelError> {
        match config {
            DirectionConfig::Dof(name) => Ok(vec![(self.dof(name, || key.to_string())?, 1.0)]),
            DirectionConfig::Coefficients(terms) => self.combination(terms, key),
        }
    }

    fn no_other_damping(&self, config: &DampingConfig) -> Result<(), ModelError> {
        let given = [
            ("damping.ratios", config.ratios.is_some()),
            ("damping.default_ratio", config.default_ratio.is_some()),
            ("damping.rayleigh", config.rayleigh.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            None => Ok(()),
            Some((key, _)) => {
                let remedy = "`matrices.damping` gives the damping already; remove one of the two";
                Err(ModelError::superfluous(self.origin.place(key), remedy))
            }
        }
    }

    fn damping(&self, config: DampingConfig) -> Result<DampingSource, ModelError> {
        let n = self.structure.size();
        if let Some(rayleigh) = config.rayleigh {
            if config.ratios.is_some() || config.default_ratio.is_some() {
                let remedy =
                    "`damping.ratios` or `damping.default_ratio` gives the damping already; remove one of them";
                return Err(ModelError::superfluous(self.origin.place("damping.rayleigh"), remedy));
            }
            return Ok(DampingSource::Rayleigh { mass: rayleigh.mass, stiffness: rayleigh.stiffness });
        }
        let default = config.default_ratio.unwrap_or(DampingConfig::DEFAULT_RATIO);
        check_ratio(self.origin.place("damping.default_ratio"), default)?;
        let mut ratios = vec![None; n];
        for (i, entry) in config.ratios.unwrap_or_default().iter().enumerate() {
            check_ratio(self.origin.place(format!("damping.ratios[{i}].ratio")), entry.ratio)?;
            let place = self.origin.place(format!("damping.ratios[{i}].modes"));
            let (text, range) = match &entry.modes {
                ModesConfig::One(mode) => (mode.to_string(), Some((*mode, *mode))),
                ModesConfig::Range(text) => (text.clone(), mode_range(text)),
            };
            let Some((first, last)) = range.filter(|&(first, last)| 1 <= first && first <= last && last <= n) else {
                let remedy = format!("expected a mode number or an ascending range \"a-b\" within 1 to {n}");
                return Err(ModelError::value(place, text, remedy));
            };
            for (mode, slot) in ratios.iter_mut().enumerate().take(last).skip(first - 1) {
                if slot.replace(entry.ratio).is_some() {
                    let remedy = format!("mode {} has a ratio already; give it once", mode + 1);
                    return Err(ModelError::value(place, text, remedy));
                }
            }
        }
        Ok(DampingSource::Ratios(ratios.into_iter().map(|ratio| ratio.unwrap_or(default)).collect()))
    }

    fn shape(&self, config: ShapeConfig) -> Result<ForcingSource, ModelError> {
        let n = self.structure.size();
        Ok(match config {
            ShapeConfig::Mode(number) => ForcingSource::Mode(number),
            ShapeConfig::ModeShape(number) => ForcingSource::ModeShape(number),
            ShapeConfig::Constant(force) => ForcingSource::Vector(vec![force; n]),
            ShapeConfig::Dofs(forces) => {
                let mut shape = vec![0.0; n];
                for (name, force) in &forces {
                    shape[self.dof(name, || format!("forcing.shape.dofs.{name}"))?] = *force;
                }
                ForcingSource::Vector(shape)
            }
        })
    }

    fn contacts(&self, config: &ContactConfig) -> Result<Vec<Element>, ModelError> {
        // Checked here, so that a wrong common value is reported once and under its own key.
        self.check_contact("contact", config.gap, config.epsilon, config.friction, config.sense)?;
        let mut normals = Vec::with_capacity(config.nodes.len());
        for (i, node) in config.nodes.iter().enumerate() {
            normals.push(self.direction(&node.normal, &format!("contact.nodes[{i}].normal"))?);
        }
        let epsilon = match config.epsilon {
            None if config.nodes.iter().any(|node| node.epsilon.is_none()) => {
                let normals: Vec<&[(usize, f64)]> = normals.iter().map(Vec::as_slice).collect();
                let epsilon = self.structure.default_epsilon(&normals);
                Some(epsilon.map_err(|error| error.located(|key| self.origin.place(key)))?)
            }
            given => given,
        };
        let nodes = config.nodes.iter().zip(normals).enumerate();
        nodes.map(|(i, (node, normal))| self.contact(config, node, i, normal, epsilon)).collect()
    }

    fn check_contact(
        &self,
        section: &str,
        gap: Option<f64>,
        epsilon: Option<f64>,
        friction: Option<f64>,
        sense: Option<f64>,
    ) -> Result<(), ModelError> {
        let place = |key: &str| self.origin.place(format!("{section}.{key}"));
        gap.map_or(Ok(()), |value| above_zero(place("gap"), value, &format!("m{NO_GAP}")))?;
        epsilon.map_or(Ok(()), |value| {
            let unit = "N/m; right is the order of the stiffness condensed on the contact dofs, or above";
            above_zero(place("epsilon"), value, unit)
        })?;
        friction.map_or(Ok(()), |value| at_least_zero(place("friction"), value, ""))?;
        sense.map_or(Ok(()), |value| check_sense(place("sense"), value))
    }

    fn contact(
        &self,
        common: &ContactConfig,
        node: &NodeConfig,
        i: usize,
        normal: Direction,
        epsilon: Option<f64>,
    ) -> Result<Element, ModelError> {
        let section = format!("contact.nodes[{i}]");
        let place = |key: &str| self.origin.place(format!("{section}.{key}"));
        self.check_contact(&section, node.gap, node.epsilon, node.friction, node.sense)?;
        node.radius.map_or(Ok(()), |radius| above_zero(place("radius"), radius, "m"))?;
        if node.tangential.len() > 2 {
            return Err(ModelError::value(place("tangential"), node.tangential.len(), "give one or two directions"));
        }
        let mut tangential = Vec::with_capacity(2);
        for (k, direction) in node.tangential.iter().enumerate() {
            tangential.push(self.direction(direction, &format!("{section}.tangential[{k}]"))?);
        }
        let coefficient = node.friction.or(common.friction).unwrap_or(0.0);
        let mut channels = vec![normal];
        let mut friction = None;
        if coefficient > 0.0 {
            let missing = |key| {
                let remedy =
                    format!("friction is {coefficient}, so `{key}` is needed; give it, or set friction = 0 here");
                ModelError::missing(place(key), remedy)
            };
            if tangential.is_empty() {
                return Err(missing("tangential"));
            }
            let radius = node.radius.ok_or_else(|| missing("radius"))?;
            friction = Some(Friction { coefficient, radius, sense: node.sense.or(common.sense).unwrap_or(1.0) });
            channels.extend(tangential);
            channels.resize(3, vec![]);
        }
        let gap = node.gap.or(common.gap);
        let gap = gap.ok_or_else(|| {
            ModelError::missing(place("gap"), format!("give it, or contact.gap for all, in m{NO_GAP}"))
        })?;
        Ok(Element {
            name: node.name.clone().unwrap_or_else(|| format!("contact{}", i + 1)),
            channels,
            law: Contact { gap, epsilon: node.epsilon.or(epsilon).unwrap_or(f64::NAN), friction }.into(),
        })
    }

    fn law(&self, config: LawConfig, i: usize) -> Result<Element, ModelError> {
        let key = |key: &str| format!("laws[{i}].{key}");
        let channel = match (&config.dof, &config.between, &config.coefficients) {
            (Some(name), None, None) => vec![(self.dof(name, || key("dof"))?, 1.0)],
            (None, Some([a, b]), None) if a != b => {
                // What is no dof may be meant as the ground.
                let end = |name: &str, other: &str, place: &str| {
                    let grounded = || format!("a law against the ground has `dof = \"{other}\"` instead of `between`");
                    self.dof(name, || key(place)).map_err(|error| error.hinted(&grounded()))
                };
                vec![(end(a, b, "between[0]")?, 1.0), (end(b, a, "between[1]")?, -1.0)]
            }
            (None, Some([a, _]), None) => {
                let remedy = format!("a law between `{a}` and itself never acts; name two different dofs");
                return Err(ModelError::value(self.origin.place(key("between")), format!("[{a}, {a}]"), remedy));
            }
            (None, None, Some(terms)) => self.combination(terms, &key("coefficients"))?,
            (None, None, None) => {
                let remedy = "say what the law acts on, by `dof`, `between` or `coefficients`";
                return Err(ModelError::missing(self.origin.place(key("dof")), remedy));
            }
            (dof, between, _) => {
                let (first, second) = match (dof, between) {
                    (Some(_), Some(_)) => ("dof", "between"),
                    (Some(_), None) => ("dof", "coefficients"),
                    _ => ("between", "coefficients"),
                };
                let remedy = format!("`{first}` says what the law acts on already; remove one of the two");
                return Err(ModelError::superfluous(self.origin.place(key(second)), remedy));
            }
        };
        if config.law.rigid().is_some() {
            let remedy = "rigid contact is described under [[contact.nodes]]";
            return Err(ModelError::value(self.origin.place(key("law")), "contact", remedy));
        }
        let kind = self.origin.law(i).unwrap_or_default();
        check_law(&config.law, |parameter| self.origin.place(key(&format!("law.{kind}.{parameter}"))))?;
        let name = config.name.unwrap_or_else(|| format!("law{}", i + 1));
        Ok(Element { name, channels: vec![channel], law: config.law })
    }
}

/// "2-5" → (2, 5); "3" → (3, 3).
fn mode_range(text: &str) -> Option<(usize, usize)> {
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    Some((first.trim().parse().ok()?, last.trim().parse().ok()?))
}
