//! Steps of tasks under way, which whoever is handed a task next goes on from.

use super::error::At;
use super::{Reader, Result};
use crate::journal::{CheckpointPart, Kept};
use protocol::codec::decode_stored;
use protocol::ids::{Attempt, TaskId};
use protocol::to_worker::Checkpoint;
use rusqlite::{Connection, Row, params};
use std::collections::HashMap;
use std::path::Path;

/// Adds steps of a task; the first ones replace all.
pub(super) fn insert_part(db: &Connection, file: &Path, part: &CheckpointPart) -> Result<()> {
    let CheckpointPart { task, attempt, first, steps, payload } = part;
    if *first == 0 {
        forget(db, file, task)?;
    }
    let sql = "INSERT INTO checkpoints (task, first, steps, attempt, payload) VALUES (?1, ?2, ?3, ?4, ?5)";
    let row = params![task.as_str(), *first as i64, *steps as i64, attempt.0, payload];
    db.prepare_cached(sql).at(file)?.execute(row).at(file)?;
    Ok(())
}

/// Drops the steps of a task.
pub(super) fn forget(db: &Connection, file: &Path, task: &TaskId) -> Result<()> {
    db.prepare_cached("DELETE FROM checkpoints WHERE task = ?1").at(file)?.execute([task.as_str()]).at(file)?;
    Ok(())
}

impl Reader {
    /// What is kept of tasks under way.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn kept(&self) -> Result<HashMap<TaskId, Kept>> {
        let sql = "SELECT task, sum(steps), sum(length(payload)), max(attempt) FROM checkpoints GROUP BY task";
        let row = |row: &Row<'_>| {
            let kept = Kept { steps: row.get(1)?, bytes: row.get(2)?, attempt: Attempt(row.get(3)?) };
            Ok((row.get::<_, String>(0)?, kept))
        };
        self.all(sql, [], row)?.into_iter().map(|(task, kept)| Ok((self.task_id(&task)?, kept))).collect()
    }

    /// Steps kept of a task from the one with number `from` on, of about `most` bytes but at least one part; `None` if no part begins
    /// there.
    ///
    /// # Errors
    /// If the file cannot be read, or what is in it makes no sense.
    pub fn checkpoint(&self, task: &TaskId, from: usize, most: usize) -> Result<Option<Checkpoint>> {
        // The sizes of blobs are known without reading them.
        let sql = "WITH sized AS (SELECT first, sum(length(payload)) OVER (ORDER BY first) AS size FROM checkpoints \
                   WHERE task = ?1 AND first >= ?2) \
                   SELECT payload FROM checkpoints JOIN sized USING (first) \
                   WHERE task = ?1 AND (size <= ?3 OR first = ?2) ORDER BY first";
        let params = params![task.as_str(), from as i64, most as i64];
        let payloads = self.all(sql, params, |row| row.get::<_, Vec<u8>>(0))?;
        let part = |bytes: Vec<u8>| decode_stored(&bytes).map_err(|error| self.corrupt(error));
        let parts = payloads.into_iter().map(part).collect::<Result<Vec<_>>>()?;
        Ok((!parts.is_empty()).then(|| Checkpoint { task: task.clone(), parts }))
    }
}
