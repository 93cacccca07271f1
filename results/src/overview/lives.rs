//! From which forcing amplitude to which an isola is there, where a fold curve tells it for sure.

#[cfg(test)]
mod tests;

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
    /// Whether it is the main branch that it merges with, or parts from: its other edge is an edge of that at the next level.
    pub is_with_main: bool,
}

/// The isolas of which birth and end, or beginning and death, are known to belong together, by forcing.
pub fn lives(curves: &[CurveRow]) -> Vec<Life<'_>> {
    let mut found: Vec<Life<'_>> = Vec::new();
    for (kind, point) in curves.iter().flat_map(CurveRow::events) {
        let is_birth = kind == CriticalKind::Birth.name();
        if !is_birth && kind != CriticalKind::Death.name() {
            continue;
        }
        let Some(End { point: other, names, is_with_main }) = other_end(curves, point, is_birth) else { continue };
        let (from, to) = if is_birth { (point, other) } else { (other, point) };
        let is_new = |known: &Life<'_>| !known.from.is_at(from) || !known.to.is_at(to);
        // What begins where branches merge is what ends only if nothing comes off it between.
        let is_one = is_birth || !may_part(curves, from, to);
        let is_disturbed = is_disturbed(curves, &[from, to], &[&names], is_birth);
        if is_one && !is_disturbed && !is_lost(curves, from, to) && found.iter().all(is_new) {
            found.push(Life { from, to, is_with_main });
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

/// Whether an isola of a level, by name, is born between a forcing amplitude and that of the level, or, above the level, dies there: beyond it is
/// something else that has its folds.
pub(super) fn is_within_its_life(curves: &[CurveRow], name: &str, level: (&str, f64), forcing: f64) -> bool {
    let (amplitude, value) = level;
    let is_birth = forcing < value;
    let kind = if is_birth { CriticalKind::Birth } else { CriticalKind::Death };
    let between = |point: &CurvePoint| (forcing.min(value)..=forcing.max(value)).contains(&point.forcing);
    let is_own = |curve: &CurveRow, at: usize| {
        let firsts = [false, true].map(|is_onwards| edge(curve, at, is_onwards, is_birth).crossings.first().copied());
        let mut firsts = firsts.into_iter().flatten().peekable();
        // An edge that is lost on the way says nothing.
        firsts.peek().is_some() && firsts.all(|first| first.amplitude == amplitude && first.branch == name)
    };
    let of_curve = |curve: &CurveRow| {
        let ends = curve.points.iter().enumerate();
        let mut ends = ends.filter(|(_, point)| point.event.as_deref() == Some(kind.name()) && between(point));
        ends.any(|(at, _)| is_own(curve, at))
    };
    !curves.iter().any(of_curve)
}

/// Frequencies (rad/s) and amplitudes (m) of the folds of what is born, or dies, at a point, where its edges first come to a forcing
/// amplitude.
pub(super) fn folds_at(curves: &[CurveRow], point: &CurvePoint, forcing: f64) -> Vec<(f64, f64)> {
    let is_birth = point.event.as_deref() != Some(CriticalKind::Death.name());
    let of_curve = |curve: &CurveRow| {
        let at = curve.points.iter().position(|other| other.event == point.event && point.is_at(other))?;
        let fold = |is_onwards: bool| {
            let edge = edge(curve, at, is_onwards, is_birth);
            let passes = |pair: &&[&CurvePoint]| {
                pair[0].forcing != pair[1].forcing && (pair[0].forcing - forcing) * (pair[1].forcing - forcing) <= 0.0
            };
            let pair = edge.path.windows(2).find(passes)?;
            let share = (forcing - pair[0].forcing) / (pair[1].forcing - pair[0].forcing);
            let between = |of: fn(&CurvePoint) -> f64| of(pair[0]) + share * (of(pair[1]) - of(pair[0]));
            Some((between(|point| point.omega), between(|point| point.amplitude)))
        };
        Some([false, true].into_iter().filter_map(fold).collect::<Vec<_>>())
    };
    curves.iter().find_map(of_curve).unwrap_or_default()
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

/// Where an isola ends, or begins.
struct End<'c> {
    point: &'c CurvePoint,
    /// What it is called up to there.
    names: Vec<Party<'c>>,
    is_with_main: bool,
}

/// Where what is born, or dies, at a point ends, or begins: what comes first along its two edges. At levels between, both have to be
/// those of an isola.
fn other_end<'c>(curves: &'c [CurveRow], point: &CurvePoint, is_birth: bool) -> Option<End<'c>> {
    let of_curve = |curve: &'c CurveRow| {
        let at = curve.points.iter().position(|other| std::ptr::eq(other, point))?;
        let edges = [false, true].map(|is_onwards| edge(curve, at, is_onwards, is_birth));
        let sign = if is_birth { 1.0 } else { -1.0 };
        let met = edges.iter().filter_map(|edge| edge.event);
        let first = met.min_by(|a, b| (sign * a.forcing).total_cmp(&(sign * b.forcing)))?;
        // An edge of which nothing is known so far may end before.
        let reaches = |edge: &Edge<'_>| sign * edge.farthest >= sign * first.forcing;
        let is_isola = |edge: &Edge<'_>| {
            let mut between = edge.crossings_before(first.forcing, is_birth);
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
        is_known.then(|| End {
            point: first,
            names: names(point, is_birth, &edges, first.forcing),
            is_with_main: is_with_main(curves, &edges, first, is_birth),
        })
    };
    curves.iter().find_map(of_curve)
}

/// Whether what an isola has become part of where one of its edges ends, or was part of before, is the main branch: that has the other edge
/// at the next level, and nothing else happens up to there.
fn is_with_main(curves: &[CurveRow], edges: &[Edge<'_>; 2], end: &CurvePoint, is_birth: bool) -> bool {
    let is_beyond = |forcing: f64| if is_birth { forcing > end.forcing } else { forcing < end.forcing };
    let goes_on = edges.iter().filter(|edge| edge.event.is_none_or(|event| is_beyond(event.forcing)));
    let mut next = goes_on.filter_map(|edge| edge.crossings.iter().find(|crossing| is_beyond(crossing.forcing)));
    next.any(|crossing| {
        let level = CurvePoint { forcing: crossing.forcing, ..CurvePoint::default() };
        let [low, high] = if is_birth { [end, &level] } else { [&level, end] };
        // Whatever happens between may be about it.
        crossing.branch == BranchKind::Main.name()
            && !is_disturbed(curves, &[end, &level], &[&[]], is_birth)
            && !is_lost(curves, low, high)
    })
}

/// What the isola between a birth, or a death, and another forcing amplitude is called: by that, and at the levels that its edges cross
/// before, where both have one name.
fn names<'c>(point: &CurvePoint, is_birth: bool, edges: &[Edge<'c>; 2], to: f64) -> Vec<Party<'c>> {
    let crossings = || edges.iter().flat_map(|edge| edge.crossings_before(to, is_birth));
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
    /// Levels that it crosses up to there, in their order.
    crossings: Vec<&'c Crossing>,
    /// Its points, with the one that it begins with.
    path: Vec<&'c CurvePoint>,
}

impl<'c> Edge<'c> {
    /// The levels that it crosses before it first comes to a forcing amplitude: beyond, it may turn back at a cusp, as that of another
    /// branch.
    fn crossings_before(&self, to: f64, is_birth: bool) -> impl Iterator<Item = &'c Crossing> {
        let is_before =
            move |crossing: &&Crossing| if is_birth { crossing.forcing < to } else { crossing.forcing > to };
        self.crossings.iter().copied().take_while(is_before)
    }
}

/// An edge, followed through cusps, where two edges of one branch meet.
fn edge(curve: &CurveRow, start: usize, is_onwards: bool, is_birth: bool) -> Edge<'_> {
    let points = &curve.points;
    let origin = points[start].forcing;
    let (mut i, mut is_rising) = (start, is_birth);
    let path = vec![&points[start]];
    let mut edge = Edge { event: None, is_open: false, farthest: origin, crossings: Vec::new(), path };
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
        let mut crossed: Vec<&Crossing> =
            curve.crossings.iter().filter(|crossing| crossing.segment == segment).collect();
        let here = points[i].forcing;
        crossed.sort_by(|a, b| (a.forcing - here).abs().total_cmp(&(b.forcing - here).abs()));
        edge.crossings.extend(crossed);
        edge.path.push(&points[j]);
        i = j;
    }
    edge
}
