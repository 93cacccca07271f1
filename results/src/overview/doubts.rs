//! Curves that stopped before their ends, so that what lies beyond is not known.

use super::modes::not_started;
use crate::store::{CurveRow, GRAZING, Reader, Result};
use crate::words::{count, digits, listed_first};
use protocol::backbone::BackboneMessage;
use protocol::to_everyone::Stage;
use solver::response::branch::{Outcome, Stop};
use solver::settings::Effort;

/// Digits of forcing amplitudes.
const DIGITS: i32 = 4;

/// How many curves the sentence names.
const NAMED: usize = 4;

/// How many levels of crossings it names.
const LEVELS: usize = 5;

/// Where a backbone stops at a threshold this many times above the highest level, the rest is taken to be out of its reach.
const FAR: f64 = 100.0;

/// A fold curve that stopped this factor beyond the levels may come back to them.
const NEAR: f64 = 1.25;

/// Says which main branches stopped before their ends, which backbones did so at thresholds that levels may reach, or did not
/// start, and which fold curves stopped among the levels: branches may hang on what lies beyond. `None` if none did.
///
/// # Errors
/// If the store cannot be read.
pub fn doubts(reader: &Reader) -> Result<Option<String>> {
    let mut curves = Vec::new();
    let levels: Vec<f64> = reader.levels()?.into_iter().map(|(_, _, value)| value).collect();
    let highest = levels.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    for backbone in reader.backbone()?.into_iter().chain(reader.further_backbones()?) {
        let ends = last_points(&backbone).into_iter().enumerate();
        let those = ends.filter(|(_, (_, end))| !is_beyond(&backbone, *end, highest));
        curves.extend(those.filter_map(|(piece, (outcome, _))| {
            let what = if piece == 0 { "the" } else { "a curve beside the" };
            Some(format!("{what} backbone of mode {} ({})", backbone.mode + 1, stopped(outcome)?))
        }));
    }
    if let Some(choice) = reader.modes()? {
        curves.extend(not_started(&choice).map(|(mode, _)| format!("the backbone of mode {} (no start)", mode + 1)));
    }
    for (amplitude, outcome) in reader.main_outcomes()? {
        curves.extend(stopped(&outcome).map(|stop| format!("the main branch at A = {amplitude} ({stop})")));
    }
    let stopped = reader.curves()?;
    let stopped = stopped.iter().filter(|curve| curve.is_unfinished && ends_near(curve, &levels));
    curves.extend(stopped.map(fold_curve));
    let search = reader.search_counts()?;
    let lost_at = if search.lost > 0 { reader.levels_of_lost_crossings()? } else { Vec::new() };
    let without_branch = format!("of a curve and a level, without a branch, {}", at(reader, &lost_at)?);
    // Folds and open branches of a run that goes on are still to come.
    let is_finished = reader.stage()? == Stage::Finished;
    let [left_out, uncarried] = [search.left_out, search.uncarried].map(|number| if is_finished { number } else { 0 });
    let lost = [
        (search.unfollowed, "fold", "not followed over the forcing"),
        (left_out, "fold", "beyond the limit of the search"),
        (search.lost, "crossing", without_branch.as_str()),
        (uncarried, "open branch", "not followed to all levels"),
    ];
    let lost = lost.into_iter().filter(|(number, ..)| *number > 0);
    curves.extend(lost.map(|(number, what, why)| format!("{} ({why})", count(number, what))));
    // A level may have two main branches that end alike.
    curves.dedup();
    if curves.is_empty() {
        return Ok(None);
    }
    let points = more_points(&curves);
    let is_thorough = reader.header()?.settings.search.effort == Effort::Thorough;
    let search = if is_thorough { "" } else { " (search.effort = \"thorough\" looks for them by more random starts)" };
    let more = curves.len().saturating_sub(NAMED);
    curves.truncate(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let list = curves.join(", ");
    Ok(Some(format!(
        "not known to its end: {list}{more}{points}; beyond, responses may be larger than those listed, and others may begin{search}"
    )))
}

/// Where levels are, each once: `at A = 3, 4 and 5`.
fn at(reader: &Reader, numbers: &[i64]) -> Result<String> {
    let levels = reader.levels()?.into_iter().filter(|(number, ..)| numbers.contains(number));
    Ok(format!("at A = {}", listed_first(levels.map(|(_, name, _)| name).collect(), LEVELS)))
}

/// Which keys allow more points, if some of these curves used up theirs.
fn more_points(curves: &[String]) -> String {
    let short = |what: &str| {
        curves.iter().any(|curve| curve.starts_with(what) && curve.contains(&Stop::PointBudget.to_string()))
    };
    let keys = [("the main branch", "branch.max_points"), ("the backbone", "backbone.max_points")];
    let keys: Vec<&str> = keys.into_iter().filter(|(what, _)| short(what)).map(|(_, key)| key).collect();
    match keys[..] {
        [] => String::new(),
        [key] => format!("; {key} allows more points"),
        _ => format!("; {} allow more points", keys.join(" and ")),
    }
}

/// A fold curve, by where it ends.
fn fold_curve(curve: &CurveRow) -> String {
    let ends = [curve.points.first(), curve.points.last()].map(|end| end.map_or(f64::NAN, |end| end.forcing));
    let [first, last] = ends.map(|forcing| digits(forcing, DIGITS));
    let ends = match curve.status.matches(GRAZING).count() {
        0 => format!("at A = {first} and at A = {last}"),
        1 if curve.status.ends_with(&format!("{GRAZING})")) => format!("at A = {first} and, {GRAZING}, at A = {last}"),
        1 => format!("at A = {last} and, {GRAZING}, at A = {first}"),
        _ => format!("at A = {first} and at A = {last}, both {GRAZING}"),
    };
    format!("fold curve {} (which ends {ends})", curve.number)
}

/// A reason without brackets of its own, to stand in brackets.
fn plain(reason: &str) -> String {
    reason.replace(" (", ", ").replace(')', "")
}

/// Whether a backbone that ends at this threshold A*, with this share of its own mode, ends far beyond a forcing amplitude: where another
/// mode leads, A* rises and falls again; where the forcing does no work it is infinite, and says nothing.
pub fn ends_far_beyond(threshold: f64, share: f64, forcing: f64) -> bool {
    threshold.is_finite() && threshold > FAR * forcing && share > 0.5
}

/// How the pieces of a backbone begin and end, with the number of the last point of each.
fn last_points(backbone: &BackboneMessage) -> Vec<(&Outcome, usize)> {
    let count = backbone.points.len();
    let pieces = backbone.columns.get("piece").and_then(|array| array.values("piece", &[count]).ok());
    let pieces = pieces.unwrap_or_else(|| vec![0.0; count]);
    let is_last = |&i: &usize| i + 1 == count || pieces[i] != pieces[i + 1];
    let outcomes = std::iter::once(&backbone.outcome).chain(&backbone.crossing);
    outcomes.zip((0..count).filter(is_last)).collect()
}

/// Whether a piece of a backbone as it is stored ends far beyond a forcing amplitude, at this point.
fn is_beyond(backbone: &BackboneMessage, end: usize, forcing: f64) -> bool {
    let count = backbone.points.len();
    let column = |name| backbone.columns.get(name);
    let thresholds = column("threshold").and_then(|array| array.values("threshold", &[count]).ok());
    let last = thresholds.and_then(|values| values.get(end).copied());
    let contributions = column("contributions").filter(|array| array.is_sound() && array.shape.len() == 2);
    let share = contributions.and_then(|array| {
        let values = array.values("contributions", &[count, array.shape[1]]).ok()?;
        values.get(end * array.shape[1] + backbone.mode).copied()
    });
    last.zip(share).is_some_and(|(last, share)| ends_far_beyond(last, share, forcing))
}

/// Whether one of the ends of a fold curve lies among levels, or not far beyond.
pub fn ends_near(curve: &CurveRow, levels: &[f64]) -> bool {
    let low = levels.iter().copied().fold(f64::INFINITY, f64::min) / NEAR;
    let high = levels.iter().copied().fold(f64::NEG_INFINITY, f64::max) * NEAR;
    let ends = [curve.points.first(), curve.points.last()];
    ends.into_iter().flatten().any(|end| (low..=high).contains(&end.forcing))
}

/// Why a curve goes on where it ends, if it does: without brackets of its own, to stand in brackets.
pub fn stopped(outcome: &Outcome) -> Option<String> {
    unfinished(outcome).map(|stop| plain(&stop.to_string()))
}

/// The same, of curves that are neither closed nor end at a bound.
fn unfinished(outcome: &Outcome) -> Option<Stop> {
    let Outcome::Open(first, last) = outcome else { return None };
    let is_unfinished = |stop: &&Stop| matches!(stop, Stop::PointBudget | Stop::Stalled(_) | Stop::Reversed);
    [last, first].into_iter().find(is_unfinished).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::CurvePoint;

    #[test]
    fn a_fold_curve_matters_where_it_may_come_back_to_a_level() {
        let point = |forcing| CurvePoint { forcing, omega: 1.0, amplitude: 1.0, ..CurvePoint::default() };
        let curve = |first, last| CurveRow {
            number: 1,
            origin: String::new(),
            status: String::new(),
            is_unfinished: true,
            points: vec![point(first), point(30.0), point(last)],
            ..CurveRow::default()
        };
        for (first, last, matters) in [(1.0, 60.0, true), (24.0, 100.0, true), (1.0, 13.0, false), (70.0, 15.9, false)]
        {
            assert_eq!(ends_near(&curve(first, last), &[20.0, 50.0]), matters, "{first} to {last}");
        }
    }

    #[test]
    fn ends_are_told_without_brackets_in_brackets() {
        let point = |forcing| CurvePoint { forcing, ..CurvePoint::default() };
        let curve = |status: String| CurveRow {
            number: 2,
            status,
            points: vec![point(0.072_93), point(0.3243)],
            ..CurveRow::default()
        };
        let end = format!("stalled at the smallest step: no convergence (scaled residual 6.6e-5) ({GRAZING})");
        assert_eq!(
            fold_curve(&curve(format!("open: {end} to {end}"))),
            format!("fold curve 2 (which ends at A = 0.07293 and at A = 0.3243, both {GRAZING})")
        );
        let one = fold_curve(&curve(format!("open: forcing bound to {end}")));
        assert!(one.ends_with(&format!("(which ends at A = 0.07293 and, {GRAZING}, at A = 0.3243)")), "{one}");
        let other = fold_curve(&curve(format!("open: {end} to forcing bound")));
        assert!(other.ends_with(&format!("(which ends at A = 0.3243 and, {GRAZING}, at A = 0.07293)")), "{other}");
        assert!(fold_curve(&curve("open: forcing bound to stalled".into())).ends_with("and at A = 0.3243)"));
        assert_eq!(plain("no convergence (residual 1)"), "no convergence, residual 1");
    }

    #[test]
    fn a_curve_is_known_up_to_bounds() {
        for end in [Stop::FrequencyBound, Stop::AmplitudeBound] {
            assert_eq!(unfinished(&Outcome::Open(Stop::Start, end)), None);
        }
        assert_eq!(unfinished(&Outcome::Closed), None);
        for end in [Stop::PointBudget, Stop::Reversed] {
            assert_eq!(unfinished(&Outcome::Open(Stop::Start, end)), Some(end));
            assert_eq!(unfinished(&Outcome::Open(end, Stop::FrequencyBound)), Some(end));
        }
    }
}
