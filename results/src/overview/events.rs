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

/// Where isolas are born and where branches merge, as fold curves say; which branches, where that is known for sure.
pub fn events_sentence(curves: &[CurveRow], frequency: impl Fn(f64) -> String) -> Option<String> {
    let place = |point: &CurvePoint| format!("{} ({})", digits(point.forcing, 5), frequency(point.omega));
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
    for merge in merges(curves) {
        match merge.what {
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
    (!parts.is_empty()).then(|| format!("Computed along fold curves: {}.", parts.join("; ")))
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
}
