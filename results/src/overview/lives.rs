//! From which forcing amplitude to which an isola is there, where a fold curve tells it for sure.

use super::folds::{CurveEvent, curve_events};
use super::level::Level;
use super::parties::{Party, is_disturbed, next};
use crate::store::{Crossing, CurvePoint, CurveRow};
use solver::response::branch::{BranchKind, Stop};
use solver::response::critical::CriticalKind;

/// An isola over the forcing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Life<'c> {
    /// Where it is born, or where branches part.
    pub from: &'c CurvePoint,
    /// Where it vanishes, or where branches merge or part.
    pub to: &'c CurvePoint,
}

/// The isolas of which birth and end, or beginning and death, are known to belong together, by forcing.
pub fn lives(curves: &[CurveRow]) -> Vec<Life<'_>> {
    let mut found: Vec<Life<'_>> = Vec::new();
    for (kind, point) in curves.iter().flat_map(CurveRow::events) {
        let is_birth = kind == CriticalKind::Birth.name();
        if !is_birth && kind != CriticalKind::Death.name() {
            continue;
        }
        let Some((other, names)) = other_end(curves, point, is_birth) else { continue };
        let (from, to) = if is_birth { (point, other) } else { (other, point) };
        let is_new = |known: &Life<'_>| !known.from.is_at(from) || !known.to.is_at(to);
        // What begins where branches merge is what ends only if nothing comes off it between.
        let is_one = is_birth || !may_part(curves, from, to);
        let is_disturbed = is_disturbed(curves, &[from, to], &[&names], is_birth);
        if is_one && !is_disturbed && !is_lost(curves, from, to) && found.iter().all(is_new) {
            found.push(Life { from, to });
        }
    }
    found.sort_by(|a, b| a.from.forcing.total_cmp(&b.from.forcing));
    found
}

/// An isola that is not known to end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lasting<'c> {
    /// Where it is born.
    pub from: &'c CurvePoint,
    /// Largest forcing amplitude up to which both of its edges are known.
    pub to: f64,
}

/// The isolas of which a birth is known and no end, where it is sure that both edges up to there are those of an isola, by forcing.
pub fn lasting<'c>(curves: &'c [CurveRow]) -> Vec<Lasting<'c>> {
    let births = curve_events(curves).into_iter().filter(|event| event.kind == CriticalKind::Birth.name());
    // After a run was extended the same curve is followed again, farther: none of those through the birth may tell of an end.
    let known = |birth: CurveEvent<'c>| {
        let all = curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve, point)));
        let same = all.filter(|(_, point)| point.event.as_deref() == Some(birth.kind) && point.is_at(birth.point));
        let known: Vec<Lasting<'_>> =
            same.map(|(curve, point)| known_up_to(curves, curve, point)).collect::<Option<_>>()?;
        known.into_iter().max_by(|a, b| a.to.total_cmp(&b.to)).map(|farthest| Lasting { from: birth.point, ..farthest })
    };
    let mut found: Vec<Lasting<'_>> = births.filter_map(known).collect();
    found.sort_by(|a, b| a.from.forcing.total_cmp(&b.from.forcing));
    found
}

/// Where an edge of what is born at a point comes to a branch point before anything else happens along it, if one does: it may join
/// another branch near there, at a point that is on no fold curve.
pub fn joining<'c>(curves: &'c [CurveRow], birth: &CurvePoint) -> Option<&'c CurvePoint> {
    let of_curve = |curve: &'c CurveRow| {
        let at = curve.points.iter().position(|other| other.event == birth.event && birth.is_at(other))?;
        let (first, last) = curve.status.strip_prefix("open: ")?.split_once(" to ")?;
        let ends = [(false, first, curve.points.first()), (true, last, curve.points.last())];
        let joined = ends.into_iter().find(|(is_onwards, stop, _)| {
            *stop == Stop::Branching.to_string() && edge(curve, at, *is_onwards, true).is_open
        });
        joined.and_then(|(.., end)| end)
    };
    curves.iter().find_map(of_curve)
}

/// How far what is born at a point of a curve is known, if nothing ends it before: to where both edges are followed no farther.
fn known_up_to<'c>(curves: &'c [CurveRow], curve: &CurveRow, from: &'c CurvePoint) -> Option<Lasting<'c>> {
    let at = curve.points.iter().position(|other| std::ptr::eq(other, from))?;
    // At other bounds, and at branch points, it may be no isola any more.
    let bound = Stop::ForcingBound.to_string();
    let (first, last) = curve.status.strip_prefix("open: ")?.split_once(" to ")?;
    if first != bound || last != bound {
        return None;
    }
    let edges = [false, true].map(|is_onwards| edge(curve, at, is_onwards, true));
    let to = edges.iter().map(|edge| edge.farthest).fold(f64::INFINITY, f64::min);
    let is_isola =
        |edge: &Edge<'_>| edge.crossings.iter().all(|crossing| crossing.branch.starts_with(BranchKind::Isola.name()));
    let end = CurvePoint { forcing: to, ..CurvePoint::default() };
    let is_sure = to > from.forcing
        && edges.iter().all(|edge| edge.is_open && is_isola(edge))
        && !is_disturbed(curves, &[from, &end], &[&names(from, true, &edges, to)], true)
        && !is_lost(curves, from, &end);
    is_sure.then_some(Lasting { from, to })
}

/// Whether a curve is lost between two forcing amplitudes: what happens where it goes on may be about anything.
fn is_lost(curves: &[CurveRow], from: &CurvePoint, to: &CurvePoint) -> bool {
    let unfinished = curves.iter().filter(|curve| curve.is_unfinished);
    let mut ends = unfinished.flat_map(|curve| curve.points.first().into_iter().chain(curve.points.last()));
    ends.any(|end| (from.forcing..=to.forcing).contains(&end.forcing))
}

/// Whether a fold curve ends at a branch point between two forcing amplitudes: near there a branch joins another one, or parts from it, at
/// a point that is on no fold curve.
fn may_part(curves: &[CurveRow], from: &CurvePoint, to: &CurvePoint) -> bool {
    let stop = Stop::Branching.to_string();
    let ends = |curve: &CurveRow| {
        let (first, last) = curve.status.strip_prefix("open: ")?.split_once(" to ")?;
        let ends = [(first, curve.points.first()), (last, curve.points.last())];
        let mut joined = ends.into_iter().filter(|(name, _)| *name == stop).filter_map(|(_, end)| end);
        Some(joined.any(|end| from.forcing < end.forcing && end.forcing < to.forcing))
    };
    curves.iter().any(|curve| ends(curve).unwrap_or(false))
}

/// The isolas that begin where branches part, and are there at no level.
pub fn parted_between<'c>(curves: &'c [CurveRow], levels: &[Level]) -> Vec<Life<'c>> {
    let is_missed = |life: &Life<'_>| {
        let is_there = |level: &Level| (life.from.forcing..=life.to.forcing).contains(&level.value);
        life.from.event.as_deref() != Some(CriticalKind::Birth.name()) && !levels.iter().any(is_there)
    };
    lives(curves).into_iter().filter(is_missed).collect()
}

/// Where what is born, or dies, at a point ends, or begins: what comes first along its two edges. At levels between, both have to be
/// those of an isola. With it comes what that is called.
fn other_end<'c>(
    curves: &'c [CurveRow],
    point: &CurvePoint,
    is_birth: bool,
) -> Option<(&'c CurvePoint, Vec<Party<'c>>)> {
    let of_curve = |curve: &'c CurveRow| {
        let at = curve.points.iter().position(|other| std::ptr::eq(other, point))?;
        let edges = [false, true].map(|is_onwards| edge(curve, at, is_onwards, is_birth));
        let sign = if is_birth { 1.0 } else { -1.0 };
        let met = edges.iter().filter_map(|edge| edge.event);
        let first = met.min_by(|a, b| (sign * a.forcing).total_cmp(&(sign * b.forcing)))?;
        // An edge of which nothing is known so far may end before.
        let reaches = |edge: &Edge<'_>| sign * edge.farthest >= sign * first.forcing;
        let is_isola = |edge: &Edge<'_>| {
            let mut between = edge.crossings.iter().filter(|crossing| sign * crossing.forcing < sign * first.forcing);
            between.all(|crossing| crossing.branch.starts_with(BranchKind::Isola.name()))
        };
        let (own, shrinks) = match is_birth {
            true => (CriticalKind::Birth, CriticalKind::Death),
            false => (CriticalKind::Death, CriticalKind::Birth),
        };
        let kind = first.event.as_deref()?;
        // It shrinks to a point where both of its edges do.
        let is_whole = kind != shrinks.name() || edges.iter().all(|edge| edge.event.is_some_and(|to| to.is_at(first)));
        let is_known = kind != own.name() && is_whole && edges.iter().all(|edge| reaches(edge) && is_isola(edge));
        is_known.then(|| (first, names(point, is_birth, &edges, first.forcing)))
    };
    curves.iter().find_map(of_curve)
}

/// What the isola between a birth, or a death, and another forcing amplitude is called: by that, and at the levels that its edges cross
/// before, where both have one name.
fn names<'c>(point: &CurvePoint, is_birth: bool, edges: &[Edge<'c>; 2], to: f64) -> Vec<Party<'c>> {
    let is_before = |crossing: &Crossing| if is_birth { crossing.forcing < to } else { crossing.forcing > to };
    let crossings = || edges.iter().flat_map(|edge| edge.crossings.iter().copied()).filter(|one| is_before(one));
    let is_one = |crossing: &Crossing| {
        crossings().filter(|other| other.amplitude == crossing.amplitude).all(|other| other.branch == crossing.branch)
    };
    let named = crossings().filter(|crossing| is_one(crossing));
    let levels = named.map(|crossing| Party::Branch(&crossing.branch, &crossing.amplitude, crossing.forcing));
    std::iter::once(Party::Isola(point.forcing, !is_birth)).chain(levels).collect()
}

/// An edge of an isola from a birth, or a death, on.
struct Edge<'c> {
    /// The event that it comes to, if that is known.
    event: Option<&'c CurvePoint>,
    /// Whether it goes on to the end of the curve.
    is_open: bool,
    /// The forcing amplitude farthest from where it begins, up to there.
    farthest: f64,
    /// Levels that it crosses up to there.
    crossings: Vec<&'c Crossing>,
}

/// An edge, followed through cusps, where two edges of one branch meet.
fn edge(curve: &CurveRow, start: usize, is_onwards: bool, is_birth: bool) -> Edge<'_> {
    let points = &curve.points;
    let origin = points[start].forcing;
    let (mut i, mut is_rising) = (start, is_birth);
    let mut edge = Edge { event: None, is_open: false, farthest: origin, crossings: Vec::new() };
    for _ in 0..points.len() {
        let Some((segment, j)) = next(curve, i, is_onwards) else {
            edge.is_open = true;
            break;
        };
        let there = points[j].forcing;
        if (there > points[i].forcing) != is_rising {
            match points[i].event.as_deref() {
                Some(event) if event == CriticalKind::Cusp.name() => is_rising = !is_rising,
                Some(event) if event != CriticalKind::Unknown.name() => {
                    edge.event = Some(&points[i]);
                    break;
                }
                _ => break,
            }
        }
        if (there > origin) != is_birth {
            break;
        }
        edge.farthest = if is_birth { edge.farthest.max(there) } else { edge.farthest.min(there) };
        edge.crossings.extend(curve.crossings.iter().filter(|crossing| crossing.segment == segment));
        i = j;
    }
    edge
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[(f64, &str)]) -> CurveRow {
        let point = |(i, &(forcing, event)): (usize, &(f64, &str))| CurvePoint {
            forcing,
            omega: 1.0 + i as f64,
            event: (!event.is_empty()).then(|| event.into()),
            ..CurvePoint::default()
        };
        CurveRow { points: points.iter().enumerate().map(point).collect(), ..CurveRow::default() }
    }

    fn told(curves: &[CurveRow]) -> Vec<(f64, f64)> {
        lives(curves).iter().map(|life| (life.from.forcing, life.to.forcing)).collect()
    }

    #[test]
    fn what_comes_first_along_two_edges() {
        let merges = [(1.0, ""), (4.0, "merge"), (1.5, "birth"), (5.0, "")];
        assert_eq!(told(&[curve(&merges)]), [(1.5, 4.0)]);
        // Its other edge is not known up to there.
        assert_eq!(told(&[curve(&[(1.0, ""), (4.0, "merge"), (1.5, "birth"), (3.0, "")])]), []);
        let both = [(1.0, ""), (4.0, "merge"), (1.5, "birth"), (3.0, "merge"), (1.0, "")];
        assert_eq!(told(&[curve(&both)]), [(1.5, 3.0)]);
        let mut closed = curve(&[(1.0, "birth"), (2.0, ""), (3.0, "death"), (2.0, "")]);
        closed.points.push(CurvePoint { event: None, ..closed.points[0].clone() });
        assert_eq!(told(&[closed]), [(1.0, 3.0)]);
        assert_eq!(told(&[curve(&[(1.0, "birth"), (2.0, "")])]), []);
    }

    #[test]
    fn what_comes_to_no_end() {
        let bounded = |points: &[(f64, &str)]| CurveRow {
            status: "open: forcing bound to forcing bound".into(),
            ..curve(points)
        };
        let told =
            |curves: &[CurveRow]| lasting(curves).iter().map(|one| (one.from.forcing, one.to)).collect::<Vec<_>>();
        let both = bounded(&[(4.0, ""), (1.0, "birth"), (2.0, ""), (3.0, "")]);
        assert_eq!(told(std::slice::from_ref(&both)), [(1.0, 3.0)]);
        // Something else may be its end, or an edge turns or is lost before.
        for event in ["merge", "unknown"] {
            assert_eq!(told(&[both.clone(), curve(&[(9.0, ""), (2.5, event), (9.0, "")])]), []);
        }
        assert_eq!(told(&[bounded(&[(4.0, ""), (1.0, "birth"), (3.0, ""), (2.0, "")])]), []);
        assert_eq!(told(&[bounded(&[(4.0, ""), (1.0, "birth"), (3.0, "merge"), (2.0, "")])]), []);
        assert_eq!(told(&[CurveRow { is_unfinished: true, ..both.clone() }]), []);
        let met = Crossing { segment: 1, forcing: 1.5, branch: "main".into(), ..Crossing::default() };
        assert_eq!(told(&[CurveRow { crossings: vec![met], ..both.clone() }]), []);
        // Elsewhere than at the bound of the forcing it may end as an isola.
        for status in ["open: forcing bound to branch point", "open: frequency bound to forcing bound", "closed"] {
            assert_eq!(told(&[CurveRow { status: status.into(), ..both.clone() }]), []);
        }
        // The same curve, followed again, knows more.
        let farther = bounded(&[(8.0, ""), (1.0, "birth"), (2.0, ""), (6.0, "")]);
        assert_eq!(told(&[both.clone(), farther]), [(1.0, 6.0)]);
        let ends = bounded(&[(8.0, ""), (1.0, "birth"), (6.0, "merge"), (1.5, "")]);
        assert_eq!(told(&[both.clone(), ends.clone()]), []);
        assert_eq!(lives(&[both, ends]).len(), 1);
    }

    #[test]
    fn what_may_join_another_branch() {
        let ends = |status: &str, points: &[(f64, &str)]| {
            let curves = [CurveRow { status: status.into(), ..curve(points) }];
            let birth = curves[0].points.iter().find(|point| point.event.as_deref() == Some("birth")).unwrap();
            joining(&curves, birth).map(|end| end.forcing)
        };
        let points = [(3.0, ""), (2.0, ""), (1.0, "birth"), (2.5, ""), (4.0, "")];
        assert_eq!(ends("open: branch point to forcing bound", &points), Some(3.0));
        assert_eq!(ends("open: forcing bound to branch point", &points), Some(4.0));
        assert_eq!([ends("open: forcing bound to forcing bound", &points), ends("closed", &points)], [None, None]);
        // What happens before is told.
        let merges = [(2.0, ""), (3.0, "merge"), (1.0, "birth"), (4.0, "")];
        assert_eq!(ends("open: branch point to forcing bound", &merges), None);
    }

    #[test]
    fn through_cusps_and_from_deaths() {
        let cusp = [(9.0, ""), (2.378, "merge"), (2.379, "cusp"), (2.1, "birth"), (9.0, "")];
        assert_eq!(told(&[curve(&cusp)]), [(2.1, 2.378)]);
        let parts = [(0.8, ""), (0.74, "merge"), (0.73, "cusp"), (4.2, "death"), (3.0, "merge"), (3.2, "")];
        assert_eq!(told(&[curve(&parts)]), [(3.0, 4.2)]);
        // Two isolas of two curves are told one by one.
        assert_eq!(told(&[curve(&parts), curve(&cusp)]), [(2.1, 2.378), (3.0, 4.2)]);
    }

    #[test]
    fn what_levels_have_is_no_other() {
        let crossing = |segment, forcing, branch: &str| Crossing {
            segment,
            forcing,
            branch: branch.into(),
            ..Crossing::default()
        };
        let with = |crossings: Vec<Crossing>| {
            let merges = curve(&[(1.0, ""), (4.0, "merge"), (1.5, "birth"), (5.0, "")]);
            told(&[CurveRow { crossings, ..merges }]).len()
        };
        assert_eq!(with(vec![crossing(1, 2.0, "isola 1"), crossing(2, 2.0, "isola 1"), crossing(2, 4.5, "main")]), 1);
        // At a level between it is part of something else by now, or still.
        assert_eq!(with(vec![crossing(1, 2.0, "isola 1"), crossing(1, 3.5, "main")]), 0);
        let merges = curve(&[(1.0, ""), (4.0, "merge"), (1.5, "birth"), (5.0, "")]);
        let lost = |end| CurveRow { is_unfinished: true, ..curve(&[(0.5, ""), (end, "")]) };
        assert_eq!(told(&[merges.clone(), lost(3.0)]).len(), 0);
        assert_eq!(told(&[merges, lost(7.0)]).len(), 1);
    }

    #[test]
    fn what_begins_where_branches_merge_may_come_apart() {
        let parts = curve(&[(9.0, ""), (1.0, "merge"), (2.0, "death"), (0.5, "")]);
        let ends_at = |forcing| CurveRow {
            status: "open: forcing bound to branch point".into(),
            ..curve(&[(9.0, ""), (0.5, "birth"), (forcing, "")])
        };
        assert_eq!(told(std::slice::from_ref(&parts)), [(1.0, 2.0)]);
        for (forcing, expected) in [(1.5, 0), (0.9, 1), (2.5, 1)] {
            assert_eq!(told(&[parts.clone(), ends_at(forcing)]).len(), expected, "{forcing}");
        }
        // It is told where no level is.
        let missed = |values: &[f64]| {
            let levels: Vec<Level> = values.iter().map(|value| Level { value: *value, ..Level::default() }).collect();
            parted_between(std::slice::from_ref(&parts), &levels).len()
        };
        assert_eq!([missed(&[0.5, 3.0]), missed(&[0.5, 1.5, 3.0])], [1, 0]);
    }

    #[test]
    fn what_happens_between_may_be_about_it() {
        let merges = curve(&[(1.0, ""), (4.0, "merge"), (1.5, "birth"), (5.0, "")]);
        for (event, forcing, expected) in
            [("merge", 2.0, 0), ("unknown", 2.0, 0), ("merge", 6.0, 1), ("birth", 2.0, 1), ("cusp", 2.0, 1)]
        {
            let other = curve(&[(7.0, ""), (forcing, event), (8.0, "")]);
            let all = [merges.clone(), other];
            let found = told(&all).into_iter().filter(|life| *life == (1.5, 4.0)).count();
            assert_eq!(found, expected, "{event} at {forcing}");
        }
    }

    /// Isolas of two curves that overlap in the forcing are told one by one, where it is known that the one is not the other.
    #[test]
    fn what_others_do_between_is_not_about_it() {
        let crossed = |row: CurveRow, crossings: &[(usize, f64, &str)]| {
            let crossing = |&(segment, forcing, branch): &(usize, f64, &str)| Crossing {
                segment,
                forcing,
                amplitude: forcing.to_string(),
                branch: branch.into(),
            };
            CurveRow { crossings: crossings.iter().map(crossing).collect(), ..row }
        };
        let outer = [(1.0, ""), (4.0, "merge"), (1.5, "birth"), (5.0, "")];
        let inner = [(1.0, ""), (3.0, "merge"), (2.0, "birth"), (3.5, "")];
        // The other one merges with the main branch, or with nobody knows what: with this one, perhaps.
        let told = |main: &[(usize, f64, &str)]| told(&[curve(&outer), crossed(curve(&inner), main)]);
        assert_eq!(told(&[(0, 1.2, "main")]), [(1.5, 4.0), (2.0, 3.0)]);
        assert_eq!(told(&[]), [(2.0, 3.0)]);
        assert_eq!(told(&[(0, 1.2, "isola 1")]), [(1.5, 4.0), (2.0, 3.0)], "it was there before this one was born");
        // At a level between it has a number of its own.
        let level = [(1, 2.5, "isola 1"), (2, 2.5, "isola 1")];
        let beside = |name| {
            let merges = [(2.2, ""), (3.0, "merge"), (2.2, "")];
            let other = crossed(curve(&merges), &[(0, 2.5, name), (1, 2.5, "main")]);
            lives(&[crossed(curve(&outer), &level), other]).len()
        };
        assert_eq!([beside("isola 2"), beside("isola 1"), beside("unfinished 1")], [1, 0, 1]);
        // What parts from the main branch need not be new.
        let parts = crossed(curve(&[(1.0, ""), (3.0, "merge"), (1.0, "")]), &[(0, 1.2, "main"), (1, 1.2, "main")]);
        assert_eq!(lives(&[curve(&outer), parts]).len(), 1);
    }
}
