//! Isolas that fold curves have at levels at which none was found.

use super::bounds::is_within;
use super::forcing_digits::{forcing_label, truncation_doubt};
use super::level::Level;
use super::lives::{folds_at, lasting, lives};
use crate::store::{CurvePoint, CurveRow};
use crate::words::{digits, listed};
use solver::response::critical::CriticalKind;
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

/// Bounds of branches.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    /// Of the frequency, rad/s.
    pub frequency: FrequencySettings,
    /// Of the amplitude, m, if it was given.
    pub amplitude: Option<f64>,
}

/// That isolas are there at levels at which none was found, as fold curves say, which go beyond the bounds of branches: `one is there at A =
/// 2 and 3 (…)`. `frequency` and `length` write these, of rad/s and m.
pub fn overlooked(
    curves: &[CurveRow],
    levels: &[Level],
    bounds: Bounds,
    frequency: impl Fn(f64) -> String,
    length: impl Fn(f64) -> String,
) -> Option<String> {
    let ended = lives(curves).into_iter().map(|life| Span { from: life.from, end: Some(life.to), to: life.to.forcing });
    let others = lasting(curves).into_iter().map(|one| Span { from: one.from, end: None, to: one.to });
    let missing = |span: &Span<'_>| levels.iter().filter(|level| span.is_missing_at(level)).collect::<Vec<&Level>>();
    let spans = ended.chain(others).map(|span| (missing(&span), span));
    let mut all: Vec<(Vec<&Level>, Span<'_>)> = spans.filter(|(at, _)| !at.is_empty()).collect();
    all.sort_by(|(_, a), (_, b)| a.from.forcing.total_cmp(&b.from.forcing));
    let (at, span) = all.first()?;
    let from = forcing_label(span.from, DIGITS);
    let range = match span.end {
        Some(end) => format!("from A = {from} to {}", forcing_label(end, DIGITS)),
        None => format!("from A = {from} to beyond {}", digits(span.to, DIGITS)),
    };
    let doubt = truncation_doubt(&std::iter::once(span.from).chain(span.end).collect::<Vec<_>>());
    // What begins where branches part has its edges from its death on.
    let is_born = span.from.event.as_deref() == Some(CriticalKind::Birth.name());
    let known = span.end.filter(|_| !is_born).unwrap_or(span.from);
    let folds = at.iter().map(|level| (level.amplitude.as_str(), folds_at(curves, known, level.value)));
    let folds: Vec<(&str, (f64, f64))> =
        folds.flat_map(|(name, folds)| folds.into_iter().map(move |fold| (name, fold))).collect();
    let largest = folds.iter().max_by(|(_, a), (_, b)| a.1.total_cmp(&b.1));
    let size = largest.map_or_else(String::new, |(name, (omega, amplitude))| {
        let level = if at.len() == 1 { String::new() } else { format!(" at A = {name}") };
        format!(", up to {} or more{level}, near {}", length(*amplitude), frequency(*omega))
    });
    let is_out = |omega: f64| !is_within(bounds.frequency, omega);
    let is_large = |amplitude: f64| bounds.amplitude.is_some_and(|bound| amplitude > bound);
    let why = match &folds[..] {
        [] if is_out(span.from.omega) => ", beyond the frequencies of the study",
        [_, ..] if folds.iter().all(|(_, (omega, _))| is_out(*omega)) => ", beyond the frequencies of the study",
        [_, ..] if folds.iter().all(|(_, (_, amplitude))| is_large(*amplitude)) => ", beyond branch.max_amplitude",
        _ => "; bounds or limits of the study may leave it out",
    };
    let more = if all.len() > 1 { format!("; and {} more elsewhere", all.len() - 1) } else { String::new() };
    let names: Vec<String> = at.iter().map(|level| level.amplitude.clone()).collect();
    Some(format!("one is there at A = {} ({range}{size}{doubt}{why}{more})", listed(&names)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::BranchRow;

    #[test]
    fn what_bounds_leave_out_is_there_all_the_same() {
        let point = |(forcing, omega, amplitude, event): (f64, f64, f64, &str)| CurvePoint {
            forcing,
            omega,
            amplitude,
            event: (!event.is_empty()).then(|| event.into()),
            doubled: Some((forcing, omega)),
        };
        let points = [(0.2, 2.0, 0.1, ""), (4.0, 2.0, 0.5, "merge"), (1.0, 3.0, 1.0, "birth"), (9.0, 4.0, 2.0, "")];
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
        let said = |levels: &[Level], max, amplitude| {
            let bounds = Bounds { frequency: FrequencySettings { max, ..FrequencySettings::default() }, amplitude };
            overlooked(&curves, levels, bounds, |omega| format!("{omega} rad/s"), |size| format!("{size} m"))
        };
        let empty = [0.5, 3.0, 5.0].map(|value| level(value, &[]));
        let there = "one is there at A = 3 (from A = 1 to 4, up to 1.25 m or more, near 3.25 rad/s";
        let may = "; bounds or limits of the study may leave it out)";
        assert_eq!(said(&empty, None, None).unwrap(), format!("{there}{may}"));
        assert_eq!(said(&empty, None, Some(0.6)).unwrap(), format!("{there}, beyond branch.max_amplitude)"));
        // One of its folds is within the bounds.
        assert_eq!(said(&empty, None, Some(0.8)).unwrap(), format!("{there}{may}"));
        assert_eq!(said(&empty, Some(2.2), None).unwrap(), format!("{there}, beyond the frequencies of the study)"));
        assert_eq!(said(&empty, Some(2.4), None).unwrap(), format!("{there}{may}"));
        let two = said(&[2.0, 3.0].map(|value| level(value, &[])), None, None).unwrap();
        assert!(
            two.starts_with("one is there at A = 2 and 3 (from A = 1 to 4, up to 1.25 m or more at A = 3, near"),
            "{two}"
        );
        // Where something is that may be it, and where it is not there, nothing is missing.
        let found = [level(2.0, &[("isola", (2.5, 3.5))]), level(3.0, &[("cut", (2.9, 3.5))]), level(4.5, &[])];
        assert_eq!(said(&found, None, None), None);
        assert!(said(&[level(3.0, &[("open", (5.0, 6.0))])], None, None).is_some());
    }
}
