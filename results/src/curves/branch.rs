//! A forced-response branch as its figures show it.

use super::column::{Column, Quantity};
use protocol::array::{Array, ArrayError};
use protocol::columns::Columns;
use protocol::to_everyone::StoredResult;
use serde::Serialize;
use solver::response::branch::{Outcome, SpecialPoint, Standing};
use solver::response::columns::{self, Axis};
use solver::stability::multipliers::Verdict;
use solver::stability::settling::{Motion, Settling};
use solver::stability::verification::Verification;

/// A branch: p points in the order of the arc, in rad/s and m. Its JSON is without the columns.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// Its level, by index.
    pub level: usize,
    /// `main`, `isola`, `open`, `cut`, `branched` or `unfinished`.
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
    /// Whether the largest amplitude is that of a maximum; not known of runs of the first programs.
    pub peak_standing: Option<Standing>,
    /// Number of points p.
    pub size: usize,
    /// Frequency.
    #[serde(skip)]
    pub omega: Column,
    /// Largest |x| over the period of every monitored dof.
    #[serde(skip)]
    pub amplitude: Vec<Column>,
    /// Whether the response at each point is known to be unstable, by time marching; empty where it was not verified.
    #[serde(skip)]
    pub unstable: Vec<bool>,
    /// The same of what is known to be stable.
    #[serde(skip)]
    pub stable: Vec<bool>,
    /// What unstable motions of it turn into, in the order of the arc.
    #[serde(skip)]
    pub beyond: Vec<Beyond>,
    /// What else the page says of its points, in the order of the list.
    #[serde(skip)]
    pub others: Vec<Quantity>,
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
        let amplitude = table("amplitude", points.columns.required("amplitude")?, size)?;
        let omega = points.motions.omega.values("omega", &[size])?;
        let first = amplitude.first().map_or(&[][..], Vec::as_slice);
        let peak = largest(first);
        Ok(Some(Self {
            level,
            kind: id.kind.name(),
            number: id.number + 1,
            name: id.to_string(),
            closed: branch.outcome == Outcome::Closed,
            status: branch.outcome.to_string(),
            task: result.task.to_string(),
            worker: result.worker.to_string(),
            seconds: result.seconds,
            rejections: branch.rejections,
            peak_standing: branch.peak_standing,
            size,
            peak,
            omega_at_peak: omega.get(peak).copied().unwrap_or(f64::NAN),
            amplitude_at_peak: first.get(peak).copied().unwrap_or(f64::NAN),
            omega: Column::exact(omega),
            amplitude: amplitude.into_iter().map(Column::short).collect(),
            unstable: Vec::new(),
            stable: Vec::new(),
            beyond: Vec::new(),
            others: others(&points.columns, size)?,
            special: branch.special.clone(),
        }))
    }

    /// With what marching says of its points.
    #[must_use]
    pub fn verified(self, verification: &Verification) -> Self {
        let verdicts = if verification.count == self.size { verification.verdicts() } else { Vec::new() };
        let are = |wanted| verdicts.iter().map(|verdict| *verdict == Some(wanted)).collect();
        Self { unstable: are(Verdict::Unstable), stable: are(Verdict::Stable), ..self }
    }

    /// With what its unstable motions turn into.
    #[must_use]
    pub fn beyond(self, found: &[Settling]) -> Self {
        let monitors = self.amplitude.len();
        let fits = |found: &&Settling| found.index < self.size && found.amplitudes.len() == monitors;
        let mut beyond: Vec<Beyond> = found.iter().filter(fits).map(Beyond::of).collect();
        beyond.sort_by_key(|beyond| beyond.point);
        Self { beyond, ..self }
    }

    /// What the page says of its points under the name of a column.
    pub fn other(&self, name: &str) -> Option<&Quantity> {
        self.others.iter().find(|quantity| quantity.about.name == name)
    }
}

/// What an unstable motion of a branch turns into.
#[derive(Debug, Clone, PartialEq)]
pub struct Beyond {
    /// Number of the point on the branch.
    pub point: usize,
    /// Frequency, rad/s.
    pub omega: f64,
    /// What it is, if that is clear.
    pub motion: Option<Motion>,
    /// Smallest and largest of the largest |x| in a period, of every monitored dof, m.
    pub amplitudes: Vec<[f64; 2]>,
}

impl Beyond {
    fn of(found: &Settling) -> Self {
        let Settling { index, omega, motion, amplitudes, .. } = found;
        Self { point: *index, omega: *omega, motion: *motion, amplitudes: amplitudes.clone() }
    }

    /// Whether it has a range of amplitudes of its own: one that repeats itself after a period has but one, as those of branches have,
    /// and what was seen of one that is not clear may be on its way to something else.
    pub fn is_shown(&self) -> bool {
        self.motion.is_some_and(|motion| motion != Motion::Periodic(1))
    }
}

/// What the page says of points besides frequency and amplitude.
fn others(columns: &Columns, size: usize) -> Result<Vec<Quantity>, ArrayError> {
    let list = columns::of_points().filter(|column| column.hover.is_some() && column.name != "amplitude");
    let mut others = Vec::new();
    for (column, array) in columns.among(list) {
        let width = if column.axis == Axis::Point { 1 } else { array.shape.get(1).copied().unwrap_or(0) };
        let shape = if column.axis == Axis::Point { vec![size] } else { vec![size, width] };
        let values = array.values(column.name, &shape)?;
        let rows: Vec<&[f64]> = (0..size).map(|i| &values[i * width..(i + 1) * width]).collect();
        others.extend(Quantity::new(column, &rows));
    }
    Ok(others)
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
