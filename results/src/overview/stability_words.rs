//! How the stability of responses is worded: in terminal and report, on the page and in figures, and in `COLUMNS.md`.

use super::BranchRow;
use crate::store::Stability;
use crate::words::{listed_first, shares};

/// What time marching says of a response.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VerdictWords {
    /// In files and tables.
    pub name: &'static str,
    /// In sentences and legends.
    pub word: &'static str,
    /// What that means.
    pub meaning: &'static str,
}

/// All of them; what has no name was not verified.
pub const VERDICTS: [VerdictWords; 6] = [
    VerdictWords { name: "stable", word: "stable", meaning: "small deviations die out" },
    VerdictWords { name: "unstable", word: "unstable", meaning: "almost every small deviation grows" },
    VerdictWords { name: "marginal", word: "marginal", meaning: "at the edge of stability" },
    VerdictWords { name: "none", word: "no periodic motion near", meaning: "time marching came to none" },
    VerdictWords {
        name: "not_comparable",
        word: "not comparable",
        meaning: "marching loses impact energy that the balance keeps",
    },
    VerdictWords { name: "", word: "not verified", meaning: "time marching was not asked" },
];

/// What legends call responses that are not known to be stable or unstable.
pub const NOT_KNOWN: &str = "stability not known";

/// The words for what is stored; of what this program does not know, those for what was not verified.
pub fn verdict_words(name: &str) -> VerdictWords {
    VERDICTS.into_iter().find(|verdict| verdict.name == name).unwrap_or(VERDICTS[VERDICTS.len() - 1])
}

/// What may be known of a branch, after "by time marching".
const CLASSES: [&str; 6] = [
    "stable wherever it could tell",
    "stable in parts",
    "unstable wherever it could tell",
    "unstable or marginal",
    "not known to be stable or unstable",
    "not verified",
];
const STABLE_IN_PARTS: usize = 1;
const UNSTABLE: usize = 2;
const UNVERIFIED: usize = 5;

/// Levels that are named.
const NAMED: usize = 6;

/// Branches of a kind by what is known of their stability.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StabilityOf {
    /// How many there are of each class, in words: what follows "by time marching".
    pub told: String,
    /// How many of them are stable, all of what is known or parts.
    pub stable: usize,
    /// How many are known to be stable or unstable anywhere.
    pub known: usize,
}

/// Number of what is known of a branch.
fn class(row: &BranchRow) -> usize {
    let Some(Stability { stable, unstable, is_marginal_in_parts, .. }) = row.stability.as_ref() else {
        return UNVERIFIED;
    };
    match (*stable > 0.0, *unstable > 0.0) {
        (true, false) => 0,
        (true, true) => 1,
        (false, true) if !is_marginal_in_parts => 2,
        (false, true) => 3,
        (false, false) => 4,
    }
}

/// What time marching says of a branch.
pub(super) fn by_marching(row: &BranchRow) -> String {
    let around = if row.stability.as_ref().is_some_and(|known| !known.is_whole) { "around the peak: " } else { "" };
    format!("{around}{}", CLASSES[class(row)])
}

/// Of these branches, called so, each with its level: how many are what, and at which levels those are that are unstable wherever that is
/// known. `around`: what of them alone was looked at. `None` if nothing was verified.
pub fn stability_of(rows: &[(&str, &BranchRow)], [one, several]: [&str; 2], around: &str) -> Option<StabilityOf> {
    let mut counts = [0; CLASSES.len()];
    rows.iter().for_each(|(_, row)| counts[class(row)] += 1);
    if counts[UNVERIFIED] == rows.len() {
        return None;
    }
    let mut unstable: Vec<String> =
        rows.iter().filter(|(_, row)| class(row) == UNSTABLE).map(|(level, _)| level.to_string()).collect();
    unstable.dedup();
    let mut found: Vec<(usize, String)> = counts.into_iter().zip(CLASSES.map(String::from)).collect();
    let are_of_several = rows.iter().any(|(level, _)| *level != rows[0].0);
    if are_of_several && counts[UNSTABLE] < rows.len() && !unstable.is_empty() {
        found[UNSTABLE].1 += &format!(" (A = {})", listed_first(unstable, NAMED));
    }
    found.retain(|(count, _)| *count > 0);
    let told = match (rows, &found[..]) {
        ([_], [(_, class), ..]) => format!("the {one}{around} is {class}"),
        _ => shares(&format!("{several}{around}"), &found),
    };
    let (stable, known) = (counts[..=STABLE_IN_PARTS].iter().sum(), counts[..UNVERIFIED - 1].iter().sum());
    Some(StabilityOf { told, stable, known })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_of_unstable_branches_are_named() {
        let row = |stable| {
            let known = Stability { is_whole: true, stable, unstable: 1.0 - stable, ..Stability::default() };
            BranchRow { stability: Some(known), ..BranchRow::default() }
        };
        let rows = [row(0.0), row(0.5), row(0.0)];
        let pairs: Vec<(&str, &BranchRow)> = ["1", "2", "3"].into_iter().zip(&rows).collect();
        let told = |pairs: &[(&str, &BranchRow)]| stability_of(pairs, ["isola", "isolas"], "").unwrap().told;
        assert_eq!(
            told(&pairs),
            "of 3 isolas 1 is stable in parts, 2 are unstable wherever it could tell (A = 1 and 3)"
        );
        let same = [("1", &rows[0]), ("1", &rows[1])];
        assert!(told(&same).ends_with("1 is unstable wherever it could tell"), "{}", told(&same));
    }

    #[test]
    fn a_branch_is_told_as_far_as_it_was_looked_at() {
        let row = |stability| BranchRow { stability, ..BranchRow::default() };
        let known = |is_whole, stable, unstable| {
            by_marching(&row(Some(Stability { is_whole, stable, unstable, ..Stability::default() })))
        };
        assert_eq!(by_marching(&row(None)), "not verified");
        assert_eq!(known(true, 0.5, 0.5), "stable in parts");
        assert_eq!(known(false, 0.25, 0.0), "around the peak: stable wherever it could tell");
        assert_eq!(known(true, 0.0, 0.0), "not known to be stable or unstable");
    }
}
