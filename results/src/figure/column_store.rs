//! Columns of numbers that figures share: each is stored once and referred to by its place.

use crate::curves::Column;
use serde::Serialize;

/// Columns in their places.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct ColumnStore {
    list: Vec<Column>,
    #[serde(skip)]
    first: usize,
}

/// A column, or some of its places.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ref {
    /// Place among the columns.
    pub column: usize,
    /// These places of it only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<Vec<usize>>,
    /// Whether it is multiplied by the forcing amplitude looked at.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub by_amplitude: bool,
}

impl Ref {
    /// The whole column.
    pub fn to(column: usize) -> Self {
        Self { column, at: None, by_amplitude: false }
    }

    /// Some places of it.
    pub fn at(&self, places: &[usize]) -> Self {
        Self { at: Some(places.to_vec()), ..self.clone() }
    }

    /// Times the forcing amplitude looked at.
    pub fn by_amplitude(&self) -> Self {
        Self { by_amplitude: true, ..self.clone() }
    }
}

impl ColumnStore {
    /// Empty; others hold the columns before place `first`.
    pub fn starting_at(first: usize) -> Self {
        Self { list: Vec::new(), first }
    }

    /// Where the next column goes.
    pub fn end(&self) -> usize {
        self.first + self.list.len()
    }

    /// Takes a column in.
    pub fn add(&mut self, column: Column) -> Ref {
        self.list.push(column);
        Ref::to(self.end() - 1)
    }

    /// Takes several columns in.
    pub fn add_all(&mut self, columns: &[Column]) -> Vec<Ref> {
        columns.iter().map(|column| self.add(column.clone())).collect()
    }

    /// Numbers with all digits.
    pub fn exact(&mut self, values: Vec<f64>) -> Ref {
        self.add(Column::exact(values))
    }

    /// What is referred to, at a forcing amplitude; nothing if it is not there.
    pub fn values(&self, of: &Ref, amplitude: f64) -> Vec<f64> {
        let column = of.column.checked_sub(self.first).and_then(|place| self.list.get(place));
        let values: &[f64] = column.map_or(&[], |column| &column.values);
        let factor = if of.by_amplitude { amplitude } else { 1.0 };
        match &of.at {
            None => values.iter().map(|value| value * factor).collect(),
            Some(places) => places.iter().filter_map(|&i| values.get(i)).map(|value| value * factor).collect(),
        }
    }
}
