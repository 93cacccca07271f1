//! A CSV file that is there when it is complete.

use super::ExportError;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// A CSV file under way, under another name until it is finished.
pub(super) struct Table {
    writer: csv::Writer<File>,
    partial: PathBuf,
    path: PathBuf,
}

impl Table {
    /// Begins `name` in folder `dir` with the names of its columns.
    pub fn create(dir: &Path, name: &str, columns: &[String]) -> Result<Self, ExportError> {
        let (path, partial) = (dir.join(name), dir.join(format!(".{name}.partial")));
        let file = File::create(&partial).map_err(|source| failed(&path, source))?;
        let mut table = Self { writer: csv::Writer::from_writer(file), partial, path };
        table.row(columns)?;
        Ok(table)
    }

    /// Adds a row.
    pub fn row<T: AsRef<[u8]>>(&mut self, fields: impl IntoIterator<Item = T>) -> Result<(), ExportError> {
        self.writer.write_record(fields).map_err(|error| failed(&self.path, error.into()))
    }

    /// Gives the file its name.
    pub fn finish(mut self) -> Result<(), ExportError> {
        self.writer.flush().map_err(|source| failed(&self.path, source))?;
        fs::rename(&self.partial, &self.path).map_err(|source| failed(&self.path, source))
    }
}

impl Drop for Table {
    fn drop(&mut self) {
        // There is nothing to remove once it has its name.
        let _ = fs::remove_file(&self.partial);
    }
}

/// A file that cannot be written.
pub(super) fn failed(file: &Path, source: io::Error) -> ExportError {
    ExportError::Write { file: file.into(), source }
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
