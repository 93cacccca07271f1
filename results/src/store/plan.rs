//! Backbone, windows and tasks: what is known once the backbone is.

use super::arrays::{empty_points, fill, insert, insert_rest, of_backbone, of_backbone_mut};
use super::displacement::Displacements;
use super::error::At;
use super::header::{corrupt, get, pack, read_levels, set, unpack};
use super::points_table::BACKBONE;
use super::scalars::{Scalars, scalars};
use super::{Result, StoreError};
use crate::journal::{LevelPlan, SweepPlan};
use protocol::backbone::BackboneMessage;
use protocol::codec::{decode_stored, encode};
use protocol::ids::TaskId;
use rusqlite::{Connection, Row, params};
use solver::response::columns::of_backbone_in_files;
use solver::response::forced::Reach;
use solver::response::seeds::{Phase, Way};
use solver::response::task::{SeedPlace, Task};
use solver::response::windows::Window;
use std::path::Path;

const OWNER: &str = "backbone";

/// Stores the backbone with everything that follows from it.
pub(super) fn insert_plan(db: &Connection, file: &Path, plan: &SweepPlan, displacements: &Displacements) -> Result<()> {
    let SweepPlan { backbone, reach, levels } = plan;
    insert_backbone(db, file, backbone, reach, displacements)?;
    let omega = backbone.points.motions.omega.values("omega", &[backbone.points.len()]).at(file)?;
    insert_levels(db, file, levels, &omega)
}

/// Stores the backbone and the reach that follows from it.
fn insert_backbone(
    db: &Connection,
    file: &Path,
    backbone: &BackboneMessage,
    reach: &Reach,
    displacements: &Displacements,
) -> Result<()> {
    let held = insert_points(db, file, backbone)?;
    insert_rest(db, file, OWNER, &of_backbone(backbone), &held)?;
    insert(db, file, OWNER, "displacement", &displacements.array(&backbone.points.motions).at(file)?)?;
    set(db, file, "backbone", encode(&without_numbers(backbone)))?;
    set(db, file, "backbone_status", backbone.outcome.to_string())?;
    set(db, file, "reach", pack(reach))?;
    set(db, file, "omega_low", reach.frequency.0)?;
    set(db, file, "omega_high", reach.frequency.1)?;
    set(db, file, "amplitude_bound", reach.amplitude)
}

fn without_numbers(backbone: &BackboneMessage) -> BackboneMessage {
    BackboneMessage {
        mode: backbone.mode,
        outcome: backbone.outcome,
        rejections: backbone.rejections,
        points: empty_points(&backbone.points),
        columns: backbone.columns.emptied(),
    }
}

/// Stores the points; returns the arrays that their table holds.
fn insert_points(db: &Connection, file: &Path, backbone: &BackboneMessage) -> Result<Vec<&'static str>> {
    let count = backbone.points.len();
    let Scalars { omega, mut columns } = Scalars::new(&backbone.points).at(file)?;
    let zeta = backbone.points.motions.decay.values("decay", &[count]).at(file)?;
    columns.append(&mut scalars(&backbone.columns, of_backbone_in_files(), count).at(file)?);
    BACKBONE.insert(db, file, None, &[&omega, &zeta], &columns)
}

/// The backbone, once it is known.
pub(super) fn read_backbone(db: &Connection, file: &Path) -> Result<Option<BackboneMessage>> {
    let Some(record) = get::<Vec<u8>>(db, file, "backbone")? else { return Ok(None) };
    let mut backbone: BackboneMessage = decode_stored(&record).map_err(|error| corrupt(file, error))?;
    fill(db, file, (OWNER, &BACKBONE), None, of_backbone_mut(&mut backbone))?;
    Ok(Some(backbone))
}

/// The reach, once it is known.
pub(super) fn read_reach(db: &Connection, file: &Path) -> Result<Option<Reach>> {
    get::<Vec<u8>>(db, file, "reach")?.map(|bytes| unpack(file, &bytes)).transpose()
}

/// Stores windows and tasks of all levels; `omega` are the frequencies of the backbone.
fn insert_levels(db: &Connection, file: &Path, plans: &[LevelPlan], omega: &[f64]) -> Result<()> {
    for plan in plans {
        let sql = "SELECT level FROM levels WHERE amplitude = ?1";
        let text = &plan.amplitude.text;
        let level: i64 = db.prepare_cached(sql).at(file)?.query_row([text], |row| row.get(0)).at(file)?;
        for (i, window) in plan.windows.iter().enumerate() {
            insert_window(db, file, level, i + 1, window, omega)?;
        }
        for (i, task) in plan.tasks.iter().enumerate() {
            let id = TaskId::of_level(text, i).expect("amplitudes are numbers");
            insert_task(db, file, level, i, &id, task)?;
        }
    }
    Ok(())
}

fn insert_window(
    db: &Connection,
    file: &Path,
    level: i64,
    number: usize,
    window: &Window,
    omega: &[f64],
) -> Result<()> {
    let sql = "INSERT INTO windows (level, window, omega_min, omega_max, omega_best, threshold, first, last, best) \
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)";
    let (low, high) = window.omega;
    let best = omega.get(window.best).copied().unwrap_or(low);
    let row = params![level, number, low, high, best, window.threshold, window.first, window.last, window.best];
    db.prepare_cached(sql).at(file)?.execute(row).at(file)?;
    Ok(())
}

fn insert_task(db: &Connection, file: &Path, level: i64, position: usize, id: &TaskId, task: &Task) -> Result<()> {
    let sql = "INSERT INTO tasks (id, level, position, kind, window, phase, way, work) \
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)";
    let (kind, place) = match task {
        Task::Main(_) => ("main", None),
        Task::Seed(place) => ("seed", Some(place)),
    };
    let row = params![
        id.as_str(),
        level,
        position,
        kind,
        place.map(|place| place.window + 1),
        place.map(phase_name),
        place.map(way_name),
        pack(task),
    ];
    db.prepare_cached(sql).at(file)?.execute(row).at(file)?;
    Ok(())
}

fn phase_name(place: &SeedPlace) -> &'static str {
    match place.phase {
        Phase::First => "first",
        Phase::Second => "second",
    }
}

fn way_name(place: &SeedPlace) -> &'static str {
    match place.way {
        Way::FixedFrequency => "fixed_frequency",
        Way::SteppedForcing => "stepped_forcing",
    }
}

/// Windows and tasks of every level; empty as long as there is no backbone.
pub(super) fn read_plans(db: &Connection, file: &Path) -> Result<Vec<LevelPlan>> {
    if get::<Vec<u8>>(db, file, "backbone")?.is_none() {
        return Ok(Vec::new());
    }
    let level = |amplitude| LevelPlan { amplitude, windows: Vec::new(), tasks: Vec::new() };
    let mut plans: Vec<LevelPlan> = read_levels(db, file)?.into_iter().map(level).collect();
    let sql = "SELECT level, first, last, best, threshold, omega_min, omega_max FROM windows ORDER BY level, window";
    for_each_level(db, file, &mut plans, sql, |plan, row| {
        let omega = (row.get(5).at(file)?, row.get(6).at(file)?);
        let (first, last, best) = (row.get(1).at(file)?, row.get(2).at(file)?, row.get(3).at(file)?);
        plan.windows.push(Window { first, last, best, threshold: row.get(4).at(file)?, omega });
        Ok(())
    })?;
    for_each_level(db, file, &mut plans, "SELECT level, work FROM tasks ORDER BY level, position", |plan, row| {
        let work: Vec<u8> = row.get(1).at(file)?;
        plan.tasks.push(unpack(file, &work)?);
        Ok(())
    })?;
    Ok(plans)
}

/// Hands every row that `sql` selects to its level, named in the first column.
fn for_each_level(
    db: &Connection,
    file: &Path,
    plans: &mut [LevelPlan],
    sql: &str,
    add: impl Fn(&mut LevelPlan, &Row<'_>) -> std::result::Result<(), StoreError>,
) -> Result<()> {
    let mut statement = db.prepare_cached(sql).at(file)?;
    let mut rows = statement.query([]).at(file)?;
    while let Some(row) = rows.next().at(file)? {
        let level: usize = row.get(0).at(file)?;
        let plan = level.checked_sub(1).and_then(|l| plans.get_mut(l));
        add(plan.ok_or_else(|| corrupt(file, format!("there is no level {level}")))?, row)?;
    }
    Ok(())
}
