//! Arrays of messages in the tables: numbers of their own as columns, the others as BLOBs.

use super::Result;
use super::error::At;
use super::points_table::PointsTable;
use protocol::array::Array;
use protocol::backbone::BackboneMessage;
use protocol::curve::{Motions, Points};
use rusqlite::{Connection, Row, params};
use std::collections::HashMap;
use std::path::Path;

/// Arrays by name.
pub(super) type Arrays<'a> = Vec<(&'a str, &'a Array)>;
/// Arrays by name, to be filled in.
pub(super) type ArraysMut<'a> = Vec<(&'a str, &'a mut Array)>;

/// Names the arrays of motions; borrows them as told.
macro_rules! arrays_of_motions {
    ($motions:expr, $($borrow:tt)+) => {
        [
            ("omega", $($borrow)+ $motions.omega),
            ("decay", $($borrow)+ $motions.decay),
            ("forcing", $($borrow)+ $motions.forcing),
            ("argument", $($borrow)+ $motions.argument),
            ("modal", $($borrow)+ $motions.modal),
        ]
    };
}

/// The arrays of points.
pub(super) fn of_points(points: &Points) -> Arrays<'_> {
    arrays_of_motions!(points.motions, &).into_iter().chain(points.columns.iter()).collect()
}

/// The arrays of points, to be filled in.
pub(super) fn of_points_mut(points: &mut Points) -> ArraysMut<'_> {
    arrays_of_motions!(points.motions, &mut).into_iter().chain(points.columns.iter_mut()).collect()
}

/// The arrays of a backbone.
pub(super) fn of_backbone(backbone: &BackboneMessage) -> Arrays<'_> {
    of_points(&backbone.points).into_iter().chain(backbone.columns.iter()).collect()
}

/// The arrays of a backbone, to be filled in.
pub(super) fn of_backbone_mut(backbone: &mut BackboneMessage) -> ArraysMut<'_> {
    of_points_mut(&mut backbone.points).into_iter().chain(backbone.columns.iter_mut()).collect()
}

/// An array without numbers.
pub(super) fn empty() -> Array {
    Array::new([0], [])
}

/// Points without numbers.
pub(super) fn empty_points(points: &Points) -> Points {
    Points {
        motions: Motions {
            harmonics: points.motions.harmonics,
            omega: empty(),
            decay: empty(),
            forcing: empty(),
            argument: empty(),
            modal: empty(),
        },
        columns: points.columns.emptied(),
    }
}

/// Whether a column keeps these numbers bit for bit: SQLite has neither NaN nor −0.
fn fits_column(array: &Array) -> bool {
    let (chunks, rest) = array.data.as_chunks::<8>();
    let kept = |bytes: &[u8; 8]| {
        let value = f64::from_le_bytes(*bytes);
        !value.is_nan() && (value != 0.0 || value.is_sign_positive())
    };
    array.shape.len() == 1 && array.dtype == "<f8" && rest.is_empty() && chunks.iter().all(kept)
}

/// Stores the arrays of `owner` that are not held by `columns`.
pub(super) fn insert_rest(
    db: &Connection,
    file: &Path,
    owner: &str,
    arrays: &Arrays<'_>,
    columns: &[&str],
) -> Result<()> {
    let rest = arrays.iter().filter(|(name, array)| !(columns.contains(name) && fits_column(array)));
    rest.into_iter().try_for_each(|(name, array)| insert(db, file, owner, name, array))
}

/// Stores an array.
pub(super) fn insert(db: &Connection, file: &Path, owner: &str, name: &str, array: &Array) -> Result<()> {
    let shape = serde_json::to_string(&array.shape).expect("a list of numbers");
    let sql = "INSERT INTO arrays (owner, name, dtype, shape, data) VALUES (?1, ?2, ?3, ?4, ?5)";
    let mut statement = db.prepare_cached(sql).at(file)?;
    statement.execute(params![owner, name, array.dtype, shape, array.data]).at(file)?;
    Ok(())
}

/// Fills in the arrays of `owner` from BLOBs and, what is not among them, from the columns of its table, of curve `of`.
pub(super) fn fill(
    db: &Connection,
    file: &Path,
    (owner, table): (&str, &PointsTable),
    of: i64,
    arrays: ArraysMut<'_>,
) -> Result<()> {
    let mut stored = read(db, file, owner)?;
    let names: Vec<&str> = arrays.iter().map(|(name, _)| *name).filter(|name| !stored.contains_key(*name)).collect();
    let mut columns = table.read(db, file, of, &names)?;
    for (name, array) in arrays {
        let of_column = |values: Vec<f64>| Array::new([values.len()], values);
        let found = stored.remove(name).or_else(|| columns.remove(name).map(of_column));
        *array = found.unwrap_or_else(empty);
    }
    Ok(())
}

/// The arrays of a message that `owner` has, by name.
fn read(db: &Connection, file: &Path, owner: &str) -> Result<HashMap<String, Array>> {
    let sql = "SELECT name, dtype, shape, data FROM arrays WHERE owner = ?1 AND name <> 'displacement'";
    let mut statement = db.prepare_cached(sql).at(file)?;
    statement
        .query_map([owner], |row| Ok((row.get(0)?, array_at(row, 1)?)))
        .at(file)?
        .collect::<rusqlite::Result<_>>()
        .at(file)
}

/// The array of a row: type, shape and numbers from this column on.
pub(super) fn array_at(row: &Row<'_>, column: usize) -> rusqlite::Result<Array> {
    let shape = serde_json::from_str(row.get_ref(column + 1)?.as_str()?).unwrap_or_default();
    Ok(Array { dtype: row.get(column)?, shape, data: row.get(column + 2)? })
}
