//! Arrays of messages in the tables: numbers of their own as columns, the others as BLOBs.

use super::Result;
use super::error::At;
use protocol::array::{Array, ArrayError};
use protocol::backbone::BackboneMessage;
use protocol::curve::{Motions, Points};
use rusqlite::{Connection, Row, params};
use std::collections::HashMap;
use std::path::Path;

/// Arrays that are columns of `points`, in the order of [`SELECT_POINTS`].
pub(super) const POINT_COLUMNS: [&str; 4] = ["omega", "residual", "high_harmonics", "iterations"];
/// Arrays that are columns of `backbone`, in the order of [`SELECT_BACKBONE`].
pub(super) const BACKBONE_COLUMNS: [&str; 11] = [
    "omega",
    "residual",
    "high_harmonics",
    "iterations",
    "decay",
    "r_lin",
    "r_nl",
    "work_per_amplitude",
    "threshold",
    "certificate",
    "arc",
];
/// Reads [`POINT_COLUMNS`] of a branch.
pub(super) const SELECT_POINTS: &str =
    "SELECT omega, residual, high_harmonics, iterations FROM points WHERE branch = ?1 ORDER BY i";
/// Reads [`BACKBONE_COLUMNS`].
pub(super) const SELECT_BACKBONE: &str = "SELECT omega, residual, high_harmonics, iterations, zeta, r_lin, r_nl, \
     work_per_amplitude, threshold, certificate, arc FROM backbone ORDER BY i";

/// Names the arrays of points; borrows them as told.
macro_rules! arrays_of_points {
    ($points:expr, $($borrow:tt)+) => {
        vec![
            ("omega", $($borrow)+ $points.motions.omega),
            ("decay", $($borrow)+ $points.motions.decay),
            ("forcing", $($borrow)+ $points.motions.forcing),
            ("argument", $($borrow)+ $points.motions.argument),
            ("modal", $($borrow)+ $points.motions.modal),
            ("amplitude", $($borrow)+ $points.amplitude),
            ("rms", $($borrow)+ $points.rms),
            ("contact", $($borrow)+ $points.contact),
            ("residual", $($borrow)+ $points.residual),
            ("high_harmonics", $($borrow)+ $points.high_harmonics),
            ("iterations", $($borrow)+ $points.iterations),
        ]
    };
}

/// Names the arrays that a backbone has besides those of its points; borrows them as told.
macro_rules! arrays_of_backbone {
    ($backbone:expr, $($borrow:tt)+) => {
        [
            ("r_lin", $($borrow)+ $backbone.r_lin),
            ("r_nl", $($borrow)+ $backbone.r_nl),
            ("work_per_amplitude", $($borrow)+ $backbone.work_per_amplitude),
            ("certificate", $($borrow)+ $backbone.certificate),
            ("threshold", $($borrow)+ $backbone.threshold),
            ("arc", $($borrow)+ $backbone.arc),
            ("contributions", $($borrow)+ $backbone.contributions),
        ]
    };
}

/// Arrays by name.
pub(super) type Arrays<'a> = Vec<(&'static str, &'a Array)>;
/// Arrays by name, to be filled in.
pub(super) type ArraysMut<'a> = Vec<(&'static str, &'a mut Array)>;

/// The arrays of points.
pub(super) fn of_points(points: &Points) -> Arrays<'_> {
    arrays_of_points!(points, &)
}

/// The arrays of points, to be filled in.
pub(super) fn of_points_mut(points: &mut Points) -> ArraysMut<'_> {
    arrays_of_points!(points, &mut)
}

/// The arrays of a backbone.
pub(super) fn of_backbone(backbone: &BackboneMessage) -> Arrays<'_> {
    let mut arrays = of_points(&backbone.points);
    arrays.extend(arrays_of_backbone!(backbone, &));
    arrays
}

/// The arrays of a backbone, to be filled in.
pub(super) fn of_backbone_mut(backbone: &mut BackboneMessage) -> ArraysMut<'_> {
    let mut arrays = arrays_of_points!(backbone.points, &mut);
    arrays.extend(arrays_of_backbone!(backbone, &mut));
    arrays
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
        amplitude: empty(),
        rms: empty(),
        contact: empty(),
        residual: empty(),
        high_harmonics: empty(),
        iterations: empty(),
    }
}

/// The columns that points of any curve have.
pub(crate) struct Scalars {
    /// ω.
    pub omega: Vec<f64>,
    /// Of the first monitored dof.
    pub amplitude: Vec<f64>,
    /// Of the first monitored dof.
    pub rms: Vec<f64>,
    /// The largest over the contact elements; `None` if there are no contact elements.
    pub contact: Vec<Option<f64>>,
    /// Largest scaled residual.
    pub residual: Vec<f64>,
    /// Share of the two highest harmonics.
    pub high_harmonics: Vec<f64>,
    /// Newton iterations.
    pub iterations: Vec<f64>,
}

impl Scalars {
    /// Of points whose arrays fit together.
    pub fn new(points: &Points) -> std::result::Result<Self, ArrayError> {
        let count = [points.len()];
        let first = |row: &[f64]| row.first().copied().unwrap_or(f64::NAN);
        Ok(Self {
            omega: points.motions.omega.values("omega", &count)?,
            amplitude: by_row("amplitude", &points.amplitude, count[0], first)?,
            rms: by_row("rms", &points.rms, count[0], first)?,
            contact: by_row("contact", &points.contact, count[0], |row| row.iter().copied().reduce(f64::max))?,
            residual: points.residual.values("residual", &count)?,
            high_harmonics: points.high_harmonics.values("high_harmonics", &count)?,
            iterations: points.iterations.values("iterations", &count)?,
        })
    }
}

/// One value a row of an array of `count` rows.
fn by_row<T>(
    name: &'static str,
    array: &Array,
    count: usize,
    of: impl Fn(&[f64]) -> T,
) -> std::result::Result<Vec<T>, ArrayError> {
    let width = array.shape.get(1).copied().unwrap_or(1);
    let values = array.values(name, &[count, width])?;
    Ok((0..count).map(|i| of(&values[i * width..(i + 1) * width])).collect())
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

/// Stores the arrays of `owner` that `columns` do not hold.
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

/// Fills in the arrays of `owner` from BLOBs and, what is not among them, from columns.
pub(super) fn fill(
    db: &Connection,
    file: &Path,
    owner: &str,
    arrays: ArraysMut<'_>,
    columns: &mut Columns,
) -> Result<()> {
    let mut stored = read(db, file, owner)?;
    for (name, array) in arrays {
        *array = match stored.remove(name) {
            Some(array) => array,
            None => columns.take(name).unwrap_or_else(empty),
        };
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

/// Columns read back, by name of their arrays.
pub(super) struct Columns(HashMap<&'static str, Vec<f64>>);

impl Columns {
    /// Reads `names`, which `sql` selects in this order.
    pub fn read(
        db: &Connection,
        file: &Path,
        names: &[&'static str],
        sql: &str,
        params: impl rusqlite::Params,
    ) -> Result<Self> {
        let mut columns = vec![Vec::new(); names.len()];
        let mut statement = db.prepare_cached(sql).at(file)?;
        let mut rows = statement.query(params).at(file)?;
        while let Some(row) = rows.next().at(file)? {
            for (c, column) in columns.iter_mut().enumerate() {
                column.push(number(row, c).at(file)?);
            }
        }
        Ok(Self(names.iter().copied().zip(columns).collect()))
    }

    fn take(&mut self, name: &str) -> Option<Array> {
        self.0.remove(name).map(|values| Array::new([values.len()], values))
    }
}

/// A number of a row.
pub(crate) fn number(row: &Row<'_>, column: usize) -> rusqlite::Result<f64> {
    Ok(row.get::<_, Option<f64>>(column)?.unwrap_or(f64::NAN))
}
