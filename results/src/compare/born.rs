//! Births, deaths and merges along fold curves that runs have in common, and those that only one has.

use super::NumberRow;
use crate::overview::{EVENTS, EventWords, events_of, forcing_label};
use crate::report::Report;
use crate::store::CurvePoint;
use crate::told::Told;
use crate::words::digits;
use solver::response::critical::CriticalKind;

/// Relative distances of forcing and frequency up to which events of two runs are taken to be one.
const NEAR: (f64, f64) = (0.1, 0.03);

/// What is said of these.
pub(super) fn nearness() -> String {
    let percent = |share: f64| digits(100.0 * share, 2);
    format!(
        "within {} % of A and {1} % of the frequency, or the only one of each run within {1} % of the frequency",
        percent(NEAR.0),
        percent(NEAR.1)
    )
}

/// The forcing amplitude of an event, as told.
pub(super) fn forcing(event: &CurvePoint) -> String {
    forcing_label(event, 5)
}

/// Events of a kind of one run that have no partner in another one.
pub(super) fn without_partner<'r>(own: &'r Report, other: &Report, kind: CriticalKind) -> Vec<&'r CurvePoint> {
    let mut events = of(own, kind);
    events.retain(|event| partner(event, own, other, kind).is_none());
    events
}

/// What happens in the first run and in others as well: a row each, with the forcing amplitudes at which it does.
pub(super) fn rows(reports: &[Report]) -> Vec<NumberRow> {
    let Some((first, others)) = reports.split_first() else { return Vec::new() };
    let row = |words: EventWords, event: &CurvePoint| {
        let partners: Vec<Option<&CurvePoint>> =
            others.iter().map(|other| partner(event, first, other, words.kind)).collect();
        let place =
            |event: &CurvePoint| Told::from(format!("A = {} at ", forcing(event))).frequency(event.omega, 5).unit();
        let moved = |found: &CurvePoint| {
            let change = digits(100.0 * (found.forcing / event.forcing - 1.0), 3);
            let sign = if change.starts_with('-') || change == "0" { "" } else { "+" };
            place(found).text(format!(" ({sign}{change} %)"))
        };
        let values = partners.iter().map(|found| found.map_or("–".into(), moved));
        let values = std::iter::once(place(event)).chain(values).collect();
        partners.iter().any(Option::is_some).then(|| NumberRow { amplitude: String::new(), what: words.one, values })
    };
    let of_kind = |words: EventWords| of(first, words.kind).into_iter().filter_map(move |event| row(words, event));
    EVENTS.into_iter().flat_map(of_kind).collect()
}

/// Events of a kind along the fold curves of a run.
fn of(report: &Report, kind: CriticalKind) -> Vec<&CurvePoint> {
    events_of(&report.curves, kind.name())
}

/// The event of another run that one of a run is taken to be: the nearest in forcing of those that are near in both, else the only
/// one near in frequency of a run where there is no other in the own.
fn partner<'o>(event: &CurvePoint, own: &Report, other: &'o Report, kind: CriticalKind) -> Option<&'o CurvePoint> {
    let within = |a: f64, b: f64, share: f64| (a - b).abs() <= share * a.abs().max(b.abs());
    let beside = |known: &&CurvePoint| within(known.omega, event.omega, NEAR.1);
    let theirs: Vec<&CurvePoint> = of(other, kind).into_iter().filter(beside).collect();
    let off = |known: &CurvePoint| (known.forcing - event.forcing).abs();
    let near = theirs.iter().filter(|known| within(known.forcing, event.forcing, NEAR.0));
    near.min_by(|a, b| off(a).total_cmp(&off(b))).copied().or_else(|| match &theirs[..] {
        [only] if of(own, kind).iter().filter(|known| beside(known)).count() == 1 => Some(*only),
        _ => None,
    })
}
