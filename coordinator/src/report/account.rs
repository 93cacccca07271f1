//! How the figures came about: numerics, tasks, workers.

use crate::store::{Reader, Result};
use crate::study::settings;
use crate::survey::{Lacks, Level};
use rusqlite::Row;
use serde::Serialize;
use std::collections::HashMap;

/// The account of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Account {
    /// Dotted keys of the study with their values, as TOML.
    pub settings: Vec<(String, String)>,
    /// Who computed how much.
    pub workers: Vec<WorkerCost>,
    /// Every task.
    pub tasks: Vec<TaskRow>,
    /// The study with every setting spelled out, TOML.
    pub study: String,
    /// Points of the backbone.
    pub backbone_points: usize,
}

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
    /// Its level, by index into [`Report::levels`](super::Report::levels).
    pub level: usize,
    /// `main` or `seed`.
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

impl Account {
    /// Of a run whose resolved study is known.
    pub fn read(reader: &Reader, study: &str, levels: &[Level], lacks: &mut Lacks) -> Self {
        let count = reader.one("SELECT count(*) FROM backbone", [], |row| row.get(0));
        Self {
            settings: settings(study),
            workers: lacks.read("The account of the workers is", workers(reader)).unwrap_or_default(),
            tasks: lacks.read("The account of the tasks is", tasks(reader, levels)).unwrap_or_default(),
            study: study.into(),
            backbone_points: lacks.read("The number of points of the backbone is", count).flatten().unwrap_or(0),
        }
    }
}

fn workers(reader: &Reader) -> Result<Vec<WorkerCost>> {
    let sql = "SELECT worker, count(branches.id), count(*), total(seconds), group_concat(DISTINCT program) \
               FROM results LEFT JOIN branches USING (task) GROUP BY worker ORDER BY worker";
    reader.all(sql, [], |row| {
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

/// Tasks of these levels.
fn tasks(reader: &Reader, levels: &[Level]) -> Result<Vec<TaskRow>> {
    let places: HashMap<&str, usize> =
        levels.iter().enumerate().map(|(place, level)| (level.amplitude.as_str(), place)).collect();
    let sql = "SELECT tasks.id, levels.amplitude, tasks.kind, window, phase, way, state, attempts, \
               coalesce(outcome, (SELECT reason FROM attempts WHERE task = tasks.id AND reason IS NOT NULL \
               ORDER BY attempt DESC LIMIT 1)), branch, worker, seconds \
               FROM tasks JOIN levels USING (level) LEFT JOIN results ON results.task = tasks.id \
               ORDER BY levels.value, position";
    let rows = reader.all(sql, [], |row| {
        let amplitude: String = row.get(1)?;
        places.get(amplitude.as_str()).map(|&place| task(row, place)).transpose()
    })?;
    Ok(rows.into_iter().flatten().collect())
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
