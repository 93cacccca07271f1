//! Names of runs, tasks and workers: one chunk of a key each.

use serde::{Deserialize, Serialize};
use solver::response::task::{DisturbPlace, MarchPlace, Origin, VerifyPlace};
use solver::settings::Stretch;
use std::fmt;
use thiserror::Error;

/// A name that cannot be a chunk of a key.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("`{0}` is not a name: use letters, digits, `.`, `-` and `_`, the first one a letter or a digit")]
pub struct NameError(pub String);

fn checked(name: &str) -> Result<String, NameError> {
    let allowed = |c: char| c.is_ascii_alphanumeric() || ".-_".contains(c);
    let starts = name.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '_');
    if starts && name.len() <= 100 && name.chars().all(allowed) {
        Ok(name.to_string())
    } else {
        Err(NameError(name.to_string()))
    }
}

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(try_from = "String", into = "String")]
        pub struct $name(String);

        impl $name {
            /// Checks a name.
            ///
            /// # Errors
            /// If it is empty, too long, or has characters that a part of a key cannot have.
            pub fn new(name: &str) -> Result<Self, NameError> {
                checked(name).map(Self)
            }

            /// As text.
            pub fn as_str(&self) -> &str {
                &self.0
            }
        }

        impl TryFrom<String> for $name {
            type Error = NameError;
            fn try_from(name: String) -> Result<Self, NameError> {
                Self::new(&name)
            }
        }

        impl std::str::FromStr for $name {
            type Err = NameError;
            fn from_str(name: &str) -> Result<Self, NameError> {
                Self::new(name)
            }
        }

        impl From<$name> for String {
            fn from(id: $name) -> String {
                id.0
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.pad(&self.0)
            }
        }
    };
}

id!(
    /// A run: one study carried out once.
    RunId
);
id!(
    /// A task of a run.
    TaskId
);
id!(
    /// A worker process.
    WorkerId
);

impl TaskId {
    /// Task number `index` (from 0: the main branch from below) of the level whose amplitude was typed as `amplitude`.
    ///
    /// # Errors
    /// If the amplitude is no part of a key.
    pub fn of_level(amplitude: &str, index: usize) -> Result<Self, NameError> {
        Self::new(&format!("{}-{index}", amplitude.replace('+', "")))
    }

    /// Task number `index`, from 0, among those that follow curves over the levels: this one from there.
    pub fn of_curve(index: usize, origin: Origin) -> Self {
        match origin {
            Origin::Fold(_) => Self(format!("fold-{index}")),
            Origin::Carry(_) => Self(format!("carry-{index}")),
        }
    }

    /// The task that verifies a branch, or what is around its peak, of the level whose amplitude was typed as `amplitude`.
    ///
    /// # Errors
    /// If the amplitude is no part of a key.
    pub fn of_verification(amplitude: &str, place: &VerifyPlace) -> Result<Self, NameError> {
        let VerifyPlace { branch, stretch } = place;
        let (amplitude, peak) = (amplitude.replace('+', ""), if *stretch == Stretch::Peak { "-peak" } else { "" });
        Self::new(&format!("verify-{amplitude}-{}-{}{peak}", branch.kind, branch.number + 1))
    }

    /// The task that scans pushes onto a branch of the level whose amplitude was typed as `amplitude`.
    ///
    /// # Errors
    /// If the amplitude is no part of a key.
    pub fn of_disturbance(amplitude: &str, place: &DisturbPlace) -> Result<Self, NameError> {
        let DisturbPlace { branch, mode, .. } = place;
        let amplitude = amplitude.replace('+', "");
        Self::new(&format!("disturb-{amplitude}-{}-{}-mode-{}", branch.kind, branch.number + 1, mode + 1))
    }

    /// The task that marches on from a point of a branch of the level whose amplitude was typed as `amplitude`.
    ///
    /// # Errors
    /// If the amplitude is no part of a key.
    pub fn of_march(amplitude: &str, place: &MarchPlace) -> Result<Self, NameError> {
        let MarchPlace { branch, index, .. } = place;
        let amplitude = amplitude.replace('+', "");
        Self::new(&format!("march-{amplitude}-{}-{}-point-{index}", branch.kind, branch.number + 1))
    }

    /// Whether this is a task of the level whose amplitude was typed as `amplitude`.
    pub fn is_of_level(&self, amplitude: &str) -> bool {
        self.0.rsplit_once('-').is_some_and(|(level, _)| level == amplitude.replace('+', ""))
    }
}

/// Counts how often a task was handed out, from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Attempt(pub u32);

impl fmt::Display for Attempt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}
