//! Why a folder or a set of matrices is not a model. Every message names the file, the key, the value and a remedy.

use super::laws::meant;
use std::collections::HashSet;
use std::fmt;
use std::path::PathBuf;
use thiserror::Error;

/// Where a refused value stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file, unless the value was typed or the model was built from matrices at hand.
    pub file: Option<PathBuf>,
    /// Dotted key; entries of lists are counted from 0, as in what is typed. Empty: the settings as a whole.
    pub key: String,
    /// What set the key, if not this file: an option as typed, or the settings that name this matrix.
    pub set_by: Option<Box<str>>,
}

impl Place {
    /// A key of nobody's file.
    pub fn key(key: impl Into<String>) -> Self {
        Self { file: None, key: key.into(), set_by: None }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.file, &self.set_by) {
            (Some(file), None) => {
                write!(f, "{}: ", file.display())?;
                // Files do not number their entries, and numbers in keys begin with 0.
                if let Some((which, list)) = entry(&self.key) {
                    write!(f, "{which} of {list}: ")?;
                }
            }
            (Some(file), Some(_)) => write!(f, "{}: ", file.display())?,
            (None, Some(typed)) => write!(f, "{typed}: ")?,
            (None, None) => {}
        }
        match self.key.as_str() {
            "" => f.write_str("settings")?,
            key => write!(f, "`{key}`")?,
        }
        match (&self.file, &self.set_by) {
            (Some(_), Some(by)) => write!(f, " (set by {by})"),
            _ => Ok(()),
        }
    }
}

/// Which entry of which list a key is, or is below.
fn entry(key: &str) -> Option<(String, &str)> {
    const ORDINALS: [&str; 5] = ["first", "second", "third", "fourth", "fifth"];
    let (list, rest) = key.split_once('[')?;
    let (index, _) = rest.split_once(']')?;
    let index: usize = index.parse().ok()?;
    let which =
        ORDINALS.get(index).map_or_else(|| format!("entry {} (counted from 1)", index + 1), |o| format!("{o} entry"));
    Some((which, list))
}

/// Why a model was refused.
#[derive(Debug, Error)]
pub enum ModelError {
    /// A file is missing or cannot be read.
    #[error("{place}: the file cannot be read ({source}); {remedy}")]
    Read {
        /// The file and the key that names it.
        place: Place,
        /// What the system says.
        source: std::io::Error,
        /// What to do.
        remedy: String,
    },
    /// The settings are not TOML.
    #[error("{}: not valid TOML {message}", file.display())]
    Syntax {
        /// The file.
        file: PathBuf,
        /// The parser's account, with line and column.
        message: String,
    },
    /// A Matrix Market file is malformed.
    #[error("{}, line {line}: {problem}", file.display())]
    MatrixMarket {
        /// The file.
        file: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// What is wrong, and what would be right.
        problem: String,
    },
    /// A key, a dof, or the name of a choice (a law, a forcing shape) does not exist.
    #[error("{place}: there is no {what} `{name}`; {hint}")]
    Unknown {
        /// Where it stands.
        place: Place,
        /// The kind of thing.
        what: Box<str>,
        /// What was asked for.
        name: Box<str>,
        /// The known name that looks most like it, and what else exists.
        hint: String,
    },
    /// A value has the wrong type, a required one is missing, or a typed one cannot be applied.
    #[error("{place}: {message}")]
    Type {
        /// Where it stands.
        place: Place,
        /// What was found and what was expected.
        message: String,
    },
    /// A value is out of its range, or contradicts another one.
    #[error("{place} = {value}: {remedy}")]
    Value {
        /// Where it stands.
        place: Place,
        /// The value.
        value: String,
        /// What would be right.
        remedy: String,
    },
    /// A value that is needed is missing, or one stands beside another that excludes it.
    #[error("{place} is {}: {remedy}", if *.is_given { "given as well" } else { "not given" })]
    Presence {
        /// Where it stands, or should.
        place: Place,
        /// Whether it is there.
        is_given: bool,
        /// What would be right.
        remedy: String,
    },
    /// A matrix has the wrong size.
    #[error("{place} is {rows} × {cols}, {expected}")]
    Size {
        /// The matrix.
        place: Place,
        /// Its rows.
        rows: usize,
        /// Its columns.
        cols: usize,
        /// What size would be right, and why.
        expected: String,
    },
    /// A matrix has an entry that is not a finite number.
    #[error("{place}: entry ({row}, {col}) is {value}; every entry must be a finite number")]
    NotFinite {
        /// The matrix.
        place: Place,
        /// Row, counted from 1.
        row: usize,
        /// Column, counted from 1.
        col: usize,
        /// The entry.
        value: f64,
    },
    /// A matrix is not symmetric.
    #[error(
        "{place} is not symmetric: entry ({row}, {col}) is {value:?} but entry ({col}, {row}) is {mirrored:?}; M, K and \
         C must be symmetric to 1e-8 of their largest entry (gyroscopic and follower terms are not supported)"
    )]
    NotSymmetric {
        /// The matrix.
        place: Place,
        /// Row, counted from 1.
        row: usize,
        /// Column, counted from 1.
        col: usize,
        /// The entry.
        value: f64,
        /// Its mirror image.
        mirrored: f64,
    },
    /// The mass matrix is not positive definite.
    #[error(
        "{place} is not positive definite: its leading {minor} × {minor} block, up to dof `{dof}` (diagonal entry \
         {diagonal:?} kg), has no Cholesky factor; every motion needs a positive mass: condense massless dofs out, or \
         check that mass and stiffness are not exchanged"
    )]
    MassNotPositive {
        /// The mass matrix.
        place: Place,
        /// Order of the first leading block that is not positive definite.
        minor: usize,
        /// Name of the last dof of this block.
        dof: String,
        /// Its diagonal entry, kg.
        diagonal: f64,
    },
    /// The stiffness matrix has a negative eigenvalue.
    #[error(
        "{place} has a negative eigenvalue: {value:.4e} (rad/s)², the largest being {largest:.4e}; the structure at rest \
         must be stable: put negative stiffness into a nonlinear law, or check signs and units"
    )]
    StiffnessNegative {
        /// The stiffness matrix.
        place: Place,
        /// Lowest eigenvalue of (K, M), (rad/s)².
        value: f64,
        /// Highest eigenvalue of (K, M), (rad/s)².
        largest: f64,
    },
    /// The eigenvalue problem of (K, M) did not converge.
    #[error("{place}: the modes of (K, M) could not be computed; check the scaling of both matrices (SI units)")]
    NoModes {
        /// The stiffness matrix.
        place: Place,
    },
    /// A name is used twice.
    #[error("{place}: the name `{name}` is used twice; give every {what} its own name")]
    Duplicate {
        /// Where it stands.
        place: Place,
        /// The kind of thing.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// The forcing shape is zero.
    #[error("{place} = 0 on every dof: this forcing does nothing; force at least one dof, or mode 1 by `{{mode = 1}}`")]
    NoForce {
        /// The forcing shape.
        place: Place,
    },
}

/// The place of an error, borrowed as the error is.
macro_rules! place_of {
    ($error:expr) => {
        match $error {
            Self::Read { place, .. }
            | Self::Unknown { place, .. }
            | Self::Type { place, .. }
            | Self::Value { place, .. }
            | Self::Presence { place, .. }
            | Self::Size { place, .. }
            | Self::NotFinite { place, .. }
            | Self::NotSymmetric { place, .. }
            | Self::MassNotPositive { place, .. }
            | Self::StiffnessNegative { place, .. }
            | Self::NoModes { place }
            | Self::Duplicate { place, .. }
            | Self::NoForce { place } => Some(place),
            Self::Syntax { .. } | Self::MatrixMarket { .. } => None,
        }
    };
}

impl ModelError {
    /// A value that is refused.
    pub fn value(place: Place, value: impl fmt::Display, remedy: impl Into<String>) -> Self {
        Self::Value { place, value: value.to_string(), remedy: remedy.into() }
    }

    /// A value that is needed and not there.
    pub fn missing(place: Place, remedy: impl Into<String>) -> Self {
        Self::Presence { place, is_given: false, remedy: remedy.into() }
    }

    /// A value that another one excludes.
    pub(crate) fn superfluous(place: Place, remedy: impl Into<String>) -> Self {
        Self::Presence { place, is_given: true, remedy: remedy.into() }
    }

    /// Where the refused value stands; none if a whole file is refused.
    pub fn place(&self) -> Option<&Place> {
        place_of!(self)
    }

    /// The same error with its key looked up: `find` knows what set it.
    pub(crate) fn located(mut self, find: impl FnOnce(&str) -> Place) -> Self {
        if let Some(place) = self.place_mut()
            && place.file.is_none()
            && place.set_by.is_none()
        {
            *place = find(&place.key);
        }
        self
    }

    /// The same error; of what was typed as the first of these, after another option that sets the same key.
    #[must_use]
    pub fn retyped(mut self, typed: &str, after: &str) -> Self {
        if let Some(place) = self.place_mut()
            && place.set_by.as_deref() == Some(typed)
        {
            place.set_by = Some(after.into());
        }
        self
    }

    /// The same error; of an unknown name with another hint as well.
    #[must_use]
    pub fn hinted(mut self, more: &str) -> Self {
        if let Self::Unknown { hint, .. } = &mut self {
            *hint = format!("{hint}; {more}");
        }
        self
    }

    fn place_mut(&mut self) -> Option<&mut Place> {
        place_of!(self)
    }

    /// A name that does not exist, of a kind of thing, with those that look like it.
    pub fn unknown<'a>(place: Place, what: &str, name: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        /// More names than this are not shown.
        const SHOWN: usize = 12;
        /// So many letters of a law may be wrong, missing, too many or exchanged.
        const SLIP: usize = 2;
        let mut seen = HashSet::new();
        let known = known.into_iter().filter(|known| seen.insert(*known));
        let mut known: Vec<(f64, &str)> = known.map(|k| (similarity(name, k), k)).collect();
        let nearest = known
            .iter()
            .filter(|(similarity, _)| *similarity > 0.7)
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, name)| *name);
        // What differs by a slip of the finger is what was meant, whatever words are in it.
        let slip = || {
            let near = known.iter().map(|(_, known)| (strsim::damerau_levenshtein(name, known), *known));
            near.filter(|(letters, _)| *letters <= SLIP).min_by_key(|(letters, _)| *letters).map(|(_, known)| known)
        };
        let nearest = if what == "law" { slip().or_else(|| meant(name)).or(nearest) } else { nearest };
        let more = known.len().saturating_sub(SHOWN);
        if more > 0 {
            known.sort_by(|a, b| b.0.total_cmp(&a.0));
            known.truncate(SHOWN);
        }
        let known: Vec<String> = known.into_iter().map(|(_, known)| format!("`{known}`")).collect();
        let guess = nearest.map_or_else(String::new, |name| format!("did you mean `{name}`? "));
        let more = if more > 0 { format!(", … and {more} more") } else { String::new() };
        let hint = format!("{guess}known here: {}{more}", known.join(", "));
        Self::Unknown { place, what: what.into(), name: name.into(), hint }
    }
}

/// Similarity of a name with a known one, or of the last parts of dotted keys, which a letter is like no word; what stands before tells
/// keys of the same last part apart.
fn similarity(name: &str, known: &str) -> f64 {
    let last = |key| str::rsplit(key, '.').next().filter(|last| last.len() > 1).unwrap_or(key);
    let whole = strsim::jaro_winkler(name, known);
    // A letter too many or too few counts more in short words there than it should.
    let (short, long) = (last(name).len().min(last(known).len()), last(name).len().max(last(known).len()));
    let is_but_for_a_letter = short > 1 && long == short + 1 && strsim::levenshtein(last(name), last(known)) == 1;
    let parts = strsim::jaro_winkler(last(name), last(known)).max(if is_but_for_a_letter { 0.9 } else { 0.0 });
    whole.max(0.9 * parts + 0.1 * whole)
}
