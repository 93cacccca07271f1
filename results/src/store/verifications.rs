//! What marching says of branches: written with the results of the tasks that verified them.

use super::error::At;
use super::strayed::Marched;
use super::{Reader, Result};
use protocol::ids::TaskId;
use protocol::level::typed;
use rusqlite::{Connection, Row, params};
use serde::Serialize;
use solver::response::task::{BranchId, VerifyPlace};
use solver::settings::Stretch;
use solver::stability::along::End;
use solver::stability::multipliers::Verdict;
use solver::stability::verification::Verification;
use std::collections::HashMap;
use std::path::Path;

/// First version of the schema that has verifications.
const SINCE: i64 = 4;

/// A bifurcation of the marched orbits of a branch in numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BifurcationRow {
    /// Forcing amplitude as typed.
    pub forcing: String,
    /// Name of the branch.
    pub branch: String,
    /// `fold`, `period_doubling`, `neimark_sacker`, `branch_point` or `grazing`.
    pub kind: String,
    /// Marched frequency, rad/s.
    pub omega: f64,
    /// Largest |x| of the first monitored dof of the marched orbit, m.
    pub amplitude: f64,
}

/// The marched orbit near the point of largest amplitude of a branch; none where what marching came to from there is another motion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PeakOrbit {
    /// Whether it is stable, or what is known instead: a word of [`verdict_name`].
    pub verdict: String,
    /// Its frequency, rad/s, and its largest |x| of the first monitored dof, m, if there is one.
    pub at: Option<(f64, f64)>,
}

/// What is known of the stability of a branch in numbers.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Stability {
    /// Whether all of it was looked at, and not only what is around its peak.
    pub is_whole: bool,
    /// Share of its points that are known to be stable, 0 to 1.
    pub stable: f64,
    /// Share of its points that are known to be unstable.
    pub unstable: f64,
    /// Whether a multiplier of some of its points has modulus 1 as far as can be told: next to folds, or all along where nothing holds
    /// the structure.
    pub is_marginal_in_parts: bool,
    /// Number of points that were looked at, if there are others on the branch or, where only what is around its peak was looked at, between
    /// the first and the last of them: two changes between neighbours among
    /// them that undo each other are not seen.
    pub sampled: Option<usize>,
    /// What is near its point of largest amplitude, if that was looked at.
    pub peak: Option<PeakOrbit>,
    /// Frequency and amplitude of the largest marched orbit of it that is stable, rad/s and m: those of its points are as good as the
    /// harmonics allow.
    pub largest: Option<(f64, f64)>,
}

/// The word for a verdict in tables and files.
pub fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Stable => "stable",
        Verdict::Unstable => "unstable",
        Verdict::Marginal => "marginal",
        Verdict::NoOrbitNearby => "none",
        Verdict::NotComparable => "not_comparable",
    }
}

fn stretch_name(stretch: Stretch) -> &'static str {
    match stretch {
        Stretch::Whole => "whole",
        Stretch::Peak => "peak",
    }
}

fn end_name(end: End) -> &'static str {
    match end {
        End::Complete => "complete",
        End::Budget => "budget",
        End::Cancelled => "cancelled",
    }
}

/// Number in the file of a branch of the level whose amplitude was typed as `amplitude`, and how many points it has.
pub(super) fn branch_of(db: &Connection, file: &Path, amplitude: &str, branch: BranchId) -> Result<(i64, usize)> {
    let sql = "SELECT id, points FROM branches WHERE amplitude = ?1 AND kind = ?2 AND number = ?3";
    let of = params![amplitude, branch.kind.name(), branch.number + 1];
    db.prepare_cached(sql).at(file)?.query_row(of, |row| Ok((row.get(0)?, row.get(1)?))).at(file)
}

/// Stores the verification of a branch of the level whose amplitude was typed as `amplitude`.
pub(super) fn insert_verification(
    db: &Connection,
    file: &Path,
    (task, amplitude, place): (&TaskId, &str, &VerifyPlace),
    verification: &Verification,
) -> Result<()> {
    let VerifyPlace { branch, stretch } = place;
    let (id, points) = branch_of(db, file, amplitude, *branch)?;
    // One of another branch than that says nothing of it.
    if verification.count != points {
        return Ok(());
    }
    let sql = "INSERT INTO verifications (task, branch, stretch, status, stable, unstable, peak) \
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)";
    let row = params![
        task.as_str(),
        id,
        stretch_name(*stretch),
        end_name(verification.end),
        verification.share(Verdict::Stable),
        verification.share(Verdict::Unstable),
        verification.at_peak().map(|point| point.index),
    ];
    db.prepare_cached(sql).at(file)?.execute(row).at(file)?;
    insert_points(db, file, task, verification)?;
    tell_points(db, file, id, verification)?;
    insert_bifurcations(db, file, task, verification)
}

/// Writes what is known of each point of a branch beside it.
fn tell_points(db: &Connection, file: &Path, branch: i64, verification: &Verification) -> Result<()> {
    let sql = "UPDATE points SET stable = ?3, multiplier = ?4 WHERE branch = ?1 AND i = ?2";
    let mut statement = db.prepare_cached(sql).at(file)?;
    for (i, (verdict, modulus)) in verification.verdicts().into_iter().zip(verification.moduli()).enumerate() {
        statement.execute(params![branch, i, verdict.map(verdict_name), modulus]).at(file)?;
    }
    Ok(())
}

fn insert_points(db: &Connection, file: &Path, task: &TaskId, verification: &Verification) -> Result<()> {
    let sql = "INSERT INTO verified_points (task, i, at, verdict, reason, omega, amplitude, distance, re, im, impacts) \
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)";
    let mut statement = db.prepare_cached(sql).at(file)?;
    for point in &verification.points {
        let orbit = point.orbit.as_ref();
        let largest = orbit.and_then(|orbit| orbit.multipliers.first());
        let row = params![
            task.as_str(),
            point.index,
            point.at,
            verdict_name(point.verdict),
            point.reason.map(|reason| reason.to_string()),
            orbit.map(|orbit| orbit.omega),
            orbit.and_then(|orbit| orbit.amplitudes.first()),
            orbit.map(|orbit| orbit.distance),
            largest.map(|mu| mu.re),
            largest.map(|mu| mu.im),
            orbit.map(|orbit| orbit.impacts),
        ];
        statement.execute(row).at(file)?;
    }
    Ok(())
}

fn insert_bifurcations(db: &Connection, file: &Path, task: &TaskId, verification: &Verification) -> Result<()> {
    let sql = "INSERT INTO bifurcations (task, number, kind, omega, amplitude, at, before, after) \
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)";
    let mut statement = db.prepare_cached(sql).at(file)?;
    for (i, found) in verification.bifurcations.iter().enumerate() {
        let [before, after] = found.outside;
        let (kind, amplitude) = (found.kind.name(), found.amplitudes.first());
        let row = params![task.as_str(), i + 1, kind, found.omega, amplitude, found.at, before, after];
        statement.execute(row).at(file)?;
    }
    Ok(())
}

impl Reader {
    /// What is known of the stability of the branches of a level, by their numbers in the file: of all of a branch, if all of it
    /// was verified.
    pub(super) fn stability(&self, level: i64) -> Result<HashMap<i64, Stability>> {
        if self.version()? < SINCE {
            return Ok(HashMap::new());
        }
        let sql = "SELECT branch, stretch = 'whole', verifications.stable, unstable, point.verdict, point.omega, point.amplitude, \
                   (SELECT count(*) FROM verified_points AS each WHERE each.task = verifications.task), \
                   CASE stretch WHEN 'whole' THEN points \
                   ELSE (SELECT max(each.i) - min(each.i) + 1 FROM verified_points AS each WHERE each.task = verifications.task) END, \
                   EXISTS (SELECT 1 FROM verified_points AS each WHERE each.task = verifications.task AND each.verdict = 'marginal'), \
                   (SELECT points.amplitude FROM points WHERE points.branch = branches.id AND points.i = point.at) \
                   FROM verifications JOIN branches ON branches.id = branch \
                   LEFT JOIN verified_points AS point ON point.task = verifications.task AND point.i = peak \
                   WHERE level = ?1 ORDER BY stretch = 'whole'";
        let row = |row: &Row<'_>| {
            let at = row.get::<_, Option<f64>>(5)?.zip(row.get(6)?);
            let peak = row.get::<_, Option<String>>(4)?.map(|verdict| PeakOrbit { verdict, at });
            let own: Option<f64> = row.get(10)?;
            let orbit = at.zip(own).map(|(at, own)| Marched { at, own });
            let (is_whole, stable, unstable) = (row.get(1)?, row.get(2)?, row.get(3)?);
            let (marched, points): (usize, Option<usize>) = (row.get(7)?, row.get(8)?);
            let sampled = points.is_some_and(|points| marched < points).then_some(marched);
            let is_marginal_in_parts = row.get(9)?;
            let stability =
                Stability { is_whole, stable, unstable, is_marginal_in_parts, sampled, peak, largest: None };
            Ok((row.get(0)?, stability, orbit))
        };
        let mut found: HashMap<i64, Stability> = HashMap::new();
        for (branch, mut stability, orbit) in self.all(sql, [level], row)? {
            if orbit.is_some_and(|orbit| self.is_strayed(level, orbit).unwrap_or_default()) {
                stability.peak = Some(PeakOrbit { verdict: verdict_name(Verdict::NoOrbitNearby).into(), at: None });
            }
            found.insert(branch, stability);
        }
        // Of what was marched last, the largest first.
        let sql = "SELECT branch, point.omega, point.amplitude, \
                   (SELECT points.amplitude FROM points WHERE points.branch = branches.id AND points.i = point.at) \
                   FROM verifications JOIN branches ON branches.id = branch \
                   JOIN verified_points AS point ON point.task = verifications.task \
                   WHERE level = ?1 AND point.verdict = 'stable' AND point.amplitude IS NOT NULL AND (stretch = 'whole') = \
                   (SELECT max(each.stretch = 'whole') FROM verifications AS each WHERE each.branch = branches.id) \
                   ORDER BY point.amplitude DESC";
        let row = |row: &Row<'_>| {
            let at = (row.get(1)?, row.get(2)?);
            Ok((row.get(0)?, at, row.get::<_, Option<f64>>(3)?.map(|own| Marched { at, own })))
        };
        // Where points are damaged that is said of their branches, which can be told of without them.
        for (branch, at, orbit) in self.all::<(i64, (f64, f64), _)>(sql, [level], row).unwrap_or_default() {
            let unset = found.get_mut(&branch).filter(|stability| stability.largest.is_none());
            let is_strayed = || orbit.is_some_and(|orbit| self.is_strayed(level, orbit).unwrap_or_default());
            if let Some(stability) = unset.filter(|_| !is_strayed()) {
                stability.largest = Some(at);
            }
        }
        Ok(found)
    }

    /// What marching says of the branch that a task found, of as much of it as was verified; `None` if nothing was.
    pub fn verification(&self, task: &str) -> Result<Option<Verification>> {
        if self.version()? < SINCE {
            return Ok(None);
        }
        let sql = "SELECT verifications.task, points FROM branches JOIN verifications ON branch = branches.id \
                   WHERE branches.task = ?1 ORDER BY stretch = 'whole' DESC LIMIT 1";
        let row = |row: &Row<'_>| Ok((row.get::<_, String>(0)?, row.get::<_, usize>(1)?));
        let Some((name, points)) = self.one(sql, [task], row)? else { return Ok(None) };
        let id = TaskId::new(&name).map_err(|error| self.corrupt(error))?;
        let found = self.result(&id)?.and_then(|result| result.verification);
        match found.filter(|found| found.count == points && found.is_sound(found.monitors())) {
            Some(found) => Ok(Some(found)),
            None => {
                Err(self.corrupt(format!("the result of task {name} is no verification of the branch of task {task}")))
            }
        }
    }

    /// The bifurcations of marched orbits, level by level in the order of the study and branch by branch.
    pub fn bifurcations(&self) -> Result<Vec<BifurcationRow>> {
        if self.version()? < SINCE {
            return Ok(Vec::new());
        }
        let sql = "SELECT branches.amplitude, branches.kind, branches.number, bifurcations.kind, omega, bifurcations.amplitude \
                   FROM bifurcations JOIN verifications USING (task) JOIN branches ON branches.id = branch \
                   WHERE stretch = 'whole' OR NOT EXISTS \
                   (SELECT 1 FROM verifications AS other WHERE other.branch = branches.id AND other.stretch = 'whole') \
                   ORDER BY level, branches.id, bifurcations.number";
        self.all(sql, [], |row| {
            let (kind, number): (String, usize) = (row.get(1)?, row.get(2)?);
            Ok((kind, number, row.get(0)?, row.get(3)?, row.get(4)?, row.get(5)?))
        })?
        .into_iter()
        .filter(|(_, _, forcing, ..): &(_, _, String, _, _, _)| self.tells_of(forcing))
        .map(|(kind, number, forcing, what, omega, amplitude)| {
            let forcing = typed(&forcing).into();
            Ok(BifurcationRow { forcing, branch: self.branch_name(&kind, number)?, kind: what, omega, amplitude })
        })
        .collect()
    }
}
