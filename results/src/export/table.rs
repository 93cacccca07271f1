//! A CSV file.

use super::ExportError;
use super::atomic::Partial;
use std::fs::File;
use std::path::Path;

/// A CSV file under way.
pub(super) struct Table {
    writer: csv::Writer<File>,
    partial: Partial,
}

impl Table {
    /// Begins `name` in folder `dir` with the names of its columns.
    pub fn create(dir: &Path, name: &str, columns: &[String]) -> Result<Self, ExportError> {
        let (partial, file) = Partial::create(dir, name)?;
        let mut table = Self { writer: csv::Writer::from_writer(file), partial };
        table.row(columns)?;
        Ok(table)
    }

    /// Adds a row.
    pub fn row<T: AsRef<[u8]>>(&mut self, fields: impl IntoIterator<Item = T>) -> Result<(), ExportError> {
        self.writer.write_record(fields).map_err(|error| self.partial.failed(error.into()))
    }

    /// Gives the file its name.
    pub fn finish(mut self) -> Result<(), ExportError> {
        self.writer.flush().map_err(|source| self.partial.failed(source))?;
        self.partial.finish()
    }
}

/// A number, in the shortest form that reads back the same.
pub(super) fn text(value: f64) -> String {
    let is_handy = value == 0.0 || !value.is_finite() || (1e-4..1e15).contains(&value.abs());
    if is_handy { value.to_string() } else { format!("{value:e}") }
}

/// A number, or nothing.
pub(super) fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, text)
}
