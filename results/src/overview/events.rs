//! What happens along fold curves, in a sentence.

use super::counted::{Counted, counted};
use super::event_words::{BIRTH, DEATH, MERGE};
use super::folds::events_of;
use super::forcing_digits::{DIGITS, forcing_digits};
use super::level::Level;
use super::lives::{Lasting, joining, lasting, lives};
use super::merges::{Merge, merges};
use super::stories::{Story, nearest, of_lives, told};
use crate::store::{CurvePoint, CurveRow};
use crate::words::capitalised;
use solver::response::critical::CriticalKind;

/// Events of a kind that the sentence names.
const NAMED: usize = 6;

/// How what is told begins.
const COMPUTED: &str = "Computed along fold curves";

/// What stands in the place of many.
const BELOW: &str = "What fold curves have of births, merges and ends stands below, one by one.";

/// As many after the first are too many for a sentence.
const FEW: usize = 2;

/// What follows where not all is told.
const ALL: &str = " (all of it is in events.csv)";

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
const UNCONFIRMED: &str = "Not confirmed: with twice the harmonics it was not found near there, and may happen at another A or not at all; \
     set harmonics.count to twice as many to see.";

/// What happens along fold curves, in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Events {
    /// Isola by isola.
    parts: Vec<String>,
    /// Whether nothing is left out.
    is_all: bool,
    /// Whether something was not found with twice the harmonics.
    is_any_doubtful: bool,
}

impl Events {
    /// All of it as a sentence.
    pub fn sentence(&self) -> String {
        format!("{COMPUTED}: {}{}.{}", self.parts.join("; "), self.all(), self.doubt())
    }

    /// The same as sentences, one for each isola, if there are too many for one; what stands in their place.
    pub fn sentences(&self) -> Option<(&'static str, Vec<String>)> {
        let (first, others) = self.parts.split_first().filter(|(_, others)| others.len() >= FEW)?;
        let one = std::iter::once(format!("{COMPUTED}: {first}."));
        let others = others.iter().map(|part| format!("{}.", capitalised(part)));
        let all = (!self.is_all).then(|| "All of it is in events.csv.".to_string());
        let doubt = self.is_any_doubtful.then(|| format!("{UNKNOWN} {UNCONFIRMED}"));
        Some((BELOW, one.chain(others).chain(all).chain(doubt).collect()))
    }

    fn all(&self) -> &'static str {
        if self.is_all { "" } else { ALL }
    }

    fn doubt(&self) -> String {
        if self.is_any_doubtful { format!(" ({UNKNOWN} {UNCONFIRMED})") } else { String::new() }
    }
}

/// Where isolas are born and where branches merge, as fold curves say: isola by isola, and which branches, where that is known for
/// sure; if `is_whole`, from the levels whether they merge or part, where the curves do not tell. Of many those among the levels come first.
pub fn events(
    curves: &[CurveRow],
    levels: &[Level],
    is_whole: bool,
    frequency: impl Fn(f64) -> String,
) -> Option<Events> {
    let place = |point: &CurvePoint| {
        let (own, doubled) = forcing_digits(point, DIGITS);
        let mark = if point.doubled.is_none() { UNKNOWN } else { "" };
        let doubled = doubled.map_or_else(String::new, |doubled| format!("{doubled} with twice the harmonics; "));
        format!("{own}{mark} ({doubled}{})", frequency(point.omega))
    };
    let part = |points: &[&CurvePoint], one: &str, many: &str| group(points, levels, [one, many], place);
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
    let joins = |birth: &&CurvePoint| Some(Story::joining(birth, joining(curves, birth)?, place));
    let counted = |point: &CurvePoint| if is_whole { counted(point, levels, curves) } else { None };
    let touching = merged.iter().filter(|merge| !is_told(merge.point));
    let touch = |merge: &Merge<'_>| Some(Story::touching(merge.point, merge.what.as_ref()?, place));
    let stories: Vec<Story> = (of_lives(&lives, &merged, counted, place).into_iter())
        .chain(lasting.iter().map(|one| Story::lasting(one, place)))
        .chain(joined.iter().filter_map(joins))
        .chain(touching.clone().filter_map(touch))
        .collect();
    let others: Vec<&CurvePoint> = touching.filter(|merge| merge.what.is_none()).map(|merge| merge.point).collect();
    let of_kind = |kind: Option<Counted>| {
        let is_so = |point: &&CurvePoint| counted(point) == kind;
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
    let are_known = stories.len() > joined.len() + lasting.len();
    let (whole, further) = told(stories, levels);
    let mut parts: Vec<Part> = (whole.into_iter().map(|(first, text)| Part { first, text, is_all: true }))
        .chain(part(&births, BIRTH.one, BIRTH.several))
        .chain(part(&deaths, DEATH.one, DEATH.several))
        .chain(others.into_iter().flatten())
        .collect();
    // A story is told as the forcing grows.
    parts.sort_by(|a, b| a.first.total_cmp(&b.first));
    let is_first = unknown.first().is_some_and(|point| parts.first().is_none_or(|part| point.forcing < part.first));
    let (one, several) = if are_known && !is_first { (ALSO, ALSO) } else { (MERGE.one, MERGE.several) };
    if let Some(part) = part(&unknown, one, several) {
        parts.insert(parts.partition_point(|other| other.first <= part.first), part);
    }
    let is_all = further.is_empty() && parts.iter().all(|part| part.is_all);
    let parts: Vec<String> =
        (parts.into_iter().map(|part| part.text)).chain(further).chain(unrelated.then(|| UNRELATED.into())).collect();
    (!parts.is_empty()).then_some(Events { parts, is_all, is_any_doubtful })
}

/// A part of the sentence.
struct Part {
    /// Forcing amplitude at which it begins.
    first: f64,
    text: String,
    /// Whether it leaves nothing out.
    is_all: bool,
}

/// What happens at several points, of one or of several of them: some are named, those among the levels first.
fn group(
    points: &[&CurvePoint],
    levels: &[Level],
    [one, many]: [&str; 2],
    place: impl Fn(&CurvePoint) -> String,
) -> Option<Part> {
    let (mut named, left) =
        nearest(points.to_vec(), NAMED, levels, |point| (point.forcing, point.forcing), |point| Some(point.forcing));
    named.sort_by(|a, b| a.forcing.total_cmp(&b.forcing));
    let first = named.first()?.forcing;
    let more = left.len();
    let verb = if points.len() == 1 { one } else { many };
    let places: Vec<String> = named.into_iter().map(place).collect();
    let left_out = if more > 0 { format!(" and {more} more") } else { String::new() };
    Some(Part { first, text: format!("{verb} at A = {}{left_out}", places.join(", ")), is_all: more == 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sentence_of(
        curves: &[CurveRow],
        levels: &[Level],
        is_whole: bool,
        frequency: impl Fn(f64) -> String,
    ) -> Option<String> {
        events(curves, levels, is_whole, frequency).map(|events| events.sentence())
    }
    use crate::store::{BranchRow, Crossing};

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
        let say = |curves: &[CurveRow]| sentence_of(curves, &[], true, |omega| format!("{omega} rad/s"));
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
        // Where something may part from it, it goes on.
        let known = "Computed along fold curves: an isola is born at A = 1.5 (3 rad/s); at A = 4 (8 rad/s) it merges or parts, and may go on.";
        assert_eq!(say(&[whole.clone()]).unwrap(), known);
        whole.crossings = vec![crossing(0, "main"), crossing(1, "isola 1")];
        assert_eq!(say(&[whole.clone()]).unwrap(), format!("{lasts} it merges with the main branch."));
        let dies = curve(&[(5.0, ""), (9.0, "death"), (6.0, "merge"), (7.0, "")]);
        let begins = "an isola begins at A = 6 (12 rad/s), where branches merge or part, and lasts to A = 9 (18 rad/s), where it \
                      dies.";
        let both = say(&[whole.clone(), dies]).unwrap();
        assert!(both.starts_with(lasts) && both.ends_with(begins), "{both}");
        // Two that merge with each other are told at once.
        let twins = [
            [(1.0, ""), (4.0, "merge"), (1.5, "birth"), (5.0, "")],
            [(1.0, ""), (4.0, "merge"), (2.5, "birth"), (5.0, "")],
        ];
        let told = say(&twins.map(|points| curve(&points))).unwrap();
        let end = "isolas are born at A = 1.5 (3 rad/s) and A = 2.5 (5 rad/s) and last to A = 4 (8 rad/s), where they merge with each other.";
        assert_eq!(told, format!("Computed along fold curves: {end}"));
        // So short that digits do not tell its end from its birth.
        let brief = say(&[curve(&[(1.0, ""), (1.500_02, "merge"), (1.5, "birth"), (5.0, "")])]).unwrap();
        assert!(brief.contains("; at A = 1.5 (3.00004 rad/s), 2.0e-5 above it merges or parts, and may"), "{brief}");
        // One that digits would have end before it begins, and one that twice the harmonics have.
        let mut close = curve(&[(1.0, ""), (1.139_22, "merge"), (1.138_75, "birth"), (5.0, "")]);
        close.points[2].doubled = Some((1.1399, 2.0));
        let said = say(&[close.clone()]).unwrap();
        assert!(
            said.contains(
                "is born at A = 1.14 (2.2775 rad/s); at A = 1.1392 (2.27844 rad/s), 0.00047 above it merges or"
            ),
            "{said}"
        );
        assert!(said.ends_with("(with twice the harmonics it would end before it begins: at least one of the two is something else there)."), "{said}");
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
            sentence_of(&curves, &levels, true, |omega| omega.to_string()).unwrap()
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
            sentence_of(&[curve], &[], true, |omega| omega.to_string()).unwrap()
        };
        let first = "Computed along fold curves: isolas are born at A = 2 (2.1 with twice the harmonics; 2)";
        assert_eq!(said(Some(3.0)), format!("{first}, 3 (3)."));
        assert_eq!(said(None), format!("{first}, 3* (3). (* {UNCONFIRMED})"));
    }

    /// Of many isolas each has a sentence of its own, where there is room.
    #[test]
    fn many_isolas_are_told_one_by_one() {
        let told = |parts: &[&str]| {
            let parts = parts.iter().map(ToString::to_string).collect();
            Events { parts, is_all: false, is_any_doubtful: false }.sentences()
        };
        assert_eq!(told(&["one is", "two is"]), None);
        let (_, sentences) = told(&["one is", "two is", "three is"]).unwrap();
        assert_eq!(
            sentences,
            ["Computed along fold curves: one is.", "Two is.", "Three is.", "All of it is in events.csv."]
        );
    }

    /// However much happens beyond the levels, what happens among them is told, and the sentence stays readable.
    #[test]
    fn of_very_much_what_happens_among_the_levels_is_told() {
        let level = |value| Level { value, ..Level::default() };
        let levels = [100.0, 200.0].map(level);
        let event = |forcing: f64, kind: &str| CurvePoint {
            forcing,
            omega: forcing,
            event: (!kind.is_empty()).then(|| kind.to_string()),
            doubled: Some((forcing, forcing)),
            ..CurvePoint::default()
        };
        // Thirty isolas that are born and end one after the other, below the levels, and one among them.
        let isola = |from: f64| {
            let points = vec![event(from, ""), event(from + 0.5, "merge"), event(from, "birth"), event(from + 0.6, "")];
            CurveRow { points, ..CurveRow::default() }
        };
        let curves: Vec<CurveRow> = (1..=30).map(f64::from).chain([150.0]).map(isola).collect();
        let said = sentence_of(&curves, &levels, true, |omega| omega.to_string()).unwrap();
        assert_eq!(said.matches("an isola is born at A = ").count(), 5, "{said}");
        // From which forcing on there are isolas is told however far that is.
        assert!(said.contains("an isola is born at A = 1 (1); at A = 1.5"), "{said}");
        assert!(said.contains("an isola is born at A = 28 (28); at A = 28.5"), "{said}");
        assert!(said.contains("an isola is born at A = 150 (150); at A = 150.5"), "{said}");
        assert!(said.ends_with("; 26 more isolas are born and end (all of it is in events.csv)."), "{said}");
        // And so of births alone.
        let births: Vec<CurvePoint> =
            (1..=30).map(f64::from).chain([150.0]).map(|forcing| event(forcing, "birth")).collect();
        let said = sentence_of(&[CurveRow { points: births, ..CurveRow::default() }], &levels, true, |omega| {
            omega.to_string()
        });
        assert!(
            said.unwrap()
                .ends_with("1 (1), 28 (28), 29 (29), 30 (30), 150 (150) and 26 more (all of it is in events.csv).")
        );
    }
}
