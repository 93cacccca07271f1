//! A forcing level: what was found there.

use super::omissions::Omissions;
use crate::store::{BranchRow, Reader, WindowOutcome, WindowRow};
use serde::Serialize;

/// A forcing level.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Level {
    /// Forcing amplitude, as typed.
    pub amplitude: String,
    /// Forcing amplitude A.
    pub value: f64,
    /// Branches, kind by kind, main ones first.
    pub branches: Vec<BranchRow>,
    /// Windows, in the order of the backbone.
    pub windows: Vec<WindowRow>,
    /// Why there is no main branch, if it was tried.
    pub main_failure: Option<String>,
    /// Tasks still to be done.
    pub pending: usize,
    /// Tasks given up.
    pub dead: usize,
}

impl Level {
    pub(super) fn read(reader: &Reader, (level, name, value): (i64, String, f64), omissions: &mut Omissions) -> Self {
        let counts = omissions.read(format_args!("The number of tasks at A = {name} is"), reader.open_tasks(level));
        let windows = omissions.read(format_args!("The windows at A = {name} are"), reader.windows(level));
        let branches = omissions.read(format_args!("The branches at A = {name} are"), reader.branches(level));
        let failure =
            omissions.read(format_args!("The failure of the main branch at A = {name} is"), reader.main_failure(level));
        let (pending, dead) = counts.unwrap_or_default();
        Self {
            amplitude: name,
            value,
            branches: branches.unwrap_or_default(),
            windows: windows.unwrap_or_default(),
            main_failure: failure.flatten(),
            pending,
            dead,
        }
    }

    /// Name of the file of a branch, without extension: `60-isola-1`.
    pub fn file_name(&self, branch: &BranchRow) -> String {
        format!("{}-{}-{}", self.amplitude, branch.kind, branch.number)
    }

    /// Main branches: one, unless what comes from below and from above does not meet.
    pub fn mains(&self) -> impl Iterator<Item = &BranchRow> + Clone {
        self.branches.iter().filter(|branch| branch.is_main())
    }

    /// The main branch with the point of largest amplitude.
    pub fn main(&self) -> Option<&BranchRow> {
        highest(self.mains()).or_else(|| self.mains().next())
    }

    /// Branches that are not main ones.
    pub fn others(&self) -> impl Iterator<Item = &BranchRow> + Clone {
        self.branches.iter().filter(|branch| !branch.is_main())
    }

    /// Branches that are known to be apart from the main ones.
    pub fn isolas(&self) -> impl Iterator<Item = &BranchRow> + Clone {
        self.branches.iter().filter(|branch| branch.is_detached())
    }

    /// The one of them with the point of largest amplitude.
    pub fn highest_isola(&self) -> Option<&BranchRow> {
        highest(self.isolas())
    }

    /// The branch with the point of largest amplitude.
    pub fn peak(&self) -> Option<&BranchRow> {
        highest(self.branches.iter())
    }

    /// Whether nothing has been found.
    pub fn is_bare(&self) -> bool {
        self.branches.is_empty()
    }

    /// Whether every window ended on a branch and nothing is left to be done.
    pub fn is_settled(&self) -> bool {
        self.pending == 0 && self.dead == 0 && self.main().is_some() && self.not_found().next().is_none()
    }

    /// Windows that led to no branch, with the reasons.
    pub fn not_found(&self) -> impl Iterator<Item = (&WindowRow, &str)> {
        self.windows.iter().filter_map(|window| match &window.outcome {
            WindowOutcome::NotFound(reasons) => Some((window, reasons.as_str())),
            _ => None,
        })
    }
}

/// The branch with the point of largest amplitude; one whose amplitude cannot be read counts for nothing.
pub fn highest<'b>(branches: impl Iterator<Item = &'b BranchRow>) -> Option<&'b BranchRow> {
    let readable = branches.filter(|branch| branch.amplitude_max.is_finite() && branch.omega_at_max.is_finite());
    readable.max_by(|a, b| a.amplitude_max.total_cmp(&b.amplitude_max))
}
