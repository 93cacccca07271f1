//! One number a point for each column, as tables have them.

use protocol::array::{Array, ArrayError};
use protocol::columns::Columns;
use protocol::curve::Points;
use solver::response::columns::{self, Axis, Column};

/// A column with one number for each point.
pub(crate) struct Scalar {
    /// Which.
    pub column: &'static Column,
    /// Of the first monitored dof; the largest over the contact elements; NaN where there is none.
    pub values: Vec<f64>,
}

/// The numbers that points of any curve have.
pub(crate) struct Scalars {
    /// ω.
    pub omega: Vec<f64>,
    /// The columns that are there, in the order of the list.
    pub columns: Vec<Scalar>,
}

impl Scalars {
    /// Of points whose arrays fit together.
    pub fn new(points: &Points) -> Result<Self, ArrayError> {
        let count = points.len();
        let omega = points.motions.omega.values("omega", &[count])?;
        Ok(Self { omega, columns: scalars(&points.columns, columns::of_points(), count)? })
    }

    /// The values of a column; none if it is not there.
    pub fn get(&self, name: &str) -> &[f64] {
        self.columns.iter().find(|scalar| scalar.column.name == name).map_or(&[], |scalar| &scalar.values)
    }
}

/// Columns of a list with one number for each of `count` points: all but those that have one for each mode.
pub(crate) fn scalars(
    columns: &Columns,
    list: impl Iterator<Item = &'static Column>,
    count: usize,
) -> Result<Vec<Scalar>, ArrayError> {
    let with_one = list.filter(|column| column.axis != Axis::Modes);
    let scalar = |(column, array): (&'static Column, &Array)| {
        let values = match column.axis {
            Axis::Point => array.values(column.name, &[count])?,
            Axis::Contacts => by_row(column, array, count, |row| row.iter().copied().reduce(f64::max))?,
            Axis::Monitors | Axis::Modes => by_row(column, array, count, |row| row.first().copied())?,
        };
        Ok(Scalar { column, values })
    };
    columns.among(with_one).map(scalar).collect()
}

/// One value a row of an array of `count` rows.
fn by_row(
    column: &Column,
    array: &Array,
    count: usize,
    of: impl Fn(&[f64]) -> Option<f64>,
) -> Result<Vec<f64>, ArrayError> {
    let width = array.shape.get(1).copied().unwrap_or(1);
    let values = array.values(column.name, &[count, width])?;
    Ok((0..count).map(|i| of(&values[i * width..(i + 1) * width]).unwrap_or(f64::NAN)).collect())
}
