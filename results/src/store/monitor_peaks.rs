//! How far each monitored dof moves on a branch.

use super::levels::BranchRow;
use super::number::number;
use super::{Reader, Result};

impl Reader {
    /// The largest amplitude (m) of every monitored dof on a branch, and the frequency (rad/s) there; none of a branch whose motions
    /// cannot be read.
    pub(crate) fn monitor_peaks(&self, branch: &BranchRow) -> Result<Vec<(f64, f64)>> {
        let Some(array) = self.array(&branch.task, "amplitude")? else { return Ok(Vec::new()) };
        let sql = "SELECT omega FROM points WHERE branch = ?1 ORDER BY i";
        let omega: Vec<f64> = self.all(sql, [branch.id], |row| number(row, 0))?;
        let shape = array.shape.clone();
        let [points, monitors] = shape[..] else { return Ok(Vec::new()) };
        let amplitudes = array.values("amplitude", &shape).map_err(|error| self.corrupt(error))?;
        let peak = |monitor: usize| {
            let of = |point: usize| Some((*amplitudes.get(point * monitors + monitor)?, *omega.get(point)?));
            (0..points).filter_map(of).max_by(|a, b| a.0.total_cmp(&b.0))
        };
        Ok((0..monitors).filter_map(peak).collect())
    }
}
