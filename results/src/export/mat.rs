//! MATLAB's files, level 5, as MathWorks documents them ("MAT-File Format"): what MATLAB writes with `-v6`, which every
//! MATLAB, Octave and SciPy reads.
//!
//! A file is a header of 128 bytes and one element a variable. An element is a tag (type, number of bytes) and data,
//! filled up to 8 bytes; that of a variable holds elements: flags, lengths of the axes, name, and numbers in
//! column-major order (or the variables of a cell array or a structure).

mod matrix;
#[cfg(test)]
mod tests;

use super::ExportError;
use super::atomic::Partial;
use super::value::{Record, Value};
use matrix::Matrix;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Extension of the files.
pub(super) const EXTENSION: &str = "mat";
/// Largest variable, bytes.
const LIMIT: u64 = i32::MAX as u64;

/// Writes file `name` of folder `dir`: a group of the record is a structure.
///
/// # Errors
/// If it cannot be written, or a variable is larger than 2 GB; it is complete or not there.
pub(super) fn write(dir: &Path, name: &str, record: &Record) -> Result<(), ExportError> {
    let variables = variables(record);
    if let Some((name_of_variable, _)) = variables.iter().find(|(name, matrix)| matrix.bytes(name) > LIMIT) {
        return Err(ExportError::TooLarge { file: dir.join(name), variable: name_of_variable.to_string() });
    }
    let (partial, file) = Partial::create(dir, name)?;
    write_variables(BufWriter::new(file), &variables).map_err(|source| partial.failed(source))?;
    partial.finish()
}

/// Variables by name. Values of a group stand together.
fn variables(record: &Record) -> Vec<(&str, Matrix<'_>)> {
    let group = |(name, _): &(String, Value)| name.split_once('.').map(|(group, _)| group.to_string());
    let chunks = record.0.chunk_by(|a, b| group(a).is_some() && group(a) == group(b));
    chunks.map(|values| variable(values)).collect()
}

/// The variable of a value without a group, or of all values of a group.
fn variable(values: &[(String, Value)]) -> (&str, Matrix<'_>) {
    let (name, value) = &values[0];
    let Some((group, _)) = name.split_once('.') else { return (name, Matrix::of(value)) };
    let fields = values.iter().map(|(name, value)| (&name[group.len() + 1..], Matrix::of(value)));
    (group, Matrix::structure(fields.collect()))
}

fn write_variables(mut out: impl Write, variables: &[(&str, Matrix<'_>)]) -> io::Result<()> {
    // What follows "MATLAB 5.0 MAT-file" is free.
    let text = format!("MATLAB 5.0 MAT-file, written by Isola {}", protocol::PROGRAM);
    out.write_all(format!("{text:<116.116}").as_bytes())?;
    // No data of a subsystem; version 1.0, little-endian.
    out.write_all(&[0; 8])?;
    out.write_all(&[0x00, 0x01, b'I', b'M'])?;
    variables.iter().try_for_each(|(name, matrix)| matrix.write(name, &mut out))?;
    out.flush()
}
