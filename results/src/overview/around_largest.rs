//! Whether the largest amplitude of a branch is as large as said.

use super::elsewhere::CONVERGED;
use super::truncation::has_moved;
use crate::store::BranchRow;
use solver::response::certificate::Standing;

/// What is put before and behind the largest amplitude of a branch: that it has not converged; that it is larger still beyond the end of what is
/// known of it can only be said where that much of it has converged, as is taken for granted of runs of programs that did not look.
pub fn around_largest(row: &BranchRow) -> [&'static str; 2] {
    let share = row.certificate.elsewhere.map_or(Some(0.0), |change| change.share);
    match (row.peak_standing, share) {
        (Some(Standing::AtLeast), Some(share)) if share <= CONVERGED => ["at least ", ""],
        (Some(Standing::AtLeast), Some(_)) => ["", " (not converged in H)"],
        (Some(Standing::AtLeast), None) => ["", " (not known to have converged in H)"],
        (Some(Standing::At), _) if has_moved(row) => ["", " (not converged in H)"],
        _ => ["", ""],
    }
}
