//! What is known of every key of `model.toml` and `study.toml`, once: the JSON Schema of both files, what `isola schema
//! --explain` says and `REFERENCE.md` follow from it. Tests compare it with what the program reads.

mod document;
mod explain;
mod key;
mod law_keys;
mod model_keys;
mod schema;
mod study_keys;

pub use document::{document, file};
pub use explain::{example_of, explain, keys_called};
pub use key::{Absent, Key, Kind, List, Range, Tables};
pub use schema::schema;
pub use study_keys::MAX_LEVELS;

/// A file whose keys are known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum File {
    /// `model.toml`.
    Model,
    /// `study.toml`.
    Study,
}

impl File {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Model, Self::Study];

    /// Name of the file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Model => "model.toml",
            Self::Study => "study.toml",
        }
    }

    /// The path of a key after the name of the file, as in `study.units`, if that is what it begins with.
    fn within(self, path: &str) -> Option<(Self, &str)> {
        let name = self.name().strip_suffix(".toml")?;
        Some((self, path.strip_prefix(name)?.strip_prefix('.')?))
    }

    /// All its keys, each after the table that it belongs to.
    pub fn keys(self) -> impl Iterator<Item = &'static Key> {
        let scenario = || model_keys::SCENARIO.iter().chain(law_keys::LAWS);
        let (own, numerics): (&[Key], &[Key]) = match self {
            Self::Model => (std::slice::from_ref(&model_keys::NAME), &[]),
            Self::Study => (study_keys::OWN, study_keys::NUMERICS),
        };
        own.iter().chain(numerics).chain(scenario())
    }

    /// Keys that a table of this file has; without a path those at the top.
    fn keys_of(self, table: Option<&str>) -> impl Iterator<Item = &'static Key> {
        self.keys().filter(move |key| key.parent() == table)
    }
}
