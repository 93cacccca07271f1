//! NumPy's files: a zip archive, not compressed, with an array NAME.npy for every name.

use super::ExportError;
use super::atomic::Partial;
use super::value::{Record, Value};
use std::io::{self, BufWriter, Seek, Write};
use std::path::Path;
use zip::CompressionMethod;
use zip::write::{SimpleFileOptions, ZipWriter};

/// Extension of the files.
pub(super) const EXTENSION: &str = "npz";

/// Writes file `name` of folder `dir`.
///
/// # Errors
/// If it cannot be written; it is complete or not there.
pub(super) fn write(dir: &Path, name: &str, record: &Record) -> Result<(), ExportError> {
    let (partial, file) = Partial::create(dir, name)?;
    write_archive(BufWriter::new(file), record).map_err(|source| partial.failed(source))?;
    partial.finish()
}

fn write_archive(out: impl Write + Seek, record: &Record) -> io::Result<()> {
    let mut archive = ZipWriter::new(out);
    for (name, value) in &record.0 {
        let bytes = bytes(value);
        // Headers of arrays are smaller than that.
        let is_large = bytes.len() as u64 > u64::from(u32::MAX) - (1 << 16);
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored).large_file(is_large);
        archive.start_file(format!("{name}.npy"), options)?;
        archive.write_all(&header(value))?;
        archive.write_all(&bytes)?;
    }
    archive.finish()?.flush()
}

/// What stands before the numbers: format 1.0, a Python literal, filled up to a multiple of 64 bytes.
fn header(value: &Value) -> Vec<u8> {
    const START: &[u8] = b"\x93NUMPY\x01\x00";
    let axes: String = value.shape().iter().map(|axis| format!("{axis}, ")).collect();
    let text = format!("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", dtype(value), axes.trim_end());
    let taken = START.len() + 2 + text.len() + 1;
    let length = taken.next_multiple_of(64) - START.len() - 2;
    let mut bytes = START.to_vec();
    bytes.extend(u16::try_from(length).expect("an array has few axes").to_le_bytes());
    bytes.extend(format!("{text:<0$}\n", length - 1).into_bytes());
    bytes
}

fn dtype(value: &Value) -> String {
    match value {
        Value::Real(_) => "<f8".into(),
        Value::Complex(_) => "<c16".into(),
        Value::Integers(..) => "<i8".into(),
        Value::Flags(..) => "|b1".into(),
        Value::Text(text) => format!("<U{}", width(std::slice::from_ref(text))),
        Value::Texts(texts) => format!("<U{}", width(texts)),
    }
}

/// The numbers, row-major and little-endian.
fn bytes(value: &Value) -> std::borrow::Cow<'_, [u8]> {
    match value {
        Value::Real(array) | Value::Complex(array) => (&array.data[..]).into(),
        Value::Integers(_, values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
        Value::Flags(_, values) => values.iter().map(|&value| u8::from(value)).collect(),
        Value::Text(text) => code_points(std::slice::from_ref(text)).into(),
        Value::Texts(texts) => code_points(texts).into(),
    }
}

/// Length of the longest text, but not 0, which NumPy has no array of.
fn width(texts: &[String]) -> usize {
    texts.iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1)
}

/// Texts as NumPy has them: code points of four bytes, filled up with zeros.
fn code_points(texts: &[String]) -> Vec<u8> {
    let width = width(texts);
    let padded = texts.iter().flat_map(|text| text.chars().map(u32::from).chain(std::iter::repeat(0)).take(width));
    padded.flat_map(u32::to_le_bytes).collect()
}
