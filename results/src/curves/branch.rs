//! A forced-response branch as its figures show it.

use super::column::Column;
use protocol::array::{Array, ArrayError};
use protocol::to_everyone::StoredResult;
use serde::Serialize;
use solver::response::branch::{Outcome, SpecialPoint};
use solver::response::task::BranchId;

/// A branch: p points in the order of the arc, in rad/s and m. Its JSON is without the columns.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// Its level, by index.
    pub level: usize,
    /// `main` or `isola`.
    pub kind: &'static str,
    /// Number from 1 within level and kind.
    pub number: usize,
    /// `main`, `isola 1`, …
    pub name: String,
    /// Whether it is a closed curve.
    pub closed: bool,
    /// How it ends, in words.
    pub status: String,
    /// The task that found it.
    pub task: String,
    /// Who computed it.
    pub worker: String,
    /// Computing time, s.
    pub seconds: f64,
    /// Steps that were refused and repeated shorter.
    pub rejections: usize,
    /// Number of points p.
    pub size: usize,
    /// Frequency.
    #[serde(skip)]
    pub omega: Column,
    /// Largest |x| over the period of every monitored dof.
    #[serde(skip)]
    pub amplitude: Vec<Column>,
    /// Root mean square of every monitored dof.
    #[serde(skip)]
    pub rms: Vec<Column>,
    /// Share of the period in contact, the largest over the contact elements; NaN without any.
    #[serde(skip)]
    pub contact: Column,
    /// Largest scaled residual.
    #[serde(skip)]
    pub residual: Column,
    /// Share of the two highest harmonics in the motion.
    #[serde(skip)]
    pub high_harmonics: Column,
    /// Newton iterations.
    #[serde(skip)]
    pub iterations: Column,
    /// Start, peak and folds.
    pub special: Vec<SpecialPoint>,
    /// Index of the point of largest amplitude of the first monitored dof.
    pub peak: usize,
    /// Frequency there, rad/s.
    pub omega_at_peak: f64,
    /// Amplitude there, m.
    pub amplitude_at_peak: f64,
}

impl Curve {
    /// The branch that a result holds, if it does.
    ///
    /// # Errors
    /// If its arrays do not fit each other.
    pub fn of(result: &StoredResult, level: usize) -> Result<Option<Self>, ArrayError> {
        let (Some(branch), Some(id)) = (&result.branch, result.name) else { return Ok(None) };
        let points = &branch.points;
        let size = points.len();
        let single = |array: &Array, name| array.values(name, &[size]);
        let contact = table("contact", &points.contact, size)?;
        let touching = (0..size).map(|i| contact.iter().map(|node| node[i]).fold(f64::NAN, f64::max)).collect();
        let (kind, number) = match id {
            BranchId::Main => ("main", 1),
            BranchId::Isola(index) => ("isola", index + 1),
        };
        let amplitude = table("amplitude", &points.amplitude, size)?;
        let omega = single(&points.motions.omega, "omega")?;
        let first = amplitude.first().map_or(&[][..], Vec::as_slice);
        let peak = largest(first);
        let short = |columns: Vec<Vec<f64>>| columns.into_iter().map(Column::short).collect();
        Ok(Some(Self {
            level,
            kind,
            number,
            name: id.to_string(),
            closed: branch.outcome == Outcome::Closed,
            status: branch.outcome.to_string(),
            task: result.task.to_string(),
            worker: result.worker.to_string(),
            seconds: result.seconds,
            rejections: branch.rejections,
            size,
            peak,
            omega_at_peak: omega.get(peak).copied().unwrap_or(f64::NAN),
            amplitude_at_peak: first.get(peak).copied().unwrap_or(f64::NAN),
            omega: Column::exact(omega),
            amplitude: short(amplitude),
            rms: short(table("rms", &points.rms, size)?),
            contact: Column::short(touching),
            residual: Column::short(single(&points.residual, "residual")?),
            high_harmonics: Column::short(single(&points.high_harmonics, "high_harmonics")?),
            iterations: Column::short(single(&points.iterations, "iterations")?),
            special: branch.special.clone(),
        }))
    }
}

/// Index of the largest of some values.
pub fn largest(values: &[f64]) -> usize {
    (0..values.len()).max_by(|&i, &j| values[i].total_cmp(&values[j])).unwrap_or(0)
}

/// The columns of an array of `size` rows.
pub(super) fn table(name: &'static str, array: &Array, size: usize) -> Result<Vec<Vec<f64>>, ArrayError> {
    let width = array.shape.get(1).copied().unwrap_or(0);
    let values = array.values(name, &[size, width])?;
    Ok((0..width).map(|column| values.iter().skip(column).step_by(width).copied().collect()).collect())
}
