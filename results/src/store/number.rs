//! Numbers of rows.

use rusqlite::Row;

/// A number of a row.
pub(crate) fn number(row: &Row<'_>, column: usize) -> rusqlite::Result<f64> {
    Ok(row.get::<_, Option<f64>>(column)?.unwrap_or(f64::NAN))
}
