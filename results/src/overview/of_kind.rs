//! Branches of one kind over all levels, in a sentence.

use super::around_largest::around_largest;
use super::level::{Level, UNDECIDED, highest, named};
use crate::store::BranchRow;
use solver::response::branch::BranchKind;

/// Branches of which it is not known whether they are detached, in short and in a sentence each kind. `size` writes an amplitude, m.
pub fn undecided_kinds(levels: &[Level], size: impl Fn(f64) -> String) -> Vec<(String, String)> {
    let told = |kind: BranchKind| {
        let (brief, what) = match kind {
            BranchKind::Cut => ("cut by bounds", "leave through bounds that were given"),
            _ => (kind.name(), "are unfinished"),
        };
        let what = format!("{what}: whether they are detached is not known");
        let (branches, sentence) = of_kind(levels, kind, &what, &size)?;
        Some((format!("{branches} {brief}"), sentence))
    };
    UNDECIDED.into_iter().filter_map(told).collect()
}

/// `2 branches`, and in a sentence what they do, told of many. `size` writes an amplitude, m.
pub fn of_kind(
    levels: &[Level],
    kind: BranchKind,
    many: &str,
    size: impl Fn(f64) -> String,
) -> Option<(String, String)> {
    fn of(level: &Level, kind: BranchKind) -> impl Iterator<Item = &BranchRow> {
        level.others().filter(move |row| row.kind == kind.name())
    }
    let with: Vec<&Level> = levels.iter().filter(|level| of(level, kind).next().is_some()).collect();
    let rows = || with.iter().flat_map(|level| of(level, kind));
    let branches = rows().count();
    let one = many
        .replace("leave", "leaves")
        .replace("branch off", "branches off")
        .replace("they are", "it is")
        .replacen("are ", "is ", 1);
    let list = format!("{branches} {}", if branches == 1 { "branch" } else { "branches" });
    let what = if branches == 1 { one.as_str() } else { many };
    let size = highest(rows()).map_or_else(String::new, |row| {
        let [before, behind] = around_largest(row);
        let up_to = if row.at_least().is_empty() { "up to " } else { "" };
        // Brackets within brackets are hard to read.
        let behind = behind.replace(" (", ", ").replace(')', "");
        format!(" ({up_to}{before}{}{behind})", size(row.amplitude_max))
    });
    (branches > 0).then(|| {
        let sentence = format!("{list}, at {}{size}, {what}.", named(&with));
        (list, sentence)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_bounds_cut_off_is_told_with_its_levels_and_size() {
        let row = |kind: BranchKind, amplitude_max| BranchRow {
            kind: kind.name().into(),
            amplitude_max,
            omega_at_max: 1.0,
            ..BranchRow::default()
        };
        let level = |name: &str, branches: &[BranchRow]| Level {
            amplitude: name.into(),
            branches: branches.to_vec(),
            ..Level::default()
        };
        let cut = |amplitude| row(BranchKind::Cut, amplitude);
        let told = |levels: &[Level]| undecided_kinds(levels, |size| format!("{size} m"));
        assert_eq!(
            told(&[level("1", &[cut(2.0), cut(3.0)]), level("2", &[]), level("3", &[cut(4.0)])]),
            [(
                "3 branches cut by bounds".into(),
                "3 branches, at A = 1 and 3 (up to 4 m), leave through bounds that were given: whether they are detached is not known.".into()
            )]
        );
        let both = told(&[level("1", &[cut(2.0), row(BranchKind::Unfinished, 1.0)])]);
        assert!(
            both[0].1.starts_with("1 branch, at A = 1 (up to 1 m), is unfinished: whether it is detached"),
            "{both:?}"
        );
        assert!(both[1].1.contains("leaves through bounds that were given: whether it is detached"), "{both:?}");
        assert!(told(&[level("1", &[row(BranchKind::Isola, 2.0)])]).is_empty());
    }
}
