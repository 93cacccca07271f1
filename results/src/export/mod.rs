//! What people take away from a run: CSV files, and files for MATLAB and NumPy.

mod atomic;
mod contents;
mod csv_columns;
mod files;
mod list;
mod listed;
mod mat;
mod npz;
mod table;
#[cfg(test)]
mod tests;
mod value;

use crate::overview::{Omissions, Overview};
use crate::store::{Reader, StoreError};
pub use atomic::write_atomically;
use atomic::{BRANCHES, branches_folder};
use contents::Contents;
use std::path::{Path, PathBuf};
use thiserror::Error;
use value::Record;

/// What words and columns mean, Markdown.
pub const COLUMNS: &str = include_str!("../../COLUMNS.md");

/// The words among them, with what they mean.
pub fn words() -> impl Iterator<Item = (&'static str, &'static str)> {
    let section = COLUMNS.split("\n## ").find(|text| text.starts_with("Words\n")).unwrap_or_default();
    let rows = section.lines().filter_map(|line| line.strip_prefix("| ")?.strip_suffix(" |")?.split_once(" | "));
    rows.filter(|(word, _)| !matches!(*word, "word" | "---"))
}

/// Format of exported files.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Format {
    /// Tables: summary.csv, backbone.csv, windows.csv, folds.csv, events.csv, …, branches/*.csv.
    #[default]
    Csv,
    /// For MATLAB and Octave, with all harmonics: run.mat, branches/*.mat.
    Mat,
    /// For NumPy, with all harmonics: run.npz, branches/*.npz.
    Npz,
}

/// Why an export failed.
#[derive(Debug, Error)]
pub enum ExportError {
    /// The run cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A file cannot be written.
    #[error("{}: {source}; check that there is space and that you may write there", .file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The folder of a file is not there.
    #[error("{}: there is no folder {}: make it, or name another", .file.display(), .folder.display())]
    Folder {
        /// The file.
        file: PathBuf,
        /// The folder.
        folder: PathBuf,
    },
    /// A variable for MATLAB that is larger than the format allows.
    #[error("{}: `{variable}` is larger than the 2 GB that a variable may have; use --format npz", .file.display())]
    TooLarge {
        /// The file.
        file: PathBuf,
        /// The variable.
        variable: String,
    },
}

/// What was written into a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The folder.
    pub folder: PathBuf,
    /// How many periods of the force the motions last that it is of, if it is not of the run's first order.
    pub order: Option<usize>,
    /// Names of the files in it, that of the folder of branches last.
    pub files: Vec<String>,
}

/// What an export has written, and what it has not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exported {
    /// Folder by folder.
    pub written: Vec<Written>,
    /// What could not be written because it is not there or not what was stored.
    pub omissions: Omissions,
}

/// Writes what is stored of a run, at any stage, into folder `dir`, and reports what could not be written because it is
/// not there or not what was stored.
///
/// # Errors
/// If nothing of the run can be read or a file cannot be written; files are complete or not there.
pub fn export(reader: &Reader, format: Format, dir: &Path) -> Result<Exported, ExportError> {
    let mut omissions = Omissions::default();
    omissions.check(reader);
    let written = each_order(reader, dir, &mut omissions, |reader, dir, omissions| match format {
        Format::Csv => files::write(reader, dir, omissions),
        Format::Mat => records(reader, dir, omissions, mat::EXTENSION, mat::write),
        Format::Npz => records(reader, dir, omissions, npz::EXTENSION, npz::write),
    })?;
    Ok(Exported { written, omissions })
}

/// Name of the folder that has what is made of a further order of motions, beside what is made of the first one: `m3`.
pub fn order_folder(order: usize) -> String {
    format!("m{order}")
}

/// Writes what every order of motions has, each as a run of its own: of the first into `dir`, of others into folders in it.
/// `write` says which files it has written.
fn each_order(
    reader: &Reader,
    dir: &Path,
    omissions: &mut Omissions,
    write: impl Fn(&Reader, &Path, &mut Omissions) -> Result<Vec<String>, ExportError>,
) -> Result<Vec<Written>, ExportError> {
    let mut written = vec![Written { folder: dir.into(), order: None, files: write(reader, dir, omissions)? }];
    for order in omissions.read("Which orders of motions there are is", reader.further_orders()).unwrap_or_default() {
        let folder = dir.join(order_folder(order));
        let files = write(&reader.of_order(order)?, &folder, omissions)?;
        written.push(Written { folder, order: Some(order), files });
    }
    Ok(written)
}

/// Writes the CSV files, as [`export`] does, of a run that was open for writing until now and was checked then.
///
/// # Errors
/// As [`export`].
pub fn csv(reader: &Reader, dir: &Path) -> Result<Omissions, ExportError> {
    let mut omissions = Omissions::default();
    each_order(reader, dir, &mut omissions, files::write)?;
    Ok(omissions)
}

/// Writes a file for the run and one for every branch, and says what they are called.
fn records(
    reader: &Reader,
    dir: &Path,
    omissions: &mut Omissions,
    extension: &str,
    write: impl Fn(&Path, &str, &Record) -> Result<(), ExportError>,
) -> Result<Vec<String>, ExportError> {
    let _snapshot = reader.snapshot()?;
    let overview = Overview::read(reader, omissions)?;
    let folder = branches_folder(dir)?;
    let contents = Contents::new(reader, &overview);
    overview.each_branch(reader, omissions, |omissions, name, result| {
        match contents.branch(name, result, omissions) {
            Some(record) => write(&folder, &format!("{name}.{extension}"), &record),
            None => Ok(()),
        }
    })?;
    let name = format!("run.{extension}");
    write(dir, &name, &contents.run(omissions))?;
    Ok(vec![name, BRANCHES.into()])
}
