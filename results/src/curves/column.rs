//! Numbers of a curve, compact in the page: base64 of little-endian floating point numbers.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::ser::{Serialize, SerializeMap, Serializer};

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
