//! Isolas that fold curves have at levels at which none was found.

use super::bounds::is_within;
use super::forcing_digits::{forcing_label, truncation_doubt};
use super::level::Level;
use super::lives::{lasting, lives};
use crate::store::{CurvePoint, CurveRow};
use crate::words::{digits, listed};
use solver::settings::FrequencySettings;

/// Digits of forcing amplitudes.
const DIGITS: i32 = 4;

/// An isola over the forcing, as far as it is known.
struct Span<'c> {
    from: &'c CurvePoint,
    /// Where it ends, if that is known.
    end: Option<&'c CurvePoint>,
    /// Forcing amplitude up to which it is known.
    to: f64,
}

impl Span<'_> {
    /// Whether it is there at a level that has nothing at its frequencies that could be it.
    fn is_missing_at(&self, level: &Level) -> bool {
        let (low, high) = self.omega();
        let is_there = self.from.forcing * (1.0 + CurvePoint::SAME) < level.value && level.value < self.to;
        let has_other = level.others().any(|row| row.omega.0 <= high && low <= row.omega.1);
        is_there && level.is_complete() && level.isolas().next().is_none() && !has_other
    }

    /// Frequencies at which it begins and ends, the lower first.
    fn omega(&self) -> (f64, f64) {
        let end = self.end.map_or(self.from.omega, |end| end.omega);
        (self.from.omega.min(end), self.from.omega.max(end))
    }
}

/// That isolas are there at levels at which none was found, as fold curves say, which go beyond the bounds of branches: what follows "no
/// isola was found". `frequency` writes one, of rad/s.
pub fn overlooked(
    curves: &[CurveRow],
    levels: &[Level],
    bounds: FrequencySettings,
    frequency: impl Fn(f64) -> String,
) -> Option<String> {
    let ended = lives(curves).into_iter().map(|life| Span { from: life.from, end: Some(life.to), to: life.to.forcing });
    let others = lasting(curves).into_iter().map(|one| Span { from: one.from, end: None, to: one.to });
    let missing = |span: &Span<'_>| {
        let at = levels.iter().filter(|level| span.is_missing_at(level));
        at.map(|level| level.amplitude.clone()).collect::<Vec<_>>()
    };
    let spans = ended.chain(others).map(|span| (missing(&span), span));
    let mut all: Vec<(Vec<String>, Span<'_>)> = spans.filter(|(at, _)| !at.is_empty()).collect();
    all.sort_by(|(_, a), (_, b)| a.from.forcing.total_cmp(&b.from.forcing));
    let (at, span) = all.first()?;
    let (from, omega) = (forcing_label(span.from, DIGITS), span.from.omega);
    let range = match span.end {
        Some(end) => format!("from A = {from} to {}", forcing_label(end, DIGITS)),
        None => format!("from A = {from} to beyond {}", digits(span.to, DIGITS)),
    };
    let doubt = truncation_doubt(&std::iter::once(span.from).chain(span.end).collect::<Vec<_>>());
    let why = match is_within(bounds, omega) {
        true => "; bounds or limits of the study may leave it out",
        false => ", beyond the frequencies of the study",
    };
    let more = if all.len() > 1 { format!("; and {} more elsewhere", all.len() - 1) } else { String::new() };
    let at = listed(at);
    Some(format!(
        ", though along fold curves one is there at A = {at} ({range}, born near {}{doubt}{why}{more})",
        frequency(omega)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::BranchRow;

    #[test]
    fn what_bounds_leave_out_is_there_all_the_same() {
        let point = |(forcing, omega, event): (f64, f64, &str)| CurvePoint {
            forcing,
            omega,
            event: (!event.is_empty()).then(|| event.into()),
            doubled: Some((forcing, omega)),
            ..CurvePoint::default()
        };
        let points = [(0.2, 2.0, ""), (4.0, 2.0, "merge"), (1.0, 3.0, "birth"), (9.0, 4.0, "")];
        let curves = [CurveRow { points: points.map(point).to_vec(), ..CurveRow::default() }];
        let level = |value: f64, kinds: &[(&str, (f64, f64))]| {
            let row = |&(kind, omega): &(&str, (f64, f64))| BranchRow {
                kind: kind.into(),
                closed: kind == "isola",
                omega,
                ..BranchRow::default()
            };
            let branches = [("main", (0.0, 9.0))].iter().chain(kinds).map(row).collect();
            Level { amplitude: value.to_string(), value, branches, ..Level::default() }
        };
        let said = |levels: &[Level], max| {
            let bounds = FrequencySettings { max, ..FrequencySettings::default() };
            overlooked(&curves, levels, bounds, |omega| format!("{omega} rad/s"))
        };
        let empty = [0.5, 2.0, 3.0, 5.0].map(|value| level(value, &[]));
        assert_eq!(
            said(&empty, None).unwrap(),
            ", though along fold curves one is there at A = 2 and 3 (from A = 1 to 4, born near 3 rad/s; bounds or limits of the study may \
             leave it out)"
        );
        let beyond = said(&empty, Some(2.5)).unwrap();
        assert!(beyond.ends_with("near 3 rad/s, beyond the frequencies of the study)"), "{beyond}");
        // Where something is that may be it, and where it is not there, nothing is missing.
        let found = [level(2.0, &[("isola", (2.5, 3.5))]), level(3.0, &[("cut", (2.9, 3.5))]), level(4.5, &[])];
        assert_eq!(said(&found, None), None);
        assert!(said(&[level(3.0, &[("open", (5.0, 6.0))])], None).is_some());
    }
}
