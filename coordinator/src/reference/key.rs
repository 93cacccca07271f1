//! What is known of a key: one entry, from which schema, explanation and document follow.

/// A key of a file, or of tables within it.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// Dotted, as after `--set`, but for the positions of entries of lists, which are left out.
    pub path: &'static str,
    /// What its value is.
    pub kind: Kind,
    /// What holds without it.
    pub default: Absent,
    /// Unit of its numbers; empty without one.
    pub unit: &'static str,
    /// What it means, in sentences.
    pub meaning: &'static str,
    /// A value as it stands in a file, for keys without keys below them.
    pub example: &'static str,
}

/// What holds where a key is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Absent {
    /// This value, as it stands in a file.
    Value(&'static str),
    /// What this says.
    Words(&'static str),
    /// Nothing: there is none of it.
    Nothing,
    /// The key cannot be left out.
    Required,
}

/// What a value may be.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// Any text.
    Text,
    /// A text that matches this regular expression.
    Pattern(&'static str),
    /// One of these words, and what each means.
    Word(&'static [(&'static str, &'static str)]),
    /// `true` or `false`.
    Truth,
    /// A whole number.
    Whole(Range),
    /// A number.
    Number(Range),
    /// One of these numbers.
    OneOf(&'static [f64]),
    /// A list.
    List(&'static List),
    /// A table of numbers by the names of dofs.
    ByDof(Range),
    /// Whatever one of these is.
    Either(&'static [Kind]),
    /// A table of the keys below this one.
    Table,
    /// A table of exactly one of the keys below this one.
    Choice,
    /// A list of tables of the keys below this one.
    Tables(Tables),
}

/// A list of tables.
#[derive(Debug, Clone, Copy)]
pub struct Tables {
    /// Keys of which each table has exactly one, if any are named.
    pub exactly_one: &'static [&'static str],
    /// Fewest tables.
    pub fewest: usize,
}

impl Tables {
    /// Any number of tables, of any of their keys.
    pub const ANY: Self = Self { exactly_one: &[], fewest: 0 };
}

/// A list.
#[derive(Debug, Clone, Copy)]
pub struct List {
    /// What each entry is.
    pub of: Kind,
    /// Fewest entries.
    pub fewest: usize,
    /// Most entries.
    pub most: Option<usize>,
    /// Whether no two entries may be equal.
    pub distinct: bool,
}

/// Between which constants a number lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// The lower bound and whether it belongs to the range.
    pub low: Option<(f64, bool)>,
    /// The upper bound and whether it belongs to the range.
    pub high: Option<(f64, bool)>,
    /// Whether zero does.
    pub zero: bool,
}

impl Range {
    /// Any finite number.
    pub const ANY: Self = Self { low: None, high: None, zero: true };
    /// Any finite number but zero.
    pub const NOT_ZERO: Self = Self { zero: false, ..Self::ANY };
    /// Above zero.
    pub const POSITIVE: Self = Self { low: Some((0.0, false)), ..Self::ANY };
    /// From 0 to below 1.
    pub const SHARE: Self = Self { low: Some((0.0, true)), high: Some((1.0, false)), zero: true };

    /// From this number on.
    pub const fn from(low: f64) -> Self {
        Self { low: Some((low, true)), ..Self::ANY }
    }

    /// From one number to another one, both included.
    pub const fn within(low: f64, high: f64) -> Self {
        Self { low: Some((low, true)), high: Some((high, true)), zero: true }
    }

    /// In words, with what lies in the range; empty of any number.
    pub fn words(&self) -> String {
        let bound =
            |(value, included): (f64, bool), words: [&str; 2]| format!("{} {value}", words[usize::from(included)]);
        let low = self.low.map(|low| bound(low, ["above", "at least"]));
        let high = self.high.map(|high| bound(high, ["below", "at most"]));
        let zero = (!self.zero).then(|| "not 0".to_string());
        [low, high, zero].into_iter().flatten().collect::<Vec<_>>().join(", ")
    }
}

impl Key {
    /// Last part of the path.
    pub fn name(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }

    /// Path of the table that it belongs to; none at the top.
    pub fn parent(&self) -> Option<&'static str> {
        self.path.rsplit_once('.').map(|(parent, _)| parent)
    }

    /// Whether its value is made of the keys below it.
    pub fn has_keys(&self) -> bool {
        matches!(self.kind, Kind::Table | Kind::Choice | Kind::Tables(_))
    }
}

impl Kind {
    /// In words: what to write.
    pub fn words(&self) -> String {
        let in_range = |what: &str, range: &Range| match range.words() {
            words if words.is_empty() => what.to_string(),
            words => format!("{what}, {words}"),
        };
        match self {
            Self::Text | Self::Pattern(_) => "text".into(),
            Self::Word(words) => words.iter().map(|(word, _)| format!("\"{word}\"")).collect::<Vec<_>>().join(" or "),
            Self::Truth => "true or false".into(),
            Self::Whole(range) => in_range("whole number", range),
            Self::Number(range) => in_range("number", range),
            Self::OneOf(values) => values.iter().map(f64::to_string).collect::<Vec<_>>().join(" or "),
            Self::List(list) => list.words(),
            Self::ByDof(range) => in_range("table {dof = number}", range),
            Self::Either(kinds) => kinds.iter().map(Self::words).collect::<Vec<_>>().join("; or "),
            Self::Table => "section".into(),
            Self::Choice => "table of exactly one key".into(),
            Self::Tables(Tables { exactly_one: [], .. }) => "list of tables".into(),
            Self::Tables(Tables { exactly_one, .. }) => {
                format!("list of tables, each with exactly one of {}", exactly_one.join(", "))
            }
        }
    }
}

impl List {
    /// A list of any length.
    pub const fn of(kind: Kind) -> Self {
        Self { of: kind, fewest: 0, most: None, distinct: false }
    }

    fn words(&self) -> String {
        let count = match (self.fewest, self.most) {
            (0, None) => String::new(),
            (fewest, None) => format!(" of {fewest} or more"),
            (0, Some(most)) => format!(" of at most {most}"),
            (fewest, Some(most)) if fewest == most => format!(" of {fewest}"),
            (fewest, Some(most)) => format!(" of {fewest} to {most}"),
        };
        format!("list{count} ({})", self.of.words())
    }
}
