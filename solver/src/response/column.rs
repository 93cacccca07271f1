//! What a column is: name, unit and meaning of numbers that points of a curve have, and where they are shown.

/// What a column has a number for, at each point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// The point.
    Point,
    /// Every monitored dof.
    Monitors,
    /// Every contact element.
    Contacts,
    /// Every mode.
    Modes,
}

/// What the numbers of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Number {
    /// Measured.
    Real,
    /// Counted.
    Integer,
}

/// Where a column stands in a CSV file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Csv {
    /// Nowhere.
    No,
    /// One number a row: of the first monitored dof, the largest over the contact elements.
    One,
    /// One for every mode, `PREFIX_1`, …; or, of the monitored dofs, for the first one, and at the end `PREFIX_NAME` for
    /// each of the others.
    Every(&'static str),
}

/// How the page shows a column beside the pointer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hover {
    /// Name of the quantity.
    pub label: &'static str,
    /// Significant digits.
    pub digits: u8,
    /// Whether it is a share in per cent.
    pub is_percentage: bool,
}

/// A column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// Name on the wire, in tables and files.
    pub name: &'static str,
    /// Unit; empty without one.
    pub unit: &'static str,
    /// What it has numbers for.
    pub axis: Axis,
    /// What they are.
    pub number: Number,
    /// What it means, in words.
    pub meaning: &'static str,
    /// Whether results of the first programs are without it.
    pub is_later: bool,
    /// On the page, if it is shown there.
    pub hover: Option<Hover>,
    /// In the CSV files of branches.
    pub branch_csv: Csv,
    /// In the CSV file of the backbone.
    pub backbone_csv: Csv,
}

impl Column {
    /// A column that is shown nowhere.
    pub const fn new(name: &'static str, unit: &'static str, axis: Axis, meaning: &'static str) -> Self {
        let (number, is_later, hover, none) = (Number::Real, false, None, Csv::No);
        Self { name, unit, axis, number, meaning, is_later, hover, branch_csv: none, backbone_csv: none }
    }

    /// Of integers.
    pub const fn of_integers(self) -> Self {
        Self { number: Number::Integer, ..self }
    }

    /// Added after the first programs: what they computed does not have it.
    pub const fn later(self) -> Self {
        Self { is_later: true, ..self }
    }

    /// Shown on the page.
    pub const fn hover(self, label: &'static str, digits: u8) -> Self {
        Self { hover: Some(Hover { label, digits, is_percentage: false }), ..self }
    }

    /// Shown on the page, in per cent.
    pub const fn percentage(self, label: &'static str, digits: u8) -> Self {
        Self { hover: Some(Hover { label, digits, is_percentage: true }), ..self }
    }

    /// Written into CSV files: of branches, of the backbone.
    pub const fn csv(self, branch_csv: Csv, backbone_csv: Csv) -> Self {
        Self { branch_csv, backbone_csv, ..self }
    }

    /// What it means, with its unit.
    pub fn description(&self) -> String {
        if self.unit.is_empty() { self.meaning.into() } else { format!("{}, {}", self.meaning, self.unit) }
    }
}
