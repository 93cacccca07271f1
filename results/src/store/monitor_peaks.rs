//! How far each monitored dof moves on a branch.

use super::levels::BranchRow;
use super::number::number;
use super::{Reader, Result};
use solver::curve::extrema::{further_peaks, standing_peaks};

impl Reader {
    /// The largest amplitude (m) of every monitored dof on a branch, and the number of the point; none of a branch whose motions cannot be
    /// read.
    pub(crate) fn monitor_peaks(&self, branch: &BranchRow) -> Result<Vec<(f64, usize)>> {
        let largest = |values: Vec<f64>| {
            values.into_iter().enumerate().map(|(point, value)| (value, point)).max_by(|a, b| a.0.total_cmp(&b.0))
        };
        Ok(self.amplitudes(branch)?.into_iter().filter_map(largest).collect())
    }

    /// Frequency (rad/s) and amplitude (m, of the first monitored dof) of the peaks of a branch that stand out, with the largest or without.
    pub(crate) fn standing_peaks(&self, branch: &BranchRow, with_largest: bool) -> Result<Vec<(f64, f64)>> {
        let Some(amplitude) = self.amplitudes(branch)?.into_iter().next() else { return Ok(Vec::new()) };
        let mut peaks = Vec::new();
        let found = if with_largest { standing_peaks(&amplitude) } else { further_peaks(&amplitude) };
        for point in found {
            peaks.extend(self.omega_at(branch, point)?.map(|omega| (omega, amplitude[point])));
        }
        Ok(peaks)
    }

    /// Amplitudes (m) of the points of a branch, one list a monitored dof; none of one whose motions cannot be read.
    fn amplitudes(&self, branch: &BranchRow) -> Result<Vec<Vec<f64>>> {
        let Some(array) = self.array(&branch.task, "amplitude")? else { return Ok(Vec::new()) };
        let shape = array.shape.clone();
        let [_, monitors] = shape[..] else { return Ok(Vec::new()) };
        let values = array.values("amplitude", &shape).map_err(|error| self.corrupt(error))?;
        Ok((0..monitors).map(|monitor| values.iter().skip(monitor).step_by(monitors).copied().collect()).collect())
    }

    /// The frequency of a point of a branch, rad/s.
    pub(crate) fn omega_at(&self, branch: &BranchRow, point: usize) -> Result<Option<f64>> {
        let sql = "SELECT omega FROM points WHERE branch = ?1 AND i = ?2";
        Ok(self.all(sql, (branch.id, point as i64), |row| number(row, 0))?.pop())
    }
}
