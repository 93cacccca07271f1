//! A list of what was found, column by column: a CSV file has its text, files for MATLAB and NumPy its numbers.

use super::ExportError;
use super::table::{Table, optional};
use super::value::{Group, Value};
use protocol::array::Array;
use std::path::Path;

/// The cells of a column; what is not there is empty as text and not a number elsewhere.
enum Cells {
    /// Words, names.
    Texts(Vec<String>),
    /// Real numbers.
    Numbers(Vec<Option<f64>>),
    /// How many, or numbers that count from 1.
    Counts(Vec<Option<usize>>),
    /// Modes, which count from 1 as text and from 0 elsewhere.
    Modes(Vec<Option<usize>>),
    /// Truth values; what is not known is false where there is no text for it.
    Flags(Vec<Option<bool>>),
}

impl Cells {
    /// The cells as text.
    fn texts(&self) -> Vec<String> {
        let count = |count: &Option<usize>| count.map_or_else(String::new, |count| count.to_string());
        match self {
            Self::Texts(texts) => texts.clone(),
            Self::Numbers(numbers) => numbers.iter().copied().map(optional).collect(),
            Self::Counts(counts) => counts.iter().map(count).collect(),
            Self::Modes(modes) => modes.iter().map(|mode| count(&mode.map(|mode| mode + 1))).collect(),
            Self::Flags(flags) => flags.iter().map(|flag| flag.map_or_else(String::new, |f| f.to_string())).collect(),
        }
    }

    /// The cells as an array. `is_whole`: integers of which none is ever missing, which stay integers.
    fn value(&self, is_whole: bool) -> Value {
        let real = |numbers: Vec<Option<f64>>| -> Value {
            Array::new([numbers.len()], numbers.into_iter().map(|number| number.unwrap_or(f64::NAN))).into()
        };
        match self {
            Self::Texts(texts) => texts.clone().into(),
            Self::Numbers(numbers) => real(numbers.clone()),
            Self::Counts(counts) | Self::Modes(counts) if is_whole => {
                counts.iter().copied().flatten().collect::<Vec<usize>>().into()
            }
            Self::Counts(counts) | Self::Modes(counts) => {
                real(counts.iter().map(|count| count.map(|count| count as f64)).collect())
            }
            Self::Flags(flags) => flags.iter().map(|flag| flag.unwrap_or(false)).collect::<Vec<bool>>().into(),
        }
    }
}

/// A column: its name and cells, and which files have it.
struct Column {
    name: &'static str,
    cells: Cells,
    /// Whether the CSV file has it.
    is_text: bool,
    /// Whether its integers are never missing.
    is_whole: bool,
}

/// A list under way, of rows.
pub(super) struct Lister<'r, R> {
    rows: &'r [R],
    columns: Vec<Column>,
}

impl<'r, R> Lister<'r, R> {
    /// Of rows, without columns.
    pub fn new(rows: &'r [R]) -> Self {
        Self { rows, columns: Vec::new() }
    }

    fn with(mut self, name: &'static str, cells: Cells, is_whole: bool) -> Self {
        self.columns.push(Column { name, cells, is_text: true, is_whole });
        self
    }

    /// With a column of texts.
    pub fn texts<'t>(self, name: &'static str, of: impl Fn(&'r R) -> &'t str) -> Self
    where
        'r: 't,
    {
        let cells = self.rows.iter().map(|row| of(row).to_string()).collect();
        self.with(name, Cells::Texts(cells), false)
    }

    /// With a column of numbers.
    pub fn numbers(self, name: &'static str, of: impl Fn(&R) -> f64) -> Self {
        self.optional_numbers(name, |row| Some(of(row)))
    }

    /// With a column of numbers that may be missing.
    pub fn optional_numbers(self, name: &'static str, of: impl Fn(&R) -> Option<f64>) -> Self {
        let cells = self.rows.iter().map(of).collect();
        self.with(name, Cells::Numbers(cells), false)
    }

    /// With a column of counts.
    pub fn counts(self, name: &'static str, of: impl Fn(&R) -> usize) -> Self {
        let cells = self.rows.iter().map(|row| Some(of(row))).collect();
        self.with(name, Cells::Counts(cells), true)
    }

    /// With a column of counts that may be missing.
    pub fn optional_counts(self, name: &'static str, of: impl Fn(&R) -> Option<usize>) -> Self {
        let cells = self.rows.iter().map(of).collect();
        self.with(name, Cells::Counts(cells), false)
    }

    /// With a column of modes, from 0.
    pub fn modes(self, name: &'static str, of: impl Fn(&R) -> usize) -> Self {
        let cells = self.rows.iter().map(|row| Some(of(row))).collect();
        self.with(name, Cells::Modes(cells), true)
    }

    /// With a column of modes, from 0, that may be missing.
    pub fn optional_modes(self, name: &'static str, of: impl Fn(&R) -> Option<usize>) -> Self {
        let cells = self.rows.iter().map(of).collect();
        self.with(name, Cells::Modes(cells), false)
    }

    /// With a column of truth values.
    pub fn flags(self, name: &'static str, of: impl Fn(&R) -> Option<bool>) -> Self {
        let cells = self.rows.iter().map(of).collect();
        self.with(name, Cells::Flags(cells), false)
    }

    /// The last column is in files for MATLAB and NumPy alone.
    pub fn without_text(mut self) -> Self {
        if let Some(column) = self.columns.last_mut() {
            column.is_text = false;
        }
        self
    }

    /// The list, for files called `name`.
    pub fn list(self, name: &'static str) -> List {
        List { name, count: self.rows.len(), columns: self.columns }
    }
}

/// A list.
pub(super) struct List {
    /// Name of its CSV file, without extension, and of its group in other files.
    pub name: &'static str,
    count: usize,
    columns: Vec<Column>,
}

impl List {
    /// Whether it has no rows.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Columns of the CSV file.
    fn texts(&self) -> impl Iterator<Item = &Column> {
        self.columns.iter().filter(|column| column.is_text)
    }

    /// Their names.
    #[cfg(test)]
    pub fn names(&self) -> Vec<&'static str> {
        self.texts().map(|column| column.name).collect()
    }

    /// Writes its CSV file into folder `dir`, and says what it is called.
    pub fn write(&self, dir: &Path) -> Result<String, ExportError> {
        let file = format!("{}.csv", self.name);
        let names: Vec<String> = self.texts().map(|column| column.name.to_string()).collect();
        let mut table = Table::create(dir, &file, &names)?;
        let cells: Vec<Vec<String>> = self.texts().map(|column| column.cells.texts()).collect();
        for row in 0..self.count {
            table.row(cells.iter().map(|column| &column[row]))?;
        }
        table.finish()?;
        Ok(file)
    }

    /// Adds its columns to the group of its name.
    pub fn add(&self, group: &mut Group<'_>) {
        for column in &self.columns {
            group.add(column.name, column.cells.value(column.is_whole));
        }
    }
}
