//! Backbones, windows and tasks: what is known once the backbones are.

use super::arrays::{empty_points, fill, insert, insert_rest, of_backbone, of_backbone_mut};
use super::comparisons::forget_comparisons;
use super::database::version;
use super::displacement::Displacements;
use super::error::At;
use super::header::{corrupt, get, pack, read_levels, read_model, set, unpack};
use super::points_table::BACKBONE;
use super::scalars::{Scalars, scalars};
use super::{Result, StoreError};
use crate::journal::{AddedTask, LevelPlan, MorePlan, OrderPlan, SweepPlan, kind};
use protocol::backbone::BackboneMessage;
use protocol::codec::{decode_stored, encode};
use protocol::ids::TaskId;
use rusqlite::{Connection, Row, params};
use solver::response::columns::of_backbone_in_files;
use solver::response::forced::SearchRange;
use solver::response::modes::{LeftOut, ModesFollowed};
use solver::response::seeds::{LandingMethod, Phase};
use solver::response::starts::StartWay;
use solver::response::task::{BranchEnd, CarryPlace, CrossingPlace, FoldPlace, SeedPlace, Task, VerifyPlace};
use solver::response::windows::Window;
use solver::settings::Stretch;
use std::collections::HashMap;
use std::path::Path;

const OWNER: &str = "backbone";
const ORDERS: &str = "orders";
/// The first version of the schema that knows several modes.
const WITH_MODES: i64 = 3;

/// Stores the backbones with everything that follows from them.
pub(super) fn insert_plan(db: &Connection, file: &Path, plan: &SweepPlan, displacements: &Displacements) -> Result<()> {
    let SweepPlan { backbone, further, left_out, reach, orders, levels, added } = plan;
    let mut omega = Frequencies::new();
    for (place, backbone) in std::iter::once(backbone).chain(further).enumerate() {
        let owner = owner((place > 0).then_some(backbone.mode));
        insert_backbone(db, file, &owner, backbone, displacements)?;
        insert_mode(db, file, backbone.mode, Some(place), &backbone.outcome, encode(&without_numbers(backbone)))?;
        omega.insert((None, backbone.mode), frequencies(file, backbone)?);
    }
    for (mode, why) in left_out {
        insert_mode(db, file, *mode, None, why, pack(why))?;
    }
    set(db, file, "backbone", encode(&without_numbers(backbone)))?;
    set(db, file, "backbone_status", backbone.outcome.to_string())?;
    insert_reach(db, file, reach)?;
    insert_orders(db, file, orders, &mut omega)?;
    insert_levels(db, file, levels, &omega)?;
    insert_added(db, file, added)
}

/// Frequencies of the points of backbones, by order, if it is not the first, and mode.
type Frequencies = HashMap<(Option<usize>, usize), Vec<f64>>;

/// Stores what further orders of motions are looked for with.
fn insert_orders(db: &Connection, file: &Path, orders: &[OrderPlan], omega: &mut Frequencies) -> Result<()> {
    if orders.is_empty() {
        return Ok(());
    }
    for OrderPlan { order, backbones, .. } in orders {
        for backbone in backbones {
            omega.insert((Some(*order), backbone.mode), frequencies(file, backbone)?);
        }
    }
    set(db, file, ORDERS, pack(&orders))
}

/// What further orders of motions are looked for with; none as long as there is no backbone.
pub(super) fn read_orders(db: &Connection, file: &Path) -> Result<Vec<OrderPlan>> {
    get::<Vec<u8>>(db, file, ORDERS)?.map_or_else(|| Ok(Vec::new()), |bytes| unpack(file, &bytes))
}

/// Stores what follows from the backbones for levels that are added.
pub(super) fn insert_more(db: &Connection, file: &Path, more: &MorePlan) -> Result<()> {
    let MorePlan { reach, orders, levels } = more;
    let mut omega = Frequencies::new();
    for backbone in read_backbone(db, file)?.into_iter().chain(read_further(db, file)?) {
        omega.insert((None, backbone.mode), frequencies(file, &backbone)?);
    }
    let reach_of = |orders: &[OrderPlan]| orders.iter().map(|plan| (plan.order, plan.reach)).collect::<Vec<_>>();
    if read_reach(db, file)?.as_ref() != Some(reach) || reach_of(&read_orders(db, file)?) != reach_of(orders) {
        forget_comparisons(db, file)?;
    }
    insert_reach(db, file, reach)?;
    insert_orders(db, file, orders, &mut omega)?;
    insert_levels(db, file, levels, &omega)
}

/// Frequencies of the points of a backbone.
fn frequencies(file: &Path, backbone: &BackboneMessage) -> Result<Vec<f64>> {
    backbone.points.motions.omega.values("omega", &[backbone.points.len()]).at(file)
}

/// Owner of the arrays of a backbone, if it is of a further mode.
fn owner(further: Option<usize>) -> String {
    further.map_or_else(|| OWNER.into(), further_owner)
}

/// Owner of the arrays of the backbone of a further mode, from 0.
pub(crate) fn further_owner(mode: usize) -> String {
    format!("{OWNER}/{}", mode + 1)
}

fn insert_backbone(
    db: &Connection,
    file: &Path,
    owner: &str,
    backbone: &BackboneMessage,
    displacements: &Displacements,
) -> Result<()> {
    let held = insert_points(db, file, backbone)?;
    insert_rest(db, file, owner, &of_backbone(backbone), &held)?;
    insert(db, file, owner, "displacement", &displacements.array(&backbone.points.motions).at(file)?)
}

fn insert_mode(
    db: &Connection,
    file: &Path,
    mode: usize,
    place: Option<usize>,
    outcome: &impl ToString,
    record: Vec<u8>,
) -> Result<()> {
    let sql = "INSERT INTO modes (mode, place, outcome, record) VALUES (?1, ?2, ?3, ?4)";
    db.prepare_cached(sql).at(file)?.execute(params![mode + 1, place, outcome.to_string(), record]).at(file)?;
    Ok(())
}

/// Stores the reach that follows from the backbones.
fn insert_reach(db: &Connection, file: &Path, reach: &SearchRange) -> Result<()> {
    set(db, file, "reach", pack(reach))?;
    set(db, file, "omega_low", reach.frequency.0)?;
    set(db, file, "omega_high", reach.frequency.1)?;
    set(db, file, "amplitude_bound", reach.amplitude)
}

fn without_numbers(backbone: &BackboneMessage) -> BackboneMessage {
    BackboneMessage {
        mode: backbone.mode,
        outcome: backbone.outcome,
        crossing: backbone.crossing.clone(),
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
    BACKBONE.insert(db, file, key(backbone.mode), &[&omega, &zeta], &columns)
}

/// Number of a mode, from 1, as tables have it.
fn key(mode: usize) -> i64 {
    mode as i64 + 1
}

/// The backbone of the primary mode, once it is known.
pub(super) fn read_backbone(db: &Connection, file: &Path) -> Result<Option<BackboneMessage>> {
    let Some(record) = get::<Vec<u8>>(db, file, "backbone")? else { return Ok(None) };
    filled(db, file, &record, false).map(Some)
}

/// A backbone with its numbers.
fn filled(db: &Connection, file: &Path, record: &[u8], is_further: bool) -> Result<BackboneMessage> {
    let mut backbone: BackboneMessage = decode_stored(record).map_err(|error| corrupt(file, error))?;
    let (owner, key) = (owner(is_further.then_some(backbone.mode)), key(backbone.mode));
    fill(db, file, (&owner, &BACKBONE), key, of_backbone_mut(&mut backbone))?;
    Ok(backbone)
}

/// The backbones of further modes, in their order.
pub(super) fn read_further(db: &Connection, file: &Path) -> Result<Vec<BackboneMessage>> {
    if version(db, file)? < WITH_MODES {
        return Ok(Vec::new());
    }
    let mut statement = db.prepare_cached("SELECT record FROM modes WHERE place > 0 ORDER BY place").at(file)?;
    let records = statement.query_map([], |row| row.get::<_, Vec<u8>>(0)).at(file)?;
    records.map(|record| filled(db, file, &record.at(file)?, true)).collect()
}

/// Which modes have a backbone, and which not.
pub(super) fn read_modes(db: &Connection, file: &Path) -> Result<Option<ModesFollowed>> {
    let Some(record) = get::<Vec<u8>>(db, file, "backbone")? else { return Ok(None) };
    let Some(left_out) = read_left_out(db, file)? else {
        let primary = decode_stored::<BackboneMessage>(&record).map_err(|error| corrupt(file, error))?.mode;
        let others = (0..read_model(db, file)?.dofs.len()).filter(|&mode| mode != primary);
        let left_out = others.map(|mode| (mode, LeftOut::NotListed)).collect();
        return Ok(Some(ModesFollowed { followed: vec![primary], left_out }));
    };
    let sql = "SELECT mode - 1 FROM modes WHERE place IS NOT NULL ORDER BY place";
    let mut statement = db.prepare_cached(sql).at(file)?;
    let followed = statement.query_map([], |row| row.get(0)).at(file)?.collect::<rusqlite::Result<_>>().at(file)?;
    Ok(Some(ModesFollowed { followed, left_out }))
}

/// Modes without a backbone, from 0, and why.
pub(super) fn read_left_out(db: &Connection, file: &Path) -> Result<Option<Vec<(usize, LeftOut)>>> {
    if version(db, file)? < WITH_MODES || get::<Vec<u8>>(db, file, "backbone")?.is_none() {
        return Ok(None);
    }
    let sql = "SELECT mode, record FROM modes WHERE place IS NULL ORDER BY mode";
    let mut statement = db.prepare_cached(sql).at(file)?;
    let rows = statement.query_map([], |row| Ok((row.get::<_, usize>(0)?, row.get::<_, Vec<u8>>(1)?))).at(file)?;
    let list = rows.map(|row| {
        let (number, record) = row.at(file)?;
        let mode = number.checked_sub(1).ok_or_else(|| corrupt(file, "modes are counted from 1"))?;
        Ok((mode, unpack(file, &record)?))
    });
    list.collect::<Result<_>>().map(Some)
}

/// The reach, once it is known.
pub(super) fn read_reach(db: &Connection, file: &Path) -> Result<Option<SearchRange>> {
    get::<Vec<u8>>(db, file, "reach")?.map(|bytes| unpack(file, &bytes)).transpose()
}

/// Stores windows and tasks of all levels.
fn insert_levels(db: &Connection, file: &Path, plans: &[LevelPlan], omega: &Frequencies) -> Result<()> {
    for plan in plans {
        let text = &plan.amplitude.text;
        let level = number_of_level(db, file, text)?;
        for (i, window) in plan.windows.iter().enumerate() {
            let best =
                omega.get(&(plan.amplitude.order(), window.mode)).and_then(|omega| omega.get(window.best)).copied();
            insert_window(db, file, level, i + 1, window, best.unwrap_or(window.omega.0))?;
        }
        for (i, task) in plan.tasks.iter().enumerate() {
            let id = TaskId::of_level(text, i).expect("amplitudes are numbers");
            insert_task(db, file, level, i, &id, task)?;
        }
    }
    Ok(())
}

/// Number of the level whose amplitude was typed so.
fn number_of_level(db: &Connection, file: &Path, amplitude: &str) -> Result<i64> {
    let sql = "SELECT level FROM levels WHERE amplitude = ?1";
    db.prepare_cached(sql).at(file)?.query_row([amplitude], |row| row.get(0)).at(file)
}

/// Stores tasks that were added, each after those of its chain or kind.
pub(super) fn insert_added(db: &Connection, file: &Path, added: &[AddedTask]) -> Result<()> {
    for AddedTask { id, amplitude, task } in added {
        let level = number_of_level(db, file, amplitude)?;
        let sql = match task {
            Task::Fold(_) | Task::Carry(_) => "SELECT count(*) FROM tasks WHERE kind IN ('fold', 'carry') AND ?1",
            Task::Verify(_) => "SELECT count(*) FROM tasks WHERE kind = 'verify' AND ?1",
            Task::Disturb(_) => "SELECT count(*) FROM tasks WHERE kind = 'disturb' AND ?1",
            Task::March(_) => "SELECT count(*) FROM tasks WHERE kind = 'march' AND ?1",
            _ => {
                "SELECT count(*) FROM tasks WHERE kind NOT IN ('fold', 'carry', 'verify', 'disturb', 'march') AND level = ?1"
            }
        };
        let position: usize = db.prepare_cached(sql).at(file)?.query_row([level], |row| row.get(0)).at(file)?;
        insert_task(db, file, level, position, id, task)?;
    }
    Ok(())
}

fn insert_window(
    db: &Connection,
    file: &Path,
    level: i64,
    number: usize,
    window: &Window,
    omega_best: f64,
) -> Result<()> {
    let sql = "INSERT INTO windows (level, window, mode, omega_min, omega_max, omega_best, threshold, first, last, best) \
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)";
    let Window { mode, first, last, best, threshold, omega: (low, high) } = *window;
    let row = params![level, number, key(mode), low, high, omega_best, threshold, first, last, best];
    db.prepare_cached(sql).at(file)?.execute(row).at(file)?;
    Ok(())
}

fn insert_task(db: &Connection, file: &Path, level: i64, position: usize, id: &TaskId, task: &Task) -> Result<()> {
    let sql = "INSERT INTO tasks (id, level, position, kind, window, phase, way, work, origin) \
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)";
    let (place, origin) = match task {
        Task::Main(_) => (None, None),
        Task::Land(place) => (Some(place), None),
        Task::Seed(place) => (Some(place), None),
        Task::Fold(FoldPlace::Branch { branch, fold }) => (None, Some(format!("{branch}, fold {}", fold + 1))),
        Task::Fold(FoldPlace::Scout { scout, fold }) => {
            (None, Some(format!("scout {}, fold {}", scout.number + 1, fold + 1)))
        }
        Task::Crossing(CrossingPlace { curve, .. }) => (None, Some(format!("curve {}", curve + 1))),
        Task::Switch(place) => (None, Some(format!("{}, branch point {}", place.branch, place.point + 1))),
        Task::Carry(CarryPlace { branch, end: BranchEnd::First }) => (None, Some(format!("{branch}, first end"))),
        Task::Carry(CarryPlace { branch, end: BranchEnd::Last }) => (None, Some(format!("{branch}, last end"))),
        Task::Start(place) | Task::Begin(place) => {
            let way = match place.way {
                StartWay::Direct => "starts",
                StartWay::Homotopy => "homotopies",
            };
            (None, Some(format!("{way}, batch {}", place.batch + 1)))
        }
        Task::Scout(place) => (None, Some(format!("scout {}", place.number + 1))),
        Task::Verify(place) => (None, Some(of_verification(place))),
        Task::Disturb(place) => (None, Some(format!("{}, mode {}", place.branch, place.mode + 1))),
        Task::March(place) => (None, Some(format!("{}, point {}", place.branch, place.index))),
    };
    let row = params![
        id.as_str(),
        level,
        position,
        kind(task),
        place.map(|place| place.window + 1),
        place.map(phase_name),
        place.map(way_name),
        pack(task),
        origin,
    ];
    db.prepare_cached(sql).at(file)?.execute(row).at(file)?;
    Ok(())
}

fn of_verification(VerifyPlace { branch, stretch }: &VerifyPlace) -> String {
    match stretch {
        Stretch::Whole => branch.to_string(),
        Stretch::Peak => format!("{branch}, around its peak"),
    }
}

fn phase_name(place: &SeedPlace) -> &'static str {
    match place.phase {
        Phase::First => "first",
        Phase::Second => "second",
    }
}

fn way_name(place: &SeedPlace) -> &'static str {
    match place.method {
        LandingMethod::FullForcing => "fixed_frequency",
        LandingMethod::SteppedForcing => "stepped_forcing",
    }
}

/// Windows and tasks of every level, of a run of this version; empty as long as there is no backbone.
pub(super) fn read_plans(db: &Connection, file: &Path) -> Result<Vec<LevelPlan>> {
    if get::<Vec<u8>>(db, file, "backbone")?.is_none() {
        return Ok(Vec::new());
    }
    let level = |amplitude| LevelPlan { amplitude, windows: Vec::new(), tasks: Vec::new() };
    let mut plans: Vec<LevelPlan> = read_levels(db, file)?.into_iter().map(level).collect();
    let sql = "SELECT level, first, last, best, threshold, omega_min, omega_max, mode - 1 FROM windows \
               ORDER BY level, window";
    for_each_level(db, file, &mut plans, sql, |plan, row| {
        let omega = (row.get(5).at(file)?, row.get(6).at(file)?);
        let (first, last, best) = (row.get(1).at(file)?, row.get(2).at(file)?, row.get(3).at(file)?);
        let (mode, threshold) = (row.get(7).at(file)?, row.get(4).at(file)?);
        plan.windows.push(Window { mode, first, last, best, threshold, omega });
        Ok(())
    })?;
    for_each_level(
        db,
        file,
        &mut plans,
        "SELECT level, work FROM tasks WHERE kind NOT IN ('fold', 'carry', 'verify', 'disturb', 'march') \
         ORDER BY level, position",
        |plan, row| {
            let work: Vec<u8> = row.get(1).at(file)?;
            plan.tasks.push(unpack(file, &work)?);
            Ok(())
        },
    )?;
    Ok(plans)
}

/// The tasks that were added over all levels, those of a kind in their order.
pub(super) fn read_added(db: &Connection, file: &Path) -> Result<Vec<AddedTask>> {
    let sql = "SELECT id, amplitude, work FROM tasks JOIN levels USING (level) \
               WHERE kind IN ('fold', 'carry', 'verify', 'disturb', 'march') \
               ORDER BY CASE kind WHEN 'carry' THEN 'fold' ELSE kind END, position";
    let mut statement = db.prepare_cached(sql).at(file)?;
    let mut rows = statement.query([]).at(file)?;
    let mut added = Vec::new();
    while let Some(row) = rows.next().at(file)? {
        let (id, work): (String, Vec<u8>) = (row.get(0).at(file)?, row.get(2).at(file)?);
        let id = TaskId::new(&id).map_err(|error| corrupt(file, error))?;
        added.push(AddedTask { id, amplitude: row.get(1).at(file)?, task: unpack(file, &work)? });
    }
    Ok(added)
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
