//! A variable of a file, or one inside a cell array or a structure.

use crate::export::value::Value;
use protocol::array::Array;
use std::borrow::Cow;
use std::io::{self, Write};

// Types of data.
const INT8: u32 = 1;
const UINT8: u32 = 2;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
const UTF8: u32 = 16;
const UTF16: u32 = 17;
const UTF32: u32 = 18;

// Classes of variables.
const CELL_CLASS: u8 = 1;
const STRUCTURE_CLASS: u8 = 2;
const CHAR_CLASS: u8 = 4;
const DOUBLE_CLASS: u8 = 6;
const UINT8_CLASS: u8 = 9;

// Flags of variables.
const LOGICAL: u8 = 0x02;
const COMPLEX: u8 = 0x08;

/// Bytes of a tag.
const TAG: u64 = 8;
/// Numbers are eight bytes, little-endian.
const NUMBER: usize = 8;

/// A variable without its name.
pub(super) struct Matrix<'v> {
    /// Lengths of the axes, two at least.
    axes: Vec<usize>,
    content: Content<'v>,
}

enum Content<'v> {
    /// Real numbers, row-major.
    Real(Cow<'v, Array>),
    /// Complex numbers, row-major, with a last axis (re, im).
    Complex(&'v Array),
    /// Truth values.
    Flags(&'v [bool]),
    /// A row of characters: type and bytes.
    Text(u32, Cow<'v, [u8]>),
    /// A column of variables.
    Cells(Vec<Matrix<'v>>),
    /// Fields of a structure.
    Fields(Vec<(&'v str, Matrix<'v>)>),
}

impl<'v> Matrix<'v> {
    /// Of a value. A list is a column, integers are doubles, which hold them exactly up to 2^53.
    pub fn of(value: &'v Value) -> Self {
        let content = match value {
            Value::Real(array) => Content::Real(Cow::Borrowed(array)),
            Value::Complex(array) => Content::Complex(array),
            Value::Integers(shape, values) => {
                Content::Real(Cow::Owned(Array::new(shape.clone(), values.iter().map(|&value| value as f64))))
            }
            Value::Flags(_, values) => Content::Flags(values),
            Value::Text(text) => return Self::text(text),
            Value::Texts(texts) => Content::Cells(texts.iter().map(|text| Self::text(text)).collect()),
        };
        let mut axes = value.shape();
        while axes.len() < 2 {
            axes.push(1);
        }
        Self { axes, content }
    }

    fn text(text: &'v str) -> Self {
        let length = text.chars().count();
        // One unit a character: Octave counts bytes of UTF-8 as characters, SciPy pairs of UTF-16 as one.
        let content = if text.is_ascii() {
            Content::Text(UTF8, text.as_bytes().into())
        } else if text.encode_utf16().count() == length {
            Content::Text(UTF16, text.encode_utf16().flat_map(u16::to_le_bytes).collect())
        } else {
            Content::Text(UTF32, text.chars().flat_map(|c| u32::from(c).to_le_bytes()).collect())
        };
        Self { axes: vec![length.min(1), length], content }
    }

    /// A structure.
    pub fn structure(fields: Vec<(&'v str, Matrix<'v>)>) -> Self {
        Self { axes: vec![1, 1], content: Content::Fields(fields) }
    }

    /// Size of the whole element, bytes.
    pub fn bytes(&self, name: &str) -> u64 {
        TAG + self.inner_bytes(name)
    }

    /// Size of what the element holds, bytes.
    fn inner_bytes(&self, name: &str) -> u64 {
        let numbers = NUMBER as u64 * self.count();
        let content = match &self.content {
            Content::Real(_) => element(numbers),
            Content::Complex(_) => 2 * element(numbers),
            Content::Flags(_) => element(self.count()),
            Content::Text(_, bytes) => element(bytes.len() as u64),
            Content::Cells(cells) => cells.iter().map(|cell| cell.bytes("")).sum(),
            Content::Fields(fields) => {
                let names = (field_width(fields) * fields.len()) as u64;
                TAG + element(names) + fields.iter().map(|(_, field)| field.bytes("")).sum::<u64>()
            }
        };
        element(8) + element(4 * self.axes.len() as u64) + element(name.len() as u64) + content
    }

    /// Product of the axes.
    fn count(&self) -> u64 {
        self.axes.iter().fold(1, |count, &axis| count.saturating_mul(axis as u64))
    }

    fn class_and_flags(&self) -> [u8; 2] {
        match &self.content {
            Content::Real(_) => [DOUBLE_CLASS, 0],
            Content::Complex(_) => [DOUBLE_CLASS, COMPLEX],
            Content::Flags(_) => [UINT8_CLASS, LOGICAL],
            Content::Text(..) => [CHAR_CLASS, 0],
            Content::Cells(_) => [CELL_CLASS, 0],
            Content::Fields(_) => [STRUCTURE_CLASS, 0],
        }
    }

    /// Writes the element of the variable `name`.
    pub fn write(&self, name: &str, out: &mut impl Write) -> io::Result<()> {
        tag(out, MATRIX, self.inner_bytes(name))?;
        let [class, flags] = self.class_and_flags();
        data(out, UINT32, &[class, flags, 0, 0, 0, 0, 0, 0])?;
        let axes: Result<Vec<i32>, _> = self.axes.iter().map(|&axis| i32::try_from(axis)).collect();
        let axes: Vec<u8> = axes.map_err(io::Error::other)?.into_iter().flat_map(i32::to_le_bytes).collect();
        data(out, INT32, &axes)?;
        data(out, INT8, name.as_bytes())?;
        self.write_content(out)
    }

    fn write_content(&self, out: &mut impl Write) -> io::Result<()> {
        match &self.content {
            Content::Real(array) => data(out, DOUBLE, &self.column_major(&array.data, NUMBER, 0)),
            Content::Complex(array) => {
                data(out, DOUBLE, &self.column_major(&array.data, 2 * NUMBER, 0))?;
                data(out, DOUBLE, &self.column_major(&array.data, 2 * NUMBER, NUMBER))
            }
            Content::Flags(flags) => data(out, UINT8, &flags.iter().map(|&flag| u8::from(flag)).collect::<Vec<u8>>()),
            Content::Text(kind, bytes) => data(out, *kind, bytes),
            Content::Cells(cells) => cells.iter().try_for_each(|cell| cell.write("", out)),
            Content::Fields(fields) => write_fields(fields, out),
        }
    }

    /// The numbers at `offset` of items of so many bytes, from row-major to column-major order.
    fn column_major(&self, items: &[u8], item: usize, offset: usize) -> Vec<u8> {
        let mut strides = vec![1; self.axes.len()];
        for axis in (1..self.axes.len()).rev() {
            strides[axis - 1] = strides[axis] * self.axes[axis];
        }
        let place = |mut i: usize| {
            self.axes.iter().zip(&strides).fold(0, |place, (&axis, &stride)| {
                let index = i % axis;
                i /= axis;
                place + index * stride
            })
        };
        let number = |i: usize| &items[place(i) * item + offset..][..NUMBER];
        (0..items.len() / item).flat_map(number).copied().collect()
    }
}

/// Fields of a structure: width of a name, names, values.
fn write_fields(fields: &[(&str, Matrix<'_>)], out: &mut impl Write) -> io::Result<()> {
    let width = field_width(fields);
    // The one element in the short form, four bytes in the tag itself.
    out.write_all(&(4 << 16 | INT32).to_le_bytes())?;
    out.write_all(&(width as u32).to_le_bytes())?;
    let padded = |name: &str| name.bytes().chain(std::iter::repeat(0)).take(width).collect::<Vec<u8>>();
    data(out, INT8, &fields.iter().flat_map(|(name, _)| padded(name)).collect::<Vec<u8>>())?;
    fields.iter().try_for_each(|(_, field)| field.write("", out))
}

/// Bytes of a name of a field, with the zero that ends the longest.
fn field_width(fields: &[(&str, Matrix<'_>)]) -> usize {
    (fields.iter().map(|(name, _)| name.len()).max().unwrap_or(0) + 1).next_multiple_of(32)
}

/// Size of an element of so many bytes of data.
fn element(bytes: u64) -> u64 {
    TAG + bytes.div_ceil(8).saturating_mul(8)
}

fn tag(out: &mut impl Write, kind: u32, bytes: u64) -> io::Result<()> {
    out.write_all(&kind.to_le_bytes())?;
    out.write_all(&u32::try_from(bytes).map_err(io::Error::other)?.to_le_bytes())
}

/// Writes an element that holds data.
fn data(out: &mut impl Write, kind: u32, bytes: &[u8]) -> io::Result<()> {
    tag(out, kind, bytes.len() as u64)?;
    out.write_all(bytes)?;
    out.write_all(&[0; 8][..bytes.len().next_multiple_of(8) - bytes.len()])
}
