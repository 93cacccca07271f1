//! What becomes of an isola along fold curves, one story each: in words, and which of many are told.

use super::counted::Counted;
use super::event_words::{BIRTH, DEATH, MERGE};
use super::forcing_digits::{AGREED, DIGITS, forcing_digits};
use super::level::Level;
use super::lives::{Lasting, Life};
use super::merges::Merge;
use super::parties::Party;
use crate::store::CurvePoint;
use crate::words::digits;

/// Stories that are told at most.
const TOLD: usize = 8;

/// Of what happens beyond the levels alone so much is told at most, of each kind.
const BEYOND: usize = 3;

/// What kind of story: what is said of those that are not told, of one and of several.
type More = [&'static str; 2];

const LIVE: More = ["isola is born and ends", "isolas are born and end"];
const LAST: More = ["isola is born and comes to no end", "isolas are born and come to no end"];
const JOIN: More = ["isola is born and may join another branch", "isolas are born and may join other branches"];
const TOUCH: More = ["place where known branches merge or part", "places where known branches merge or part"];

/// What becomes of an isola, or what known branches do.
pub(super) struct Story {
    /// The forcing amplitudes that it is about.
    range: (f64, f64),
    /// In words.
    text: String,
    more: More,
}

impl Story {
    /// From its birth to its end, or from where branches part to its death.
    fn life(
        life: &Life<'_>,
        merged: &[Merge<'_>],
        counted: impl Fn(&CurvePoint) -> Option<Counted>,
        place: impl Fn(&CurvePoint) -> String,
    ) -> Self {
        let range = (life.from.forcing, life.to.forcing);
        Self { range, text: in_words(life, merged, counted, place), more: LIVE }
    }

    /// From their births to where two isolas merge with each other.
    fn twins(lives: [&Life<'_>; 2], merged: &[Merge<'_>], place: impl Fn(&CurvePoint) -> String) -> Self {
        let [first, second] = lives;
        let what = merged.iter().find(|merge| merge.point.is_at(first.to)).and_then(|merge| merge.what.clone());
        let ends =
            what.filter(|what| !what.contains(BIRTH.verb)).unwrap_or_else(|| "they merge with each other".into());
        let latest = if first.from.forcing > second.from.forcing { first.from } else { second.from };
        let to = end_of(latest, first.to, &place);
        let is_any = [first.from, second.from].iter().any(|from| is_reversed(from, first.to));
        let [one, other] = [first.from, second.from].map(place);
        let text = format!(
            "{} at A = {one} and A = {other} and last to {to}, where {ends}{}",
            BIRTH.several,
            reversed(is_any, "one of these")
        );
        Self { range: (first.from.forcing.min(second.from.forcing), first.to.forcing), text, more: LIVE }
    }

    /// From its birth to where its edges are followed to.
    pub(super) fn lasting(lasting: &Lasting<'_>, place: impl Fn(&CurvePoint) -> String) -> Self {
        let (from, to) = (place(lasting.from), digits(lasting.to, DIGITS));
        let text = format!("{} at A = {from}, and its edges, followed up to A = {to}, come to no end", BIRTH.one);
        Self { range: (lasting.from.forcing, lasting.to), text, more: LAST }
    }

    /// From its birth to where an edge of it comes to a branch point.
    pub(super) fn joining(birth: &CurvePoint, end: &CurvePoint, place: impl Fn(&CurvePoint) -> String) -> Self {
        // Where it ends was compared with nothing.
        let (from, to) = (place(birth), digits(end.forcing, AGREED + 1));
        let text = format!(
            "{} at A = {from}, and an edge of it comes to a branch point at A = {to}: near there it may join another branch, which is \
             not computed",
            BIRTH.one
        );
        Self { range: (birth.forcing, end.forcing), text, more: JOIN }
    }

    /// What known branches do at a point.
    pub(super) fn touching(point: &CurvePoint, what: &str, place: impl Fn(&CurvePoint) -> String) -> Self {
        let text = format!("{what} at A = {}", place(point));
        Self { range: (point.forcing, point.forcing), text, more: TOUCH }
    }
}

/// What becomes of isolas of which both ends are known; of two that merge with each other at once.
pub(super) fn of_lives(
    lives: &[Life<'_>],
    merged: &[Merge<'_>],
    counted: impl Fn(&CurvePoint) -> Option<Counted> + Copy,
    place: impl Fn(&CurvePoint) -> String + Copy,
) -> Vec<Story> {
    let is_born = |life: &Life<'_>| life.from.event.as_deref() == Some(BIRTH.kind.name());
    let are_twins = |one: &Life<'_>, other: &Life<'_>| is_born(one) && is_born(other) && one.to.is_at(other.to);
    let story = |(i, life): (usize, &Life<'_>)| {
        if lives[..i].iter().any(|other| are_twins(life, other)) {
            return None;
        }
        Some(match lives[i + 1..].iter().find(|other| are_twins(life, other)) {
            Some(other) => Story::twins([life, other], merged, place),
            None => Story::life(life, merged, counted, place),
        })
    };
    lives.iter().enumerate().filter_map(story).collect()
}

/// Those that are told, each with the forcing amplitude at which it begins, and what is said of the others: those among the levels come
/// before those beyond.
pub(super) fn told(stories: Vec<Story>, levels: &[Level]) -> (Vec<(f64, String)>, Vec<String>) {
    let begins = |story: &Story| (story.more != TOUCH).then_some(story.range.0);
    let (stories, left) = nearest(stories, TOLD, levels, |story| story.range, begins);
    let number = |more: More| left.iter().filter(|story| story.more == more).count();
    let further = [LIVE, LAST, JOIN, TOUCH].map(|more| match number(more) {
        0 => None,
        1 => Some(format!("1 more {}", more[0])),
        several => Some(format!("{several} more {}", more[1])),
    });
    (stories.into_iter().map(|story| (story.range.0, story.text)).collect(), further.into_iter().flatten().collect())
}

/// Those of things that happen over these ranges of the forcing that are told, at most so many, and the others: the first of those with
/// which, as `begins` says, something begins; else what happens among the levels comes first, then a little of what is nearest to them.
pub(super) fn nearest<T>(
    things: Vec<T>,
    most: usize,
    levels: &[Level],
    range: impl Fn(&T) -> (f64, f64),
    begins: impl Fn(&T) -> Option<f64>,
) -> (Vec<T>, Vec<T>) {
    let values = || levels.iter().map(|level| level.value);
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    // By how many times beyond the levels.
    let beyond = |thing: &T| match range(thing) {
        _ if levels.is_empty() => 1.0,
        (_, to) if to < low => low / to,
        (from, _) => (from / high).max(1.0),
    };
    let mut sorted: Vec<(f64, T)> = things.into_iter().map(|thing| (beyond(&thing), thing)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(range(&a.1).0.total_cmp(&range(&b.1).0)));
    let among = sorted.iter().filter(|(beyond, _)| *beyond <= 1.0).count();
    let mut left = sorted.split_off(sorted.len().min(most).min(among + BEYOND));
    let begins = |(_, thing): &(f64, T)| begins(thing).unwrap_or(f64::INFINITY);
    let told = sorted.iter().map(begins).fold(f64::INFINITY, f64::min);
    let earlier = (0..left.len()).filter(|&i| begins(&left[i]) < told);
    let first = earlier.min_by(|&a, &b| begins(&left[a]).total_cmp(&begins(&left[b])));
    if let Some(first) = first {
        let first = left.remove(first);
        left.extend((sorted.len() == most).then(|| sorted.pop()).flatten());
        sorted.push(first);
    }
    let without = |list: Vec<(f64, T)>| list.into_iter().map(|(_, thing)| thing).collect();
    (without(sorted), without(left))
}

/// Where an isola ends, `A = 2 (3 rad/s)`; how far above its beginning, where digits do not tell them apart, or have them the other way
/// round.
fn end_of(from: &CurvePoint, to: &CurvePoint, place: impl Fn(&CurvePoint) -> String) -> String {
    let value = |point: &CurvePoint| forcing_digits(point, DIGITS).0.parse::<f64>().unwrap_or(f64::NAN);
    let told = place(to);
    match value(from) < value(to) {
        true => format!("A = {told}"),
        false => format!("A = {told}, {} above", digits(to.forcing - from.forcing, 2)),
    }
}

/// Whether twice the harmonics would have an isola end before it begins.
fn is_reversed(from: &CurvePoint, to: &CurvePoint) -> bool {
    from.doubled.zip(to.doubled).is_some_and(|((from, _), (to, _))| from > to)
}

/// What is said of it then; `which`: what it is called.
fn reversed(is_so: bool, which: &str) -> String {
    let what = "would end before it begins: at least one of the two is something else there";
    if is_so { format!(" (with twice the harmonics {which} {what})") } else { String::new() }
}

/// An isola from its birth to its end.
fn in_words(
    life: &Life<'_>,
    merged: &[Merge<'_>],
    counted: impl Fn(&CurvePoint) -> Option<Counted>,
    place: impl Fn(&CurvePoint) -> String,
) -> String {
    let merge = |point: &CurvePoint| merged.iter().find(|merge| merge.point.is_at(point));
    // That isola is this one.
    let it =
        |merge: &Merge<'_>| merge.of_isola.as_ref().map(|does| format!("it {does}")).or_else(|| merge.what.clone());
    let (from, to) = (place(life.from), end_of(life.from, life.to, &place));
    let reversed = reversed(is_reversed(life.from, life.to), "it");
    let is_end = |merge: &Merge<'_>| {
        let is_counted = matches!(counted(life.to), Some(Counted::MergesWithMain | Counted::Merges));
        life.is_with_main || is_counted || it(merge).is_some()
    };
    // Where something may part from it, it goes on.
    let may_go_on = merge(life.to).is_some_and(|merge| !is_end(merge));
    if may_go_on {
        let begins = match merge(life.from) {
            None => format!("{} at A = {from}", BIRTH.one),
            Some(_) => format!("an isola begins at A = {from}"),
        };
        return format!("{begins}; at {to} it merges or parts, and may go on{reversed}");
    }
    let end = match (merge(life.to), counted(life.to)) {
        (None, _) => format!("it {}", DEATH.verb),
        (Some(merge), counted) => it(merge).unwrap_or_else(|| match counted {
            _ if life.is_with_main => "it merges with the main branch".into(),
            Some(Counted::MergesWithMain) => "it merges with the main branch".into(),
            Some(Counted::Merges) => "it merges with another branch".into(),
            _ => "it merges or parts".into(),
        }),
    };
    match merge(life.from) {
        None => format!("{} at A = {from} and lasts to {to}, where {end}{reversed}", BIRTH.one),
        Some(merge) => {
            let start = it(merge).unwrap_or_else(|| match life.is_with_main {
                true => "it parts from the main branch".into(),
                false => MERGE.several.into(),
            });
            // What parts there may be named by where this one ends.
            let own = Party::Isola(life.to.forcing, true).name();
            let start = start.replace(&own, "it");
            format!("an isola begins at A = {from}, where {start}, and lasts to {to}, where {end}{reversed}")
        }
    }
}
