//! How far what was said of tasks is to be believed: what came of comparing it, and what is said where two disagree.

use super::comparisons::OTHER_BOUNDS;
use super::header::{pack, set, unpack};
use super::{Reader, Result};
use crate::journal::{AttemptEnd, Evidence, Said};
use protocol::ids::{Attempt, TaskId};
use rusqlite::{Connection, Row};
use std::collections::HashMap;
use std::path::Path;

/// Begins the keys in `meta` of what is said where two disagree: `said/<task>/<attempt>`.
const SAID: &str = "said/";

/// Stores what an attempt says of a task.
pub(super) fn insert_said(db: &Connection, file: &Path, task: &TaskId, attempt: Attempt, said: Said) -> Result<()> {
    set(db, file, &format!("{SAID}{task}/{attempt}"), pack(&said))
}

impl Reader {
    /// What is known of tasks beside their results.
    pub(super) fn evidence(&self) -> Result<HashMap<String, Evidence>> {
        let mut evidence: HashMap<String, Evidence> = HashMap::new();
        let read = |row: &Row<'_>| Ok((row.get::<_, String>(0)?, row.get(1)?, row.get::<_, Option<f64>>(2)?));
        // To what is of other bounds, nobody would come again.
        let sql = "SELECT task, attempt, seconds FROM results \
                   WHERE sequence > coalesce((SELECT value FROM meta WHERE key = ?1), 0)";
        for (task, attempt, seconds) in self.all(sql, [OTHER_BOUNDS], read)? {
            evidence.entry(task).or_default().result = Some((Attempt(attempt), seconds.unwrap_or_default()));
        }
        let sql = "SELECT task, attempt, \"end\", reason FROM attempts \
                   WHERE \"end\" IN ('refused', 'confirmed', 'disputed', 'refuted') ORDER BY task, attempt";
        let read = |row: &Row<'_>| Ok((row.get::<_, String>(0)?, row.get(1)?, row.get::<_, String>(2)?, row.get(3)?));
        for (task, attempt, end, reason) in self.all(sql, [], read)? {
            let end = AttemptEnd::named(&end, reason).ok_or_else(|| self.corrupt(format!("an attempt `{end}`")))?;
            evidence.entry(task).or_default().ends.push((Attempt(attempt), end));
        }
        let sql = "SELECT key, value FROM meta WHERE key LIKE ?1 || '%'";
        let read = |row: &Row<'_>| Ok((row.get::<_, String>(0)?, row.get::<_, Vec<u8>>(1)?));
        for (key, said) in self.all(sql, [SAID], read)? {
            let place = key[SAID.len()..].rsplit_once('/');
            let place = place.and_then(|(task, attempt)| Some((task.to_string(), attempt.parse().ok()?)));
            let (task, attempt) = place.ok_or_else(|| self.corrupt(format!("`{key}` in `meta`")))?;
            evidence.entry(task).or_default().said.push((Attempt(attempt), unpack(self.file(), &said)?));
        }
        Ok(evidence)
    }
}
