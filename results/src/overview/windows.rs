//! Windows that led to branches, and whether these lie in them.

use crate::store::{BranchRow, WindowOutcome, WindowRow};
use solver::response::branch::BranchKind;

/// Whether a branch has frequencies of a window.
pub fn overlaps(branch: &BranchRow, window: &WindowRow) -> bool {
    branch.omega.0 <= window.omega.1 && branch.omega.1 >= window.omega.0
}

/// What the seeds of a window led to that has other frequencies, in words.
pub fn elsewhere(branches: &str) -> String {
    let verb = if branches.contains("; ") { "which have" } else { "which has" };
    format!("its seeds led to {}, {verb} other frequencies", branches.replace("; ", " and "))
}

/// Tells of a window that led to branches whether one of them has its frequencies. Main branches go past all frequencies: a seed is
/// said to have led to one only if it ended near its prediction.
pub(super) fn tell_elsewhere(window: &mut WindowRow, branches: &[BranchRow]) {
    let WindowOutcome::Found(found) = &window.outcome else { return };
    if within(found, window, branches).0.is_empty() {
        window.outcome = WindowOutcome::Elsewhere(found.clone());
    }
}

/// Of the branches that the seeds of a window led to, those that have its frequencies, and the others.
pub fn within<'f>(found: &'f str, window: &WindowRow, branches: &[BranchRow]) -> (Vec<&'f str>, Vec<&'f str>) {
    let row = |name: &str| branches.iter().find(|row| row.name() == name);
    let is_there = |name: &&str| row(name).is_none_or(|row| row.is_main() || overlaps(row, window));
    found.split("; ").partition(is_there)
}

/// Whether what the seeds of a window led to, or what passes by, is main branches alone; `None` if that is nothing.
pub fn is_on_main(window: &WindowRow, branches: &[BranchRow]) -> Option<bool> {
    let is_main = |name: &str| name.starts_with(BranchKind::Main.name());
    match &window.outcome {
        WindowOutcome::Found(found) => {
            let there = within(found, window, branches).0;
            (!there.is_empty()).then(|| there.into_iter().all(is_main))
        }
        WindowOutcome::Passed { branches, .. } => Some(branches.split("; ").all(is_main)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::level::Level;
    use super::*;

    #[test]
    fn a_window_is_found_where_one_of_its_branches_has_its_frequencies() {
        let branch = |kind: &str, omega| BranchRow { kind: kind.into(), number: 1, omega, ..BranchRow::default() };
        let branches = [branch("main", (0.0, 1.0)), branch("isola", (3.0, 4.0)), branch("open", (1.5, 2.5))];
        let window = |found: &str| WindowRow {
            omega: (2.0, 2.9),
            omega_best: 2.1,
            ..WindowRow::of(WindowOutcome::Found(found.into()))
        };
        let told = |found: &str| {
            let mut window = window(found);
            tell_elsewhere(&mut window, &branches);
            window.outcome.words().map(String::from)
        };
        assert_eq!(told("isola 1"), ["elsewhere", "isola 1", ""]);
        // One is enough; so is the main branch, which goes past all frequencies, and what cannot be read is not judged.
        for found in ["isola 1; open 1", "main", "isola 2"] {
            assert_eq!(told(found), ["found", found, ""]);
        }
        let found = "isola 1; main; open 1";
        assert_eq!(within(found, &window(found), &branches), (vec!["main", "open 1"], vec!["isola 1"]));
        // Of which mode figures are is no matter of an isola that lies elsewhere.
        let mode = |found: &str, branches: &[BranchRow]| {
            let level = Level { windows: vec![window(found)], branches: branches.to_vec(), ..Level::default() };
            level.mode_of_isola()
        };
        assert_eq!(mode("isola 1; main", &branches), None);
        assert_eq!(mode("isola 1; main", &[branch("isola", (2.5, 4.0))]), Some(1));
        assert_eq!(elsewhere("isola 1"), "its seeds led to isola 1, which has other frequencies");
        assert_eq!(elsewhere("isola 1; open 1"), "its seeds led to isola 1 and open 1, which have other frequencies");
    }
}
