//! How hard is looked for, and how much of it is verified.

use crate::settings::numbers::NumberList;
use serde::{Deserialize, Serialize};

/// How hard isolas are looked for beyond the windows of the energy balance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SearchSettings {
    /// How hard. Default standard.
    pub effort: Effort,
    /// Random starts of every order, shared among the levels; [`Effort::None`] has none. Default: as many as the effort says that a model
    /// of its size affords, see [`crate::response::starts::batches`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub starts: Option<usize>,
    /// Orders m of the motions that are looked for, which last m periods of the force, ascending. Default: the model's
    /// `forcing.harmonic` alone. See [`crate::response::orders`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub harmonics: Option<NumberList>,
}

/// How hard isolas are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Effort {
    /// In the windows only.
    None,
    /// Folds of the branches found are followed over the forcing amplitude, 200 at most, and random starts are tried, 16384
    /// with a small model and fewer with larger ones; where nothing leads to motions of several periods of the force, homotopies
    /// ([`StartWay::Homotopy`](crate::response::starts::StartWay::Homotopy)) as well.
    #[default]
    Standard,
    /// The same, for 5000 folds at most and 16 times as many starts.
    Thorough,
}

impl SearchSettings {
    /// Most random starts that can be asked for.
    pub const MOST_STARTS: usize = 1_000_000;
}

impl Effort {
    /// How many times as many random starts as usual are tried.
    pub const fn starts(self) -> usize {
        match self {
            Self::None => 0,
            Self::Standard => 1,
            Self::Thorough => 16,
        }
    }

    /// Most folds that are followed. Those found to lie on curves that are known do not count.
    pub const fn folds(self) -> usize {
        match self {
            Self::None => 0,
            Self::Standard => 200,
            Self::Thorough => 5000,
        }
    }
}

/// What of the branches is verified by time marching, and whether it is stable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct VerifySettings {
    /// How much. Default standard.
    pub effort: VerifyEffort,
}

/// How much of the branches is verified.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VerifyEffort {
    /// Nothing.
    None,
    /// Every branch that is not a main one, and what is around the peaks of main branches.
    #[default]
    Standard,
    /// Every branch.
    All,
}

/// How much of a branch is verified.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stretch {
    /// All of it.
    #[default]
    Whole,
    /// What is around its peak.
    Peak,
}
