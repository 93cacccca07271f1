//! Every level in a few numbers: what the closing table and the report's first sentences are made of.

use super::levels::{BranchRow, LevelRow, WindowOutcome, branches, levels, main_failure, windows};
use crate::store::{Reader, Result};

/// A level in numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelSummary {
    /// Forcing amplitude, as typed.
    pub amplitude: String,
    /// Forcing amplitude.
    pub value: f64,
    /// Main branch.
    pub main: Option<BranchRow>,
    /// Why there is no main branch, if it was tried.
    pub main_failure: Option<String>,
    /// Isolas.
    pub isolas: Vec<BranchRow>,
    /// Number of windows.
    pub windows: usize,
    /// Windows that led to no branch: range and reason.
    pub not_found: Vec<String>,
    /// Tasks still to be done.
    pub pending: usize,
    /// Tasks given up.
    pub dead: usize,
}

/// The peak moves up in frequency from one level to the next.
#[derive(Debug, Clone, PartialEq)]
pub struct Rise {
    /// Lower forcing amplitude and the next one, as typed.
    pub amplitudes: (String, String),
    /// Frequencies of the points of largest amplitude over all branches, rad/s.
    pub omega: (f64, f64),
}

/// Every level of a run, in numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// Levels by amplitude.
    pub levels: Vec<LevelSummary>,
    /// The largest rise in frequency of the peak between neighbouring levels; `None` if it never rises.
    pub rise: Option<Rise>,
}

/// Surveys a run, also one in progress (of one moment if the caller holds a snapshot).
///
/// # Errors
/// If the run cannot be read.
pub fn survey(reader: &Reader) -> Result<Survey> {
    let levels: Result<Vec<LevelSummary>> =
        levels(reader)?.into_iter().map(|level| level_summary(reader, level)).collect();
    let levels = levels?;
    let rise = largest_rise(&levels);
    Ok(Survey { levels, rise })
}

fn level_summary(reader: &Reader, level: LevelRow) -> Result<LevelSummary> {
    let (mains, isolas) =
        branches(reader, level.level)?.into_iter().partition(|branch: &BranchRow| branch.kind == "main");
    let mains: Vec<BranchRow> = mains;
    let windows = windows(reader, level.level)?;
    let sql = "SELECT count(*) FILTER (WHERE state IN ('waiting', 'leased')), count(*) FILTER (WHERE state = 'dead') \
               FROM tasks WHERE level = ?1";
    let counts = reader.one(sql, [level.level], |row| Ok((row.get(0)?, row.get(1)?)))?;
    let (pending, dead) = counts.unwrap_or_default();
    let not_found = windows.iter().filter_map(|window| match &window.outcome {
        WindowOutcome::NotFound(reason) => {
            Some(format!("{:.2} to {:.2} rad/s: {reason}", window.omega.0, window.omega.1))
        }
        _ => None,
    });
    Ok(LevelSummary {
        main: mains.into_iter().next(),
        main_failure: main_failure(reader, level.level)?,
        isolas,
        windows: windows.len(),
        not_found: not_found.collect(),
        pending,
        dead,
        amplitude: level.amplitude,
        value: level.value,
    })
}

impl LevelSummary {
    /// Branches: main, then isolas.
    pub fn branches(&self) -> impl Iterator<Item = &BranchRow> {
        self.main.iter().chain(&self.isolas)
    }

    /// The branch with the point of largest amplitude.
    pub fn peak(&self) -> Option<&BranchRow> {
        self.branches().max_by(|a, b| a.amplitude_max.total_cmp(&b.amplitude_max))
    }
}

fn largest_rise(levels: &[LevelSummary]) -> Option<Rise> {
    let rises = levels.windows(2).filter_map(|pair| {
        let omega = (pair[0].peak()?.omega_at_max, pair[1].peak()?.omega_at_max);
        let amplitudes = (pair[0].amplitude.clone(), pair[1].amplitude.clone());
        (omega.1 > omega.0).then_some(Rise { amplitudes, omega })
    });
    rises.max_by(|a, b| (a.omega.1 - a.omega.0).total_cmp(&(b.omega.1 - b.omega.0)))
}
