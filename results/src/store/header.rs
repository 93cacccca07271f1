//! What does not change in the course of a run, and the small facts in `meta`.

use super::arrays::insert;
use super::displacement::Displacements;
use super::error::At;
use super::{Result, RunHeader, StoreError};
use protocol::codec::{decode_stored, encode};
use protocol::ids::RunId;
use protocol::model::ModelMessage;
use protocol::to_everyone::{Amplitude, Stage};
use rusqlite::types::FromSql;
use rusqlite::{Connection, OptionalExtension, ToSql, params};
use serde::Serialize;
use serde::de::DeserializeOwned;
use solver::settings::Settings;
use solver::structure::laws::Law;
use std::path::{Path, PathBuf};

/// Bytes for the program itself.
pub(super) fn pack<T: Serialize>(value: &T) -> Vec<u8> {
    rmp_serde::to_vec_named(value).expect("structures of numbers have MessagePack forms")
}

/// Back from [`pack`].
pub(super) fn unpack<T: DeserializeOwned>(file: &Path, bytes: &[u8]) -> Result<T> {
    rmp_serde::from_slice(bytes).map_err(|error| corrupt(file, error))
}

/// What is stored makes no sense.
pub(super) fn corrupt(file: &Path, detail: impl std::fmt::Display) -> StoreError {
    StoreError::Corrupt { file: file.into(), detail: detail.to_string() }
}

/// Notes a fact.
pub(super) fn set(db: &Connection, file: &Path, key: &str, value: impl ToSql) -> Result<()> {
    let sql = "INSERT INTO meta (key, value) VALUES (?1, ?2) ON CONFLICT (key) DO UPDATE SET value = excluded.value";
    db.prepare_cached(sql).at(file)?.execute(params![key, value]).at(file)?;
    Ok(())
}

/// A fact, if it is known.
pub(super) fn get<T: FromSql>(db: &Connection, file: &Path, key: &str) -> Result<Option<T>> {
    let mut statement = db.prepare_cached("SELECT value FROM meta WHERE key = ?1").at(file)?;
    statement.query_row([key], |row| row.get(0)).optional().at(file)
}

/// A fact that every run has.
fn fact<T: FromSql>(db: &Connection, file: &Path, key: &str) -> Result<T> {
    get(db, file, key)?.ok_or_else(|| corrupt(file, format!("`{key}` is missing in `meta`")))
}

/// Stores the header of a run that begins.
pub(super) fn insert_header(db: &Connection, file: &Path, header: &RunHeader) -> Result<()> {
    set(db, file, "run", header.run.as_str())?;
    set(db, file, "name", &header.name)?;
    set(db, file, "study_file", header.study_file.to_string_lossy())?;
    set_study(db, file, &header.study, &header.overrides)?;
    set(db, file, "model_sha256", &header.model_sha256)?;
    set(db, file, "program", &header.program)?;
    set(db, file, "created", &header.created)?;
    set(db, file, "namespace", &header.namespace)?;
    set(db, file, "settings", pack(&header.settings))?;
    set_stage(db, file, Stage::Backbone)?;
    insert_amplitudes(db, file, &header.amplitudes)?;
    insert_model(db, file, &header.model)
}

/// Notes the study and what the command line changed in it.
pub(super) fn set_study(db: &Connection, file: &Path, study: &str, overrides: &[(String, String)]) -> Result<()> {
    set(db, file, "overrides", serde_json::to_string(overrides).expect("a list of texts"))?;
    set(db, file, "study", study)
}

/// Stores levels after those that are there.
pub(super) fn insert_amplitudes(db: &Connection, file: &Path, amplitudes: &[Amplitude]) -> Result<()> {
    let sql = "INSERT INTO levels (level, amplitude, value) SELECT count(*) + 1, ?1, ?2 FROM levels";
    let mut statement = db.prepare_cached(sql).at(file)?;
    for amplitude in amplitudes {
        statement.execute(params![amplitude.text, amplitude.value]).at(file)?;
    }
    Ok(())
}

fn insert_model(db: &Connection, file: &Path, model: &ModelMessage) -> Result<()> {
    let displacements = Displacements::new(model).at(file)?;
    let json = |names: Vec<&str>| serde_json::to_string(&names).expect("a list of names");
    let contacts = model.elements.iter().filter(|element| element.law.rigid().is_some());
    let values = params![
        model.name,
        json(model.dofs.iter().map(String::as_str).collect()),
        json(model.monitors.iter().map(|&dof| model.dofs[dof].as_str()).collect()),
        json(displacements.names(model)),
        json(contacts.map(|element| element.name.as_str()).collect()),
        encode(model),
    ];
    let sql = "INSERT INTO model (name, dofs, monitors, displacement_dofs, contacts, payload) \
               VALUES (?1, ?2, ?3, ?4, ?5, ?6)";
    db.execute(sql, values).at(file)?;
    let arrays = [
        ("mass", &model.mass),
        ("stiffness", &model.stiffness),
        ("frequencies", &model.frequencies),
        ("shapes", &model.shapes),
        ("damping", &model.damping),
        ("forcing", &model.forcing),
    ];
    arrays.into_iter().try_for_each(|(name, array)| insert(db, file, "model", name, array))
}

/// The header of a run.
pub(super) fn read_header(db: &Connection, file: &Path) -> Result<RunHeader> {
    let run: String = fact(db, file, "run")?;
    let settings: Vec<u8> = fact(db, file, "settings")?;
    let mut settings: Settings = unpack(file, &settings)?;
    if let Some(effort) = get::<Vec<u8>>(db, file, "verify")? {
        settings.verify.effort = unpack(file, &effort)?;
    }
    let overrides: String = fact(db, file, "overrides")?;
    Ok(RunHeader {
        run: RunId::new(&run).map_err(|error| corrupt(file, error))?,
        name: fact(db, file, "name")?,
        study_file: PathBuf::from(fact::<String>(db, file, "study_file")?),
        overrides: serde_json::from_str(&overrides).map_err(|error| corrupt(file, error))?,
        study: fact(db, file, "study")?,
        model: read_model(db, file)?,
        model_sha256: fact(db, file, "model_sha256")?,
        settings,
        amplitudes: read_levels(db, file)?,
        program: fact(db, file, "program")?,
        created: fact(db, file, "created")?,
        namespace: fact(db, file, "namespace")?,
    })
}

/// The model of a run.
pub(super) fn read_model(db: &Connection, file: &Path) -> Result<ModelMessage> {
    let payload: Vec<u8> = db.query_row("SELECT payload FROM model", [], |row| row.get(0)).at(file)?;
    decode_stored(&payload).map_err(|error| corrupt(file, error))
}

/// The levels of a run, in its order.
pub(super) fn read_levels(db: &Connection, file: &Path) -> Result<Vec<Amplitude>> {
    let mut statement = db.prepare_cached("SELECT amplitude, value FROM levels ORDER BY level").at(file)?;
    let rows = statement.query_map([], |row| Ok(Amplitude { text: row.get(0)?, value: row.get(1)? })).at(file)?;
    rows.collect::<rusqlite::Result<_>>().at(file)
}

fn stage_name(stage: Stage) -> &'static str {
    match stage {
        Stage::Backbone => "backbone",
        Stage::Sweep => "sweep",
        Stage::Finished => "finished",
        Stage::Cancelled => "cancelled",
    }
}

/// Notes where a run is.
pub(super) fn set_stage(db: &Connection, file: &Path, stage: Stage) -> Result<()> {
    set(db, file, "stage", stage_name(stage))
}

/// Where a run is.
pub(super) fn read_stage(db: &Connection, file: &Path) -> Result<Stage> {
    let name: String = fact(db, file, "stage")?;
    let stages = [Stage::Backbone, Stage::Sweep, Stage::Finished, Stage::Cancelled];
    let stage = stages.into_iter().find(|&stage| stage_name(stage) == name);
    stage.ok_or_else(|| corrupt(file, format!("`{name}` is no stage")))
}
