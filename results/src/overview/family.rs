//! Families: which branches of neighbouring levels are the same thing at another forcing.

use super::level::Level;
use crate::store::{BranchRow, CrossSpectrum, CurveRow, Reader};
use std::collections::HashMap;

/// How far from an end of an isola's range a fold curve may cross its level, as a share of its width: points of curves are joined by
/// straight lines.
const AT_END: f64 = 0.05;

/// Relative difference of overlaps that do not tell which ranges belong together: those of images of each other by a symmetry of the
/// structure are the same but for how sharply the steps of each have shown its ends.
const SAME_OVERLAP: f64 = 0.01;

/// The motions of branches, read where ranges do not tell branches from each other.
pub(super) struct Motions<'r> {
    reader: Option<&'r Reader>,
    /// Of branches by their numbers in the file, as far as asked for.
    known: HashMap<i64, Option<CrossSpectrum>>,
}

impl<'r> Motions<'r> {
    /// Those of a run.
    pub(super) fn of(reader: &'r Reader) -> Self {
        Self { reader: Some(reader), known: HashMap::new() }
    }

    /// How different the motions of two branches are; where they cannot be read, how different their peaks are.
    fn distance(&mut self, one: &BranchRow, other: &BranchRow) -> f64 {
        for row in [one, other] {
            let read = || self.reader.and_then(|reader| reader.cross_spectrum(row).ok().flatten());
            self.known.entry(row.id).or_insert_with(read);
        }
        let of = |row: &BranchRow| self.known.get(&row.id).and_then(Option::as_ref);
        match (of(one), of(other)) {
            (Some(one), Some(other)) => one.distance(other),
            _ => (one.amplitude_max / other.amplitude_max).ln().abs(),
        }
    }
}

/// Numbers the branches beside the main ones by families, from 1 in the order in which they appear level by level: two of
/// neighbouring levels are of one family if their frequency ranges overlap by more than half of the smaller one, or else if a
/// fold curve leads from an end of the one to the same end of the other. Where families split or merge, the larger overlap
/// keeps its number. Images of each other by a symmetry of the structure have the same ranges: of these, those belong together whose
/// motions are alike.
pub(super) fn join(levels: &mut [Level], curves: &[CurveRow], motions: &mut Motions<'_>) {
    let mut count = 0;
    for i in 0..levels.len() {
        let (before, rest) = levels.split_at_mut(i);
        let Some(level) = rest.first_mut() else { return };
        let passages = before.last().map(|lower| passages(curves, [lower.value, level.value])).unwrap_or_default();
        let earlier: Vec<&BranchRow> = before.last().map(|level| level.others().collect()).unwrap_or_default();
        let now: Vec<&mut BranchRow> = level.branches.iter_mut().filter(|branch| !branch.is_main()).collect();
        let mut neighbours = Neighbours { is_continued: vec![false; earlier.len()], earlier, now };
        neighbours.join_by_ranges(motions);
        neighbours.join_by_curves(&passages, motions);
        for branch in neighbours.now.into_iter().filter(|branch| branch.family.is_none()) {
            count += 1;
            branch.family = Some(count);
        }
    }
}

/// Branches of two neighbouring levels.
struct Neighbours<'l> {
    earlier: Vec<&'l BranchRow>,
    /// Which of them have been found at the next level.
    is_continued: Vec<bool>,
    now: Vec<&'l mut BranchRow>,
}

impl Neighbours<'_> {
    /// Joins those whose ranges overlap, the largest overlap first.
    fn join_by_ranges(&mut self, motions: &mut Motions<'_>) {
        let mut pairs: Vec<(f64, [usize; 2])> = Vec::new();
        for (e, one) in self.earlier.iter().enumerate() {
            // What branches off another lies within its range.
            let alike = self.now.iter().enumerate().filter(|(_, other)| one.is_branched() == other.is_branched());
            pairs.extend(alike.filter_map(|(n, other)| Some((overlap(one.omega, other.omega)?, [e, n]))));
        }
        loop {
            pairs.retain(|(_, pair)| self.is_open(*pair));
            let largest = pairs.iter().map(|(overlap, _)| *overlap).fold(0.0, f64::max);
            let alike = pairs.iter().filter(|(overlap, _)| *overlap >= (1.0 - SAME_OVERLAP) * largest);
            let alike: Vec<[usize; 2]> = alike.map(|(_, pair)| *pair).collect();
            if !self.join_nearest(&alike, motions) {
                return;
            }
        }
    }

    /// Joins isolas where fold curves lead from an end of the one to the same end of the other.
    fn join_by_curves(&mut self, passages: &[[f64; 2]], motions: &mut Motions<'_>) {
        for &[from, to] in passages {
            let ends = |e: usize, n: usize| end_at(self.earlier[e], from).zip(end_at(self.now[n], to));
            let all = (0..self.earlier.len()).flat_map(|e| (0..self.now.len()).map(move |n| [e, n]));
            let joined = all.filter(|&[e, n]| self.is_open([e, n]) && ends(e, n).is_some_and(|(a, b)| a == b));
            let joined: Vec<[usize; 2]> = joined.collect();
            self.join_nearest(&joined, motions);
        }
    }

    /// Whether neither of two is joined to another one.
    fn is_open(&self, [e, n]: [usize; 2]) -> bool {
        !self.is_continued[e] && self.now[n].family.is_none()
    }

    /// Joins of these pairs the one with the most similar motions, of equal ones the first; whether there is one.
    fn join_nearest(&mut self, pairs: &[[usize; 2]], motions: &mut Motions<'_>) -> bool {
        let nearest = match pairs {
            [] => return false,
            [only] => *only,
            _ => {
                let distance = |&[e, n]: &[usize; 2]| motions.distance(self.earlier[e], self.now[n]);
                let distances: Vec<f64> = pairs.iter().map(distance).collect();
                let best = (0..pairs.len()).min_by(|&a, &b| distances[a].total_cmp(&distances[b]));
                pairs[best.unwrap_or(0)]
            }
        };
        let [e, n] = nearest;
        self.is_continued[e] = true;
        self.now[n].family = self.earlier[e].family;
        true
    }
}

/// Frequencies at two forcing amplitudes between which fold curves lead from the one to the other without leaving them.
fn passages(curves: &[CurveRow], levels: [f64; 2]) -> Vec<[f64; 2]> {
    let mut found = Vec::new();
    for curve in curves {
        // The level crossed last, and where.
        let mut last: Option<(usize, f64)> = None;
        for pair in curve.points.windows(2) {
            let (a, b) = (&pair[0], &pair[1]);
            let mut crossed: Vec<(f64, usize)> = Vec::new();
            for (which, &level) in levels.iter().enumerate() {
                if (a.forcing < level) != (b.forcing < level) {
                    crossed.push(((level - a.forcing) / (b.forcing - a.forcing), which));
                }
            }
            crossed.sort_by(|one, other| one.0.total_cmp(&other.0));
            for (share, which) in crossed {
                let omega = a.omega + share * (b.omega - a.omega);
                if let Some((before, from)) = last.filter(|(before, _)| *before != which) {
                    found.push(if before == 0 { [from, omega] } else { [omega, from] });
                }
                last = Some((which, omega));
            }
        }
    }
    found
}

/// Which end of an isola's range this is, 0 for the lower one.
fn end_at(row: &BranchRow, omega: f64) -> Option<usize> {
    let (low, high) = row.omega;
    let is_at = |end: f64| (omega - end).abs() <= AT_END * (high - low);
    [low, high].into_iter().position(is_at).filter(|_| row.is_isola())
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
    use crate::store::CurvePoint;

    /// Motions that cannot be read.
    fn none() -> Motions<'static> {
        Motions { reader: None, known: HashMap::new() }
    }

    type Branches<'b> = &'b [(&'b str, (f64, f64))];

    /// Families of levels, at A = 1, 2, …, whose branches have these kinds and ranges.
    fn families(levels: &[Branches<'_>]) -> Vec<Vec<Option<usize>>> {
        families_along(levels, &[])
    }

    fn families_along(levels: &[Branches<'_>], curves: &[CurveRow]) -> Vec<Vec<Option<usize>>> {
        let branch = |&(kind, omega): &(&str, (f64, f64))| BranchRow {
            kind: kind.into(),
            closed: kind == "isola",
            omega,
            ..BranchRow::default()
        };
        let level = |(number, branches): (usize, &Branches<'_>)| Level {
            value: number as f64 + 1.0,
            branches: branches.iter().map(branch).collect(),
            ..Level::default()
        };
        let mut levels: Vec<Level> = levels.iter().enumerate().map(level).collect();
        join(&mut levels, curves, &mut none());
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
    fn images_of_each_other_keep_to_their_own() {
        let row = |amplitude_max, low| BranchRow {
            kind: "isola".into(),
            closed: true,
            omega: (low, 3.0),
            amplitude_max,
            ..BranchRow::default()
        };
        let level = |value, branches: [(f64, f64); 2]| Level {
            value,
            branches: branches.map(|(amplitude, low)| row(amplitude, low)).to_vec(),
            ..Level::default()
        };
        // The ranges differ by what is left of Newton's method.
        let mut levels = [level(1.0, [(0.57, 1.0), (0.25, 1.0)]), level(2.0, [(0.26, 0.9), (0.60, 0.9 + 1e-9)])];
        join(&mut levels, &[], &mut none());
        let families = levels.map(|level| level.branches.iter().map(|row| row.family).collect::<Vec<_>>());
        assert_eq!(families, [[Some(1), Some(2)], [Some(2), Some(1)]]);
    }

    /// Of three masses in a ring two move alike: which two, the first one alone does not tell.
    #[test]
    fn images_with_the_same_first_amplitude_keep_to_their_own() {
        let row = |id: i64, low: f64| BranchRow {
            kind: "isola".into(),
            closed: true,
            omega: (low, 3.0),
            amplitude_max: 0.2,
            id,
            ..BranchRow::default()
        };
        let level = |value, branches: [BranchRow; 3]| Level { value, branches: branches.to_vec(), ..Level::default() };
        // The second has hardly fewer frequencies at one level, by its steps.
        let mut levels = [
            level(1.0, [row(1, 1.0), row(2, 1.001), row(3, 1.0)]),
            level(2.0, [row(4, 0.9), row(5, 0.9), row(6, 0.9)]),
        ];
        let moving = |large: usize, size: f64| {
            let motion: Vec<f64> =
                (0..3).flat_map(|dof| [0.0, 0.0, if dof == large { size } else { 0.2 }, 0.0]).collect();
            CrossSpectrum::along(&[1.0, 3.0], &[&motion[..], &motion].concat(), 3, true)
        };
        let known = HashMap::from([
            (1, moving(0, 1.0)),
            (2, moving(1, 1.0)),
            (3, moving(2, 1.0)),
            (4, moving(2, 1.1)),
            (5, moving(0, 1.1)),
            (6, moving(1, 1.1)),
        ]);
        join(&mut levels, &[], &mut Motions { reader: None, known });
        let families = levels.map(|level| level.branches.iter().map(|row| row.family).collect::<Vec<_>>());
        assert_eq!(families, [[Some(1), Some(2), Some(3)], [Some(3), Some(1), Some(2)]]);
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
    fn a_fold_curve_joins_what_has_moved_by_more_than_its_width() {
        let curve = |points: &[(f64, f64)]| CurveRow {
            number: 1,
            origin: String::new(),
            status: String::new(),
            is_unfinished: false,
            points: points
                .iter()
                .map(|&(forcing, omega)| CurvePoint { forcing, omega, amplitude: 1.0, ..CurvePoint::default() })
                .collect(),
            ..CurveRow::default()
        };
        let levels: [Branches<'_>; 2] = [&[("isola", (1.0, 2.0))], &[("isola", (5.0, 7.0)), ("isola", (8.0, 9.0))]];
        let joined = families_along(&levels, &[curve(&[(0.5, 1.5), (1.0, 2.01), (1.5, 5.0), (2.5, 13.0)])]);
        assert_eq!(joined, [vec![Some(1)], vec![Some(2), Some(1)]]);
        // The other way round as well; not from an upper end to a lower one, and not where it has left both levels between.
        let backwards = families_along(&levels, &[curve(&[(2.5, 13.0), (1.5, 5.0), (0.9, 1.4)])]);
        assert_eq!(backwards, joined);
        for other in [[(0.5, 1.5), (1.0, 2.0), (2.0, 8.0)], [(1.5, 2.0), (0.5, 2.0), (0.9, 2.0)]] {
            assert_eq!(families_along(&levels, &[curve(&other)]), [vec![Some(1)], vec![Some(2), Some(3)]]);
        }
    }

    #[test]
    fn the_larger_overlap_keeps_the_number() {
        let split = families(&[&[("isola", (1.0, 9.0))], &[("isola", (1.0, 3.0)), ("isola", (4.0, 9.0))]]);
        assert_eq!(split, [vec![Some(1)], vec![Some(2), Some(1)]]);
        let merge = families(&[&[("isola", (1.0, 3.0)), ("isola", (4.0, 9.0))], &[("open", (1.0, 9.0))]]);
        assert_eq!(merge, [vec![Some(1), Some(2)], vec![Some(2)]]);
    }
}
