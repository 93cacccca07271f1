//! Settings of `model.toml`, as written.
//!
//! Every key has a default; unknown keys are refused. SI units. Messages count entries of lists from 0
//! (`contact.nodes[0]` is the first `[[contact.nodes]]`).
//!
//! | key | default | unit, range | meaning |
//! |---|---|---|---|
//! | `name` | the folder's name | | shown to people |
//! | `description` | empty | | for whoever reads the file |
//! | `dofs` | `x1` … `xn` | n different names | names of the dofs, in the order of the matrices |
//! | `monitors` | the first dof | dof names | reported amplitudes; the first one is plotted and bounded, and is positive in every mode shape |
//! | `matrices.mass` | `"M.mtx"` | kg, positive definite | Matrix Market file beside `model.toml`, or rows `[[..], [..]]` |
//! | `matrices.stiffness` | `"K.mtx"` | N/m, positive semi-definite | likewise |
//! | `matrices.damping` | none | N·s/m, symmetric | likewise; instead of the section `damping` |
//! | `damping.ratios` | none | list of `{modes, ratio}` | modal damping ratios, 0 ≤ ratio < 1; `modes` is a number or a range `"1-2"` |
//! | `damping.default_ratio` | 0.01 | 0 ≤ ξ < 1 | ratio of the modes that `ratios` leaves out |
//! | `damping.rayleigh` | none | `mass` 1/s ≥ 0, `stiffness` s ≥ 0 | C = mass · M + stiffness · K; instead of ratios |
//! | `forcing.shape` | `{mode = 1}` | N per unit of A | `{mode = j}`: M Φ_j (the paper's); `{mode_shape = j}`: Φ_j; `{dofs = {x1 = 1.0}}`; `{constant = 1.0}`: on every dof |
//! | `forcing.harmonic` | 1 | ≥ 1 | harmonic m of the response that is forced, f = A s cos(mωt) |
//! | `contact.gap` | 0 | m, ≥ 0 | clearance at rest |
//! | `contact.epsilon` | see below | N/m, > 0 | numerical stiffness of the contact prediction |
//! | `contact.friction` | 0 | ≥ 0 | coefficient μ of permanent sliding; 0: none |
//! | `contact.sense` | 1 | 1 or -1 | sign of the sliding velocity along the first tangential direction |
//! | `contact.nodes` | none | list | contact nodes: |
//! | `….name` | `contact1`, … | different names | shown to people |
//! | `….normal` | required | dof name or `{dof = coefficient}` | displacement that closes the gap; `{x1 = 1, x2 = -1}`: between two bodies |
//! | `….tangential` | none | list of 1 or 2, like `normal` | sliding directions, the first one along the rotation; required with friction |
//! | `….radius` | none | m, > 0 | radius of the node; required with friction |
//! | `….gap`, `….epsilon`, `….friction`, `….sense` | those of `contact` | | values of this node |
//! | `laws` | none | list | other nonlinear elements: |
//! | `….name` | `law1`, … | different names | shown to people |
//! | `….dof` | | dof name | the law acts between this dof and the ground, or |
//! | `….between` | | two dof names | on the first minus the second, or |
//! | `….coefficients` | | `{dof = coefficient}` | on this sum; exactly one of the three |
//! | `….law` | required | `{law_name = {parameters}}` | a law of [`LawKind`], except `contact` |
//!
//! `epsilon` changes which truncated series is found, not its limit, and decides whether Newton's method converges:
//! right is the order of the stiffness condensed on the contact dofs, or above. The default is the largest diagonal
//! entry of the stiffness condensed statically on all contact normals.

use crate::structure::laws::LawKind;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Top-level keys.
pub const KEYS: [&str; 9] =
    ["name", "description", "dofs", "monitors", "matrices", "damping", "forcing", "contact", "laws"];

/// Those of them that are sections.
pub const SECTIONS: [&str; 4] = ["matrices", "damping", "forcing", "contact"];

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
#[serde(untagged, expecting = "expected the name of a Matrix Market file, or rows of numbers like [[2, -1], [-1, 2]]")]
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
