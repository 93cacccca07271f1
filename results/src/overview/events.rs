//! What happens along fold curves, in a sentence.

use super::folds::events_of;
use super::merges::merges;
use crate::store::{CurvePoint, CurveRow};
use crate::words::digits;
use solver::response::critical::CriticalKind;

/// Events of a kind that the sentence names.
const NAMED: usize = 6;

/// Of merges whose branches are not known, after others: they may be the same branches.
const ALSO: &str = "branches also merge or part";

/// Most digits of a forcing amplitude.
const DIGITS: i32 = 5;

/// Fewest digits to which a forcing amplitude and that with twice the harmonics have to agree: fewer are told with both.
const AGREED: i32 = 3;

/// The forcing amplitude of what happens at a point, with `most` digits at most, and no more than those that twice the harmonics
/// leave as they are; where these are too few, with that of twice the harmonics.
pub fn forcing_text(point: &CurvePoint, most: i32) -> String {
    let own = |count| digits(point.forcing, count);
    let Some((doubled, _)) = point.doubled else { return own(most) };
    let agreed = (AGREED..=most).rev().map(|count| (own(count), digits(doubled, count))).find(|(a, b)| a == b);
    match agreed {
        Some((text, _)) => text,
        None => format!("{}, with twice the harmonics {}", own(AGREED + 1), digits(doubled, AGREED + 1)),
    }
}

/// Where isolas are born and where branches merge, as fold curves say; which branches, where that is known for sure.
pub fn events_sentence(curves: &[CurveRow], frequency: impl Fn(f64) -> String) -> Option<String> {
    let place = |point: &CurvePoint| format!("{} ({})", forcing_text(point, DIGITS), frequency(point.omega));
    let part = |points: &[&CurvePoint], one: &str, many: &str| {
        let verb = if points.len() == 1 { one } else { many };
        let more = points.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let named: Vec<String> = points.iter().take(NAMED).map(|point| place(point)).collect();
        (!points.is_empty()).then(|| format!("{verb} at A = {}{more}", named.join(", ")))
    };
    let births = events_of(curves, CriticalKind::Birth.name());
    let deaths = events_of(curves, CriticalKind::Death.name());
    let mut told = Vec::new();
    let mut others = Vec::new();
    let merged = merges(curves);
    for merge in &merged {
        match &merge.what {
            Some(what) if told.len() < NAMED => told.push(format!("{what} at A = {}", place(merge.point))),
            _ => others.push(merge.point),
        }
    }
    let others = match told.is_empty() {
        true => part(&others, "two branches merge or part", "branches merge or part"),
        false => part(&others, ALSO, ALSO),
    };
    let parts: Vec<String> = part(&births, "an isola is born", "isolas are born")
        .into_iter()
        .chain(part(&deaths, "an isola vanishes", "isolas vanish"))
        .chain(told)
        .chain(others)
        .collect();
    let all = || births.iter().chain(&deaths).copied().chain(merged.iter().map(|merge| merge.point));
    let (count, unchecked) = (all().count(), all().filter(|point| point.doubled.is_none()).count());
    let doubt = match unchecked {
        0 => String::new(),
        1 if count == 1 => " It was not found with twice the harmonics.".into(),
        1 => format!(" 1 of these {count} was not found with twice the harmonics."),
        _ => format!(" {unchecked} of these {count} were not found with twice the harmonics."),
    };
    (!parts.is_empty()).then(|| format!("Computed along fold curves: {}.{doubt}", parts.join("; ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Crossing;

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
        let say = |curves: &[CurveRow]| events_sentence(curves, |omega| format!("{omega} rad/s"));
        let before = "Computed along fold curves: an isola is born at A = 1.5 (3 rad/s); ";
        let unknown = "two branches merge or part at A = 4 (8 rad/s).";
        assert_eq!(say(&[known.clone()]).unwrap(), format!("{before}{unknown}"));
        known.crossings = vec![crossing(0, "main"), crossing(1, "isola 1")];
        let told = "isola 1 of A = 2 and the main branch merge at A = 4 (8 rad/s)";
        assert_eq!(say(&[known.clone()]).unwrap(), format!("{before}{told}."));
        let other = curve(&[(1.0, ""), (7.0, "merge"), (1.0, "")]);
        let others = "branches also merge or part at A = 7 (14 rad/s).";
        assert_eq!(say(&[known, other]).unwrap(), format!("{before}{told}; {others}"));
        assert_eq!(say(&[]), None);
    }

    #[test]
    fn a_forcing_has_the_digits_that_twice_the_harmonics_leave() {
        let text = |forcing, doubled: Option<f64>| {
            let doubled = doubled.map(|doubled| (doubled, 1.0));
            forcing_text(&CurvePoint { forcing, doubled, ..CurvePoint::default() }, 5)
        };
        assert_eq!(text(5.13781, None), "5.1378");
        assert_eq!(text(5.13781, Some(5.13779)), "5.1378");
        assert_eq!(text(5.13781, Some(5.1362)), "5.14");
        assert_eq!(text(5.13781, Some(4.85491)), "5.138, with twice the harmonics 4.855");
    }

    #[test]
    fn what_twice_the_harmonics_do_not_have_is_said() {
        let point = |doubled| CurvePoint {
            forcing: 2.0,
            omega: if doubled { 1.0 } else { 3.0 },
            event: Some("birth".into()),
            doubled: doubled.then_some((2.0, 1.0)),
            ..CurvePoint::default()
        };
        let curve = CurveRow { points: vec![point(true), point(false)], ..CurveRow::default() };
        let said = events_sentence(&[curve], |omega| omega.to_string()).unwrap();
        assert!(said.ends_with("(3). 1 of these 2 was not found with twice the harmonics."), "{said}");
    }
}
