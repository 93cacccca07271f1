//! Names of branches as tables have them.

use solver::response::branch::BranchKind;
use solver::response::name::BranchId;

/// The branch of this kind and number, from 1; `None` if there is no such kind.
pub(crate) fn branch_id(kind: &str, number: usize) -> Option<BranchId> {
    Some(BranchId::new(BranchKind::named(kind)?, number.checked_sub(1)?))
}
