//! Who computed what, and at what cost.

use super::{Reader, Result};
use protocol::level::typed;
use rusqlite::Row;
use serde::Serialize;
use std::collections::HashMap;

/// What a worker did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorkerCost {
    /// Who.
    pub name: String,
    /// Branches found.
    pub branches: usize,
    /// Results accepted.
    pub tasks: usize,
    /// Computing time, s.
    pub seconds: f64,
    /// Versions of the program.
    pub programs: Vec<String>,
}

/// A task and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TaskRow {
    /// Name.
    pub task: String,
    /// Its level, by index.
    pub level: usize,
    /// `main`, `land`, `seed`, `fold` or `crossing`.
    pub kind: String,
    /// The window the seed is from.
    pub window: Option<usize>,
    /// Which of its two phases.
    pub phase: Option<String>,
    /// How it is landed.
    pub way: Option<String>,
    /// `waiting`, `leased`, `done`, `skipped` or `dead`.
    pub state: String,
    /// How often it was handed out.
    pub attempts: usize,
    /// What became of it, or why it was given up.
    pub outcome: Option<String>,
    /// The branch it lies on.
    pub branch: Option<String>,
    /// Who computed it.
    pub worker: Option<String>,
    /// Computing time, s.
    pub seconds: Option<f64>,
}

impl Reader {
    /// Number of points of the backbone.
    pub(crate) fn backbone_points(&self) -> Result<usize> {
        Ok(self.one("SELECT count(*) FROM backbone", [], |row| row.get(0))?.unwrap_or(0))
    }

    /// What every worker did.
    pub(crate) fn workers(&self) -> Result<Vec<WorkerCost>> {
        let sql = "SELECT worker, count(branches.id), count(*), total(seconds), group_concat(DISTINCT program) \
                   FROM results LEFT JOIN branches USING (task) GROUP BY worker ORDER BY worker";
        self.all(sql, [], |row| {
            let programs: String = row.get(4)?;
            Ok(WorkerCost {
                name: row.get(0)?,
                branches: row.get(1)?,
                tasks: row.get(2)?,
                seconds: row.get(3)?,
                programs: programs.split(',').map(String::from).collect(),
            })
        })
    }

    /// Tasks of the levels whose amplitudes, as typed, have a place in a list.
    pub(crate) fn task_rows(&self, places: &HashMap<&str, usize>) -> Result<Vec<TaskRow>> {
        let sql = "SELECT tasks.id, levels.amplitude, tasks.kind, window, phase, way, state, attempts, \
                   coalesce(outcome, (SELECT reason FROM attempts WHERE task = tasks.id AND reason IS NOT NULL \
                   ORDER BY attempt DESC LIMIT 1)), branch, worker, seconds \
                   FROM tasks JOIN levels USING (level) LEFT JOIN results ON results.task = tasks.id \
                   ORDER BY levels.value, position";
        let rows = self.all(sql, [], |row| {
            let level: String = row.get(1)?;
            let place = places.get(typed(&level)).filter(|_| self.tells_of(&level));
            place.map(|&place| task(row, place)).transpose()
        })?;
        Ok(rows.into_iter().flatten().collect())
    }
}

fn task(row: &Row<'_>, level: usize) -> rusqlite::Result<TaskRow> {
    Ok(TaskRow {
        task: row.get(0)?,
        level,
        kind: row.get(2)?,
        window: row.get(3)?,
        phase: row.get(4)?,
        way: row.get(5)?,
        state: row.get(6)?,
        attempts: row.get(7)?,
        outcome: row.get(8)?,
        branch: row.get(9)?,
        worker: row.get(10)?,
        seconds: row.get(11)?,
    })
}
