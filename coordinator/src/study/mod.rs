//! The study: a model, forcing amplitudes, numerics and a scenario, in one file.
//!
//! A study is a TOML file, `study.toml` where a folder has only one. Unknown keys are refused. SI units;
//! frequencies may have their unit, as in "150 Hz".
//!
//! It has a `name`, the folder of its `model`, `amplitudes` and the `units` of its tables; the sections of [`Settings`]; and, as its scenario, the keys of
//! [`config`] but `name`, which come over those of `model.toml`. [`crate::reference`] describes all of them.
//!
//! Sections are merged key by key; a list or an inline table is replaced as a whole. One way to give the damping replaces
//! the others. Values typed on the command line come last and reach into lists
//! (`contact.nodes.0.gap`, `laws.NAME.law.jenkins.limit`).

mod amplitudes;
mod entry;
mod error;
mod frequencies;
mod locate;
mod meant;
mod range;

pub use amplitudes::typed;
pub use error::StudyError;

use crate::reference;
use locate::{locate, model_folder};
use protocol::to_everyone::Amplitude;
use results::resolved_study::UNITS;
use results::summary_table::{FrequencyUnit, UnitChoice};
use serde::Deserialize;
use solver::files;
use solver::files::{Layers, config};
use solver::response::orders::{Order, Orders};
use solver::settings::{SECTIONS, Settings, SettingsError};
use solver::structure::{Model, ModelError, Place};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Keys of the study itself.
const OWN: [&str; 4] = ["name", "model", "amplitudes", UNITS];

/// Keys that are accepted and do nothing any more.
const WITHOUT_EFFECT: [&str; 1] = ["branch.closure"];

/// A study, read and checked.
#[derive(Debug, Clone)]
pub struct Study {
    /// Name shown to people.
    pub name: String,
    /// The study file.
    pub file: PathBuf,
    /// Folder of the model.
    pub model_dir: PathBuf,
    /// The model, in the scenario of the study.
    pub model: Model,
    /// Numerical settings.
    pub settings: Settings,
    /// Forcing amplitudes, in the order given.
    pub amplitudes: Vec<Amplitude>,
    /// Units of what is told of it, where some are chosen.
    pub units: UnitChoice,
    /// Whether a bound of the frequency was given in Hz.
    has_hertz: bool,
    /// Keys given that have no effect any more.
    pub without_effect: Vec<&'static str>,
    /// Keys of the model that something over them replaces, which gives the same in another way: pairs of that, and of the key.
    pub replaced: Vec<(String, String)>,
    /// The study as TOML: settings of model, study and command line merged, every numerical setting that has a value
    /// spelled out. Loads as a study in the same folder.
    pub resolved: String,
}

/// What a study says about itself.
#[derive(Debug, Deserialize)]
struct Header {
    name: Option<String>,
    model: Option<String>,
    units: Option<String>,
}

impl Study {
    /// Reads a study: a file, or a folder that holds a `study.toml`. Pairs of a dotted key and a value as typed after
    /// `--set` come over it, and `amplitudes`, as typed after `--amplitudes`, over those of both.
    pub fn load(file: &Path, set: &[(String, String)], amplitudes: Option<&str>) -> Result<Self, StudyError> {
        let file = locate(file)?;
        let text = std::fs::read_to_string(&file).map_err(|source| StudyError::NoStudy {
            path: file.clone(),
            problem: format!("the file cannot be read ({source}); give a study in TOML that you may read"),
        })?;
        let mut study = Layers::parse(&file, &text)?;
        for (key, value) in set.iter().filter(|(key, _)| !is_scenario(first(key)) && !is_amplitudes(first(key))) {
            study.set("--set", key, value)?;
        }
        known_keys(&study)?;
        let amplitudes = match typed_amplitudes(set, amplitudes)? {
            Some((option, text)) => amplitudes::typed(option, text)?,
            None => amplitudes::written(&text, || study.place("amplitudes"))?,
        };

        let scenario = study.split(is_scenario);
        let mut numerics = study.split(|key| SECTIONS.contains(&key));
        study.split(is_amplitudes);
        let header: Header = study.parsed()?;
        let written = header.model.unwrap_or_else(|| ".".into());
        let model_dir = model_folder(&file, &written, || study.place("model"))?;
        let (model, scenario) = load_model(&model_dir, scenario, set)?;
        let (settings, has_hertz) = load_settings(&mut numerics, &model)?;
        let orders = Orders::of(&model, &settings);
        let model = orders.first().model.as_ref().clone();
        let name = header.name.unwrap_or_else(|| model.name().to_string());
        if name.trim().is_empty() {
            let remedy = "give a name, or leave the key out";
            return Err(ModelError::value(study.place("name"), format!("\"{name}\""), remedy).into());
        }
        let units = header.units.map(|text| {
            text.parse::<UnitChoice>()
                .map_err(|remedy| ModelError::value(study.place(UNITS), format!("\"{text}\""), remedy))
        });
        let units = units.transpose()?;
        let resolved = resolved(&name, &written, &amplitudes, units, &settings, scenario.table().clone())
            .map_err(|source| StudyError::Unwritable { file: file.clone(), source })?;
        let without_effect = WITHOUT_EFFECT.into_iter().filter(|key| is_there(numerics.table(), key)).collect();
        let units = units.unwrap_or_default();
        let replaced = scenario.replaced().to_vec();
        Ok(Self {
            name,
            file,
            model_dir,
            model,
            settings,
            amplitudes,
            units,
            has_hertz,
            without_effect,
            replaced,
            resolved,
        })
    }

    /// The unit in which frequencies are told before anything is computed: that chosen, else that of bounds that were given in Hz.
    pub fn frequency_unit(&self) -> FrequencyUnit {
        let of_bounds = if self.has_hertz { FrequencyUnit::Hertz } else { FrequencyUnit::default() };
        self.units.frequency.unwrap_or(of_bounds)
    }

    /// Whether model, study or command line give this dotted key of a model.
    pub fn gives(&self, key: &str) -> bool {
        self.resolved.parse::<Table>().is_ok_and(|table| is_there(&table, key))
    }
}

/// The levels of a study: its forcing amplitudes, for every order of motions that is looked for.
pub fn levels(amplitudes: &[Amplitude], orders: &Orders) -> Vec<Amplitude> {
    let of_order = |order: &Order| {
        let level = |amplitude: &Amplitude| match order.is_first {
            true => amplitude.clone(),
            false => amplitude.of_order(order.number()),
        };
        amplitudes.iter().map(level).collect::<Vec<_>>()
    };
    orders.iter().flat_map(of_order).collect()
}

/// The model with the scenario of the study and of the command line, and the settings of both.
fn load_model(dir: &Path, scenario: Layers, set: &[(String, String)]) -> Result<(Model, Layers), ModelError> {
    let mut layers = files::settings(dir)?;
    layers.merge(scenario);
    for (key, value) in set.iter().filter(|(key, _)| is_scenario(first(key))) {
        layers.set("--set", key, value)?;
    }
    meant::shape_of_forcing(&layers)?;
    Ok((files::from_layers(dir, &layers)?, layers))
}

/// The option that sets the amplitudes, and its text.
fn typed_amplitudes<'a>(
    set: &'a [(String, String)],
    amplitudes: Option<&'a str>,
) -> Result<Option<(&'static str, &'a str)>, ModelError> {
    let pairs = || set.iter().filter(|(key, _)| is_amplitudes(first(key)));
    if let Some((key, value)) = pairs().find(|(key, _)| key.contains('.')) {
        let place = Place { file: None, key: key.clone(), set_by: Some(format!("--set {key}={value}").into()) };
        return Err(ModelError::value(place, value, "give all amplitudes at once, like amplitudes=20:140:20"));
    }
    let among = || pairs().next_back().map(|(_, text)| ("--set amplitudes", text.as_str()));
    Ok(amplitudes.map(|text| ("--amplitudes", text)).or_else(among))
}

/// First part of a dotted key.
fn first(key: &str) -> &str {
    key.split('.').next().unwrap_or(key).trim().trim_matches(['"', '\''])
}

/// Whether a table has a value of this dotted key.
fn is_there(table: &Table, key: &str) -> bool {
    let (section, rest) = key.split_once('.').unwrap_or((key, ""));
    match (table.get(section), rest) {
        (value, "") => value.is_some(),
        (Some(Value::Table(table)), rest) => is_there(table, rest),
        _ => false,
    }
}

fn is_scenario(key: &str) -> bool {
    config::KEYS.contains(&key) && !OWN.contains(&key)
}

fn is_amplitudes(key: &str) -> bool {
    key == "amplitudes"
}

/// Where parameters of laws are, for whoever wrote a name before them.
const OF_A_LAW: &str = "a parameter of a law is `laws.NAME.law.KIND.PARAMETER`, like `laws.joint.law.jenkins.limit`";

/// Refuses top-level keys that no study has.
fn known_keys(study: &Layers) -> Result<(), ModelError> {
    let known = || OWN.into_iter().chain(SECTIONS).chain(config::KEYS.into_iter().filter(|key| is_scenario(key)));
    match study.table().keys().find(|key| !known().any(|name| name == *key)) {
        None => Ok(()),
        Some(key) => {
            // Those of a section are meant where one has this very name.
            let meant = reference::keys_called(key);
            let error = ModelError::unknown(study.place(key), "key", key, known().chain(meant));
            let is_section = study.table().get(key).is_some_and(Value::is_table);
            Err(if is_section { error.hinted(OF_A_LAW) } else { error })
        }
    }
}

/// Numerical settings, checked for the model, and whether a frequency among them was given in Hz.
fn load_settings(numerics: &mut Layers, model: &Model) -> Result<(Settings, bool), ModelError> {
    numerics.check_sections(&SECTIONS)?;
    numerics.check_sections(&["continuation.newton"])?;
    meant::unit_of_frequencies(numerics)?;
    let has_hertz = frequencies::to_radians(numerics)?;
    let settings: Settings = numerics.parsed()?;
    settings.validate(model).map_err(|SettingsError { key, value, remedy }| {
        let key = if key == "backbone.modes" && numerics.given("backbone.mode") { "backbone.mode" } else { key };
        let set_by = (!numerics.given(key)).then(|| "default".into());
        let place = numerics.place(key);
        ModelError::value(Place { set_by: set_by.or(place.set_by), ..place }, value, remedy)
    })?;
    Ok((settings, has_hertz))
}

/// The study with everything that was put over it.
fn resolved(
    name: &str,
    model: &str,
    amplitudes: &[Amplitude],
    units: Option<UnitChoice>,
    settings: &Settings,
    mut table: Table,
) -> Result<String, toml::ser::Error> {
    table.insert("name".into(), name.into());
    table.insert("model".into(), model.into());
    table.extend(units.map(|units| (UNITS.to_string(), Value::from(units.to_string()))));
    let levels = amplitudes.iter().map(|amplitude| Value::from(amplitude.text.as_str())).collect();
    table.insert("amplitudes".into(), Value::Array(levels));
    table.extend(Table::try_from(settings)?);
    toml::to_string(&table)
}
