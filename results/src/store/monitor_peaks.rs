//! How far each monitored dof moves on a branch.

use super::levels::BranchRow;
use super::number::number;
use super::{Reader, Result};

impl Reader {
    /// The largest amplitude (m) of every monitored dof on a branch, and the number of the point; none of a branch whose motions cannot be
    /// read.
    pub(crate) fn monitor_peaks(&self, branch: &BranchRow) -> Result<Vec<(f64, usize)>> {
        let Some(array) = self.array(&branch.task, "amplitude")? else { return Ok(Vec::new()) };
        let shape = array.shape.clone();
        let [points, monitors] = shape[..] else { return Ok(Vec::new()) };
        let amplitudes = array.values("amplitude", &shape).map_err(|error| self.corrupt(error))?;
        let of = |monitor: usize| (0..points).map(move |point| (point * monitors + monitor, point));
        let peak = |monitor: usize| {
            let values = of(monitor).filter_map(|(place, point)| Some((*amplitudes.get(place)?, point)));
            values.max_by(|a, b| a.0.total_cmp(&b.0))
        };
        Ok((0..monitors).filter_map(peak).collect())
    }

    /// The frequency of a point of a branch, rad/s.
    pub(crate) fn omega_at(&self, branch: &BranchRow, point: usize) -> Result<Option<f64>> {
        let sql = "SELECT omega FROM points WHERE branch = ?1 AND i = ?2";
        Ok(self.all(sql, (branch.id, point as i64), |row| number(row, 0))?.pop())
    }
}
