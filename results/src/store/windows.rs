//! Windows as the store has them, with what became of their seeds.

use super::number::number;
use super::{Reader, Result};
use serde::Serialize;

/// A window and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WindowRow {
    /// Number, from 1.
    pub number: usize,
    /// Mode of its backbone, from 1.
    pub mode: usize,
    /// First point of the backbone inside, last, and the one of smallest threshold.
    pub points: [usize; 3],
    /// Lowest and highest frequency, rad/s.
    pub omega: (f64, f64),
    /// Frequency of the smallest threshold, rad/s.
    pub omega_best: f64,
    /// Smallest threshold A*.
    pub threshold: f64,
    /// What became of it.
    pub outcome: WindowOutcome,
}

#[cfg(test)]
impl WindowRow {
    /// A window of mode 1 from 90 to 110 rad/s of which this became.
    pub(crate) fn of(outcome: WindowOutcome) -> Self {
        let (omega, omega_best, threshold) = ((90.0, 110.0), 100.0, 0.5);
        Self { number: 1, mode: 1, points: [0, 2, 1], omega, omega_best, threshold, outcome }
    }
}

/// What became of a window.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum WindowOutcome {
    /// It led to these branches, of which one at least has frequencies of it.
    Found(String),
    /// It led to these branches alone, which have other frequencies.
    Elsewhere(String),
    /// No seed landed near it, but known branches pass by: their names, and what is to be said of it.
    Passed {
        /// The branches.
        branches: String,
        /// Which one passes nearest, and what that leaves open.
        told: String,
    },
    /// Every seed was tried, none led to a branch, for these reasons.
    NotFound(String),
    /// Seeds are left to be tried; reasons why some were given up.
    Pending(String),
}

impl Reader {
    /// Windows of a level, in the order of the backbones; those are found that led to a branch, wherever it lies.
    pub(crate) fn windows(&self, level: i64) -> Result<Vec<WindowRow>> {
        let seeds = self.seeds(level)?;
        let mode = self.mode_of_windows()?;
        let sql = format!(
            "SELECT window, omega_min, omega_max, omega_best, threshold, first, last, best, {mode} FROM windows \
             WHERE level = ?1 ORDER BY window"
        );
        self.all(&sql, [level], |row| {
            let window: usize = row.get(0)?;
            Ok(WindowRow {
                number: window,
                mode: row.get(8)?,
                points: [row.get(5)?, row.get(6)?, row.get(7)?],
                omega: (number(row, 1)?, number(row, 2)?),
                omega_best: number(row, 3)?,
                threshold: number(row, 4)?,
                outcome: outcome(seeds.iter().filter(|seed| seed.window == window)),
            })
        })
    }

    /// What tells the mode of a window, in SQL: runs of earlier programs followed one mode, that of their settings.
    fn mode_of_windows(&self) -> Result<String> {
        if self.version()? >= 3 {
            return Ok("mode".into());
        }
        let model = self.model()?.model().map_err(|error| self.corrupt(error))?;
        Ok((self.header()?.settings.tracked(&model) + 1).to_string())
    }

    /// What became of the seeds of a level: tasks of landings that failed stand for what would have followed.
    fn seeds(&self, level: i64) -> Result<Vec<SeedRow>> {
        let sql = "SELECT window, state, outcome, branch, (SELECT reason FROM attempts WHERE task = id \
                   AND reason IS NOT NULL ORDER BY attempt DESC LIMIT 1) \
                   FROM tasks WHERE level = ?1 AND (kind = 'seed' \
                   OR kind = 'land' AND (state = 'dead' OR state = 'done' AND NOT found)) ORDER BY position";
        self.all(sql, [level], |row| {
            Ok(SeedRow {
                window: row.get(0)?,
                state: row.get(1)?,
                outcome: row.get(2)?,
                branch: row.get(3)?,
                reason: row.get(4)?,
            })
        })
    }
}

/// That somebody gave up, and why.
pub(super) fn given_up(reason: Option<String>) -> String {
    reason.map_or_else(|| "given up".into(), |reason| format!("given up: {reason}"))
}

impl WindowOutcome {
    /// What became of it, the branches, the reasons: as in `windows.csv`.
    pub fn words(&self) -> [&str; 3] {
        match self {
            WindowOutcome::Found(branches) => ["found", branches, ""],
            WindowOutcome::Elsewhere(branches) => ["elsewhere", branches, ""],
            WindowOutcome::Passed { branches, told } => ["passed", branches, told],
            WindowOutcome::NotFound(reasons) => ["not_found", "", reasons],
            WindowOutcome::Pending(reasons) => ["pending", "", reasons],
        }
    }
}

/// A task that starts from a window.
struct SeedRow {
    window: usize,
    state: String,
    outcome: Option<String>,
    branch: Option<String>,
    reason: Option<String>,
}

impl SeedRow {
    /// Whether a known branch passes by, on which it did not land: what it landed on is all that is said of it.
    fn is_passed_by(&self) -> bool {
        self.branch.is_some() && self.branch != self.outcome
    }
}

fn outcome<'s>(seeds: impl Iterator<Item = &'s SeedRow> + Clone) -> WindowOutcome {
    let found = distinct(seeds.clone().filter(|seed| !seed.is_passed_by()).filter_map(|seed| seed.branch.clone()));
    if !found.is_empty() {
        return WindowOutcome::Found(found);
    }
    let is_dead = |seed: &&SeedRow| seed.state == "dead";
    if seeds.clone().all(|seed| matches!(seed.state.as_str(), "done" | "skipped")) {
        let passed = seeds.clone().filter(|seed| seed.is_passed_by());
        // How far away it passes is the last word.
        let nearest =
            passed.clone().filter_map(|seed| seed.outcome.as_deref()).min_by_key(|told| told.rsplit(' ').next());
        if let Some(nearest) = nearest {
            let told = format!("no seed landed near it, but {nearest}: an isola nearby is not excluded");
            return WindowOutcome::Passed { branches: distinct(passed.filter_map(|seed| seed.branch.clone())), told };
        }
        return WindowOutcome::NotFound(distinct(seeds.filter_map(|seed| seed.outcome.clone())));
    }
    WindowOutcome::Pending(distinct(seeds.filter(is_dead).map(|seed| given_up(seed.reason.clone()))))
}

/// Texts without repetition.
fn distinct(texts: impl Iterator<Item = String>) -> String {
    let mut list: Vec<String> = Vec::new();
    for text in texts {
        if !list.contains(&text) {
            list.push(text);
        }
    }
    list.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seed(state: &str, branch: Option<&str>, outcome: &str) -> SeedRow {
        let (branch, outcome) = (branch.map(String::from), Some(outcome.into()));
        SeedRow { window: 1, state: state.into(), outcome, branch, reason: None }
    }

    #[test]
    fn a_branch_that_passes_by_is_told_with_its_doubt_and_only_where_no_seed_landed() {
        let passing = |branch, distance| {
            seed("done", Some(branch), &format!("{branch} passes by (relative distance {distance})"))
        };
        let failed = || seed("done", None, "nothing converged: no convergence (scaled residual 1.0e0)");
        let seeds = [failed(), passing("main", "0.27"), passing("isola 1", "0.08"), passing("main", "0.11")];
        let told =
            "no seed landed near it, but isola 1 passes by (relative distance 0.08): an isola nearby is not excluded";
        assert_eq!(outcome(seeds.iter()).words(), ["passed", "main; isola 1", told]);
        let landed = [failed(), passing("isola 1", "0.08"), seed("done", Some("main"), "main")];
        assert_eq!(outcome(landed.iter()).words(), ["found", "main", ""]);
        let begun = [passing("main", "0.27"), seed("leased", None, "")];
        assert_eq!(outcome(begun.iter()).words(), ["pending", "", ""]);
        assert_eq!(outcome([failed()].iter()).words()[0], "not_found");
    }
}
