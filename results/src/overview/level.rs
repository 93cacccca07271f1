//! A forcing level: what was found there.

use super::omissions::Omissions;
use super::reasons::briefly;
use super::stability_words::by_marching;
use super::windows::{elsewhere, tell_elsewhere, within};
use crate::store::{BranchRow, Reader, WindowOutcome, WindowRow};
use crate::words::listed_first;
use serde::{Serialize, Serializer};
use solver::response::branch::{BranchKind, Outcome};

/// Levels that a sentence names.
const NAMED: usize = 6;

/// Kinds of branches that may be isolas or not.
pub(super) const UNDECIDED: [BranchKind; 2] = [BranchKind::Unfinished, BranchKind::Cut];

/// A forcing level.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Level {
    /// Forcing amplitude, as typed.
    pub amplitude: String,
    /// Forcing amplitude A.
    pub value: f64,
    /// Branches, kind by kind, main ones first.
    #[serde(serialize_with = "told")]
    pub branches: Vec<BranchRow>,
    /// Windows, in the order of the backbone.
    pub windows: Vec<WindowRow>,
    /// Why no main branch starts at one side, if one was tried there.
    pub main_failure: Option<String>,
    /// Tasks still to be done, verifications apart.
    pub pending: usize,
    /// Tasks given up.
    pub dead: usize,
    /// Results that two others contradict.
    #[serde(skip)]
    pub refuted: usize,
    /// Results that one other contradicts.
    #[serde(skip)]
    pub disputed: usize,
    /// Whether not all of it can be read.
    #[serde(skip)]
    pub is_damaged: bool,
    /// Seeds of windows.
    #[serde(skip)]
    pub seeds: Seeds,
    /// Whether it is of an order of motions of which no main branches are followed.
    #[serde(skip)]
    pub is_without_mains: bool,
}

/// Branches with what time marching says of each, in words.
fn told<S: Serializer>(branches: &[BranchRow], serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Told<'r> {
        #[serde(flatten)]
        row: &'r BranchRow,
        by_marching: String,
    }
    serializer.collect_seq(branches.iter().map(|row| Told { row, by_marching: by_marching(row) }))
}

/// Seeds of the windows of a level.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Seeds {
    /// Those that were tried.
    pub tried: usize,
    /// Those of them that led to no branch.
    pub failed: usize,
}

impl Level {
    pub(super) fn read(reader: &Reader, (level, name, value): (i64, String, f64), omissions: &mut Omissions) -> Self {
        let damaged = omissions.damaged.len();
        let counts = omissions.read(format_args!("The number of tasks at A = {name} is"), reader.open_tasks(level));
        let windows = omissions.read(format_args!("The windows at A = {name} are"), reader.windows(level));
        let branches = omissions.read(format_args!("The branches at A = {name} are"), reader.branches(level));
        let failure =
            omissions.read(format_args!("The failure of the main branch at A = {name} is"), reader.main_failure(level));
        let (pending, dead) = counts.unwrap_or_default();
        let repeated = omissions.read(format_args!("What was repeated at A = {name} is"), reader.contradicted(level));
        let (refuted, disputed) = repeated.unwrap_or_default();
        let seeds = omissions.read(format_args!("The number of seeds at A = {name} is"), reader.tried_seeds(level));
        let (tried, failed) = seeds.unwrap_or_default();
        let mut windows = windows.unwrap_or_default();
        windows.iter_mut().for_each(|window| tell_elsewhere(window, branches.as_deref().unwrap_or_default()));
        Self {
            amplitude: name,
            value,
            branches: branches.unwrap_or_default(),
            windows,
            main_failure: failure.flatten(),
            pending,
            dead,
            refuted,
            disputed,
            is_damaged: omissions.damaged.len() > damaged,
            seeds: Seeds { tried, failed },
            is_without_mains: reader.order().is_some(),
        }
    }

    /// Name of the file of a branch, without extension: `60-isola-1`.
    pub fn file_name(&self, branch: &BranchRow) -> String {
        format!("{}-{}-{}", self.amplitude, branch.kind, branch.number)
    }

    /// Main branches, piece by piece: one, unless what comes from below and from above does not meet, or more of it was found later
    /// on, beyond the bounds that nobody gave say.
    pub fn mains(&self) -> impl Iterator<Item = &BranchRow> + Clone {
        self.branches.iter().filter(|branch| branch.is_main())
    }

    /// How many curves they are at most: a piece that runs on to another one, whichever that is, is none of its own.
    pub fn main_curves(&self) -> usize {
        let apart = self.mains().filter(|row| row.joints() == 0).count();
        apart.max(self.mains().count().min(1))
    }

    /// The main branch with the point of largest amplitude.
    pub fn main(&self) -> Option<&BranchRow> {
        highest(self.mains()).or_else(|| self.mains().next())
    }

    /// Whether its main branches are known to their ends: none of two sides lacks one, and none breaks off; `ends`: how main branches end, with
    /// their forcing amplitudes as typed.
    pub fn has_whole_mains(&self, ends: &[(String, Outcome)]) -> bool {
        let mut own = ends.iter().filter(|(amplitude, _)| *amplitude == self.amplitude);
        self.is_complete()
            && self.main_failure.is_none()
            && self.mains().all(|main| main.at_least().is_empty())
            && !own.any(|(_, outcome)| outcome.is_unfinished())
    }

    /// Branches that are not main ones.
    pub fn others(&self) -> impl Iterator<Item = &BranchRow> + Clone {
        self.branches.iter().filter(|branch| !branch.is_main())
    }

    /// Closed branches apart from the main ones.
    pub fn isolas(&self) -> impl Iterator<Item = &BranchRow> + Clone {
        self.branches.iter().filter(|branch| branch.is_isola())
    }

    /// Whether one of its other branches is cut or unfinished: it may be an isola.
    pub fn has_undecided(&self) -> bool {
        self.others().any(|row| UNDECIDED.map(BranchKind::name).contains(&row.kind.as_str()))
    }

    /// The one of them with the point of largest amplitude.
    pub fn highest_isola(&self) -> Option<&BranchRow> {
        highest(self.isolas())
    }

    /// Mode, from 1, of the first window that led to an isola of its frequencies.
    pub fn mode_of_isola(&self) -> Option<usize> {
        let leads = |window: &&WindowRow| match &window.outcome {
            WindowOutcome::Found(to) => {
                within(to, window, &self.branches).0.iter().any(|name| name.starts_with(BranchKind::Isola.name()))
            }
            _ => false,
        };
        self.windows.iter().find(leads).map(|window| window.mode)
    }

    /// The branch with the point of largest amplitude; of branches that are passed over only if there are no others.
    pub fn peak(&self) -> Option<&BranchRow> {
        highest(self.branches.iter().filter(|branch| !branch.is_passed_over()))
            .or_else(|| highest(self.branches.iter()))
    }

    /// Whether nothing has been found where something has to be.
    pub fn is_bare(&self) -> bool {
        self.branches.is_empty() && !self.is_without_mains && !self.is_damaged
    }

    /// Whether nothing is left to be done, nothing was given up, nothing contradicted, nothing is damaged, and there is a main branch,
    /// if one is followed.
    pub fn is_complete(&self) -> bool {
        let is_done = self.pending + self.dead + self.refuted + self.disputed == 0;
        is_done && !self.is_damaged && (self.is_without_mains || self.main().is_some())
    }

    /// Whether it is complete and every largest amplitude is that of a maximum.
    pub fn is_known(&self) -> bool {
        self.is_complete() && self.branches.iter().all(|branch| branch.at_least().is_empty())
    }

    /// Whether a seed of every window landed on a branch and nothing is left to be done.
    pub fn is_settled(&self) -> bool {
        self.is_complete() && self.not_found().chain(self.passed()).next().is_none()
    }

    /// Windows in whose range of frequencies their seeds led to no branch, with the reasons in few words.
    pub fn not_found(&self) -> impl Iterator<Item = (&WindowRow, String)> {
        self.windows.iter().filter_map(|window| match &window.outcome {
            WindowOutcome::NotFound(reasons) => Some((window, briefly(reasons))),
            WindowOutcome::Elsewhere(branches) => Some((window, elsewhere(branches))),
            WindowOutcome::Found(_) | WindowOutcome::Passed { .. } | WindowOutcome::Pending(_) => None,
        })
    }

    /// Windows near which no seed landed, but by which known branches pass, with what that leaves open in few words.
    pub fn passed(&self) -> impl Iterator<Item = (&WindowRow, String)> {
        self.windows.iter().filter_map(|window| match &window.outcome {
            WindowOutcome::Passed { told, .. } => Some((window, briefly(told))),
            _ => None,
        })
    }
}

/// What [`is_untouched`] means.
pub const UNTOUCHED: &str = "No branch of any level touches a stop.";

/// Whether every level is complete and no branch of any touches a stop.
pub fn is_untouched(levels: &[Level]) -> bool {
    let touches = |level: &Level| level.branches.iter().any(|branch| branch.certificate.contact_omega.is_some());
    let are_some = levels.iter().any(|level| !level.branches.is_empty());
    are_some && levels.iter().all(|level| level.is_complete() && !touches(level))
}

/// What is said after that no isola was found.
pub fn undecided(levels: &[Level]) -> &'static str {
    if levels.iter().any(Level::has_undecided) { "; what is cut or unfinished may be one" } else { "" }
}

/// Levels in words: `A = 1, 2 and 3 more`.
pub fn named(levels: &[&Level]) -> String {
    format!("A = {}", listed_first(levels.iter().map(|level| level.amplitude.clone()).collect(), NAMED))
}

/// The branch with the point of largest amplitude; one whose amplitude cannot be read counts for nothing.
pub fn highest<'b>(branches: impl Iterator<Item = &'b BranchRow>) -> Option<&'b BranchRow> {
    let readable = branches.filter(|branch| branch.amplitude_max.is_finite() && branch.omega_at_max.is_finite());
    readable.max_by(|a, b| a.amplitude_max.total_cmp(&b.amplitude_max))
}
