//! Curves over the forcing amplitude: written with the results that found them, those of folds read as lists of points.

use super::error::At;
use super::header::unpack;
use super::number::number;
use super::scalars::Scalars;
use super::{Reader, Result};
use protocol::critical::CriticalMessage;
use protocol::ids::TaskId;
use protocol::level::typed;
use rusqlite::{Connection, Row, params};
use serde::Serialize;
use solver::response::branch::{Outcome, Stop};
use solver::response::critical::{CriticalKind, name};
use solver::response::task::{CrossingPlace, Task};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// First version of the schema that has fold curves.
const SINCE: i64 = 3;
/// First version whose curves have births and merges with twice the harmonics.
const SINCE_DOUBLED: i64 = 9;

/// A fold curve in numbers.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct CurveRow {
    /// Number, from 1.
    pub number: usize,
    /// Where it starts: forcing amplitude as typed, branch and fold.
    pub origin: String,
    /// How it begins and ends, in words.
    pub status: String,
    /// Whether it is known only in part.
    pub is_unfinished: bool,
    /// Points in the order of the arc; a closed curve ends with its first one again.
    pub points: Vec<CurvePoint>,
    /// Where it crosses levels, as far as the branch that turns back there is known.
    #[serde(skip)]
    pub crossings: Vec<Crossing>,
}

/// A level that a fold curve crosses, and the branch that turns back there.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Crossing {
    /// The point of the curve before it.
    pub segment: usize,
    /// Forcing amplitude A.
    pub forcing: f64,
    /// The same, as typed.
    pub amplitude: String,
    /// `main`, `isola 1`, …
    pub branch: String,
}

impl CurveRow {
    /// What happens along it, and where.
    pub fn events(&self) -> impl Iterator<Item = (&str, &CurvePoint)> {
        self.points.iter().filter_map(|point| Some((point.event.as_deref()?, point)))
    }
}

/// A point of a fold curve.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Forcing amplitude.
    pub forcing: f64,
    /// Frequency, rad/s.
    pub omega: f64,
    /// Amplitude of the first monitored dof, m.
    pub amplitude: f64,
    /// `birth`, `death`, `merge`, `cusp` or `unknown`.
    pub event: Option<String>,
    /// Of a birth, death or merge: forcing amplitude and frequency, rad/s, with twice the harmonics. Nothing if it was not found there,
    /// or in a run of an earlier program.
    pub doubled: Option<(f64, f64)>,
}

impl CurvePoint {
    /// Relative distance up to which what happens along two curves is one thing: where a curve stops at grazing, another one may
    /// begin on it again.
    pub const SAME: f64 = 1e-5;

    /// Whether what happens at two points is one thing.
    pub fn is_at(&self, other: &Self) -> bool {
        let is_near = |a: f64, b: f64| (a - b).abs() <= Self::SAME * a.abs().max(b.abs());
        is_near(self.forcing, other.forcing) && is_near(self.omega, other.omega)
    }
}

/// What twice the harmonics make of an event is known along all curves that have it, if along one: after a run is extended the same
/// curve is followed again, farther.
fn share_doubled(curves: &mut [CurveRow]) {
    let is_event = |point: &&CurvePoint| point.event.is_some();
    let known: Vec<CurvePoint> = (curves.iter().flat_map(|curve| &curve.points).filter(is_event))
        .filter(|point| point.doubled.is_some())
        .cloned()
        .collect();
    for point in curves.iter_mut().flat_map(|curve| &mut curve.points) {
        if point.event.is_some() && point.doubled.is_none() {
            let same = known.iter().find(|other| other.event == point.event && other.is_at(point));
            point.doubled = same.and_then(|same| same.doubled);
        }
    }
}

/// Where a curve stopped at grazing another one may come by, which was come upon from the other side and goes on: then it is known as well.
fn join(curves: &mut [CurveRow]) {
    let is_passed = |curve: &CurveRow, end: Option<&CurvePoint>| {
        let is_near = |a: f64, b: f64| (a - b).abs() <= CurvePoint::SAME * a.abs().max(b.abs());
        let others = curves.iter().filter(|other| other.number != curve.number);
        let mut within = others.flat_map(|other| other.points.iter().skip(1).rev().skip(1));
        end.is_some_and(|end| within.any(|point| point.is_at(end) && is_near(point.amplitude, end.amplitude)))
    };
    let is_joined = |curve: &CurveRow| {
        let bounds = [Stop::ForcingBound, Stop::FrequencyBound, Stop::Branching].map(|stop| stop.to_string());
        let grazing = format!("({GRAZING})");
        let (starts, ends) = (
            |what: &String| curve.status.starts_with(&format!("open: {what} to ")),
            |what: &String| curve.status.ends_with(&format!(" to {what}")),
        );
        let (first, last) = (is_passed(curve, curve.points.first()), is_passed(curve, curve.points.last()));
        let is_last = curve.status.ends_with(&grazing);
        match curve.status.matches(&grazing).count() {
            1 if is_last => last && bounds.iter().any(starts),
            1 => first && bounds.iter().any(ends),
            2 if is_last => first && last,
            _ => false,
        }
    };
    let joined: Vec<bool> = curves.iter().map(is_joined).collect();
    curves
        .iter_mut()
        .zip(joined)
        .filter(|(_, is_joined)| *is_joined)
        .for_each(|(curve, _)| curve.is_unfinished = false);
}

/// Whether it is a curve of folds or peaks, not of responses at one frequency, curve by curve.
const IS_CRITICAL: &str = "SELECT kind <> 'response' FROM curves ORDER BY number";

/// The amplitude in the name of a level.
fn level(row: &Row<'_>, column: usize) -> rusqlite::Result<String> {
    Ok(typed(&row.get::<_, String>(column)?).into())
}

/// Of an end of a curve at grazing.
pub(crate) const GRAZING: &str = "next to where an element begins or ceases to act";

/// How a curve begins and ends, in words.
fn status(outcome: Outcome, grazing: [Option<usize>; 2]) -> String {
    let Outcome::Open(first, last) = outcome else { return outcome.to_string() };
    let end = |(stop, grazes): (Stop, Option<usize>)| {
        if grazes.is_some() { format!("{stop} ({GRAZING})") } else { stop.to_string() }
    };
    let [first, last] = [(first, grazing[0]), (last, grazing[1])].map(end);
    format!("open: {first} to {last}")
}

/// Stores a curve; its number is one more than that of the last.
pub(super) fn insert_curve(
    db: &Connection,
    file: &Path,
    task: &TaskId,
    number: usize,
    curve: &CriticalMessage,
) -> Result<()> {
    let sql = "INSERT INTO curves (number, task, kind, status, closed, unfinished, rejections) \
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)";
    let row = params![
        number + 1,
        task.as_str(),
        name(curve.quantity),
        status(curve.outcome, curve.grazing),
        curve.outcome == Outcome::Closed,
        curve.outcome.is_unfinished(),
        curve.rejections,
    ];
    db.prepare_cached(sql).at(file)?.execute(row).at(file)?;
    let points = Scalars::new(&curve.points).at(file)?;
    let (forcing, amplitude) = (curve.forcing(), points.get("amplitude"));
    let sql = "INSERT INTO curve_points (curve, i, forcing, omega, amplitude, event, forcing_2h, omega_2h) \
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)";
    let mut statement = db.prepare_cached(sql).at(file)?;
    for (i, (forcing, omega)) in forcing.iter().zip(&points.omega).enumerate() {
        let here = curve.events.iter().filter(|event| event.index == i);
        // Of two at one point the one that is more than a cusp.
        let event = here.max_by_key(|event| event.kind != CriticalKind::Cusp);
        let (kind, (forcing_2h, omega_2h)) =
            (event.map(|event| event.kind.name()), event.and_then(|event| event.doubled).unzip());
        let row = params![number + 1, i, forcing, omega, amplitude.get(i), kind, forcing_2h, omega_2h];
        statement.execute(row).at(file)?;
    }
    Ok(())
}

impl Reader {
    /// The fold curves, in the order in which they were found; none of a run of an earlier program.
    pub fn curves(&self) -> Result<Vec<CurveRow>> {
        if self.version()? < SINCE {
            return Ok(Vec::new());
        }
        let sql = "SELECT number, levels.amplitude, origin, status, unfinished FROM curves \
                   JOIN tasks ON tasks.id = curves.task JOIN levels USING (level) ORDER BY number";
        let rows = self.all(sql, [], |row| {
            let (amplitude, origin): (String, String) = (row.get(1)?, row.get(2)?);
            let is_told_of = self.tells_of(&amplitude);
            let amplitude = typed(&amplitude);
            let curve = CurveRow {
                number: row.get(0)?,
                origin: match origin.starts_with("scout ") {
                    true => format!("{origin}, beyond A = {amplitude}"),
                    false => format!("A = {amplitude}, {origin}"),
                },
                status: row.get(3)?,
                is_unfinished: row.get(4)?,
                ..CurveRow::default()
            };
            Ok((is_told_of, curve))
        })?;
        let (is_told_of, mut curves): (Vec<bool>, Vec<CurveRow>) = rows.into_iter().unzip();
        let doubled = if self.version()? < SINCE_DOUBLED { "NULL, NULL" } else { "forcing_2h, omega_2h" };
        let sql =
            format!("SELECT curve, forcing, omega, amplitude, event, {doubled} FROM curve_points ORDER BY curve, i");
        let point = |row: &Row<'_>| {
            let (forcing, omega, amplitude) = (number(row, 1)?, number(row, 2)?, number(row, 3)?);
            let doubled = row.get::<_, Option<f64>>(5)?.zip(row.get(6)?);
            Ok((row.get::<_, usize>(0)?, CurvePoint { forcing, omega, amplitude, event: row.get(4)?, doubled }))
        };
        for (curve, point) in self.all(&sql, [], point)? {
            let row = curves.get_mut(curve.wrapping_sub(1));
            row.ok_or_else(|| self.corrupt(format!("there is no fold curve {curve}")))?.points.push(point);
        }
        share_doubled(&mut curves);
        join(&mut curves);
        for number in self.all("SELECT number FROM curves WHERE closed", [], |row| row.get::<_, usize>(0))? {
            let Some(curve) = curves.get_mut(number.wrapping_sub(1)) else { continue };
            let first = curve.points.first().map(|first| CurvePoint { event: None, doubled: None, ..first.clone() });
            curve.points.extend(first);
        }
        for (number, crossing) in self.crossings()? {
            let Some(curve) = curves.get_mut(number) else { continue };
            curve.crossings.push(crossing);
        }
        let is_critical = self.all(IS_CRITICAL, [], |row| row.get::<_, bool>(0))?;
        let mut is_meant =
            is_critical.into_iter().zip(is_told_of).map(|(is_critical, is_told_of)| is_critical && is_told_of);
        curves.retain(|_| is_meant.next().unwrap_or(false));
        Ok(curves)
    }

    /// Crossings of curves with levels that led to a branch, each with the index of its curve.
    fn crossings(&self) -> Result<Vec<(usize, Crossing)>> {
        let sql = "SELECT work, levels.value, levels.amplitude, branch FROM tasks JOIN levels USING (level) \
                   WHERE kind = 'crossing' AND found AND branch IS NOT NULL ORDER BY levels.value, position";
        let rows = self.all(sql, [], |row| {
            let crossing =
                Crossing { segment: 0, forcing: number(row, 1)?, amplitude: level(row, 2)?, branch: row.get(3)? };
            Ok((row.get::<_, Vec<u8>>(0)?, crossing))
        })?;
        let place = |(work, crossing): (Vec<u8>, Crossing)| match unpack(self.file(), &work).ok()? {
            Task::Crossing(CrossingPlace { curve, segment }) => Some((curve, Crossing { segment, ..crossing })),
            _ => None,
        };
        Ok(rows.into_iter().filter_map(place).collect())
    }

    /// Forcing amplitudes of the points of curves, of closed ones the first again, by the tasks that found them.
    pub(super) fn forcings(&self) -> Result<HashMap<String, Arc<[f64]>>> {
        if self.version()? < SINCE {
            return Ok(HashMap::new());
        }
        let sql = "SELECT task, forcing FROM curve_points JOIN curves ON curves.number = curve ORDER BY curve, i";
        let mut forcings: HashMap<String, Vec<f64>> = HashMap::new();
        for (task, forcing) in self.all(sql, [], |row| Ok((row.get::<_, String>(0)?, number(row, 1)?)))? {
            forcings.entry(task).or_default().push(forcing);
        }
        for task in self.all("SELECT task FROM curves WHERE closed", [], |row| row.get::<_, String>(0))? {
            let forcing = forcings.entry(task).or_default();
            forcing.extend(forcing.first().copied());
        }
        Ok(forcings.into_iter().map(|(task, forcing)| (task, forcing.into())).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve that was followed again may be known with twice the harmonics where it was not before.
    #[test]
    fn what_twice_the_harmonics_make_of_an_event_is_known_along_all_curves() {
        let point = |forcing, event: &str, doubled| CurvePoint {
            forcing,
            omega: 2.0,
            event: Some(event.into()),
            doubled,
            ..CurvePoint::default()
        };
        let curve = |points| CurveRow { points, ..CurveRow::default() };
        let known = Some((3.01, 2.0));
        let mut curves = [
            curve(vec![point(3.0, "birth", None), point(5.0, "birth", None), point(3.0, "merge", None)]),
            curve(vec![point(3.0 + 1e-9, "birth", known)]),
        ];
        share_doubled(&mut curves);
        let doubled: Vec<_> = curves.iter().flat_map(|curve| &curve.points).map(|point| point.doubled).collect();
        assert_eq!(doubled, [known, None, None, known]);
    }

    /// The fold of an isola at a grazing corner that one walk passes and another one, from the other side, does not.
    #[test]
    fn a_curve_that_another_one_goes_on_with_is_known() {
        let point = |forcing, omega| CurvePoint { forcing, omega, amplitude: 0.5, ..CurvePoint::default() };
        let stalled = format!("stalled at the smallest step ({GRAZING})");
        let curve = |number, status: String, points| CurveRow {
            number,
            status,
            points,
            is_unfinished: true,
            ..CurveRow::default()
        };
        let joined = |statuses: [&str; 2], through: [f64; 3]| {
            let own = vec![point(2.787_183, 59.861_378_8), point(3.9, 59.58), point(16.0, 57.48)];
            let other = through.map(|forcing| point(forcing, 59.861_379_9)).to_vec();
            let mut curves =
                [curve(1, format!("open: {} to {}", statuses[0], statuses[1]), own), curve(2, "closed".into(), other)];
            join(&mut curves);
            !curves[0].is_unfinished
        };
        let past = [2.6, 2.787_181, 3.0];
        assert!(joined([&stalled, "forcing bound"], past));
        assert!(!joined([&stalled, "point budget used up"], past));
        assert!(!joined([&stalled, &stalled], past));
        assert!(!joined(["forcing bound", &stalled], past));
        // What ends there as well does not go on.
        assert!(!joined([&stalled, "forcing bound"], [2.787_181, 3.0, 4.0]));
    }

    #[test]
    fn an_end_tells_where_an_element_begins_to_act() {
        let outcome = Outcome::Open(Stop::Cancelled, Stop::ForcingBound);
        let told = |grazing| status(outcome, grazing);
        assert_eq!(told([None; 2]), outcome.to_string());
        let expected = "open: cancelled (next to where an element begins or ceases to act) to forcing bound";
        assert_eq!(told([Some(3), None]), expected);
        assert_eq!(status(Outcome::Closed, [None; 2]), "closed");
    }
}
