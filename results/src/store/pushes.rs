//! What pushes do to the main motion: written with the results of the tasks that marched them.

use super::error::At;
use super::verifications::branch_of;
use super::{Reader, Result};
use crate::journal::AddedTask;
use protocol::ids::TaskId;
use protocol::level::typed;
use rusqlite::{Connection, Row, params};
use serde::Serialize;
use solver::response::task::{BranchId, DisturbPlace, Task};
use solver::stability::disturbance::Disturbance;
use solver::stability::endings::Ending;
use std::path::Path;

/// First version of the schema that has pushes, and the first one that has where motions from rest end.
const SINCE: i64 = 4;
const FROM_REST_SINCE: i64 = 13;

/// Pushes in one mode from the main motion of a level, and which of them is the smallest found that ends on a branch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PushRow {
    /// Forcing amplitude as typed.
    pub forcing: String,
    /// Name of the branch.
    pub branch: String,
    /// Number of the mode, from 1.
    pub mode: usize,
    /// Frequency of both motions, rad/s.
    pub omega: f64,
    /// Number of the monitored dof that the impulses are given for, from 0.
    pub monitor: usize,
    /// Motions that were marched in the scan.
    pub motions: usize,
    /// The largest impulse that was scanned, N s; nothing if none was.
    pub largest: Option<f64>,
    /// The smallest impulse found that ends on the branch, N s at the monitored dof, if there is one.
    pub impulse: Option<f64>,
    /// The largest smaller one at the same phase that was seen not to, N s.
    pub below: Option<f64>,
    /// What it changes the velocity of the monitored dof by, m/s.
    pub velocity: Option<f64>,
    /// When it acts, as a share of the period of the motion from an instant at which the force is largest.
    pub phase: Option<f64>,
    /// Whether both were marched until they were beyond doubt where they end.
    pub confirmed: Option<bool>,
    /// Why nothing was scanned.
    pub reason: Option<String>,
    /// Where the motion ends that begins when the forcing is switched on at rest; not known without either motion.
    pub from_rest: Option<Ending>,
}

impl PushRow {
    /// The kinetic energy that the smallest push found gives a structure at rest, J: what pushes at different dofs and in different modes
    /// are compared by.
    pub fn energy(&self) -> Option<f64> {
        // Impulse s/|φ| and velocity s|φ| of a mode of unit mass; runs of before 2026-11-27 may have the latter in the other sense.
        Some(0.5 * self.impulse? * self.velocity?.abs())
    }
}

/// The push of least energy.
pub fn least_energy<'p>(pushes: impl IntoIterator<Item = &'p PushRow>) -> Option<&'p PushRow> {
    let found = pushes.into_iter().filter_map(|push| Some((push.energy()?, push)));
    found.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, push)| push)
}

/// Stores what pushes onto a branch of the level whose amplitude was typed as `amplitude` do.
pub(super) fn insert_push(
    db: &Connection,
    file: &Path,
    (task, amplitude, place): (&TaskId, &str, &DisturbPlace),
    found: &Disturbance,
) -> Result<()> {
    let (branch, _) = branch_of(db, file, amplitude, place.branch)?;
    // A mode that does not move the dof has no impulse there.
    let impulse = |size: f64| (found.shape > 0.0).then(|| size / found.shape);
    let push = found.push.as_ref();
    let sql = "INSERT INTO pushes (task, branch, mode, omega, monitor, motions, largest, impulse, below, velocity, phase, \
               confirmed, reason, from_rest) \
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14)";
    let row = params![
        task.as_str(),
        branch,
        found.mode + 1,
        found.omega,
        found.monitor,
        found.endings.len(),
        found.sizes.last().and_then(|size| impulse(*size)),
        push.and_then(|push| impulse(push.size)),
        push.and_then(|push| impulse(push.below)),
        push.map(|push| push.size * found.shape),
        push.map(|push| push.phase as f64 / found.phases as f64),
        push.map(|push| push.is_confirmed),
        found.reason.map(|reason| reason.to_string()),
        found.from_rest.map(Ending::name),
    ];
    db.prepare_cached(sql).at(file)?.execute(row).at(file).map(|_| ())
}

impl Reader {
    /// Number of isolas of which it is not known where they are stable.
    pub fn unverified_isolas(&self) -> Result<usize> {
        let verified = self.isolas()?.into_iter().map(|(.., task)| self.verification(&task));
        verified.filter(|found| !matches!(found, Ok(Some(_)))).map(|found| found.map(|_| 1)).sum()
    }

    /// Amplitude as typed, name and task of every isola, level by level.
    ///
    /// # Errors
    /// If the store cannot be read.
    pub fn isolas(&self) -> Result<Vec<(String, BranchId, String)>> {
        let sql = "SELECT levels.amplitude, number, task FROM branches JOIN levels USING (level) WHERE kind = 'isola' \
                   ORDER BY value, level, number";
        let row = |row: &Row<'_>| {
            let number: usize = row.get(1)?;
            Ok((row.get(0)?, BranchId::isola(number.saturating_sub(1)), row.get(2)?))
        };
        self.all(sql, [], row)
    }

    /// Tasks that push onto every isola with a stable part, in each of the first so many modes, without those that there are.
    pub fn pushes_left(&self, modes: usize) -> Result<Vec<AddedTask>> {
        let known: Vec<String> = self.all("SELECT id FROM tasks WHERE kind = 'disturb'", [], |row| row.get(0))?;
        let mut left = Vec::new();
        for (amplitude, branch, task) in self.isolas()? {
            let Some(omega) = self.verification(&task)?.and_then(|found| found.settled()) else { continue };
            for mode in 0..modes {
                let place = DisturbPlace { branch, mode, omega };
                let id = TaskId::of_disturbance(&amplitude, &place).map_err(|error| self.corrupt(error))?;
                if !known.iter().any(|known| known == id.as_str()) {
                    left.push(AddedTask { id, amplitude: amplitude.clone(), task: Task::Disturb(place) });
                }
            }
        }
        Ok(left)
    }

    /// What pushes do, level by level in the order of the study, branch by branch and mode by mode.
    pub fn pushes(&self) -> Result<Vec<PushRow>> {
        let from_rest = match self.version()? {
            ..SINCE => return Ok(Vec::new()),
            SINCE..FROM_REST_SINCE => "NULL",
            _ => "from_rest",
        };
        let sql = format!(
            "SELECT branches.amplitude, branches.kind, branches.number, mode, omega, monitor, motions, largest, impulse, \
             below, velocity, phase, confirmed, reason, {from_rest} FROM pushes JOIN branches ON branches.id = branch \
             ORDER BY level, branches.id, mode"
        );
        let rows = self.all(&sql, [], |row| {
            let ending: Option<String> = row.get(14)?;
            let (kind, number): (String, usize) = (row.get(1)?, row.get(2)?);
            let push = PushRow {
                forcing: row.get(0)?,
                branch: String::new(),
                mode: row.get(3)?,
                omega: row.get(4)?,
                monitor: row.get(5)?,
                motions: row.get(6)?,
                largest: row.get(7)?,
                impulse: row.get(8)?,
                below: row.get(9)?,
                velocity: row.get(10)?,
                phase: row.get(11)?,
                confirmed: row.get(12)?,
                reason: row.get(13)?,
                from_rest: ending.and_then(|name| Ending::named(&name)),
            };
            Ok((kind, number, push))
        })?;
        let rows = rows.into_iter().filter(|(_, _, push)| self.tells_of(&push.forcing));
        let named = |(kind, number, push): (String, usize, PushRow)| {
            let forcing = typed(&push.forcing).into();
            Ok(PushRow { branch: self.branch_name(&kind, number)?, forcing, ..push })
        };
        rows.map(named).collect()
    }
}
