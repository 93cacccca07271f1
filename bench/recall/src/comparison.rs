//! What the product lists against the truth.

use crate::confirm::closed_through;
use crate::product::Row;
use crate::record::{Isola, Level, Record, Standing};

/// Largest relative difference of peaks.
const PEAK: f64 = 0.01;

/// Largest difference of ends: of the width, and of the frequency.
const ENDS: (f64, f64) = (0.05, 2e-4);

/// Relative difference at which two forcing amplitudes are one.
const SAME_LEVEL: f64 = 1e-9;

/// A level of the truth with what the product has of it.
#[derive(Debug)]
pub struct Compared<'r> {
    /// The truth.
    pub level: &'r Level,
    /// For every closed branch of the truth the row that lists it.
    pub found: Vec<(&'r Isola, Option<&'r Row>)>,
    /// Isolas of the product that the truth does not have, and that its equations confirm ([`Compared::confirm`]).
    pub confirmed: Vec<(Isola, &'r Row)>,
    /// Isolas of the product that the truth does not have, or that are listed twice.
    pub extra: Vec<&'r Row>,
    /// The main peak of the product, if it is another one than the truth's and stands as one.
    pub wrong_main: Option<&'r Row>,
}

/// Compares a level with the rows of a run.
pub fn compare<'r>(level: &'r Level, rows: &'r [Row]) -> Compared<'r> {
    let of_level = |row: &&Row| (row.amplitude - level.forcing).abs() <= SAME_LEVEL * level.forcing;
    let mut left: Vec<&Row> = rows.iter().filter(of_level).filter(|row| row.kind == "isola").collect();
    let branched: Vec<&Row> = rows.iter().filter(of_level).filter(|row| row.kind == "branched").collect();
    let mut take = |isola: &Isola| {
        if isola.standing == Standing::Attached {
            return branched.iter().find(|row| is_listed_as(isola, row)).copied();
        }
        let at = left.iter().position(|row| is_listed_as(isola, row))?;
        Some(left.swap_remove(at))
    };
    let found = level.isolas.iter().map(|isola| (isola, take(isola))).collect();
    let main = level.main.and_then(|[_, peak]| {
        let mains = rows.iter().filter(of_level).filter(|row| row.kind == "main");
        let largest = mains.max_by(|a, b| a.amplitude_max.unwrap_or(0.0).total_cmp(&b.amplitude_max.unwrap_or(0.0)))?;
        let is_right = largest.amplitude_max.is_some_and(|amplitude| (amplitude - peak).abs() <= PEAK * peak);
        (!is_right && largest.peak_standing == "at").then_some(largest)
    });
    Compared { level, found, confirmed: Vec::new(), extra: left, wrong_main: main }
}

impl<'r> Compared<'r> {
    /// Asks the equations of the truth about every isola that it does not have: `motions` are some of a row's, as
    /// [`closed_through`] takes them. What lies elsewhere, branches off other motions, or is listed already is not confirmed.
    ///
    /// # Errors
    /// Those of `motions`.
    pub fn confirm<E>(
        &mut self,
        record: &Record,
        mut motions: impl FnMut(&Row) -> Result<Vec<Vec<f64>>, E>,
    ) -> Result<(), E> {
        for row in std::mem::take(&mut self.extra) {
            let motions = motions(row)?;
            let is_right = |isola: &Isola| isola.standing != Standing::Attached && is_listed_as(isola, row);
            let others = || self.level.isolas.iter().chain(self.confirmed.iter().map(|(isola, _)| isola));
            let is_new = |isola: &Isola| is_right(isola) && !others().any(|other| is_same(isola, other));
            match closed_through(record, self.level.forcing, &motions, &is_new) {
                Some(isola) => self.confirmed.push((isola, row)),
                None => self.extra.push(row),
            }
        }
        Ok(())
    }
}

/// Whether two closed branches of the equations of the truth are one: walked from other points on, they differ by far less.
fn is_same(a: &Isola, b: &Isola) -> bool {
    let near = |a: f64, b: f64, distance: f64| (a / b - 1.0).abs() < distance;
    let apart = f64::min(ENDS.1, ENDS.0 * (b.omega[1] / b.omega[0] - 1.0));
    let ends = a.omega.iter().zip(b.omega).all(|(&a, b)| near(a, b, apart));
    ends && near(a.peak[1], b.peak[1], PEAK)
}

/// Whether a row has the frequencies and the peak of a closed branch.
fn is_listed_as(isola: &Isola, row: &Row) -> bool {
    let (Some(low), Some(high), Some(amplitude)) = (row.omega_min, row.omega_max, row.amplitude_max) else {
        return false;
    };
    let tolerance = ENDS.0 * (isola.omega[1] - isola.omega[0]) + ENDS.1 * isola.omega[1];
    (low - isola.omega[0]).abs() <= tolerance
        && (high - isola.omega[1]).abs() <= tolerance
        && (amplitude - isola.peak[1]).abs() <= PEAK * isola.peak[1]
}
