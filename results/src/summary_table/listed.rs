//! Which branches beside the main one have a row of their own: where bounds cut a level's branches there may be very many.

use crate::overview::{BranchRow, Level};

/// Isolas of a level that are shown at most.
const ISOLAS: usize = 12;

/// Branches of any other kind.
const OTHERS: usize = 4;

/// A row of a level.
#[derive(Debug, PartialEq)]
pub(super) enum Listed<'l> {
    /// A branch.
    Branch(&'l BranchRow),
    /// So many more of a kind.
    More(usize, &'l str),
}

/// The rows of a level, kind by kind: of many those with the largest responses, in their order. All of them are in summary.csv.
pub(super) fn listed(level: &Level) -> Vec<Listed<'_>> {
    let mut kinds: Vec<(&str, Vec<&BranchRow>)> = Vec::new();
    for row in level.others() {
        match kinds.iter_mut().find(|(kind, _)| *kind == row.kind) {
            Some((_, rows)) => rows.push(row),
            None => kinds.push((&row.kind, vec![row])),
        }
    }
    kinds.into_iter().flat_map(|(kind, rows)| of_kind(kind, rows)).collect()
}

fn of_kind<'l>(kind: &'l str, rows: Vec<&'l BranchRow>) -> Vec<Listed<'l>> {
    let most = if rows.iter().any(|row| row.is_isola()) { ISOLAS } else { OTHERS };
    // A line that says that there is one more is no shorter than that one's.
    if rows.len() <= most + 1 {
        return rows.into_iter().map(Listed::Branch).collect();
    }
    let size = |row: &BranchRow| if row.amplitude_max.is_finite() { row.amplitude_max } else { 0.0 };
    let mut by_size = rows.clone();
    by_size.sort_by(|a, b| size(b).total_cmp(&size(a)));
    by_size.truncate(most);
    let more = Listed::More(rows.len() - most, kind);
    let shown = rows.into_iter().filter(|row| by_size.iter().any(|known| std::ptr::eq(*known, *row)));
    shown.map(Listed::Branch).chain([more]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_branches_of_a_kind_the_largest_are_shown() {
        let row = |kind: &str, number: usize, amplitude_max: f64| BranchRow {
            kind: kind.into(),
            number,
            closed: kind == "isola",
            amplitude_max,
            ..BranchRow::default()
        };
        let told = |cuts: usize| {
            let isolas = (1..=6).map(|number| row("isola", number, 1.0));
            let cuts = (1..=cuts).map(|number| row("cut", number, (number as f64 - 10.0).abs()));
            let level = Level {
                branches: [row("main", 1, 9.0)].into_iter().chain(isolas).chain(cuts).collect(),
                ..Level::default()
            };
            let name = |row: Listed<'_>| match row {
                Listed::Branch(row) => row.name(),
                Listed::More(count, kind) => format!("{count} more {kind}"),
            };
            listed(&level).into_iter().skip(6).map(name).collect::<Vec<_>>()
        };
        assert_eq!(told(85), ["cut 82", "cut 83", "cut 84", "cut 85", "81 more cut"]);
        assert_eq!(told(12), ["cut 1", "cut 2", "cut 3", "cut 4", "8 more cut"]);
        assert_eq!(told(5).len(), 5);
    }
}
