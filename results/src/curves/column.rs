//! Numbers of a curve, compact in the page: base64 of little-endian floating point numbers.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::ser::{Serialize, SerializeMap, Serializer};
use solver::response::columns::{self, Axis};

/// A number for each point of a curve; NaN where there is none.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// The numbers.
    pub values: Vec<f64>,
    is_exact: bool,
}

impl Column {
    /// Written with all digits: frequencies, whose differences matter in a close-up.
    pub fn exact(values: Vec<f64>) -> Self {
        Self { values, is_exact: true }
    }

    /// Written with seven digits.
    pub fn short(values: Vec<f64>) -> Self {
        Self { values, is_exact: false }
    }
}

/// A column of the solver's list as figures show it.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// What it is.
    pub about: &'static columns::Column,
    /// For every monitored dof, or once: of the point, or the largest over the contact elements; NaN without any.
    pub values: Vec<Column>,
}

impl Quantity {
    /// Of points, from a row of numbers each; `None`: of modes, which have a figure of their own.
    pub fn new<'p>(about: &'static columns::Column, rows: &[&'p [f64]]) -> Option<Self> {
        let of = |value: &dyn Fn(&'p [f64]) -> f64| Column::short(rows.iter().map(|row| value(row)).collect());
        let largest = |row: &[f64]| row.iter().copied().fold(f64::NAN, f64::max);
        let values = match about.axis {
            Axis::Point => vec![of(&|row| row[0])],
            Axis::Contacts => vec![of(&largest)],
            Axis::Monitors => (0..rows.first().map_or(0, |row| row.len())).map(|m| of(&|row| row[m])).collect(),
            Axis::Modes => return None,
        };
        Some(Self { about, values })
    }

    /// Whether there is anything to be said of it: shares of the period in contact, where nothing can touch, are none.
    pub fn is_known(&self) -> bool {
        self.about.axis != Axis::Contacts
            || self.values.iter().any(|column| column.values.iter().any(|v| v.is_finite()))
    }
}

impl Serialize for Column {
    /// `{"f8": "…"}` or `{"f4": "…"}`.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (name, bytes): (_, Vec<u8>) = if self.is_exact {
            ("f8", self.values.iter().flat_map(|value| value.to_le_bytes()).collect())
        } else {
            ("f4", self.values.iter().flat_map(|&value| (value as f32).to_le_bytes()).collect())
        };
        let mut map = serializer.serialize_map(Some(1))?;
        map.serialize_entry(name, &BASE64_STANDARD.encode(bytes))?;
        map.end()
    }
}
