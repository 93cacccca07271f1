//! What is not there, or damaged, in sentences.

use crate::store::{Reader, Result, StoreError};
use crate::words::count;
use std::fmt::Display;

/// What a reading of a run has to leave out.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub struct Omissions {
    /// What is stored but cannot be read, or is not what was stored.
    pub damaged: Vec<String>,
    /// What is not there, or not yet.
    pub missing: Vec<String>,
}

impl Omissions {
    /// All sentences.
    pub fn sentences(&self) -> impl Iterator<Item = &String> {
        self.damaged.iter().chain(&self.missing)
    }

    /// Looks for damage in the file as a whole.
    pub(crate) fn check(&mut self, reader: &Reader) {
        if let Err(error) = reader.check() {
            self.damaged.push(format!("The file of the run is damaged: {}.", detail(&error)));
        }
    }

    /// What was read, if it could be; `what` begins the sentence otherwise.
    pub(crate) fn read<T>(&mut self, what: impl Display, result: Result<T>) -> Option<T> {
        self.take(what, result.map_err(|error| detail(&error)))
    }

    /// As [`Omissions::read`], with a reason of its own.
    pub(crate) fn take<T>(&mut self, what: impl Display, result: std::result::Result<T, impl Display>) -> Option<T> {
        result.map_err(|why| self.left_out(what, why)).ok()
    }

    /// Notes that `what` is left out.
    pub(crate) fn left_out(&mut self, what: impl Display, why: impl Display) {
        self.damaged.push(format!("{what} left out: {why}."));
    }
}

/// What is said first of a run whose file is damaged: of so many parts that cannot be read, if there are some.
pub fn damage_sentence(parts: usize) -> Option<String> {
    let are = if parts == 1 { "is" } else { "are" };
    let parts = (parts > 0).then(|| count(parts, "part"))?;
    Some(format!("The file of the run is damaged: {parts} of it {are} left out, and what was found may be missing."))
}

/// What is wrong, without the remedy, which is the same for all of them.
pub(crate) fn detail(error: &StoreError) -> String {
    match error {
        StoreError::Corrupt { detail, .. } => detail.clone(),
        other => other.to_string(),
    }
}
