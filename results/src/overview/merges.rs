//! Which branches merge and part along fold curves.

use super::event_words::{MERGE, MERGES, PARTS};
use super::folds::events_of;
use super::lives::is_within_its_life;
use super::parties::{Beside, Party, is_disturbed, is_merge, sides};
use crate::store::{CurvePoint, CurveRow};
use solver::response::branch::BranchKind;
use solver::response::critical::CriticalKind;

/// Where branches merge or part.
#[derive(Debug, Clone, PartialEq)]
pub struct Merge<'c> {
    /// The point of a fold curve.
    pub point: &'c CurvePoint,
    /// Which branches do what there as the forcing grows, if that is known for sure.
    pub what: Option<String>,
    /// What that is of the isola that takes part in it, if that is only one: what follows its name, as in "merges with the main branch".
    pub of_isola: Option<String>,
    /// What that is, in a word or so.
    pub verb: &'static str,
}

/// What happens as the forcing grows where branches are known to merge or part: which of both, if that is known for sure.
pub fn merge_verb(curves: &[CurveRow], point: &CurvePoint) -> &'static str {
    let known = merges(curves).into_iter().find(|merge| merge.point.is_at(point));
    known.map_or(MERGE.verb, |merge| merge.verb)
}

/// Merges along fold curves, by forcing; what two curves share once.
pub fn merges<'c>(curves: &'c [CurveRow]) -> Vec<Merge<'c>> {
    let merge = |point: &'c CurvePoint| {
        let places = curves.iter().flat_map(|curve| {
            let here = move |(_, other): &(usize, &CurvePoint)| is_merge(other) && point.is_at(other);
            curve.points.iter().enumerate().filter(here).map(move |(i, _)| (curve, i))
        });
        match places.into_iter().find_map(|(curve, i)| words(curves, curve, i)) {
            Some(Told { what, of_isola, verb }) => Merge { point, what: Some(what), of_isola, verb },
            None => Merge { point, what: None, of_isola: None, verb: MERGE.verb },
        }
    };
    events_of(curves, CriticalKind::Merge.name()).into_iter().map(merge).collect()
}

/// A merge in words, as [`Merge`] has them.
struct Told {
    what: String,
    of_isola: Option<String>,
    verb: &'static str,
}

fn words(curves: &[CurveRow], curve: &CurveRow, merge: usize) -> Option<Told> {
    let Beside { parties: [first, second], ways: [from, to], is_below } = sides(curve, merge)?;
    let point = &curve.points[merge];
    let at = |forcing: f64| CurvePoint { forcing, ..CurvePoint::default() };
    let known = [point, &at(from), &at(to)];
    if is_disturbed(curves, &known, &[&[first], &[second]], is_below) {
        return None;
    }
    // Branches of two levels may be one, and so may one of a level and an isola that is born before it.
    let is_nearer = |near: f64, far: f64| (near - point.forcing).abs() < (far - point.forcing).abs();
    let is_told = match (first, second) {
        (Party::Main, _) | (_, Party::Main) | (Party::Isola(..), Party::Isola(..)) => true,
        (Party::Branch(_, level, _), Party::Branch(_, other, _)) => level == other,
        (Party::Isola(..), Party::Branch(..)) => is_nearer(from, to),
        (Party::Branch(..), Party::Isola(..)) => is_nearer(to, from),
    };
    let is_there = |party: &Party<'_>| match *party {
        Party::Branch(name, level, value) => is_within_its_life(curves, name, (level, value), point.forcing),
        _ => true,
    };
    if !is_told || ![first, second].iter().all(is_there) {
        return None;
    }
    let mut parties = [first, second];
    parties.sort_by_key(Party::is_main);
    let kinds = parties.map(|party| party.kind());
    // What is not known to its ends (an isola that bounds cut, say), or is one with its image, may be more than one branch, or less.
    let is_known = |kind: &Option<BranchKind>| {
        kind.is_some_and(|kind| !matches!(kind, BranchKind::Unfinished | BranchKind::Branched | BranchKind::Cut))
    };
    if !kinds.iter().all(is_known) {
        return None;
    }
    let [one, other] = parties;
    // Of two main branches none is told from the same one at another level.
    if one != other && one.is_main() {
        return None;
    }
    if one == other {
        // Two strands of one curve: beside what goes from bound to bound there is a closed one on the other side.
        let (it, is_closed) = (one.name(), one.kind() == Some(BranchKind::Isola));
        let of_one = |does: &str, verb| Told {
            what: format!("an isola {does} {it}"),
            of_isola: Some(format!("{does} {it}")),
            verb,
        };
        return Some(match (is_below, is_closed) {
            (true, true) => Told { what: format!("{it} parts in two"), of_isola: None, verb: PARTS },
            (true, false) => of_one("parts from", PARTS),
            (false, true) => Told { what: format!("two isolas merge into {it}"), of_isola: None, verb: MERGES },
            (false, false) => of_one("merges into", MERGES),
        });
    }
    let verb = match kinds.contains(&Some(BranchKind::Isola)) {
        true if is_below => MERGES,
        true => PARTS,
        // Of two that go from bound to bound two are left, too.
        false => "exchange ends",
    };
    let names = match (one, other) {
        (Party::Branch(one, level, _), Party::Branch(_, same, _)) if level == same => {
            format!("{one} and {}", other.name())
        }
        _ => format!("{} and {}", one.name(), other.name()),
    };
    // Of two isolas each could be the one.
    let is_one = one.kind() == Some(BranchKind::Isola) && other.kind() != Some(BranchKind::Isola);
    let does = if verb == MERGES { "merges with" } else { "parts from" };
    let of_isola = is_one.then(|| format!("{does} {}", other.name()));
    Some(Told { what: format!("{names} {verb}"), of_isola, verb })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Crossing;

    /// A fold curve through these forcing amplitudes, with events and with crossings: segment, level, branch.
    fn curve(forcings: &[f64], events: &[(usize, &str)], crossings: &[(usize, &str, &str)]) -> CurveRow {
        let event = |i| events.iter().find(|(at, _)| *at == i).map(|(_, event)| event.to_string());
        let point = |(i, &forcing): (usize, &f64)| CurvePoint {
            forcing,
            omega: 1.0 + i as f64,
            amplitude: 1.0,
            event: event(i),
            ..CurvePoint::default()
        };
        let crossing = |&(segment, level, branch): &(usize, &str, &str)| Crossing {
            segment,
            forcing: level.parse().unwrap(),
            amplitude: level.into(),
            branch: branch.into(),
        };
        CurveRow {
            points: forcings.iter().enumerate().map(point).collect(),
            crossings: crossings.iter().map(crossing).collect(),
            ..CurveRow::default()
        }
    }

    /// What happens at the only merge, if it is known.
    fn told(curves: &[CurveRow]) -> Option<String> {
        let found = merges(curves);
        assert_eq!(found.len(), 1, "{found:?}");
        found[0].what.clone()
    }

    /// Two branches of a level turn back along the two sides of a merge above it, or, mirrored, below it.
    fn beside_level(branches: [&str; 2], is_above: bool) -> Option<String> {
        let forcings = if is_above { [1.0, 3.0, 4.0, 3.0, 1.0] } else { [6.0, 5.0, 4.0, 5.0, 6.0] };
        let level = if is_above { "2" } else { "5.5" };
        told(&[curve(&forcings, &[(2, "merge")], &[(0, level, branches[0]), (3, level, branches[1])])])
    }

    #[test]
    fn branches_of_the_nearest_level() {
        let pair = |one, other, is_above| beside_level([one, other], is_above).unwrap();
        assert_eq!(pair("main", "isola 1", true), "isola 1 of A = 2 and the main branch merge");
        assert_eq!(pair("isola 2", "isola 1", true), "isola 2 and isola 1 of A = 2 merge");
        assert_eq!(pair("isola 1", "main", false), "isola 1 of A = 5.5 and the main branch part");
        assert_eq!(pair("isola 1", "isola 1", true), "isola 1 of A = 2 parts in two");
        assert_eq!(pair("main", "main", false), "an isola merges into the main branch");
        assert_eq!(pair("main", "main", true), "an isola parts from the main branch");
        assert_eq!(pair("isola 1", "isola 1", false), "two isolas merge into isola 1 of A = 5.5");
        assert_eq!(pair("open 1", "main", true), "open 1 of A = 2 and the main branch exchange ends");
        for unsure in ["branched 1", "unfinished 1", "cut 1", "something 1"] {
            assert_eq!(beside_level([unsure, "main"], true), None);
        }
    }

    /// What has a fold of an isola of a level before that is born is something else.
    #[test]
    fn an_isola_takes_part_in_nothing_before_its_birth() {
        let merge = curve(&[6.0, 2.0, 6.0], &[(1, "merge")], &[(0, "5", "isola 5"), (1, "5", "isola 4")]);
        assert_eq!(told(std::slice::from_ref(&merge)).unwrap(), "isola 5 and isola 4 of A = 5 part");
        let born = |forcing, other| {
            let birth = curve(&[6.0, forcing, 6.0], &[(1, "birth")], &[(0, "5", "isola 4"), (1, "5", other)]);
            told(&[merge.clone(), birth])
        };
        assert_eq!(born(3.0, "isola 4"), None);
        // Where it is born before, or two isolas have become one, that says nothing.
        assert!(born(1.0, "isola 4").is_some() && born(3.0, "isola 5").is_some());
    }

    #[test]
    fn isolas_that_no_level_has() {
        let born = curve(&[2.0, 1.0, 3.0, 1.5, 2.0], &[(1, "birth"), (2, "merge"), (3, "birth")], &[]);
        assert_eq!(told(&[born]).unwrap(), "the isola born at A = 1 and the isola born at A = 1.5 merge");
        let events = [(2, "merge"), (3, "birth")];
        let main = curve(&[0.0, 2.0, 3.0, 1.5, 2.0], &events, &[(0, "1", "main")]);
        assert_eq!(told(&[main]).unwrap(), "the isola born at A = 1.5 and the main branch merge");
        let isola = |level| curve(&[0.0, 2.0, 3.0, 1.5, 2.0], &events, &[(0, level, "isola 1")]);
        let both = "isola 1 of A = 1 and the isola born at A = 1.5 merge";
        assert_eq!(told(&[isola("1")]).unwrap(), both);
        // It may be the one that is born before the level.
        assert_eq!(told(&[isola("1.75")]), None);
        let end = curve(&[5.0, 2.0, 3.5, 3.0], &[(1, "merge"), (2, "death")], &[(0, "4", "main")]);
        assert_eq!(told(&[end]).unwrap(), "the isola that dies at A = 3.5 and the main branch part");
    }

    #[test]
    fn what_is_not_known_for_sure() {
        let crossings = [(0, "2", "isola 1"), (3, "2", "main")];
        let merge = curve(&[1.0, 3.0, 4.0, 3.0, 1.0], &[(2, "merge")], &crossings);
        assert!(told(std::slice::from_ref(&merge)).is_some());
        // Something else may have happened between.
        for event in ["merge", "unknown"] {
            let other = |forcing| curve(&[forcing + 1.0, forcing, forcing + 1.0], &[(1, event)], &[]);
            let what = |forcing| {
                let curves = [merge.clone(), other(forcing)];
                let mut all = merges(&curves).into_iter();
                all.find(|merge| merge.point.forcing == 4.0).unwrap().what
            };
            assert_eq!(what(2.5), None);
            assert!(what(4.5).is_some() && what(1.5).is_some());
        }
        // No branch was found on one side; the curve turns, comes back beyond the merge or ends before it comes to a level.
        assert_eq!(told(&[CurveRow { crossings: merge.crossings[..1].to_vec(), ..merge.clone() }]), None);
        let turns = [1.0, 3.0, 4.0, 3.0, 3.5, 1.0];
        let turning = |event, high| {
            let points = turns.map(|forcing| if forcing == 3.5 { high } else { forcing });
            told(&[curve(&points, &[(2, "merge"), (3, event), (4, event)], &[crossings[0], (4, "2", "main")])])
        };
        assert_eq!([turning("unknown", 3.5), turning("death", 3.5), turning("cusp", 4.5)], [None, None, None]);
        assert!(turning("cusp", 3.5).is_some(), "at a cusp it goes on along the same branch");
        assert_eq!(told(&[curve(&turns[..3], &[(2, "merge")], &crossings[..1])]), None);
        let levels = [crossings[0], (3, "1.5", "isola 1")];
        assert_eq!(told(&[curve(&[1.0, 3.0, 4.0, 3.0, 1.0], &[(2, "merge")], &levels)]), None);
    }

    #[test]
    fn along_a_closed_curve_and_twice() {
        let mut closed = curve(&[4.0, 1.0, 0.5, 1.0], &[(0, "merge"), (2, "birth")], &[(0, "2", "isola 1")]);
        closed.points.push(CurvePoint { event: None, ..closed.points[0].clone() });
        closed.crossings.push(Crossing { segment: 3, branch: "main".into(), ..closed.crossings[0].clone() });
        let expected = "isola 1 of A = 2 and the main branch merge";
        assert_eq!(told(&[closed.clone()]).unwrap(), expected);
        // Another curve has it at its end.
        let end = curve(&[4.0, 3.0], &[(0, "merge")], &[]);
        assert_eq!(told(&[end, closed]).unwrap(), expected);
    }

    /// What other branches do between a level and a merge does not hide which branches merge there.
    #[test]
    fn what_others_do_is_not_about_these() {
        let own = curve(&[1.0, 3.0, 4.0, 3.0, 1.0], &[(2, "merge")], &[(0, "2", "isola 1"), (3, "2", "main")]);
        let what = |branches: [&str; 2]| {
            let crossings = [(0, "2", branches[0]), (3, "2", branches[1])];
            let other = curve(&[1.0, 2.5, 3.0, 2.5, 1.0], &[(2, "merge")], &crossings);
            let curves = [own.clone(), other];
            let found = merges(&curves);
            found.iter().find(|merge| merge.point.forcing == 4.0).unwrap().what.clone()
        };
        let told = Some("isola 1 of A = 2 and the main branch merge".to_string());
        for others in [["isola 2", "main"], ["isola 2", "isola 3"], ["isola 2", "isola 2"]] {
            assert_eq!(what(others), told, "{others:?}");
        }
        // The isola may have become part of another one, or what its fold is beside may have parted from the main branch.
        for others in [["isola 1", "isola 2"], ["isola 1", "main"], ["main", "main"], ["cut 1", "main"]] {
            assert_eq!(what(others), None, "{others:?}");
        }
    }
}
