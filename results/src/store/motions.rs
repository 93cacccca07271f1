//! What unstable motions turn into: written with the results of the tasks that marched them.

use super::error::At;
use super::verifications::branch_of;
use super::{Reader, Result};
use protocol::ids::TaskId;
use protocol::level::typed;
use rusqlite::{Connection, Row, params};
use serde::Serialize;
use solver::response::task::MarchPlace;
use solver::stability::settling::{Motion, Settling};
use std::path::Path;

/// First version of the schema that has them.
const SINCE: i64 = 5;

/// What an unstable motion of a branch turns into.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MotionRow {
    /// Forcing amplitude as typed.
    pub forcing: String,
    /// Name of the branch.
    pub branch: String,
    /// Number of the point on the branch that it was marched from, from 0.
    pub point: usize,
    /// Frequency, rad/s.
    pub omega: f64,
    /// A word of [`motion_name`]; `unclear` where marching did not tell.
    pub motion: String,
    /// Periods of the response after which it repeats itself, if it does.
    pub repeats: Option<usize>,
    /// Name of the branch that it ends on, if it is one of those found.
    pub onto: Option<String>,
    /// Smallest and largest of the largest |x| of the first monitored dof in a period, m; nothing if it could not be marched.
    pub amplitude: Option<(f64, f64)>,
    /// Growth rate of small deviations per period, of a motion that does not repeat itself.
    pub growth: Option<f64>,
    /// Periods that were marched.
    pub periods: usize,
}

/// The word for a motion in tables and files.
pub fn motion_name(motion: Option<Motion>) -> &'static str {
    match motion {
        Some(Motion::Periodic(_)) => "periodic",
        Some(Motion::QuasiPeriodic) => "quasi_periodic",
        Some(Motion::Chaotic) => "chaotic",
        None => "unclear",
    }
}

/// Stores what an unstable motion of the level whose amplitude was typed as `amplitude` turns into.
pub(super) fn insert_motion(
    db: &Connection,
    file: &Path,
    (task, amplitude, place): (&TaskId, &str, &MarchPlace),
    found: &Settling,
) -> Result<()> {
    let (branch, _) = branch_of(db, file, amplitude, place.branch)?;
    let repeats = match found.motion {
        Some(Motion::Periodic(count)) => Some(count),
        _ => None,
    };
    let range = found.amplitudes.first();
    let sql = "INSERT INTO motions (task, branch, i, omega, motion, repeats, onto, amplitude_min, amplitude_max, growth, periods) \
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)";
    let row = params![
        task.as_str(),
        branch,
        found.index,
        found.omega,
        motion_name(found.motion),
        repeats,
        found.onto.map(|onto| onto.to_string()),
        range.map(|range| range[0]),
        range.map(|range| range[1]),
        found.growth,
        found.periods,
    ];
    db.prepare_cached(sql).at(file)?.execute(row).at(file).map(|_| ())
}

impl Reader {
    /// What unstable motions of the branch that a task found turn into.
    pub fn settlings(&self, task: &str) -> Result<Vec<Settling>> {
        if self.version()? < SINCE {
            return Ok(Vec::new());
        }
        let sql = "SELECT motions.task FROM motions JOIN branches ON branches.id = branch WHERE branches.task = ?1 ORDER BY i";
        let names: Vec<String> = self.all(sql, [task], |row| row.get(0))?;
        let settling = |name: String| {
            let found = self.result(&self.task_id(&name)?)?.and_then(|result| result.settling);
            found.ok_or_else(|| self.corrupt(format!("the result of task {name} is no motion")))
        };
        names.into_iter().map(settling).collect()
    }

    /// What unstable motions turn into, level by level in the order of the study, branch by branch and along each.
    pub fn motions(&self) -> Result<Vec<MotionRow>> {
        if self.version()? < SINCE {
            return Ok(Vec::new());
        }
        let sql = "SELECT branches.amplitude, kind, number, i, omega, motion, repeats, onto, amplitude_min, motions.amplitude_max, \
                   growth, periods FROM motions JOIN branches ON branches.id = branch ORDER BY level, branches.id, i";
        let rows = self.all(sql, [], |row: &Row<'_>| {
            let (kind, number): (String, usize) = (row.get(1)?, row.get(2)?);
            let low: Option<f64> = row.get(8)?;
            let motion = MotionRow {
                forcing: row.get(0)?,
                branch: String::new(),
                point: row.get(3)?,
                omega: row.get(4)?,
                motion: row.get(5)?,
                repeats: row.get(6)?,
                onto: row.get(7)?,
                amplitude: low.zip(row.get(9)?),
                growth: row.get(10)?,
                periods: row.get(11)?,
            };
            Ok((kind, number, motion))
        })?;
        let rows = rows.into_iter().filter(|(_, _, motion)| self.tells_of(&motion.forcing));
        let named = |(kind, number, motion): (String, usize, MotionRow)| {
            let forcing = typed(&motion.forcing).into();
            Ok(MotionRow { branch: self.branch_name(&kind, number)?, forcing, ..motion })
        };
        rows.map(named).collect()
    }
}
