//! Who takes part where branches touch along fold curves, and whether what happens elsewhere may be about the same ones.

use crate::store::{CurvePoint, CurveRow};
use crate::words::digits;
use solver::response::branch::BranchKind;
use solver::response::critical::CriticalKind;
use std::cmp::Ordering;

/// Digits of the forcing that an isola is called by: fewer than are claimed where the birth itself is told.
const NAME: i32 = 4;

/// What turns back along a fold curve beside a merge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Party<'c> {
    /// The main branch, which all levels have.
    Main,
    /// Another branch of a level, by name, with the level as typed and its forcing amplitude.
    Branch(&'c str, &'c str, f64),
    /// The isola that is born at this forcing amplitude, or, if the second is set, ends there.
    Isola(f64, bool),
}

impl Party<'_> {
    pub(super) fn kind(&self) -> Option<BranchKind> {
        match self {
            Party::Main => Some(BranchKind::Main),
            Party::Branch(name, ..) => BranchKind::named(name.split(' ').next()?),
            Party::Isola(..) => Some(BranchKind::Isola),
        }
    }

    pub(super) fn is_main(&self) -> bool {
        self.kind() == Some(BranchKind::Main)
    }

    pub(super) fn name(&self) -> String {
        match self {
            Party::Main => "the main branch".into(),
            // Numbers are those of a level.
            Party::Branch(name, level, _) => format!("{name} of A = {level}"),
            Party::Isola(forcing, false) => format!("the isola born at A = {}", digits(*forcing, NAME)),
            Party::Isola(forcing, true) => format!("the isola that dies at A = {}", digits(*forcing, NAME)),
        }
    }

    /// Whether it is another branch than this one for sure, as long as nothing joins them or parts from them.
    fn is_other_than(&self, other: &Self) -> bool {
        // Beyond the bounds two that are open may be one.
        if [self, other].iter().all(|party| party.kind() != Some(BranchKind::Isola)) {
            return false;
        }
        match (self, other) {
            (Party::Main, _) | (_, Party::Main) => true,
            // Numbers of two levels say nothing of each other.
            (Party::Branch(one, level, _), Party::Branch(other, same, _)) => level == same && one != other,
            // Mirror images are born at one forcing amplitude.
            (Party::Isola(one, _), Party::Isola(other, _)) => (one - other).abs() > CurvePoint::SAME * one.abs(),
            // At the level it was not there yet, or not any more.
            (Party::Isola(event, ends), Party::Branch(_, _, level))
            | (Party::Branch(_, _, level), Party::Isola(event, ends)) => {
                if *ends {
                    event < level
                } else {
                    event > level
                }
            }
        }
    }
}

/// What turns back on the two sides of a merge along its curve.
pub(super) struct Beside<'c> {
    pub(super) parties: [Party<'c>; 2],
    /// The forcing amplitudes of the ways there that are farthest from the merge.
    pub(super) ways: [f64; 2],
    /// Whether they do so below it.
    pub(super) is_below: bool,
}

/// The same, if it is known and on one side of its forcing amplitude: two folds on different sides are those of a cusp.
pub(super) fn sides(curve: &CurveRow, merge: usize) -> Option<Beside<'_>> {
    let (first, from) = beside(curve, merge, false)?;
    let (second, to) = beside(curve, merge, true)?;
    let side = |way: f64| way.total_cmp(&curve.points[merge].forcing);
    let is_one = side(from) == side(to) && side(from) != Ordering::Equal;
    is_one.then(|| Beside { parties: [first, second], ways: [from, to], is_below: side(from) == Ordering::Less })
}

/// What turns back along a curve on one side of a merge: the branch of the first level that the curve comes to, or an isola that
/// begins or ends there before. With it comes the forcing amplitude of the way there that is farthest from the merge.
fn beside(curve: &CurveRow, merge: usize, is_onwards: bool) -> Option<(Party<'_>, f64)> {
    let points = &curve.points;
    let start = points[merge].forcing;
    let is_below = points[next(curve, merge, is_onwards)?.1].forcing < start;
    let (mut i, mut is_rising, mut farthest) = (merge, !is_below, start);
    for _ in 0..points.len() {
        let (segment, j) = next(curve, i, is_onwards)?;
        let (here, there) = (points[i].forcing, points[j].forcing);
        if (there > here) != is_rising {
            let event = points[i].event.as_deref()?;
            let end = if is_below { CriticalKind::Birth } else { CriticalKind::Death };
            if event == end.name() {
                return Some((Party::Isola(here, !is_below), farthest));
            }
            // At a cusp two folds of one branch meet.
            if event != CriticalKind::Cusp.name() {
                return None;
            }
            is_rising = !is_rising;
        }
        if (there < start) != is_below || there == start {
            return None;
        }
        let crossed = curve.crossings.iter().filter(|crossing| crossing.segment == segment);
        let distance = |forcing: f64| (forcing - here).abs();
        let nearest = crossed.min_by(|a, b| distance(a.forcing).total_cmp(&distance(b.forcing)));
        let reached = nearest.map_or(there, |crossing| crossing.forcing);
        farthest = if is_below { farthest.min(reached) } else { farthest.max(reached) };
        if let Some(crossing) = nearest {
            let is_main = crossing.branch == BranchKind::Main.name();
            let other = Party::Branch(&crossing.branch, &crossing.amplitude, crossing.forcing);
            return Some((if is_main { Party::Main } else { other }, farthest));
        }
        i = j;
    }
    None
}

/// The point of a curve that follows in a direction, after the segment that leads there; a closed curve goes round.
pub(super) fn next(curve: &CurveRow, i: usize, is_onwards: bool) -> Option<(usize, usize)> {
    let count = curve.points.len();
    let is_closed = count > 2 && curve.points.first()?.is_at(curve.points.last()?);
    match (is_onwards, i) {
        (true, i) if i + 1 < count => Some((i, i + 1)),
        (true, _) if is_closed => Some((0, 1)),
        (false, 0) if is_closed => Some((count - 2, count - 2)),
        (false, i) => Some((i.checked_sub(1)?, i - 1)),
        _ => None,
    }
}

/// Whether branches merge or part elsewhere between these points such that it may be about the same ones: those that are known there, each by
/// all that it is called, and that are followed from below, or else from above, to where it is.
///
/// What joins two branches of which neither is one of these leaves them as they are; as long as nothing else happens, a branch that was
/// another one at its level, or at its birth, still is.
pub(super) fn is_disturbed(curves: &[CurveRow], known: &[&CurvePoint], whose: &[&[Party<'_>]], is_below: bool) -> bool {
    let range = |(low, high): (f64, f64), point: &&CurvePoint| (low.min(point.forcing), high.max(point.forcing));
    let (low, high) = known.iter().fold((f64::INFINITY, f64::NEG_INFINITY), range);
    let is_between =
        |point: &CurvePoint| (low..=high).contains(&point.forcing) && !known.iter().any(|known| known.is_at(point));
    let is_unknown = |point: &CurvePoint| point.event.as_deref() == Some(CriticalKind::Unknown.name());
    let is_about = |curve: &CurveRow, i: usize| {
        let point = &curve.points[i];
        // Another curve through the same place may tell more.
        let same = curves.iter().flat_map(|curve| {
            let here = move |other: &usize| is_merge(&curve.points[*other]) && curve.points[*other].is_at(point);
            (0..curve.points.len()).filter(here).map(move |i| (curve, i))
        });
        is_merge(point) && !same.into_iter().any(|(curve, i)| is_about_others(curve, i, whose, is_below))
    };
    let all = curves.iter().flat_map(|curve| (0..curve.points.len()).map(move |i| (curve, i)));
    all.filter(|(curve, i)| is_between(&curve.points[*i]))
        .any(|(curve, i)| is_unknown(&curve.points[i]) || is_about(curve, i))
}

/// Whether what happens at a merge is about other branches than these for sure.
fn is_about_others(curve: &CurveRow, merge: usize, whose: &[&[Party<'_>]], is_below: bool) -> bool {
    let Some(beside) = sides(curve, merge).filter(|beside| beside.is_below == is_below) else { return false };
    let is_other = |party: &Party<'_>| whose.iter().all(|names| names.iter().any(|name| name.is_other_than(party)));
    let [one, other] = &beside.parties;
    // Whatever comes to it, the main branch is still that; what parts from it may be what was followed along it.
    let stays = |party: &Party<'_>| one != other && party.is_main();
    beside.parties.iter().all(|party| stays(party) || is_other(party))
}

/// Whether branches merge or part at a point.
pub(super) fn is_merge(point: &CurvePoint) -> bool {
    point.event.as_deref() == Some(CriticalKind::Merge.name())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_another_branch_for_sure() {
        let isola = |name, level| Party::Branch(name, level, level.parse().unwrap());
        let is_other = |one: Party<'_>, other: Party<'_>| {
            assert_eq!(one.is_other_than(&other), other.is_other_than(&one));
            one.is_other_than(&other)
        };
        assert!(is_other(isola("isola 1", "2"), isola("isola 2", "2")));
        assert!(!is_other(isola("isola 1", "2"), isola("isola 2", "3")));
        assert!(is_other(Party::Main, isola("isola 1", "2")) && is_other(isola("cut 1", "2"), isola("isola 1", "2")));
        for other in [Party::Main, isola("cut 2", "2"), isola("main 2", "2")] {
            assert!(!is_other(Party::Main, other) && !is_other(isola("cut 1", "2"), other), "{other:?}");
        }
        assert!(is_other(Party::Isola(1.0, false), Party::Isola(1.1, false)));
        assert!(!is_other(Party::Isola(1.0, false), Party::Isola(1.0, false)));
        // What is born above a level is none that it has, and what dies above it may be one.
        assert!(is_other(Party::Isola(3.0, false), isola("isola 1", "2")));
        assert!(!is_other(Party::Isola(1.0, false), isola("isola 1", "2")));
        assert!(is_other(Party::Isola(1.0, true), isola("isola 1", "2")));
        assert!(!is_other(Party::Isola(3.0, true), isola("isola 1", "2")));
    }
}
