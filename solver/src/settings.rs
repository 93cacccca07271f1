//! Numerical settings: every one has a default, a range and a message.

mod effort;
mod modes;
mod numbers;

pub use effort::{Effort, SearchSettings, Stretch, VerifyEffort, VerifySettings};
pub use modes::ModeChoice;
pub use numbers::NumberList;

use crate::curve::continuation::ContinuationSettings;
use crate::structure::Model;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A setting out of its range.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{key} = {value}: {remedy}")]
pub struct SettingsError {
    /// Dotted key.
    pub key: &'static str,
    /// Its value.
    pub value: String,
    /// What would be right.
    pub remedy: String,
}

/// A frequency as messages have it, whichever unit it was given in: `942.478 rad/s (150 Hz)`.
pub(crate) fn told_frequency(omega: f64) -> String {
    // Seven digits are more than anybody types, and without what conversion adds.
    let digits = |value: f64| format!("{value:.6e}").parse::<f64>().unwrap_or(value);
    format!("{} rad/s ({} Hz)", digits(omega), digits(omega / std::f64::consts::TAU))
}

/// Truncation of the harmonic balance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HarmonicSettings {
    /// Number of harmonics H, 1 to 400. Default 10 (the paper's).
    pub count: usize,
    /// Instants a period N_t, at least 4 H. Default 512 (the paper's).
    pub samples: usize,
    /// How laws that switch are integrated over a period. Default arcs.
    pub quadrature: Quadrature,
}

impl HarmonicSettings {
    /// Twice as many harmonics, and enough samples for them: what they change is what was left out.
    pub fn doubled(self) -> Self {
        // A multiple of those there were: whatever they are symmetric in stays.
        let samples = self.samples * (8 * self.count).div_ceil(self.samples).max(1);
        Self { count: 2 * self.count, samples, ..self }
    }
}

/// How laws that switch are integrated over a period.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quadrature {
    /// From one switch to the next: over the exact arcs of contact, of sticking and of sliding, and as finely as regularised
    /// friction turns over. Smooth, independent of the number of samples. Where the friction of a contact nearly stops or
    /// reverses its sliding its direction is not smooth: use samples there.
    #[default]
    Arcs,
    /// By the samples, as the paper does.
    Samples,
}

impl Default for HarmonicSettings {
    fn default() -> Self {
        Self { count: 10, samples: 512, quadrature: Quadrature::default() }
    }
}

/// Frequencies between which responses are wanted, rad/s of the response. Main branches are followed beyond them until the
/// response is the ordinary one there; other branches end at bounds that are given, and are followed beyond those that are not.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FrequencySettings {
    /// Lower bound; the main branch starts here. Default: 10 % below the lowest frequency of the backbone.
    pub min: Option<f64>,
    /// Upper bound. Default: 10 % above the highest frequency of the backbone.
    pub max: Option<f64>,
}

/// Which energies the work of the forcing has to exceed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// W > |R_lin + R_nl|: the balance itself. Where the nonlinear forces feed energy in, only this one finds all.
    #[default]
    Balance,
    /// W > |R_lin| + |R_nl|: the paper's criterion, sufficient.
    Sufficient,
}

/// The backbones: damped nonlinear normal modes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "BackboneKeys")]
pub struct BackboneSettings {
    /// Modes followed, from 1, the primary one first. Default `"auto"`. A file may say `mode = 1` for `modes = [1]`.
    pub modes: ModeChoice,
    /// Largest amplitude of the first monitored dof, in m. Default: 8 reference lengths (gaps).
    pub max_amplitude: Option<f64>,
    /// Lowest frequency, rad/s. Default: a quarter of the mode's eigenfrequency.
    pub min_frequency: Option<f64>,
    /// Highest frequency, rad/s. Default: four times the mode's eigenfrequency, and more where the forcing leads beyond.
    pub max_frequency: Option<f64>,
    /// Largest number of points. Default 6000.
    pub max_points: usize,
    /// Energy criterion of the windows. Default balance.
    pub criterion: Criterion,
    /// Equation of the backbone. Default damped_mode.
    pub equation: BackboneEquation,
}

/// Keys of the backbone as they are written: `mode` is another name for one of `modes`.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
struct BackboneKeys {
    modes: Option<ModeChoice>,
    mode: Option<usize>,
    max_amplitude: Option<f64>,
    min_frequency: Option<f64>,
    max_frequency: Option<f64>,
    max_points: usize,
    criterion: Criterion,
    equation: BackboneEquation,
}

impl Default for BackboneKeys {
    fn default() -> Self {
        let BackboneSettings { modes: _, max_amplitude, min_frequency, max_frequency, max_points, criterion, equation } =
            BackboneSettings::default();
        let (modes, mode) = (None, None);
        Self { modes, mode, max_amplitude, min_frequency, max_frequency, max_points, criterion, equation }
    }
}

impl TryFrom<BackboneKeys> for BackboneSettings {
    type Error = &'static str;

    fn try_from(keys: BackboneKeys) -> Result<Self, Self::Error> {
        let BackboneKeys { modes, mode, max_amplitude, min_frequency, max_frequency, max_points, criterion, equation } =
            keys;
        let modes = match (modes, mode) {
            (Some(_), Some(_)) => {
                return Err("backbone.mode is another name for one of backbone.modes: give only one of them");
            }
            (None, Some(mode)) => ModeChoice::one(mode),
            (modes, None) => modes.unwrap_or_default(),
        };
        Ok(Self { modes, max_amplitude, min_frequency, max_frequency, max_points, criterion, equation })
    }
}

/// What the backbone is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BackboneEquation {
    /// Damped nonlinear normal mode (the paper's).
    #[default]
    DampedMode,
    /// The same without linear damping; the energy balance still counts what the damping dissipates.
    ConservativeMode,
    /// Forced responses in quadrature with the forcing, of any amplitude. On a strongly damped structure free motion
    /// decays too fast to resemble a forced response, and this is the backbone to use: its energy balance is exact.
    PhaseResonance,
}

impl Default for BackboneSettings {
    fn default() -> Self {
        Self {
            modes: ModeChoice::Auto,
            max_amplitude: None,
            min_frequency: None,
            max_frequency: None,
            max_points: 6000,
            criterion: Criterion::default(),
            equation: BackboneEquation::default(),
        }
    }
}

/// Forced-response branches.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BranchSettings {
    /// Largest number of points in each direction. Default 6000.
    pub max_points: usize,
    /// Accepted, and without effect: a branch has closed when it converges onto its first point.
    pub closure: f64,
    /// Largest amplitude of the first monitored dof, in m. Default: none.
    pub max_amplitude: Option<f64>,
}

impl Default for BranchSettings {
    fn default() -> Self {
        Self { max_points: 6000, closure: 1e-2, max_amplitude: None }
    }
}

/// Names of the sections of [`Settings`].
pub const SECTIONS: [&str; 7] = ["harmonics", "frequency", "continuation", "backbone", "branch", "search", "verify"];

/// All numerical settings of a study.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Truncation.
    pub harmonics: HarmonicSettings,
    /// Frequency range.
    pub frequency: FrequencySettings,
    /// Continuation of every curve.
    pub continuation: ContinuationSettings,
    /// Backbone.
    pub backbone: BackboneSettings,
    /// Forced-response branches.
    pub branch: BranchSettings,
    /// Search for isolas that no window leads to.
    pub search: SearchSettings,
    /// Verification of what was found by time marching.
    pub verify: VerifySettings,
}

/// What is said of a structure with rigid-body modes alone.
const NONE_DEFORMS: &str = "all modes are rigid-body modes, which have no backbone: the stiffness matrix resists no motion; put the linear \
                            part of the laws into it";

impl Settings {
    /// Checks every setting, for a model.
    ///
    /// # Errors
    /// The first setting out of its range, with the key and what would be right.
    pub fn validate(&self, model: &Model) -> Result<(), SettingsError> {
        let refuse = |key, value: String, remedy: String| Err(SettingsError { key, value, remedy });
        let HarmonicSettings { count, samples, .. } = self.harmonics;
        if !(1..=400).contains(&count) {
            return refuse("harmonics.count", count.to_string(), "use 1 to 400 harmonics".into());
        }
        let (fewest, most) = (4 * count, 1 << 20);
        if !(fewest..=most).contains(&samples) {
            let enough = fewest.next_power_of_two();
            let remedy = format!(
                "{count} harmonics need at least {fewest} samples a period (at most {most} are possible): {enough} will do"
            );
            return refuse("harmonics.samples", samples.to_string(), remedy);
        }
        let m = model.forcing().harmonic;
        // The orders that are asked for say themselves what the force acts on.
        if m > count && self.search.harmonics.is_none() {
            let remedy = format!("the forcing acts on harmonic {m}: use at least {m} harmonics");
            return refuse("harmonics.count", count.to_string(), remedy);
        }
        self.validate_orders()?;
        self.validate_modes(model)?;
        let positive = [
            ("frequency.min", self.frequency.min),
            ("frequency.max", self.frequency.max),
            ("backbone.max_amplitude", self.backbone.max_amplitude),
            ("backbone.min_frequency", self.backbone.min_frequency),
            ("backbone.max_frequency", self.backbone.max_frequency),
            ("branch.max_amplitude", self.branch.max_amplitude),
            ("branch.closure", Some(self.branch.closure)),
            ("continuation.initial_step", Some(self.continuation.initial_step)),
            ("continuation.min_step", Some(self.continuation.min_step)),
            ("continuation.max_step", Some(self.continuation.max_step)),
            ("continuation.newton.tolerance", Some(self.continuation.newton.tolerance)),
        ];
        for (key, value) in positive {
            if let Some(value) = value
                && !(value > 0.0 && value.is_finite())
            {
                return refuse(key, value.to_string(), "use a finite number above zero".into());
            }
        }
        let ordered = [
            (
                ["continuation.min_step", "continuation.initial_step"],
                Some(self.continuation.min_step),
                Some(self.continuation.initial_step),
            ),
            (["frequency.min", "frequency.max"], self.frequency.min, self.frequency.max),
            (
                ["backbone.min_frequency", "backbone.max_frequency"],
                self.backbone.min_frequency,
                self.backbone.max_frequency,
            ),
            (
                ["continuation.min_step", "continuation.max_step"],
                Some(self.continuation.min_step),
                Some(self.continuation.max_step),
            ),
        ];
        for ([below, key], low, high) in ordered {
            if let (Some(low), Some(high)) = (low, high)
                && low >= high
            {
                let told = |value: f64| match key {
                    "frequency.max" | "backbone.max_frequency" => told_frequency(value),
                    _ => value.to_string(),
                };
                let remedy = format!("use a value above {below} = {}, or are the two exchanged?", told(low));
                return refuse(key, told(high), remedy);
            }
        }
        if !(0.0..1.0).contains(&self.continuation.min_cosine) {
            let value = self.continuation.min_cosine.to_string();
            return refuse("continuation.min_cosine", value, "use a cosine from 0 to below 1".into());
        }
        for (key, value) in [
            ("backbone.max_points", self.backbone.max_points),
            ("branch.max_points", self.branch.max_points),
            ("continuation.target_factorisations", self.continuation.target_factorisations),
            ("continuation.newton.max_iterations", self.continuation.newton.max_iterations),
        ] {
            if value == 0 {
                return refuse(key, "0".into(), "use at least 1".into());
            }
        }
        match self.search.starts {
            Some(starts) if starts > SearchSettings::MOST_STARTS => {
                refuse("search.starts", starts.to_string(), format!("use at most {}", SearchSettings::MOST_STARTS))
            }
            _ => Ok(()),
        }
    }

    /// Whether the orders of motions can be told apart, and their harmonics are there.
    fn validate_orders(&self) -> Result<(), SettingsError> {
        let (Some(list), count) = (self.search.harmonics, self.harmonics.count) else { return Ok(()) };
        let refuse = |remedy: String| Err(SettingsError { key: "search.harmonics", value: list.to_string(), remedy });
        match list.numbers() {
            [] => refuse("give at least one number m of periods of the force, as in [1, 2, 3]".into()),
            [0, ..] => refuse("motions last 1 period of the force or more".into()),
            numbers if !numbers.is_sorted_by(|a, b| a < b) => {
                refuse("give every number of periods once, in ascending order".into())
            }
            [.., most] if *most > count => refuse(format!(
                "the force acts on harmonic {most} of the longest: harmonics.count = {count} is too few"
            )),
            _ => Ok(()),
        }
    }

    /// Whether every mode followed is there, deforms the structure and stands in the list once.
    fn validate_modes(&self, model: &Model) -> Result<(), SettingsError> {
        let choice = self.backbone.modes;
        let refuse = |remedy: String| {
            let (key, value) = ("backbone.modes", choice.to_string());
            Err(SettingsError { key, value, remedy })
        };
        let ModeChoice::These(list) = &choice else {
            return match model.modes().lowest_deforming() {
                Some(_) => Ok(()),
                None => refuse(NONE_DEFORMS.into()),
            };
        };
        let numbers = list.numbers();
        if numbers.is_empty() {
            return refuse("give at least one mode, or \"auto\"".into());
        }
        let modes = model.size();
        for (i, &number) in numbers.iter().enumerate() {
            if !(1..=modes).contains(&number) {
                return refuse(format!("the model has modes 1 to {modes}"));
            }
            if model.modes().is_rigid(number - 1) {
                let remedy = match model.modes().lowest_deforming() {
                    Some(elastic) => {
                        format!("choose modes that deform the structure, as in backbone.modes = [{}]", elastic + 1)
                    }
                    None => NONE_DEFORMS.into(),
                };
                return refuse(format!("mode {number} is a rigid-body mode, which has no backbone; {remedy}"));
            }
            if numbers[..i].contains(&number) {
                return refuse(format!("mode {number} comes twice; give every mode once"));
            }
        }
        Ok(())
    }

    /// Index of the primary mode of a model, from 0: the first one of the list; with `"auto"` the lowest that the force
    /// drives ([`Model::primary_mode`]).
    pub fn tracked(&self, model: &Model) -> usize {
        match &self.backbone.modes {
            ModeChoice::Auto => model.primary_mode().unwrap_or(0),
            ModeChoice::These(list) => list.numbers().first().copied().unwrap_or_default().saturating_sub(1),
        }
    }

    /// The same settings for the backbone of another mode, from 0, alone.
    #[must_use]
    pub fn tracking(&self, mode: usize) -> Self {
        let backbone = BackboneSettings { modes: ModeChoice::one(mode + 1), ..self.backbone };
        Self { backbone, ..*self }
    }
}
