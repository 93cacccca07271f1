//! Whether branches merge or part, as the numbers of isolas at the levels beside say where fold curves alone do not.

use super::folds::events_of;
use super::level::Level;
use crate::store::{CurvePoint, CurveRow};
use solver::response::branch::BranchKind;
use solver::response::critical::CriticalKind;

/// What happens at a merge along a fold curve, as the forcing grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Counted {
    /// Isolas become fewer by one.
    Merges,
    /// The same, of the only isola there is by then: with the main branch.
    MergesWithMain,
    /// An isola parts from another branch.
    Parts,
    /// The same, of the only isola there is after it: from the main branch.
    PartsFromMain,
}

/// What all merges between two neighbouring levels are, if it follows from the numbers of isolas there: births and ends apart, each changes that
/// number by one, up or down, and where the change is as large as their number all go the same way. `None` where something is not known that
/// may count: a branch, a curve or what happens along one.
pub(super) fn counted(point: &CurvePoint, levels: &[Level], curves: &[CurveRow]) -> Option<Counted> {
    let pair = levels.windows(2).find(|pair| pair[0].value < point.forcing && point.forcing < pair[1].value)?;
    if !pair.iter().all(is_countable) || is_lost(curves, pair) {
        return None;
    }
    let number_below = |kind: CriticalKind, forcing: f64| {
        let events = events_of(curves, kind.name());
        let between = |point: &&CurvePoint| pair[0].value < point.forcing && point.forcing < forcing;
        i64::try_from(events.into_iter().filter(between).count()).unwrap_or(i64::MAX)
    };
    let number = |kind: CriticalKind| number_below(kind, pair[1].value);
    if number(CriticalKind::Unknown) > 0 {
        return None;
    }
    let [before, after] = [0, 1].map(|i| i64::try_from(pair[i].isolas().count()).unwrap_or(0));
    let (births, deaths) = (number(CriticalKind::Birth), number(CriticalKind::Death));
    let change = after - before - births + deaths;
    let merges = number(CriticalKind::Merge);
    // Where all go one way it is known how many isolas there are just below.
    let below = |kind: CriticalKind| number_below(kind, point.forcing);
    let born = before + below(CriticalKind::Birth) - below(CriticalKind::Death);
    match change {
        _ if merges == 0 => None,
        change if change == -merges && born - below(CriticalKind::Merge) == 1 => Some(Counted::MergesWithMain),
        change if change == merges && born + below(CriticalKind::Merge) == 0 => Some(Counted::PartsFromMain),
        change if change == -merges => Some(Counted::Merges),
        change if change == merges => Some(Counted::Parts),
        _ => None,
    }
}

/// Whether a level has one main branch and isolas, and nothing else that may be one or take part in a merge.
fn is_countable(level: &Level) -> bool {
    let is_plain = |kind: &str| [BranchKind::Main, BranchKind::Isola].iter().any(|plain| plain.name() == kind);
    level.is_known() && level.main_curves() == 1 && level.branches.iter().all(|row| is_plain(&row.kind))
}

/// Whether a fold curve is lost between two levels: what happens where it goes on is not counted.
fn is_lost(curves: &[CurveRow], pair: &[Level]) -> bool {
    let unfinished = curves.iter().filter(|curve| curve.is_unfinished);
    let mut ends = unfinished.flat_map(|curve| curve.points.first().into_iter().chain(curve.points.last()));
    ends.any(|end| (pair[0].value..=pair[1].value).contains(&end.forcing))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::BranchRow;

    fn level(value: f64, isolas: usize) -> Level {
        let row = |kind: &str, number| BranchRow {
            kind: kind.into(),
            number,
            closed: kind == "isola",
            ..BranchRow::default()
        };
        let branches = std::iter::once(row("main", 1)).chain((1..=isolas).map(|number| row("isola", number)));
        Level { amplitude: value.to_string(), value, branches: branches.collect(), ..Level::default() }
    }

    /// A main branch in two pieces that meet is one; in two that do not, nobody knows.
    #[test]
    fn pieces_of_a_curve_count_once() {
        let curves = [curve(&[(1.5, "merge")])];
        let with = |status: &str| {
            let mut levels = [level(1.0, 1), level(2.0, 0)];
            let piece = BranchRow { number: 2, status: status.into(), ..levels[1].branches[0].clone() };
            levels[1].branches.push(piece);
            counted(&curves[0].points[0], &levels, &curves)
        };
        assert_eq!(with("open: frequency bound to known branch"), Some(Counted::MergesWithMain));
        assert_eq!(with("open: frequency bound to frequency bound"), None);
    }

    fn curve(events: &[(f64, &str)]) -> CurveRow {
        let point = |&(forcing, event): &(f64, &str)| CurvePoint {
            forcing,
            omega: forcing,
            event: Some(event.into()),
            ..CurvePoint::default()
        };
        CurveRow { points: events.iter().map(point).collect(), ..CurveRow::default() }
    }

    /// What the event at 1.5 is, between these numbers of isolas at 1 and at 2.
    fn told(isolas: [usize; 2], events: &[(f64, &str)]) -> Option<Counted> {
        let all: Vec<(f64, &str)> = std::iter::once((1.5, "merge")).chain(events.iter().copied()).collect();
        let curves = [curve(&all)];
        counted(&curves[0].points[0], &[level(1.0, isolas[0]), level(2.0, isolas[1])], &curves)
    }

    #[test]
    fn where_all_go_the_same_way() {
        // With one isola there is nothing but the main branch to merge with, or to part from.
        assert_eq!(told([1, 0], &[]), Some(Counted::MergesWithMain));
        assert_eq!(told([0, 0], &[(1.2, "birth")]), Some(Counted::MergesWithMain));
        assert_eq!(told([0, 1], &[]), Some(Counted::PartsFromMain));
        assert_eq!(told([0, 0], &[(1.7, "death")]), Some(Counted::PartsFromMain));
        assert_eq!([told([2, 1], &[]), told([1, 2], &[])], [Some(Counted::Merges), Some(Counted::Parts)]);
        assert_eq!(told([4, 2], &[(1.7, "merge")]), Some(Counted::Merges));
        // The last of several has nothing left but the main branch, and so has the first that parts.
        assert_eq!(told([2, 0], &[(1.2, "merge")]), Some(Counted::MergesWithMain));
        assert_eq!(told([2, 0], &[(1.7, "merge")]), Some(Counted::Merges));
        assert_eq!(told([1, 0], &[(1.2, "merge"), (1.3, "birth")]), Some(Counted::MergesWithMain));
        assert_eq!(told([0, 2], &[(1.7, "merge")]), Some(Counted::PartsFromMain));
        assert_eq!(told([0, 2], &[(1.2, "merge")]), Some(Counted::Parts));
        assert_eq!(told([1, 1], &[(1.2, "birth")]), Some(Counted::Merges));
        assert_eq!(told([1, 1], &[(1.7, "death")]), Some(Counted::Parts));
        // Beyond the levels nothing counts.
        assert_eq!(told([1, 0], &[(2.5, "merge"), (0.5, "birth")]), Some(Counted::MergesWithMain));
        // One merges and one parts, or they exchange ends.
        assert_eq!([told([1, 1], &[(1.7, "merge")]), told([1, 1], &[])], [None, None]);
        assert_eq!(told([1, 0], &[(1.7, "unknown")]), None);
    }

    #[test]
    fn what_is_not_known_may_count() {
        let curves = [curve(&[(1.5, "merge")])];
        let at = |levels: &[Level]| counted(&curves[0].points[0], levels, &curves);
        let levels = [level(1.0, 1), level(2.0, 0)];
        assert_eq!(at(&levels), Some(Counted::MergesWithMain));
        let mut pending = levels.clone();
        pending[1].pending = 1;
        let mut branched = levels.clone();
        branched[0].branches[1].kind = "branched".into();
        assert_eq!([at(&pending), at(&branched), at(&levels[..1])], [None, None, None]);
        let lost = [curves[0].clone(), CurveRow { is_unfinished: true, ..curve(&[(0.5, "cusp"), (1.2, "cusp")]) }];
        assert_eq!(counted(&lost[0].points[0], &levels, &lost), None);
    }
}
