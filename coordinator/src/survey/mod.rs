//! What a run has found so far, level by level, as the store has it: branches, windows and what became of them; and what
//! is missing.

mod lacks;
mod levels;

pub use lacks::Lacks;
pub use levels::{BranchRow, WindowOutcome, WindowRow};

pub(crate) use lacks::detail;

use crate::store::{Reader, Result, RunHeader, Summary};
use levels::{branches, levels, main_failure, windows};
use protocol::ids::TaskId;
use protocol::model::ModelMessage;
use protocol::to_everyone::StoredResult;
use solver::task::BranchId;

/// A run without its points.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Survey {
    /// What does not change; `None` if it cannot be read.
    pub header: Option<RunHeader>,
    /// Model; `None` if it cannot be read.
    pub model: Option<ModelMessage>,
    /// Levels by amplitude.
    pub levels: Vec<Level>,
}

/// A forcing level.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Forcing amplitude, as typed.
    pub amplitude: String,
    /// Forcing amplitude A.
    pub value: f64,
    /// Main branch, isolas.
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

/// The peak moves up in frequency from one level to the next.
#[derive(Debug, Clone, PartialEq)]
pub struct Rise {
    /// Lower forcing amplitude and the next one, as typed.
    pub amplitudes: (String, String),
    /// Frequencies of the points of largest amplitude over all branches, rad/s.
    pub omega: (f64, f64),
}

impl Survey {
    /// Reads what can be read, at any stage (of one moment if the caller holds a snapshot).
    ///
    /// # Errors
    /// If neither header nor model nor levels can be read.
    pub fn read(reader: &Reader, lacks: &mut Lacks) -> Result<Self> {
        let (header, model, levels) = match (reader.header(), reader.genuine_model(), levels(reader)) {
            (Err(error), Err(_), Err(_)) => return Err(error),
            all => all,
        };
        let header = lacks.read("Names and settings of the run are", header);
        let model = lacks.read("The model is", model);
        let levels = lacks.read("Levels and branches are", levels).unwrap_or_default();
        let levels = levels.into_iter().map(|row| Level::read(reader, row, lacks)).collect();
        Ok(Self { header, model, levels })
    }

    /// Branches with their levels: level by level, main before isolas.
    pub fn branches(&self) -> impl Iterator<Item = (&Level, &BranchRow)> {
        self.levels.iter().flat_map(|level| level.branches.iter().map(move |branch| (level, branch)))
    }

    /// Hands every branch that is what was stored to `sink`, one after the other, with its [`Level::file_name`]; notes the
    /// others.
    ///
    /// # Errors
    /// Those of `sink`.
    pub fn each_branch<E>(
        &self,
        reader: &Reader,
        lacks: &mut Lacks,
        mut sink: impl FnMut(&mut Lacks, &str, StoredResult) -> std::result::Result<(), E>,
    ) -> std::result::Result<(), E> {
        for (level, branch) in self.branches() {
            let name = level.file_name(branch);
            if let Some(result) = lacks.take(format_args!("Branch {name} is"), whole(reader, branch)) {
                sink(lacks, &name, result)?;
            }
        }
        Ok(())
    }

    /// The largest rise in frequency of the peak between neighbouring levels; `None` if it never rises.
    pub fn rise(&self) -> Option<Rise> {
        let rises = self.levels.windows(2).filter_map(|pair| {
            let omega = (pair[0].peak()?.omega_at_max, pair[1].peak()?.omega_at_max);
            let amplitudes = (pair[0].amplitude.clone(), pair[1].amplitude.clone());
            (omega.1 > omega.0).then_some(Rise { amplitudes, omega })
        });
        rises.max_by(|a, b| (a.omega.1 - a.omega.0).total_cmp(&(b.omega.1 - b.omega.0)))
    }
}

/// The result that a branch is from, checksum verified: what was accepted, to the bit. Otherwise says why not.
pub(crate) fn whole(reader: &Reader, branch: &BranchRow) -> std::result::Result<StoredResult, String> {
    let task = TaskId::new(&branch.task).map_err(|error| error.to_string())?;
    let result = reader.result(&task).map_err(|error| detail(&error))?;
    let result = result.ok_or_else(|| format!("the result of task {task} is gone"))?;
    let name = match branch.kind.as_str() {
        "main" => BranchId::Main,
        _ => BranchId::Isola(branch.number.saturating_sub(1)),
    };
    let Some(message) = result.branch.as_ref().filter(|_| result.name == Some(name)) else {
        return Err(format!("the result of task {task} is another one"));
    };
    let row = Summary::from([branch.omega.0, branch.omega.1, branch.amplitude_max, branch.omega_at_max]);
    if Summary::of(message) != row {
        return Err("its numbers in the table of branches are others".into());
    }
    Ok(result)
}

impl Level {
    fn read(reader: &Reader, (level, name, value): (i64, String, f64), lacks: &mut Lacks) -> Self {
        let sql = "SELECT count(*) FILTER (WHERE state IN ('waiting', 'leased')), \
                   count(*) FILTER (WHERE state = 'dead') FROM tasks WHERE level = ?1";
        let counts = reader.one(sql, [level], |row| Ok((row.get(0)?, row.get(1)?)));
        let counts = lacks.read(format_args!("The number of tasks at A = {name} is"), counts).flatten();
        let windows = lacks.read(format_args!("The windows at A = {name} are"), windows(reader, level));
        let branches = lacks.read(format_args!("The branches at A = {name} are"), branches(reader, level));
        let failure =
            lacks.read(format_args!("The failure of the main branch at A = {name} is"), main_failure(reader, level));
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

    /// Main branch.
    pub fn main(&self) -> Option<&BranchRow> {
        self.branches.iter().find(|branch| branch.kind == "main")
    }

    /// Isolas.
    pub fn isolas(&self) -> impl Iterator<Item = &BranchRow> + Clone {
        self.branches.iter().filter(|branch| branch.kind != "main")
    }

    /// The isola with the point of largest amplitude.
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
