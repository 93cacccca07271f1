//! What happens along fold curves, in a sentence.

use super::counted::{Counted, counted};
use super::event_words::{BIRTH, DEATH, MERGE};
use super::folds::events_of;
use super::level::Level;
use super::lives::{Lasting, Life, joining, lasting, lives};
use super::merges::{Merge, merges};
use crate::store::{CurvePoint, CurveRow};
use crate::words::digits;
use solver::response::critical::CriticalKind;

/// Events of a kind that the sentence names.
const NAMED: usize = 6;

/// Isolas that it tells from birth to end.
const LIVES: usize = 6;

/// Of merges whose branches are not known, after others: they may be the same branches.
const ALSO: &str = "branches also merge or part";

/// Of merges which the numbers of isolas at the levels tell from partings.
const MERGES: &str = "an isola merges with another branch";

/// Of partings.
const PARTS: &str = "an isola parts from another branch";

/// Of merges and partings of the only isola there is beside the main branch.
const WITH_MAIN: [&str; 2] = ["an isola merges with the main branch", "an isola parts from the main branch"];

/// Of births and ends that are not known to be those of one isola.
const UNRELATED: &str = "which of these belong together is not known";

/// Marks what was not found with twice the harmonics.
const UNKNOWN: &str = "*";

/// What that means.
const UNCONFIRMED: &str =
    "Not confirmed: with twice the harmonics it was not found near there, and may happen at another A or not at all.";

/// Most digits of a forcing amplitude.
const DIGITS: i32 = 5;

/// Fewest digits to which a forcing amplitude and that with twice the harmonics have to agree: fewer are told with both.
const AGREED: i32 = 3;

/// The forcing amplitude of what happens at a point, with `most` digits at most, and no more than those that twice the harmonics
/// leave as they are; where these are too few, that with twice the harmonics as well.
fn forcing_digits(point: &CurvePoint, most: i32) -> (String, Option<String>) {
    let own = |count| digits(point.forcing, count);
    // No more is claimed of what nothing was compared with.
    let Some((doubled, _)) = point.doubled else { return (own(most.min(AGREED + 1)), None) };
    let agreed = (AGREED..=most).rev().map(|count| (own(count), digits(doubled, count))).find(|(a, b)| a == b);
    agreed.map_or_else(|| (own(AGREED + 1), Some(digits(doubled, AGREED + 1))), |(text, _)| (text, None))
}

/// The same for the label of a figure.
pub fn forcing_label(point: &CurvePoint, most: i32) -> String {
    let (own, doubled) = forcing_digits(point, most);
    doubled.map_or_else(|| own.clone(), |doubled| format!("{own} (2H: {doubled})"))
}

/// The doubt about what happens at points, if at any it was not found with twice the harmonics.
pub fn truncation_doubt(points: &[&CurvePoint]) -> &'static str {
    match points.iter().filter(|point| point.doubled.is_none()).count() {
        0 => "",
        unknown if unknown == points.len() => ", not confirmed with twice the harmonics",
        _ => ", not all confirmed with twice the harmonics",
    }
}

/// Where isolas are born and where branches merge, as fold curves say: isola by isola, and which branches, where that is known for
/// sure; from `levels` whether they merge or part, where the curves do not tell.
pub fn events_sentence(curves: &[CurveRow], levels: &[Level], frequency: impl Fn(f64) -> String) -> Option<String> {
    let place = |point: &CurvePoint| {
        let (own, doubled) = forcing_digits(point, DIGITS);
        let mark = if point.doubled.is_none() { UNKNOWN } else { "" };
        let doubled = doubled.map_or_else(String::new, |doubled| format!("{doubled} with twice the harmonics; "));
        format!("{own}{mark} ({doubled}{})", frequency(point.omega))
    };
    let part = |points: &[&CurvePoint], one: &str, many: &str| {
        let verb = if points.len() == 1 { one } else { many };
        let more = points.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let named: Vec<String> = points.iter().take(NAMED).map(|point| place(point)).collect();
        let first = points.first().map(|point| point.forcing)?;
        Some((first, format!("{verb} at A = {}{more}", named.join(", "))))
    };
    let (lives, merged) = (lives(curves), merges(curves));
    let is_told = |point: &CurvePoint| lives.iter().any(|life| life.from.is_at(point) || life.to.is_at(point));
    let [births, deaths] = [CriticalKind::Birth, CriticalKind::Death].map(|kind| events_of(curves, kind.name()));
    let is_doubtful = |point: &&CurvePoint| point.doubled.is_none();
    let is_any_doubtful = births.iter().chain(&deaths).any(is_doubtful) || merged.iter().any(|m| is_doubtful(&m.point));
    let lasting: Vec<Lasting<'_>> = lasting(curves).into_iter().filter(|lasting| !is_told(lasting.from)).collect();
    let lasts = |point: &CurvePoint| lasting.iter().any(|lasting| lasting.from.is_at(point));
    let [births, deaths] = [births, deaths].map(|mut points| {
        points.retain(|point| !is_told(point) && !lasts(point));
        points
    });
    let (joined, births): (Vec<&CurvePoint>, Vec<&CurvePoint>) =
        births.into_iter().partition(|birth| joining(curves, birth).is_some());
    let joins = |birth: &&CurvePoint| Some((birth.forcing, to_branch_point(birth, joining(curves, birth)?, place)));
    let mut told = Vec::new();
    let mut others = Vec::new();
    for merge in merged.iter().filter(|merge| !is_told(merge.point)) {
        match &merge.what {
            Some(what) if told.len() < NAMED => {
                told.push((merge.point.forcing, format!("{what} at A = {}", place(merge.point))));
            }
            _ => others.push(merge.point),
        }
    }
    let of_kind = |kind: Option<Counted>| {
        let is_so = |point: &&CurvePoint| counted(point, levels, curves) == kind;
        others.iter().copied().filter(is_so).collect::<Vec<_>>()
    };
    let [merges_with_main, parts_from_main] = WITH_MAIN;
    let others = [
        (Counted::Merges, MERGES),
        (Counted::MergesWithMain, merges_with_main),
        (Counted::Parts, PARTS),
        (Counted::PartsFromMain, parts_from_main),
    ]
    .map(|(kind, words)| part(&of_kind(Some(kind)), words, words));
    let unknown = of_kind(None);
    let are_others = others.iter().any(Option::is_some) || !unknown.is_empty();
    let are_births = !births.is_empty() || !joined.is_empty();
    let unrelated = [are_births, !deaths.is_empty(), are_others].into_iter().filter(|is| *is).count() > 1;
    let are_known = !told.is_empty() || !lives.is_empty();
    let counted = |point: &CurvePoint| counted(point, levels, curves);
    let whole = lives.iter().take(LIVES).map(|life| (life.from.forcing, in_words(life, &merged, counted, place)));
    let open = lasting.iter().take(NAMED).map(|one| (one.from.forcing, without_end(one, place)));
    let joins = joined.iter().take(NAMED).filter_map(joins);
    let mut parts: Vec<(f64, String)> = (whole.chain(open).chain(joins))
        .chain(part(&births, BIRTH.one, BIRTH.several))
        .chain(part(&deaths, DEATH.one, DEATH.several))
        .chain(told)
        .chain(others.into_iter().flatten())
        .collect();
    // A story is told as the forcing grows.
    parts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let is_first = unknown.first().is_some_and(|point| parts.first().is_none_or(|(first, _)| point.forcing < *first));
    let (one, several) = if are_known && !is_first { (ALSO, ALSO) } else { (MERGE.one, MERGE.several) };
    if let Some(part) = part(&unknown, one, several) {
        parts.insert(parts.partition_point(|(first, _)| *first <= part.0), part);
    }
    let parts: Vec<String> = (parts.into_iter().map(|(_, part)| part))
        .chain(further(lives.len(), LIVES, "is born and ends", "are born and end"))
        .chain(further(lasting.len(), NAMED, "is born and comes to no end", "are born and come to no end"))
        .chain(further(
            joined.len(),
            NAMED,
            "is born and may join another branch",
            "are born and may join other branches",
        ))
        .chain(unrelated.then(|| UNRELATED.into()))
        .collect();
    let doubt = if is_any_doubtful { format!(" ({UNKNOWN} {UNCONFIRMED})") } else { String::new() };
    (!parts.is_empty()).then(|| format!("Computed along fold curves: {}.{doubt}", parts.join("; ")))
}

/// That beside those isolas that are named there are more.
fn further(count: usize, named: usize, one: &str, several: &str) -> Option<String> {
    match count.saturating_sub(named) {
        0 => None,
        1 => Some(format!("1 more isola {one}")),
        more => Some(format!("{more} more isolas {several}")),
    }
}

/// An isola from its birth to where its edges are followed to.
fn without_end(lasting: &Lasting<'_>, place: impl Fn(&CurvePoint) -> String) -> String {
    let (from, to) = (place(lasting.from), digits(lasting.to, DIGITS));
    format!("{} at A = {from}, and its edges, followed up to A = {to}, come to no end", BIRTH.one)
}

/// An isola from its birth to where an edge of it comes to a branch point.
fn to_branch_point(birth: &CurvePoint, end: &CurvePoint, place: impl Fn(&CurvePoint) -> String) -> String {
    // Where it ends was compared with nothing.
    let (from, to) = (place(birth), digits(end.forcing, AGREED + 1));
    format!(
        "{} at A = {from}, and an edge of it comes to a branch point at A = {to}: near there it may join another branch, which is not \
         computed",
        BIRTH.one
    )
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
    let (from, mut to) = (place(life.from), place(life.to));
    // Where digits do not tell them apart.
    if forcing_digits(life.from, DIGITS) == forcing_digits(life.to, DIGITS) {
        to = format!("{to}, {} above", digits(life.to.forcing - life.from.forcing, 2));
    }
    let end = match (merge(life.to), counted(life.to)) {
        (None, _) => format!("it {}", DEATH.verb),
        (Some(merge), counted) => it(merge).unwrap_or_else(|| match counted {
            Some(Counted::MergesWithMain) => "it merges with the main branch".into(),
            Some(Counted::Merges) => "it merges with another branch".into(),
            _ => "it merges or parts".into(),
        }),
    };
    match merge(life.from) {
        None => format!("{} at A = {from} and lasts to A = {to}, where {end}", BIRTH.one),
        Some(merge) => {
            let start = it(merge).unwrap_or_else(|| MERGE.several.into());
            format!("an isola begins at A = {from}, where {start}, and lasts to A = {to}, where {end}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{BranchRow, Crossing};

    #[test]
    fn how_many_are_known_with_twice_the_harmonics() {
        let known = CurvePoint { doubled: Some((1.0, 2.0)), ..CurvePoint::default() };
        let unknown = CurvePoint::default();
        assert_eq!(truncation_doubt(&[&known, &known]), "");
        assert_eq!(truncation_doubt(&[&unknown, &unknown]), ", not confirmed with twice the harmonics");
        assert_eq!(truncation_doubt(&[&known, &unknown]), ", not all confirmed with twice the harmonics");
    }

    #[test]
    fn branches_are_named_where_they_are_known() {
        let point = |(forcing, event): &(f64, &str)| CurvePoint {
            forcing: *forcing,
            omega: 2.0 * forcing,
            amplitude: 1.0,
            event: (!event.is_empty()).then(|| event.to_string()),
            doubled: Some((1.000_01 * forcing, 2.0 * forcing)),
        };
        let curve =
            |points: &[(f64, &str)]| CurveRow { points: points.iter().map(point).collect(), ..CurveRow::default() };
        let crossing =
            |segment, branch: &str| Crossing { segment, forcing: 2.0, amplitude: "2".into(), branch: branch.into() };
        let mut known = curve(&[(1.0, ""), (4.0, "merge"), (1.5, "birth"), (3.0, "")]);
        let say = |curves: &[CurveRow]| events_sentence(curves, &[], |omega| format!("{omega} rad/s"));
        let before = "Computed along fold curves: an isola is born at A = 1.5 (3 rad/s); ";
        let unknown = "two branches merge or part at A = 4 (8 rad/s); which of these belong together is not known.";
        assert_eq!(say(&[known.clone()]).unwrap(), format!("{before}{unknown}"));
        known.crossings = vec![crossing(0, "main"), crossing(1, "isola 1")];
        let told = "isola 1 of A = 2 and the main branch merge at A = 4 (8 rad/s)";
        assert_eq!(say(&[known.clone()]).unwrap(), format!("{before}{told}."));
        let other = curve(&[(1.0, ""), (7.0, "merge"), (1.0, "")]);
        let others = "branches also merge or part at A = 7 (14 rad/s); which of these belong together is not known.";
        assert_eq!(say(&[known, other]).unwrap(), format!("{before}{told}; {others}"));
        assert_eq!(say(&[]), None);
        // Of one that ends nowhere it is told how far it was looked for.
        let status = "open: forcing bound to forcing bound".into();
        let lasting = CurveRow { status, ..curve(&[(6.0, ""), (1.5, "birth"), (3.0, "")]) };
        assert_eq!(
            say(&[lasting]).unwrap(),
            "Computed along fold curves: an isola is born at A = 1.5 (3 rad/s), and its edges, followed up to A = 3, come to no end."
        );
        // A branch that it may join at no fold is not left out.
        let status = "open: branch point to forcing bound".into();
        let joins = CurveRow { status, ..curve(&[(2.0, ""), (1.5, "birth"), (3.0, "")]) };
        assert_eq!(
            say(&[joins]).unwrap(),
            "Computed along fold curves: an isola is born at A = 1.5 (3 rad/s), and an edge of it comes to a branch point at A = 2: near \
             there it may join another branch, which is not computed."
        );
        // One whose other edge is known beyond is told from its birth to its end, and so is what leads to a death.
        let mut whole = curve(&[(1.0, ""), (4.0, "merge"), (1.5, "birth"), (5.0, "")]);
        let lasts =
            "Computed along fold curves: an isola is born at A = 1.5 (3 rad/s) and lasts to A = 4 (8 rad/s), where";
        assert_eq!(say(&[whole.clone()]).unwrap(), format!("{lasts} it merges or parts."));
        whole.crossings = vec![crossing(0, "main"), crossing(1, "isola 1")];
        assert_eq!(say(&[whole.clone()]).unwrap(), format!("{lasts} it merges with the main branch."));
        let dies = curve(&[(5.0, ""), (9.0, "death"), (6.0, "merge"), (7.0, "")]);
        let begins = "an isola begins at A = 6 (12 rad/s), where branches merge or part, and lasts to A = 9 (18 rad/s), where it \
                      dies.";
        let both = say(&[whole.clone(), dies]).unwrap();
        assert!(both.starts_with(lasts) && both.ends_with(begins), "{both}");
        // So short that digits do not tell its end from its birth.
        let brief = say(&[curve(&[(1.0, ""), (1.500_02, "merge"), (1.5, "birth"), (5.0, "")])]).unwrap();
        assert!(brief.contains(" and lasts to A = 1.5 (3.00004 rad/s), 2.0e-5 above, where"), "{brief}");
        // As the forcing grows, whatever kind of thing happens.
        let early = curve(&[(0.9, ""), (0.5, "birth"), (0.8, "")]);
        let late = curve(&[(0.1, ""), (0.2, "merge"), (0.1, ""), (8.0, "merge"), (7.0, "")]);
        let all = say(&[whole, early, late]).unwrap();
        let places: Vec<usize> =
            ["at A = 0.2 (", "at A = 0.5 (", "at A = 1.5 ("].iter().map(|part| all.find(part).expect(&all)).collect();
        assert!(places.is_sorted() && !all.contains(": branches also"), "{all}");
    }

    /// Between a level with an isola and one without there is a merge, whatever else is known of it.
    #[test]
    fn levels_tell_merges_from_partings() {
        let row = |kind: &str| BranchRow { kind: kind.into(), closed: kind == "isola", ..BranchRow::default() };
        let level = |value, kinds: &[&str]| Level {
            value,
            branches: kinds.iter().map(|kind| row(kind)).collect(),
            ..Level::default()
        };
        let (one, none) = (["main", "isola"], ["main"]);
        let point = CurvePoint { forcing: 3.0, omega: 1.0, event: Some("merge".into()), ..CurvePoint::default() };
        let curves = [CurveRow { points: vec![point], ..CurveRow::default() }];
        let said = |kinds: [&[&str]; 2]| {
            let levels = [level(2.0, kinds[0]), level(4.0, kinds[1])];
            events_sentence(&curves, &levels, |omega| omega.to_string()).unwrap()
        };
        assert!(said([&one, &none]).contains(": an isola merges with the main branch at A = 3"));
        assert!(said([&none, &one]).contains(": an isola parts from the main branch at A = 3"));
        // Two isolas may merge with each other.
        let two: &[&str] = &["main", "isola", "isola"];
        assert!(said([two, &one]).contains(": an isola merges with another branch at A = 3"));
        assert!(said([&one, two]).contains(": an isola parts from another branch at A = 3"));
        assert!(said([&one, &one]).contains(": two branches merge or part at A = 3"));
    }

    #[test]
    fn a_forcing_has_the_digits_that_twice_the_harmonics_leave() {
        let text = |forcing, doubled: Option<f64>| {
            let doubled = doubled.map(|doubled| (doubled, 1.0));
            forcing_label(&CurvePoint { forcing, doubled, ..CurvePoint::default() }, 5)
        };
        // What nothing was compared with is told with no more than what was compared and does not agree.
        assert_eq!(text(5.13781, None), "5.138");
        assert_eq!(text(5.13781, Some(5.13779)), "5.1378");
        assert_eq!(text(5.13781, Some(5.1362)), "5.14");
        assert_eq!(text(5.13781, Some(4.85491)), "5.138 (2H: 4.855)");
    }

    #[test]
    fn what_twice_the_harmonics_change_or_do_not_have_is_said() {
        let point = |forcing, doubled: Option<f64>| CurvePoint {
            forcing,
            omega: forcing,
            event: Some("birth".into()),
            doubled: doubled.map(|doubled| (doubled, 1.0)),
            ..CurvePoint::default()
        };
        let said = |second| {
            let curve = CurveRow { points: vec![point(2.0, Some(2.1)), point(3.0, second)], ..CurveRow::default() };
            events_sentence(&[curve], &[], |omega| omega.to_string()).unwrap()
        };
        let first = "Computed along fold curves: isolas are born at A = 2 (2.1 with twice the harmonics; 2)";
        assert_eq!(said(Some(3.0)), format!("{first}, 3 (3)."));
        assert_eq!(said(None), format!("{first}, 3* (3). (* {UNCONFIRMED})"));
    }
}
