//! Settings of `model.toml`, as written.
//!
//! Every key has a default; unknown keys are refused. SI units. Messages count entries of lists from 0
//! (`contact.nodes[0]` is the first `[[contact.nodes]]`).
//!
//! `REFERENCE.md` lists all keys with kind, default, unit and meaning; `isola schema --explain KEY` says the same of one.

use crate::structure::laws::LawKind;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Top-level keys.
pub const KEYS: [&str; 9] =
    ["name", "description", "dofs", "monitors", "matrices", "damping", "forcing", "contact", "laws"];

/// Those of them that are sections, and sections within them.
pub const SECTIONS: [&str; 5] = ["matrices", "damping", "damping.rayleigh", "forcing", "contact"];

#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct Config {
    pub name: Option<String>,
    pub description: String,
    pub dofs: Option<Vec<String>>,
    pub monitors: Option<Vec<String>>,
    pub matrices: MatricesConfig,
    pub damping: DampingConfig,
    pub forcing: ForcingConfig,
    pub contact: ContactConfig,
    pub laws: Vec<LawConfig>,
}

#[derive(Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct MatricesConfig {
    pub mass: MatrixConfig,
    pub stiffness: MatrixConfig,
    pub damping: Option<MatrixConfig>,
}

impl Default for MatricesConfig {
    fn default() -> Self {
        Self { mass: MatrixConfig::File("M.mtx".into()), stiffness: MatrixConfig::File("K.mtx".into()), damping: None }
    }
}

#[derive(Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected the name of a Matrix Market file, or its rows, like [[2, 0], [0, 1]] of two dofs, [[2]] of one"
)]
pub(super) enum MatrixConfig {
    File(String),
    Rows(Vec<Vec<f64>>),
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct DampingConfig {
    pub ratios: Option<Vec<RatioConfig>>,
    pub default_ratio: Option<f64>,
    pub rayleigh: Option<RayleighConfig>,
}

impl DampingConfig {
    pub const DEFAULT_RATIO: f64 = crate::structure::DEFAULT_RATIO;
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RatioConfig {
    pub modes: ModesConfig,
    pub ratio: f64,
}

#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "expected a mode number like 3, or a range of modes like \"1-2\"")]
pub(super) enum ModesConfig {
    One(usize),
    Range(String),
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct RayleighConfig {
    pub mass: f64,
    pub stiffness: f64,
}

#[derive(Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ForcingConfig {
    pub shape: ShapeConfig,
    pub harmonic: usize,
}

impl Default for ForcingConfig {
    fn default() -> Self {
        Self { shape: ShapeConfig::Mode(1), harmonic: 1 }
    }
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ShapeConfig {
    Mode(usize),
    ModeShape(usize),
    Dofs(BTreeMap<String, f64>),
    Constant(f64),
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ContactConfig {
    pub gap: Option<f64>,
    pub epsilon: Option<f64>,
    pub friction: Option<f64>,
    pub sense: Option<f64>,
    pub nodes: Vec<NodeConfig>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NodeConfig {
    pub name: Option<String>,
    pub normal: DirectionConfig,
    #[serde(default)]
    pub tangential: Vec<DirectionConfig>,
    pub radius: Option<f64>,
    pub gap: Option<f64>,
    pub epsilon: Option<f64>,
    pub friction: Option<f64>,
    pub sense: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "expected a dof name, or a table of coefficients like {x1 = 1, x2 = -1}")]
pub(super) enum DirectionConfig {
    Dof(String),
    Coefficients(BTreeMap<String, f64>),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LawConfig {
    pub name: Option<String>,
    pub dof: Option<String>,
    pub between: Option<[String; 2]>,
    pub coefficients: Option<BTreeMap<String, f64>>,
    pub law: LawKind,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_keys_are_those_of_the_settings() {
        let error = toml::from_str::<Config>("no_such_key = 1").unwrap_err().to_string();
        let known: Vec<&str> = error.split('`').skip(3).step_by(2).collect();
        assert_eq!(known, KEYS);
    }
}
