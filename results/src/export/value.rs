//! What is exported, by name and in no particular format.

use protocol::array::Array;

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    /// Real numbers.
    Real(Array),
    /// Complex numbers: the last axis of the array is (re, im) and none of theirs.
    Complex(Array),
    /// Integers: lengths of the axes, numbers.
    Integers(Vec<usize>, Vec<i64>),
    /// Truth values: lengths of the axes, values.
    Flags(Vec<usize>, Vec<bool>),
    /// A text.
    Text(String),
    /// A list of texts.
    Texts(Vec<String>),
}

impl Value {
    /// Lengths of the axes, none for a single value.
    pub fn shape(&self) -> Vec<usize> {
        match self {
            Self::Real(array) => array.shape.clone(),
            Self::Complex(array) => array.shape[..array.shape.len().saturating_sub(1)].to_vec(),
            Self::Integers(shape, _) | Self::Flags(shape, _) => shape.clone(),
            Self::Text(_) => Vec::new(),
            Self::Texts(texts) => vec![texts.len()],
        }
    }
}

impl From<Array> for Value {
    fn from(array: Array) -> Self {
        Self::Real(array)
    }
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self::Real(Array::new([], [value]))
    }
}

impl From<Vec<f64>> for Value {
    fn from(values: Vec<f64>) -> Self {
        Self::Real(Array::new([values.len()], values))
    }
}

impl From<usize> for Value {
    fn from(value: usize) -> Self {
        Self::Integers(Vec::new(), vec![value as i64])
    }
}

impl From<Vec<i64>> for Value {
    fn from(values: Vec<i64>) -> Self {
        Self::Integers(vec![values.len()], values)
    }
}

impl From<Vec<usize>> for Value {
    fn from(values: Vec<usize>) -> Self {
        Self::Integers(vec![values.len()], values.into_iter().map(|value| value as i64).collect())
    }
}

impl From<bool> for Value {
    fn from(value: bool) -> Self {
        Self::Flags(Vec::new(), vec![value])
    }
}

impl From<Vec<bool>> for Value {
    fn from(values: Vec<bool>) -> Self {
        Self::Flags(vec![values.len()], values)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.into())
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<Vec<String>> for Value {
    fn from(texts: Vec<String>) -> Self {
        Self::Texts(texts)
    }
}

/// Values by name; a name may have a group before a point.
#[derive(Debug, Default)]
pub(super) struct Record(pub Vec<(String, Value)>);

impl Record {
    /// Adds values to a group; the empty one has no name.
    pub fn group<'r>(&'r mut self, name: &'r str) -> Group<'r> {
        Group { record: self, name }
    }
}

/// A group of a record under way.
pub(super) struct Group<'r> {
    record: &'r mut Record,
    name: &'r str,
}

impl Group<'_> {
    /// Adds a value.
    pub fn add(&mut self, name: &str, value: impl Into<Value>) {
        let name = if self.name.is_empty() { name.into() } else { format!("{}.{name}", self.name) };
        self.record.0.push((name, value.into()));
    }
}
