//! A forcing level and the windows predicted for it.

use crate::survey::{self, WindowRow};
use serde::Serialize;

/// A forcing level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Level {
    /// Forcing amplitude, as typed.
    pub amplitude: String,
    /// Forcing amplitude A.
    pub value: f64,
    /// Windows along the backbone.
    pub windows: Vec<Window>,
    /// Why there is no main branch, if it was tried.
    pub main_failure: Option<String>,
    /// Tasks still to be done.
    pub pending: usize,
    /// Tasks given up.
    pub dead: usize,
}

/// A window and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Window {
    /// Number within the level, from 1.
    pub number: usize,
    /// Backbone points: first and last inside, and the one of smallest threshold.
    pub first: usize,
    /// Last point.
    pub last: usize,
    /// Point of smallest threshold.
    pub best: usize,
    /// Lowest and highest frequency, rad/s.
    pub omega: (f64, f64),
    /// Frequency of the smallest threshold, rad/s.
    pub omega_best: f64,
    /// Smallest threshold A*.
    pub threshold: f64,
    /// `found`, `not_found` or `pending`.
    pub outcome: String,
    /// Branches it led to, in words.
    pub branches: String,
    /// Why it was not found, or why seeds were given up.
    pub reason: String,
}

impl Level {
    /// A level of which nothing is known yet.
    pub fn bare(amplitude: String, value: f64) -> Self {
        Self { amplitude, value, windows: Vec::new(), main_failure: None, pending: 0, dead: 0 }
    }
}

impl From<&survey::Level> for Level {
    fn from(level: &survey::Level) -> Self {
        Self {
            amplitude: level.amplitude.clone(),
            value: level.value,
            windows: level.windows.iter().map(Window::from).collect(),
            main_failure: level.main_failure.clone(),
            pending: level.pending,
            dead: level.dead,
        }
    }
}

impl From<&WindowRow> for Window {
    fn from(row: &WindowRow) -> Self {
        let [outcome, branches, reason] = row.outcome.words();
        let [first, last, best] = row.points;
        Self {
            number: row.number,
            first,
            last,
            best,
            omega: row.omega,
            omega_best: row.omega_best,
            threshold: row.threshold,
            outcome: outcome.into(),
            branches: branches.into(),
            reason: reason.into(),
        }
    }
}
