//! Levels as the store has them: branches, windows, failures.

use super::branch_id::branch_id;
use super::number::number;
use super::verifications::Stability;
use super::windows::given_up;
use super::{Reader, Result, StoreError};
use protocol::codec::decode_stored;
use protocol::level::typed;
use protocol::to_everyone::StoredResult;
use rusqlite::Row;
use serde::Serialize;
use solver::response::branch::{BranchKind, Certificate, Outcome, Standing, Stop};
use solver::response::certificate::{Change, Doubled};
use std::collections::HashMap;

/// Columns of branches that files of earlier versions are without, and the first version that has them.
const LATER: [(&str, i64); 10] = [
    ("peak_standing", 2),
    ("penetration", 2),
    ("pressure_beyond", 2),
    ("amplitude_2h", 2),
    ("shift_2h", 2),
    ("omega_min_2h", 6),
    ("omega_max_2h", 6),
    ("change_2h", 11),
    ("change_omega_2h", 11),
    ("slowest_sliding", 12),
];

/// A branch of a level in numbers.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct BranchRow {
    /// `main`, `isola`, `open`, `cut`, `branched` or `unfinished`.
    pub kind: String,
    /// Number from 1 within its kind, as in names of files.
    pub number: usize,
    /// How it ends, in words.
    pub status: String,
    /// Whether it is a closed curve.
    pub closed: bool,
    /// Number of points.
    pub points: usize,
    /// Lowest and highest frequency, rad/s.
    pub omega: (f64, f64),
    /// Largest amplitude of the first monitored dof, m.
    pub amplitude_max: f64,
    /// Frequency there, rad/s.
    pub omega_at_max: f64,
    /// Whether the largest amplitude is that of a maximum; not known of runs of the first programs.
    pub peak_standing: Option<Standing>,
    /// What is known of the harmonics that were left out.
    pub certificate: Certificate,
    /// What is known of its stability; nothing if it was not verified.
    pub stability: Option<Stability>,
    /// Number, from 1, of what it is one forcing level of; none for main branches.
    pub family: Option<usize>,
    /// What led to it.
    pub found_by: Option<Origin>,
    #[serde(skip)]
    pub(crate) id: i64,
    #[serde(skip)]
    pub(crate) task: String,
}

impl BranchRow {
    /// Whether it shares frequencies with another branch.
    pub fn meets(&self, other: &Self) -> bool {
        self.omega.0 <= other.omega.1 && other.omega.0 <= self.omega.1
    }

    /// `main`, `isola 1`, …
    pub fn name(&self) -> String {
        let id = branch_id(&self.kind, self.number);
        id.map_or_else(|| format!("{} {}", self.kind, self.number), |id| id.to_string())
    }

    /// Whether ordinary continuation reaches it.
    pub fn is_main(&self) -> bool {
        self.kind == BranchKind::Main.name()
    }

    /// Whether it is a closed curve apart from the main branch.
    pub fn is_isola(&self) -> bool {
        self.closed && self.kind == BranchKind::Isola.name()
    }

    /// Whether it is an open branch on which nothing stays: all of it was looked at, and is unstable wherever that can be told. Parts that are
    /// pressed against each other for ever are on such, far larger than anything else.
    pub fn is_passed_over(&self) -> bool {
        let is_unstable = |known: &Stability| known.is_whole && known.stable == 0.0 && known.unstable > 0.0;
        self.kind == BranchKind::Open.name() && self.stability.as_ref().is_some_and(is_unstable)
    }

    /// Whether it branches off another.
    pub fn is_branched(&self) -> bool {
        self.kind == BranchKind::Branched.name()
    }

    /// At how many of its ends a main branch runs on to one that was known before: it is a piece of one curve with that.
    pub fn joints(&self) -> usize {
        let joined = Stop::Joined.to_string();
        if self.is_main() { self.status.matches(&joined).count() } else { 0 }
    }

    /// Whether it runs on to a branch that was known before.
    pub fn is_joined(&self) -> bool {
        self.status.contains(&Stop::Joined.to_string())
    }

    /// `≥ ` if the response may be larger than the largest amplitude that is known.
    pub fn at_least(&self) -> &'static str {
        if self.peak_standing == Some(Standing::AtLeast) { "≥ " } else { "" }
    }
}

/// What led to a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub enum Origin {
    /// Ordinary continuation.
    #[serde(rename = "continuation")]
    Continuation,
    /// A window of the energy balance.
    #[serde(rename = "energy balance")]
    Balance,
    /// A curve over the forcing, of folds as a rule.
    #[serde(rename = "fold curve")]
    Curve,
    /// A random start.
    #[serde(rename = "random start")]
    Start,
}

impl Origin {
    /// Of what a task of this kind found.
    fn of(kind: &str) -> Option<Self> {
        match kind {
            "main" => Some(Self::Continuation),
            "seed" => Some(Self::Balance),
            "crossing" => Some(Self::Curve),
            "begin" => Some(Self::Start),
            _ => None,
        }
    }
}

impl Reader {
    /// Number, forcing amplitude as typed, and its value: levels by amplitude.
    pub(crate) fn levels(&self) -> Result<Vec<(i64, String, f64)>> {
        let sql = "SELECT level, amplitude, value FROM levels ORDER BY value, level";
        let mut levels: Vec<(i64, String, f64)> =
            self.all(sql, [], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))?;
        levels.retain(|(_, name, _)| self.tells_of(name));
        levels.iter_mut().for_each(|(_, name, _)| *name = typed(name).into());
        Ok(levels)
    }

    /// Tasks of a level that are still to be done, and those that were given up, verifications apart.
    pub(crate) fn open_tasks(&self, level: i64) -> Result<(usize, usize)> {
        let sql = "SELECT count(*) FILTER (WHERE state IN ('waiting', 'leased')), \
                   count(*) FILTER (WHERE state = 'dead') FROM tasks WHERE level = ?1 AND kind NOT IN ('verify', 'disturb', 'march')";
        Ok(self.one(sql, [level], |row| Ok((row.get(0)?, row.get(1)?)))?.unwrap_or_default())
    }

    /// Results of all levels that two others contradict, and those that one does.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn contradictions(&self) -> Result<(usize, usize)> {
        self.contradicted_where("?1 IS NULL", None)
    }

    /// The same of a level.
    pub(crate) fn contradicted(&self, level: i64) -> Result<(usize, usize)> {
        self.contradicted_where("level = ?1", Some(level))
    }

    fn contradicted_where(&self, condition: &str, level: Option<i64>) -> Result<(usize, usize)> {
        let sql = format!(
            "SELECT count(DISTINCT task) FILTER (WHERE \"end\" = 'refuted' AND attempts.attempt = results.attempt), \
             count(DISTINCT task) FILTER (WHERE \"end\" = 'disputed' AND attempts.attempt > results.attempt) \
             FROM attempts JOIN results USING (task) JOIN tasks ON tasks.id = task WHERE {condition}"
        );
        Ok(self.one(&sql, [level], |row| Ok((row.get(0)?, row.get(1)?)))?.unwrap_or_default())
    }

    /// Seeds of a level that were tried, in one way or more, and those of them that led to no branch, which one may pass by.
    pub(crate) fn tried_seeds(&self, level: i64) -> Result<(usize, usize)> {
        // A seed is one of a phase of a well; those of a window's wells stand in their order, for each way once.
        let sql = "SELECT count(*), count(*) FILTER (WHERE branch IS NULL) FROM (SELECT max(CASE WHEN outcome = branch THEN branch END) AS branch FROM (\
                   SELECT *, row_number() OVER (PARTITION BY window, phase, way, kind ORDER BY position) AS well \
                   FROM tasks WHERE level = ?1 AND kind IN ('land', 'seed')) \
                   WHERE state = 'done' AND (kind = 'seed' OR NOT found) GROUP BY window, phase, well)";
        Ok(self.one(sql, [level], |row| Ok((row.get(0)?, row.get(1)?)))?.unwrap_or_default())
    }

    /// Branches of a level, kind by kind: main branches first.
    pub(crate) fn branches(&self, level: i64) -> Result<Vec<BranchRow>> {
        let version = self.version()?;
        let later = LATER.map(|(name, since)| if version < since { "NULL" } else { name }).join(", ");
        let sql = format!(
            "SELECT kind, number, status, closed, points, omega_min, omega_max, amplitude_max, omega_at_max, \
             contact_omega_min, contact_omega_max, id, task, {later}, \
             (SELECT tasks.kind FROM tasks WHERE tasks.id = task) FROM branches WHERE level = ?1 ORDER BY number"
        );
        let mut list = self.all(&sql, [level], branch)?;
        let mut stability = match self.stability(level) {
            // Branches can be told of without their verifications; that the file is damaged is said besides.
            Err(StoreError::Corrupt { .. }) => HashMap::new(),
            known => known?,
        };
        list.iter_mut().for_each(|row| row.stability = stability.remove(&row.id));
        list.sort_by_key(|row| BranchKind::named(&row.kind));
        Ok(list)
    }

    /// How main branches end, by amplitudes as typed, the smallest first.
    pub(crate) fn main_outcomes(&self) -> Result<Vec<(String, Outcome)>> {
        let sql = "SELECT levels.amplitude, record FROM branches JOIN levels USING (level) JOIN results USING (task) \
                   WHERE kind = 'main' ORDER BY value, number";
        let mut rows = self.all(sql, [], |row| Ok((row.get::<_, String>(0)?, row.get::<_, Vec<u8>>(1)?)))?;
        rows.retain(|(amplitude, _)| self.tells_of(amplitude));
        rows.iter_mut().for_each(|(amplitude, _)| *amplitude = typed(amplitude).into());
        let outcome = |(amplitude, record): (String, Vec<u8>)| {
            let result: StoredResult = decode_stored(&record).map_err(|error| self.corrupt(error))?;
            Ok(result.branch.map(|branch| (amplitude, branch.outcome)))
        };
        rows.into_iter().filter_map(|row| outcome(row).transpose()).collect()
    }

    /// Why no main branch starts at one side of a level, if one was tried there.
    pub(crate) fn main_failure(&self, level: i64) -> Result<Option<String>> {
        let sql = "SELECT state, outcome, (SELECT reason FROM attempts WHERE task = id AND reason IS NOT NULL \
                   ORDER BY attempt DESC LIMIT 1) FROM tasks \
                   WHERE level = ?1 AND kind = 'main' AND (state = 'dead' OR state = 'done' AND NOT found) \
                   ORDER BY position LIMIT 1";
        self.one(sql, [level], |row| {
            let (state, outcome, reason): (String, Option<String>, Option<String>) =
                (row.get(0)?, row.get(1)?, row.get(2)?);
            Ok(if state == "dead" { given_up(reason) } else { outcome.unwrap_or_default() })
        })
    }
}

fn branch(row: &Row<'_>) -> rusqlite::Result<BranchRow> {
    let touching: (Option<f64>, Option<f64>) = (row.get(9)?, row.get(10)?);
    let standing: Option<String> = row.get(13)?;
    let doubled: (Option<f64>, Option<f64>) = (row.get(16)?, row.get(17)?);
    let range: (Option<f64>, Option<f64>) = (row.get(18)?, row.get(19)?);
    let range = range.0.zip(range.1);
    let change: (Option<f64>, Option<f64>) = (row.get(20)?, row.get(21)?);
    let status: String = row.get(2)?;
    Ok(BranchRow {
        kind: row.get(0)?,
        number: row.get(1)?,
        closed: row.get(3)?,
        points: row.get(4)?,
        omega: (number(row, 5)?, number(row, 6)?),
        amplitude_max: number(row, 7)?,
        omega_at_max: number(row, 8)?,
        id: row.get(11)?,
        task: row.get(12)?,
        peak_standing: standing.and_then(|name| Standing::named(&name)).map(|named| standing_between(&status, named)),
        status,
        certificate: Certificate {
            penetration: row.get(14)?,
            pressure_beyond: row.get(15)?,
            doubled: doubled.0.zip(doubled.1).map(|(amplitude, shift)| Doubled { amplitude, shift, range }),
            elsewhere: change.1.map(|omega| Change { share: change.0, omega }),
            contact_omega: touching.0.zip(touching.1),
            slowest_sliding: row.get(22)?,
        },
        stability: None,
        family: None,
        found_by: row.get::<_, Option<String>>(13 + LATER.len())?.as_deref().and_then(Origin::of),
    })
}

/// Where the largest amplitude of a branch stands. What runs on to known branches at both ends is known from end to end, of which programs of
/// before said that it is no larger than known.
fn standing_between(status: &str, told: Standing) -> Standing {
    if status == Outcome::Open(Stop::Joined, Stop::Joined).to_string() { Standing::At } else { told }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_between_known_branches_is_known_to_its_ends() {
        let told = |first, last| standing_between(&Outcome::Open(first, last).to_string(), Standing::AtLeast);
        assert_eq!(told(Stop::Joined, Stop::Joined), Standing::At);
        for other in [Stop::PointBudget, Stop::FrequencyBound] {
            assert_eq!(told(Stop::Joined, other), Standing::AtLeast);
        }
    }
}
