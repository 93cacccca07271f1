//! What became of random starts and of what follows from folds.

use super::header::unpack;
use super::number::number;
use super::{CurvePoint, Reader, Result, StoreError};
use rusqlite::{Row, params};
use solver::response::starts::BATCH;
use solver::response::task::{CrossingPlace, Task};

/// Whether what follows from a fold was found, or is nothing that is missing.
const IS_WELL: &str = "coalesce(found, 0) OR coalesce(outcome, '') LIKE 'outside %' OR coalesce(outcome, '') LIKE 'on asymmetric %' \
                       OR coalesce(outcome, '') LIKE 'every motion that converged repeats %'";

/// Relative difference of frequencies, and of amplitudes, up to which two curves cross a level at one place, as points along them tell.
const BESIDE: f64 = 1e-3;
const ALIKE: f64 = 1e-2;

/// What became of random starts and of the tasks that follow from folds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SearchCounts {
    /// Folds of branches that are to be followed, or found to lie on known curves; what scouts met is none of the study.
    pub folds: usize,
    /// Folds of branches beyond the limit of the search.
    pub left_out: usize,
    /// Folds from which no curve could be followed.
    pub unfollowed: usize,
    /// Branches that branch off others and have folds: these are not followed.
    pub hanging: usize,
    /// Curves at one frequency, along which responses of open branches were carried over the forcing.
    pub carried: usize,
    /// Of these those that stopped before their ends, and responses that could not be carried.
    pub uncarried: usize,
    /// Crossings of curves with levels.
    pub crossings: usize,
    /// Crossings that led to no branch, though they lie within the bounds.
    pub lost: usize,
    /// Branch points at which it was looked for what crosses.
    pub switched: usize,
    /// Of these those at which nothing was found that does.
    pub uncrossed: usize,
    /// Random starts tried.
    pub starts: usize,
    /// Homotopies from motions of the fundamental tried, where nothing else had led to motions of several periods of the force.
    pub homotopies: usize,
    /// Of these at the level that has the fewest.
    pub fewest: usize,
    /// Branches that they led to.
    pub started: usize,
    /// Forcing amplitudes beyond the study's at which random starts were tried as well.
    pub scouts: usize,
    /// Verifications that were given up.
    pub unverified: usize,
}

impl SearchCounts {
    /// Whether every fold that counts was followed and every crossing led to its branch: what happens along fold curves, and what levels have,
    /// is then all that the search could find.
    pub fn is_whole(&self) -> bool {
        self.left_out + self.unfollowed + self.uncarried + self.lost == 0
    }
}

/// Folds that are followed if there is room (`FoldPlace::of`).
const ALL_FOLDS: &str = "SELECT count(*) FROM branches, json_each(branches.special) \
     WHERE json_extract(json_each.value, '$.kind') = 'fold' AND branches.kind <> 'branched' AND level IN {levels}";

/// Branches whose folds are not (`FoldPlace::of`).
const HANGING: &str = "SELECT count(*) FROM branches WHERE kind = 'branched' AND level IN {levels} \
     AND EXISTS (SELECT 1 FROM json_each(branches.special) WHERE json_extract(json_each.value, '$.kind') = 'fold')";

impl Reader {
    /// The levels of crossings without a branch, though they lie within the bounds: of each as often as it has such.
    pub(crate) fn levels_of_lost_crossings(&self) -> Result<Vec<i64>> {
        let levels = self.levels_told_of();
        let sql = format!(
            "SELECT level FROM tasks JOIN levels USING (level) WHERE kind = 'crossing' AND state = 'done' AND NOT ({IS_WELL}) \
             AND origin NOT LIKE 'scout %' AND level IN {levels} ORDER BY value, level"
        );
        let mut lost: Vec<i64> = self.all(&sql, [], |row| row.get(0))?;
        if !lost.is_empty() {
            for met in self.crossings_met_otherwise(&levels)? {
                if let Some(place) = lost.iter().position(|&level| level == met) {
                    lost.remove(place);
                }
            }
        }
        Ok(lost)
    }

    /// The levels of crossings without a branch at which another curve, the same one followed again after the run was extended, has one.
    fn crossings_met_otherwise(&self, levels: &str) -> Result<Vec<i64>> {
        let sql = format!(
            "SELECT work, level, value, coalesce(found, 0) FROM tasks JOIN levels USING (level) \
             WHERE kind = 'crossing' AND state = 'done' AND (found OR NOT ({IS_WELL})) AND origin NOT LIKE 'scout %' AND level IN {levels}"
        );
        let row = |row: &Row<'_>| {
            Ok((row.get::<_, Vec<u8>>(0)?, row.get::<_, i64>(1)?, number(row, 2)?, row.get::<_, bool>(3)?))
        };
        let mut places: Vec<(CrossingPlace, i64, [f64; 2], bool)> = Vec::new();
        for (work, level, value, is_found) in self.all(&sql, [], row)? {
            let Task::Crossing(place) = unpack(self.file(), &work)? else { continue };
            places.extend(self.between(place, value)?.map(|at| (place, level, at, is_found)));
        }
        let is_near = |a: f64, b: f64, share: f64| (a - b).abs() <= share * a.abs().max(b.abs());
        let mut met = Vec::new();
        for (place, level, [omega, amplitude], _) in places.iter().filter(|(.., is_found)| !is_found) {
            let there = places.iter().filter(|(other, at, [o, a], is_found)| {
                let is_there = is_near(*o, *omega, BESIDE) && is_near(*a, *amplitude, ALIKE);
                *is_found && at == level && other.curve != place.curve && is_there
            });
            for (other, ..) in there {
                if self.is_same_curve(place.curve, other.curve)? {
                    met.push(*level);
                    break;
                }
            }
        }
        Ok(met)
    }

    /// Whether two curves, from 0, have something that happens along them in common.
    fn is_same_curve(&self, one: usize, other: usize) -> Result<bool> {
        let sql = "SELECT EXISTS (SELECT 1 FROM curve_points AS a JOIN curve_points AS b ON a.event = b.event \
                   WHERE a.curve = ?1 AND b.curve = ?2 AND abs(a.forcing - b.forcing) <= ?3 * abs(a.forcing) \
                   AND abs(a.omega - b.omega) <= ?3 * abs(a.omega))";
        Ok(self.one(sql, params![one + 1, other + 1, CurvePoint::SAME], |row| row.get(0))?.unwrap_or_default())
    }

    /// Frequency and amplitude at which a segment of a curve has a forcing amplitude.
    fn between(&self, CrossingPlace { curve, segment }: CrossingPlace, forcing: f64) -> Result<Option<[f64; 2]>> {
        let sql =
            "SELECT forcing, omega, amplitude FROM curve_points WHERE curve = ?1 AND i IN (?2, ?2 + 1) ORDER BY i";
        let point = |row: &Row<'_>| Ok([number(row, 0)?, number(row, 1)?, number(row, 2)?]);
        let ends = self.all(sql, [curve + 1, segment], point)?;
        let [a, b] = ends[..] else { return Ok(None) };
        let share = (forcing - a[0]) / (b[0] - a[0]);
        Ok(share.is_finite().then(|| [1, 2].map(|k| a[k] + share * (b[k] - a[k]))))
    }

    /// What became of random starts and of the tasks that follow from folds.
    pub fn search_counts(&self) -> Result<SearchCounts> {
        let levels = self.levels_told_of();
        let told_of = |sql: &str| sql.replace("{levels}", &levels);
        let sql = format!(
            "SELECT kind, state <> 'done' OR {IS_WELL} FROM tasks \
             WHERE kind IN ('fold', 'crossing', 'switch') AND origin NOT LIKE 'scout %' AND level IN {levels}"
        );
        let mut counts = SearchCounts::default();
        for (kind, is_well) in self.all(&sql, [], |row| Ok((row.get::<_, String>(0)?, row.get::<_, bool>(1)?)))? {
            let (all, lost) = match kind.as_str() {
                "fold" => (&mut counts.folds, &mut counts.unfollowed),
                "switch" => (&mut counts.switched, &mut counts.uncrossed),
                // Which of these are lost takes more than their states.
                _ => (&mut counts.crossings, &mut 0),
            };
            *all += 1;
            *lost += usize::from(!is_well);
        }
        counts.lost = self.levels_of_lost_crossings()?.len();
        let number = |sql: &str| {
            Ok::<_, StoreError>(self.one(&told_of(sql), [], |row| row.get::<_, usize>(0))?.unwrap_or_default())
        };
        // Without any task folds were not to be followed.
        if counts.folds > 0 {
            counts.left_out = number(ALL_FOLDS)?.saturating_sub(counts.folds);
        }
        counts.hanging = number(HANGING)?;
        let batches = "SELECT count(*) FROM tasks WHERE kind = 'start' AND state = 'done' AND level IN {levels}";
        counts.starts = BATCH * number(&format!("{batches} AND origin LIKE 'starts, %'"))?;
        counts.homotopies = BATCH * number(&format!("{batches} AND origin LIKE 'homotopies, %'"))?;
        let sql = "SELECT min(number) FROM (SELECT count(tasks.id) AS number FROM levels LEFT JOIN tasks \
                   ON tasks.level = levels.level AND tasks.kind = 'start' AND tasks.state = 'done' AND origin LIKE 'starts, %' \
                   WHERE levels.level IN {levels} GROUP BY levels.level)";
        counts.fewest = BATCH * number(sql)?;
        let sql = "SELECT count(*) FROM branches JOIN tasks ON tasks.id = branches.task \
                   WHERE tasks.kind = 'begin' AND tasks.level IN {levels}";
        counts.started = number(sql)?;
        // Those of a level that was the largest once may lie within the study now.
        let sql = "SELECT count(*) FROM tasks JOIN levels ON levels.level = tasks.level WHERE kind = 'scout' AND state = 'done' \
                   AND value = (SELECT max(value) FROM levels) AND tasks.level IN {levels}";
        counts.scouts = number(sql)?;
        let responses = "SELECT count(*) FROM curves JOIN tasks ON tasks.id = curves.task \
                         WHERE curves.kind = 'response' AND tasks.level IN {levels}";
        counts.carried = number(responses)?;
        let stopped = number(&format!("{responses} AND unfinished"))?;
        let sql =
            "SELECT count(*) FROM tasks WHERE kind = 'carry' AND (state <> 'done' OR NOT found) AND level IN {levels}";
        counts.uncarried = stopped + number(sql)?;
        let sql = "SELECT count(*) FROM tasks WHERE kind = 'verify' AND state = 'dead' AND level IN {levels}";
        counts.unverified = number(sql)?;
        Ok(counts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Study;
    use crate::store::header::pack;
    use crate::store::{FILE, Store};
    use tempfile::tempdir;

    /// A level that a curve crosses where nothing converges, and the same curve, followed again, where something does.
    #[test]
    fn a_crossing_is_not_lost_where_another_curve_has_its_branch() {
        let (study, dir) = (Study::damper(), tempdir().unwrap());
        drop(study.finished(dir.path()));
        let db = rusqlite::Connection::open(dir.path().join(FILE)).unwrap();
        let run = |sql: &str| db.execute_batch(sql).unwrap();
        run("PRAGMA foreign_keys = OFF; DELETE FROM tasks WHERE kind = 'crossing'; DELETE FROM curve_points");
        let curve = |number: usize, omega: f64| {
            run(&format!(
                "INSERT INTO curve_points (curve, i, forcing, omega, amplitude, event) VALUES \
                 ({number}, 0, 0, {omega}, 1, NULL), ({number}, 1, 1, {omega}, 1, NULL), ({number}, 2, 0.5, 3.0, 1, 'birth')"
            ));
        };
        let crossing_with = |curve: usize, found: bool, outcome: &str| {
            let sql = "INSERT INTO tasks (id, level, position, kind, origin, state, outcome, found, work) \
                       VALUES (?1, (SELECT min(level) FROM levels), ?2, 'crossing', ?1, 'done', ?5, ?3, ?4)";
            let work = pack(&Task::Crossing(CrossingPlace { curve, segment: 0 }));
            db.execute(sql, params![format!("curve {curve}"), 1000 + curve, found, work, outcome]).unwrap();
        };
        let crossing = |curve, found| crossing_with(curve, found, "nothing converged");
        let lost = || Store::open(dir.path()).unwrap().search_counts().unwrap().lost;
        curve(1, 2.0);
        crossing(0, false);
        assert_eq!(lost(), 1);
        // It is told where.
        let reader = Store::open(dir.path()).unwrap();
        let lowest = reader.levels().unwrap().remove(0);
        assert_eq!(reader.levels_of_lost_crossings().unwrap(), [lowest.0]);
        drop(reader);
        // What is not done, or was given up, is told as that.
        for state in ["waiting", "leased", "skipped", "dead"] {
            run(&format!("UPDATE tasks SET state = '{state}' WHERE id = 'curve 0'"));
            assert_eq!(lost(), 0, "{state}");
        }
        run("UPDATE tasks SET state = 'done' WHERE id = 'curve 0'");
        // One elsewhere says nothing of it.
        curve(2, 2.01);
        crossing(1, true);
        assert_eq!(lost(), 1);
        curve(3, 2.0 + 1e-4);
        crossing(2, true);
        assert_eq!(lost(), 0);
        // What lies outside is none that is lost, and makes no other one found.
        curve(4, 2.0);
        crossing_with(3, false, "outside the frequency or amplitude bounds");
        curve(5, 7.0);
        crossing(4, false);
        assert_eq!(lost(), 1);
        // Another curve through the same place is no same one.
        run("UPDATE curve_points SET omega = 4 WHERE curve = 3 AND event IS NOT NULL");
        assert_eq!(lost(), 2);
    }
}
