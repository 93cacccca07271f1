//! The tables of points: a row for each, and their columns follow from the list of the solver.

use super::Result;
use super::error::At;
use super::number::number;
use super::scalars::Scalar;
use rusqlite::types::Value;
use rusqlite::{Connection, params_from_iter};
use solver::response::columns::{self, Axis, Column, Number};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// A table of points. A file of an earlier program has fewer columns, one of a later program has more.
pub(super) struct PointsTable {
    name: &'static str,
    /// The column that tells whose points they are; a table of an earlier program may be without it, all being of one curve.
    key: &'static str,
    /// Arrays of motions that are columns, and the names of these.
    motions: &'static [(&'static str, &'static str)],
}

/// Points of branches.
pub(super) const POINTS: PointsTable = PointsTable { name: "points", key: "branch", motions: &[("omega", "omega")] };
/// Points of backbones, by the number of the mode.
pub(super) const BACKBONE: PointsTable =
    PointsTable { name: "backbone", key: "mode", motions: &[("omega", "omega"), ("decay", "zeta")] };

/// The text of the schema with the columns of the list in their places.
pub(super) fn schema() -> String {
    let definitions = |list: Vec<&Column>| list.into_iter().filter_map(definition).collect::<Vec<String>>().join(",\n");
    let arrays = columns::of_points().chain(columns::of_backbone()).filter(|column| column.axis != Axis::Point);
    let array = |column: &Column| {
        let axis = match column.axis {
            Axis::Point => "",
            Axis::Monitors => " x monitors",
            Axis::Contacts => " x contacts",
            Axis::Modes => " x modes",
        };
        format!("--   {:<14} p{axis}: {}\n", column.name, column.description())
    };
    include_str!("schema.sql")
        .replace("    {columns of points}", &definitions(columns::of_points().collect()))
        .replace("    {columns of the backbone}", &definitions(columns::of_backbone_in_files().collect()))
        .replace("{arrays}\n", &arrays.map(array).collect::<String>())
}

/// A column with its comment, unless it has no number of its own.
fn definition(column: &Column) -> Option<String> {
    let Column { name, axis, number, .. } = column;
    let of = match axis {
        Axis::Point => String::new(),
        Axis::Monitors => format!(", of the first monitored dof (of all of them: array `{name}`)"),
        Axis::Contacts => format!(", the largest over the contact elements (of each: array `{name}`)"),
        Axis::Modes => return None,
    };
    let kind = match number {
        Number::Real => "REAL",
        Number::Integer => "INTEGER",
    };
    let description = column.description();
    let (first, rest) = description.split_at(description.chars().next().map_or(0, char::len_utf8));
    Some(format!("    -- {}{rest}{of}.\n    {name} {kind}", first.to_uppercase()))
}

/// A name as SQL takes it, whatever is in it.
fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

impl PointsTable {
    /// Names of the columns that the table has in this file.
    fn names(&self, db: &Connection, file: &Path) -> Result<HashSet<String>> {
        let sql = "SELECT name FROM pragma_table_info(?1)";
        let mut statement = db.prepare_cached(sql).at(file)?;
        let names = statement.query_map([self.name], |row| row.get(0)).at(file)?;
        names.collect::<rusqlite::Result<_>>().at(file)
    }

    /// Stores the points of curve `of`, as far as the table has columns for them: the first of `motions` is as long as there
    /// are points. Returns the arrays that are held entirely.
    pub fn insert(
        &self,
        db: &Connection,
        file: &Path,
        of: i64,
        motions: &[&[f64]],
        scalars: &[Scalar],
    ) -> Result<Vec<&'static str>> {
        let present = self.names(db, file)?;
        let scalars: Vec<&Scalar> = scalars.iter().filter(|scalar| present.contains(scalar.column.name)).collect();
        let names = [self.key, "i"].into_iter().chain(self.motions.iter().map(|(_, column)| *column));
        let names: Vec<String> = names.chain(scalars.iter().map(|scalar| scalar.column.name)).map(quoted).collect();
        let values = vec!["?"; names.len()].join(", ");
        let sql = format!("INSERT INTO {} ({}) VALUES ({values})", self.name, names.join(", "));
        let mut statement = db.prepare_cached(&sql).at(file)?;
        for i in 0..motions[0].len() {
            let keys = [of, i as i64].into_iter().map(Value::Integer);
            let numbers = motions.iter().map(|values| values[i]).chain(scalars.iter().map(|scalar| scalar.values[i]));
            statement.execute(params_from_iter(keys.chain(numbers.map(Value::Real)))).at(file)?;
        }
        let held = scalars.iter().map(|scalar| scalar.column).filter(|column| column.axis == Axis::Point);
        Ok(self.motions.iter().map(|(array, _)| *array).chain(held.map(|column| column.name)).collect())
    }

    /// Reads the arrays among `arrays` that the table holds of curve `of`.
    pub fn read(&self, db: &Connection, file: &Path, of: i64, arrays: &[&str]) -> Result<HashMap<String, Vec<f64>>> {
        let present = self.names(db, file)?;
        let column = |array: &str| {
            let renamed = self.motions.iter().find(|(motion, _)| *motion == array);
            let column = renamed.map_or(array, |(_, column)| column);
            (is_of_points(array) && present.contains(column)).then(|| (array.to_string(), quoted(column)))
        };
        let (arrays, columns): (Vec<String>, Vec<String>) = arrays.iter().filter_map(|array| column(array)).unzip();
        if arrays.is_empty() {
            return Ok(HashMap::new());
        }
        let of = present.contains(self.key).then_some(of);
        let which = of.map_or(String::new(), |_| format!(" WHERE {} = ?1", self.key));
        let sql = format!("SELECT {} FROM {}{which} ORDER BY i", columns.join(", "), self.name);
        let mut lists = vec![Vec::new(); arrays.len()];
        let mut statement = db.prepare_cached(&sql).at(file)?;
        let mut rows = statement.query(params_from_iter(of)).at(file)?;
        while let Some(row) = rows.next().at(file)? {
            for (c, list) in lists.iter_mut().enumerate() {
                list.push(number(row, c).at(file)?);
            }
        }
        Ok(arrays.into_iter().zip(lists).collect())
    }
}

/// Whether an array has one number a point; of one that is not known here, the table tells.
fn is_of_points(array: &str) -> bool {
    columns::named(array).is_none_or(|column| column.axis == Axis::Point)
}
