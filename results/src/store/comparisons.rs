//! From which result on what is said of a task may be compared with what is said again.

use super::Result;
use super::error::At;
use super::header::set;
use rusqlite::Connection;
use std::path::Path;

/// Key of the number of the last result that is of bounds from before the run was extended.
pub(super) const OTHER_BOUNDS: &str = "other_bounds";

/// What was said so far is of other bounds from now on, and is compared with nothing that is said within these.
pub(super) fn forget_comparisons(db: &Connection, file: &Path) -> Result<()> {
    let last: Option<i64> = db.query_row("SELECT max(sequence) FROM results", [], |row| row.get(0)).at(file)?;
    set(db, file, OTHER_BOUNDS, last.unwrap_or_default())
}
