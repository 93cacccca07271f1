//! What is not there, or damaged, in sentences.

use super::Level;
use crate::store::{Reader, Result, StoreError};
use std::fmt::Display;

/// What a reading of a run lacks.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub struct Lacks {
    /// What is stored but cannot be read, or is not what was stored.
    pub damaged: Vec<String>,
    /// What is not there, or not yet.
    pub missing: Vec<String>,
}

/// How many levels a sentence names.
const NAMED: usize = 8;

impl Lacks {
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

    /// As [`Lacks::read`], with a reason of its own.
    pub(crate) fn take<T>(&mut self, what: impl Display, result: std::result::Result<T, impl Display>) -> Option<T> {
        result.map_err(|why| self.left_out(what, why)).ok()
    }

    /// Notes that `what` is left out.
    pub(crate) fn left_out(&mut self, what: impl Display, why: impl Display) {
        self.damaged.push(format!("{what} left out: {why}."));
    }

    /// Notes which levels are not finished.
    pub(crate) fn levels(&mut self, levels: &[Level], has_backbone: bool) {
        if !has_backbone {
            self.missing.push("There is no backbone yet, and so there are no windows and no branches.".into());
            return;
        }
        let pending = count(levels, |level| level.pending);
        let dead = count(levels, |level| level.dead);
        let bare = count(levels, |level| usize::from(level.is_bare()));
        let sentences = [
            pending.map(|(tasks, list)| {
                format!("{} still to be done, at A = {list}.", number(tasks, "task is", "tasks are"))
            }),
            dead.map(|(tasks, list)| {
                format!("{} given up, at A = {list}: see `isola retry-dead`.", number(tasks, "task was", "tasks were"))
            }),
            bare.map(|(_, list)| format!("There is no branch at A = {list}.")),
        ];
        self.missing.extend(sentences.into_iter().flatten());
    }
}

/// Sum over the levels, and the levels that count; `None` if none does.
fn count(levels: &[Level], of: impl Fn(&Level) -> usize) -> Option<(usize, String)> {
    let counted: Vec<&Level> = levels.iter().filter(|level| of(level) > 0).collect();
    let named: Vec<&str> = counted.iter().take(NAMED).map(|level| level.amplitude.as_str()).collect();
    let list = match counted.len() {
        0 => return None,
        all if all > NAMED => format!("{} and {} more", named.join(", "), all - NAMED),
        _ => named.join(", "),
    };
    Some((counted.into_iter().map(of).sum(), list))
}

fn number(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// What is wrong, without the remedy, which is the same for all of them.
pub(crate) fn detail(error: &StoreError) -> String {
    match error {
        StoreError::Corrupt { detail, .. } => detail.clone(),
        other => other.to_string(),
    }
}
