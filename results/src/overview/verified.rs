//! Results that are what was stored.

use super::omissions::detail;
use crate::store::{BranchRow, Extent, Reader, branch_id};
use protocol::ids::TaskId;
use protocol::to_everyone::StoredResult;

/// The result that a branch is from, checksum verified: what was accepted, to the bit. Otherwise says why not.
pub(crate) fn verified_result(reader: &Reader, branch: &BranchRow) -> std::result::Result<StoredResult, String> {
    let task = TaskId::new(&branch.task).map_err(|error| error.to_string())?;
    let result = reader.result(&task).map_err(|error| detail(&error))?;
    let result = result.ok_or_else(|| format!("the result of task {task} is gone"))?;
    let name = branch_id(&branch.kind, branch.number);
    let Some(message) = result.branch.as_ref().filter(|_| name.is_some() && result.name == name) else {
        return Err(format!("the result of task {task} is another one"));
    };
    let numbers = [branch.omega.0, branch.omega.1, branch.amplitude_max, branch.omega_at_max];
    let row = Extent { points: branch.points, ..Extent::from(numbers) };
    if Extent::of(message) != row {
        return Err("its numbers in the table of branches are others".into());
    }
    Ok(result)
}
