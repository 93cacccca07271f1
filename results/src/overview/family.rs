//! Families: which branches of neighbouring levels are the same thing at another forcing.

use super::level::Level;
use crate::store::BranchRow;

/// Numbers the branches beside the main ones by families, from 1 in the order in which they appear level by level: two of
/// neighbouring levels are of one family if their frequency ranges overlap by more than half of the smaller one. Where
/// families split or merge, the larger overlap keeps its number.
pub(super) fn join(levels: &mut [Level]) {
    let mut count = 0;
    for i in 0..levels.len() {
        let (before, rest) = levels.split_at_mut(i);
        let Some(level) = rest.first_mut() else { return };
        let earlier: Vec<&BranchRow> = before.last().map(|level| level.others().collect()).unwrap_or_default();
        let mut now: Vec<&mut BranchRow> = level.branches.iter_mut().filter(|branch| !branch.is_main()).collect();
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (e, one) in earlier.iter().enumerate() {
            let overlaps =
                now.iter().enumerate().filter_map(|(n, other)| Some((overlap(one.omega, other.omega)?, e, n)));
            pairs.extend(overlaps);
        }
        // The sort is stable: of equal overlaps the first counts.
        pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut is_continued = vec![false; earlier.len()];
        for (_, e, n) in pairs {
            if !is_continued[e] && now[n].family.is_none() {
                is_continued[e] = true;
                now[n].family = earlier[e].family;
            }
        }
        for branch in now.into_iter().filter(|branch| branch.family.is_none()) {
            count += 1;
            branch.family = Some(count);
        }
    }
}

/// Width of the overlap of two ranges, if it is more than half of the smaller one.
fn overlap(a: (f64, f64), b: (f64, f64)) -> Option<f64> {
    let is_known = [a.0, a.1, b.0, b.1].iter().all(|omega| omega.is_finite());
    let width = a.1.min(b.1) - a.0.max(b.0);
    (is_known && 2.0 * width > (a.1 - a.0).min(b.1 - b.0)).then_some(width)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Families of levels whose branches have these kinds and ranges.
    fn families(levels: &[&[(&str, (f64, f64))]]) -> Vec<Vec<Option<usize>>> {
        let branch =
            |&(kind, omega): &(&str, (f64, f64))| BranchRow { kind: kind.into(), omega, ..BranchRow::default() };
        let level = |branches: &&[(&str, (f64, f64))]| Level {
            branches: branches.iter().map(branch).collect(),
            ..Level::default()
        };
        let mut levels: Vec<Level> = levels.iter().map(level).collect();
        join(&mut levels);
        levels.iter().map(|level| level.branches.iter().map(|branch| branch.family).collect()).collect()
    }

    #[test]
    fn ranges_that_overlap_are_one_family_through_the_levels() {
        let found = families(&[
            &[("main", (0.0, 9.0))],
            &[("main", (0.0, 9.0)), ("isola", (4.0, 6.0))],
            &[("main", (0.0, 9.0)), ("isola", (1.0, 2.0)), ("isola", (3.5, 7.0))],
            &[("main", (0.0, 9.0)), ("cut", (3.0, 8.0))],
        ]);
        let expected = [vec![None], vec![None, Some(1)], vec![None, Some(2), Some(1)], vec![None, Some(1)]];
        assert_eq!(found, expected);
    }

    #[test]
    fn half_of_the_smaller_range_is_not_enough_and_a_gap_ends_a_family() {
        let apart = families(&[&[("isola", (1.0, 3.0))], &[("isola", (2.0, 9.0))]]);
        assert_eq!(apart, [[Some(1)], [Some(2)]]);
        let enough = families(&[&[("isola", (1.0, 3.0))], &[("isola", (1.9, 9.0))]]);
        assert_eq!(enough, [[Some(1)], [Some(1)]]);
        let gap = families(&[&[("isola", (1.0, 3.0))], &[], &[("isola", (1.0, 3.0))]]);
        assert_eq!(gap, [vec![Some(1)], vec![], vec![Some(2)]]);
        assert_eq!(families(&[&[("isola", (1.0, f64::NAN))], &[("isola", (1.0, 3.0))]]), [[Some(1)], [Some(2)]]);
    }

    #[test]
    fn the_larger_overlap_keeps_the_number() {
        let split = families(&[&[("isola", (1.0, 9.0))], &[("isola", (1.0, 3.0)), ("isola", (4.0, 9.0))]]);
        assert_eq!(split, [vec![Some(1)], vec![Some(2), Some(1)]]);
        let merge = families(&[&[("isola", (1.0, 3.0)), ("isola", (4.0, 9.0))], &[("open", (1.0, 9.0))]]);
        assert_eq!(merge, [vec![Some(1), Some(2)], vec![Some(2)]]);
    }
}
