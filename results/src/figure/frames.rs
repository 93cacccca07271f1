//! What depends on the forcing amplitude looked at: windows, the runs of the backbone along which the amplitude lies above
//! the threshold, with their names and colours, and what the balance predicts, in words.

use super::style::Color;
use super::subject::Subject;
use crate::curves::{BackboneCurve, Piece};
use crate::overview::{Level, WindowOutcome, WindowRow, briefly, elsewhere, told_threshold, within};
use crate::told::Told;
use crate::words::{count, digits};
use serde::Serialize;
use solver::response::windows::crossing;

/// One forcing amplitude.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Frame {
    /// Forcing amplitude A.
    pub amplitude: f64,
    /// `A = 60`.
    pub name: String,
    /// The level of the run that has it, by index.
    pub level: Option<usize>,
    /// Windows along the backbone.
    pub runs: Vec<Run>,
    /// How many windows are predicted.
    pub words: String,
    /// A sentence for each window.
    pub sentences: Vec<Told>,
}

/// A window as a run of the backbone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Run {
    /// Place where it begins; between points, a fraction.
    pub first: f64,
    /// Place where it ends.
    pub last: f64,
    /// Point of smallest threshold.
    pub best: usize,
    /// What it led to, or its number.
    pub name: String,
    /// Its colour.
    pub color: Color,
}

impl Run {
    /// The same, so many points later.
    fn after(self, points: usize) -> Self {
        let later = points as f64;
        Self { first: self.first + later, last: self.last + later, best: self.best + points, ..self }
    }
}

impl Frame {
    /// Of a level of a run.
    pub fn of_level(subject: &Subject<'_>, backbone: &BackboneCurve, level: usize) -> Option<Self> {
        let row = subject.levels.get(level)?;
        Some(Self::new(subject, backbone, row.value, Some((level, row))))
    }

    /// Of any forcing amplitude.
    pub fn at(subject: &Subject<'_>, backbone: &BackboneCurve, amplitude: f64) -> Self {
        let level = subject.levels.iter().enumerate().find(|(_, level)| level.value == amplitude);
        Self::new(subject, backbone, amplitude, level)
    }

    /// That it is none of the run's levels, if so.
    pub fn beside(&self) -> &'static str {
        beside(self.level)
    }

    fn new(subject: &Subject<'_>, backbone: &BackboneCurve, amplitude: f64, level: Option<(usize, &Level)>) -> Self {
        let mut runs = runs_of(backbone, amplitude);
        let row = |run: &Run| level.and_then(|(_, level)| window_of(level, backbone, run));
        for (k, run) in runs.iter_mut().enumerate() {
            run.name = name(level.map(|(_, level)| level).zip(row(run)), k + 1);
        }
        paint(&mut runs);
        let levels: Vec<f64> = subject.levels.iter().map(|level| level.value).collect();
        let numbered =
            |(k, run): (usize, &Run)| sentence(backbone, row(run).map_or(k + 1, |row| row.number), run, level, &levels);
        let mut sentences: Vec<Told> = runs.iter().enumerate().map(numbered).collect();
        let elsewhere =
            level.map_or(0, |(_, level)| level.windows.iter().filter(|w| w.mode != backbone.mode + 1).count());
        if elsewhere > 0 {
            let windows = count(elsewhere, "window");
            let others =
                format!("Of other modes, which are not drawn here, {windows} more: see the account (table 7).");
            sentences.push(others.into());
        }
        let name = level.map_or_else(|| digits(amplitude, 4), |(_, level)| level.amplitude.clone());
        let what = match runs.len() {
            0 => "no forced response on this backbone.".into(),
            windows => format!("{}:", count(windows, "window")),
        };
        let note = beside(level.map(|(index, _)| index));
        Self {
            amplitude,
            words: format!("At A = {name}{note} the balance of mode {} predicts {what}", backbone.mode + 1),
            name: format!("A = {name}"),
            level: level.map(|(index, _)| index),
            runs,
            sentences,
        }
    }
}

/// What follows a forcing amplitude that is none of the levels.
fn beside(level: Option<usize>) -> &'static str {
    if level.is_some() { "" } else { " (not a level of this run)" }
}

/// Runs of a backbone, each within one of its pieces, along which the threshold lies below an amplitude.
fn runs_of(backbone: &BackboneCurve, amplitude: f64) -> Vec<Run> {
    let of = |piece: &Piece| {
        let found = runs(&backbone.threshold.values[piece.points.clone()], amplitude);
        let first = piece.points.start;
        found.into_iter().map(move |run| run.after(first))
    };
    backbone.pieces.iter().flat_map(of).collect()
}

/// Runs along which the threshold lies below an amplitude, without names and colours.
fn runs(threshold: &[f64], amplitude: f64) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let mut is_inside = false;
    for (i, &value) in threshold.iter().enumerate() {
        let was_inside = std::mem::replace(&mut is_inside, value < amplitude);
        if is_inside && !was_inside {
            let first = if i == 0 { 0.0 } else { passes(threshold, i - 1, amplitude) };
            runs.push(Run { first, last: i as f64, best: i, name: String::new(), color: Color::Ink });
        }
        let Some(run) = runs.last_mut() else { continue };
        if is_inside {
            run.last = i as f64;
            run.best = if value < threshold[run.best] { i } else { run.best };
        } else if was_inside {
            run.last = passes(threshold, i - 1, amplitude);
        }
    }
    runs
}

/// Where between points `i` and `i + 1` the threshold passes the amplitude.
fn passes(threshold: &[f64], i: usize, amplitude: f64) -> f64 {
    i as f64 + crossing(threshold[i], threshold[i + 1], amplitude)
}

/// The window of a level that a run of a backbone is.
fn window_of<'l>(level: &'l Level, backbone: &BackboneCurve, run: &Run) -> Option<&'l WindowRow> {
    let mut windows = level.windows.iter().filter(|window| window.mode == backbone.mode + 1);
    windows.find(|window| (window.points[0]..=window.points[1]).contains(&run.best))
}

/// What there is of a window, if it is one of a level; else its number.
fn name(known: Option<(&Level, &WindowRow)>, number: usize) -> String {
    let Some((level, window)) = known else { return format!("window {number}") };
    let number = window.number;
    match &window.outcome {
        WindowOutcome::Found(found) => within(found, window, &level.branches).0.join("; "),
        WindowOutcome::Passed { branches, .. } => {
            format!("window {number}, passed by {}", branches.replace("; ", " and "))
        }
        WindowOutcome::NotFound(_) | WindowOutcome::Elsewhere(_) => format!("window {number}, not found"),
        WindowOutcome::Pending(_) => format!("window {number}, pending"),
    }
}

/// The first category is of the run that begins where the backbone does; the others follow, one for each thing that the
/// runs led to.
fn paint(runs: &mut [Run]) {
    let mut names: Vec<String> = vec![runs.first().filter(|run| run.first == 0.0).map_or("", |run| &run.name).into()];
    for run in runs {
        let place = names.iter().position(|name| *name == run.name).unwrap_or(names.len());
        if place == names.len() {
            names.push(run.name.clone());
        }
        run.color = Color::Category(place);
    }
}

/// What is predicted and, at a level of the run, what was found there.
fn sentence(
    backbone: &BackboneCurve,
    number: usize,
    run: &Run,
    level: Option<(usize, &Level)>,
    levels: &[f64],
) -> Told {
    let omega = along(&backbone.omega.values, run.first, run.last);
    let (low, high) = super::axis::bounds(omega);
    let window = level.and_then(|(_, level)| window_of(level, backbone, run));
    let is_main = |window: &WindowRow| match &window.outcome {
        WindowOutcome::Found(branches) => branches.split("; ").any(|branch| branch.starts_with("main")),
        _ => false,
    };
    // The first point of a piece stands for the gap before it.
    let starts = |piece: &Piece| (piece.points.start..=piece.points.start + 1).contains(&(run.first.ceil() as usize));
    let crosses = backbone.pieces.iter().skip(1).any(starts);
    let which = match (run.first == 0.0, window.is_some_and(is_main)) {
        (true, true) => "begins where the backbone does: main branch",
        (true, false) => "begins where the backbone does: main branch, as a rule",
        _ if crosses => "begins where a curve crosses the backbone: branches off another response, as a rule",
        _ => "separate: an isola, unless the main branch reaches it",
    };
    let outcome = match level.zip(window).map(|((_, level), window)| (level, window, &window.outcome)) {
        None if level.is_none() => String::new(),
        None => " Not among the windows of this level.".into(),
        Some((level, window, WindowOutcome::Found(found))) => computed(found, window, level),
        Some((.., WindowOutcome::Passed { told, .. })) => format!(" Computed: {}.", briefly(told)),
        Some((.., WindowOutcome::Pending(_))) => " Not computed yet.".into(),
        Some((.., WindowOutcome::NotFound(reasons))) => format!(" Computed, not found: {}.", briefly(reasons)),
        Some((.., WindowOutcome::Elsewhere(branches))) => format!(" Computed, not found: {}.", elsewhere(branches)),
    };
    // The same numbers as in the account.
    let (low, high) = window.map_or((low, high), |window| window.omega);
    let threshold = told_threshold(backbone.threshold.values[run.best], levels.iter().copied());
    let is_end = |piece: &Piece| [piece.points.start, piece.points.end - 1].contains(&run.best);
    let is_inside = !backbone.pieces.iter().any(is_end);
    let begins = if is_inside { "born at A* =" } else { "A* down to" };
    let range = Told::from(format!("Window {number}: ")).frequency(low, 5).text(" to ").frequency(high, 5).unit();
    range.text(format!(", {begins} {threshold}; {which}.{outcome}"))
}

/// What the seeds of a window led to.
fn computed(found: &str, window: &WindowRow, level: &Level) -> String {
    let (there, others) = within(found, window, &level.branches);
    let others = if others.is_empty() { String::new() } else { format!("; {}", elsewhere(&others.join("; "))) };
    format!(" Computed: {}{others}.", there.join("; "))
}

/// A column at a place between its points.
pub fn value_at(column: &[f64], place: f64) -> f64 {
    let i = (place as usize).min(column.len().saturating_sub(1));
    match (column.get(i), column.get(i + 1)) {
        (Some(&value), Some(&next)) if place > i as f64 => value + (next - value) * (place - i as f64),
        (Some(&value), _) => value,
        _ => f64::NAN,
    }
}

/// A column along a run, both ends included.
pub fn along(column: &[f64], first: f64, last: f64) -> Vec<f64> {
    let inside = (first as usize + 1..column.len()).take_while(|&i| (i as f64) < last).map(|i| column[i]);
    let end = (last > first).then(|| value_at(column, last));
    std::iter::once(value_at(column, first)).chain(inside).chain(end).collect()
}

/// Levels among the frames at most; more are thinned evenly.
const LEVELS: usize = 150;
/// Amplitudes between and beside the levels.
const BETWEEN: usize = 60;

/// Forcing amplitudes worth looking at, ascending: levels, births and merges, and steps from below the first birth, yet not
/// far below the levels, to above the highest level.
pub fn ladder(subject: &Subject<'_>, backbone: &BackboneCurve) -> Vec<f64> {
    let levels: Vec<f64> = subject.levels.iter().map(|level| level.value).filter(|value| *value > 0.0).collect();
    let (low, high) = match levels[..] {
        [] => (0.1, 10.0),
        _ => (levels[0], levels[levels.len() - 1]),
    };
    let positive = backbone.threshold.values.iter().copied().filter(|value| *value > 0.0);
    let first = positive.fold(f64::INFINITY, f64::min);
    let (low, high) = (low.min(first.max(low / 30.0)) / 1.3, high * 1.5);
    let step = |k: usize| low * (high / low).powf(k as f64 / BETWEEN as f64);
    let round = |value: f64| digits(value, 3).parse().unwrap_or(value);
    let stride = levels.len().div_ceil(LEVELS).max(1);
    let events = backbone.events.iter().map(|event| event.threshold).filter(|value| (low..=high).contains(value));
    let first = subject.first_level().map(|level| subject.levels[level].value);
    let mut all: Vec<f64> = levels.iter().rev().copied().step_by(stride).chain(first).chain(events).collect();
    all.extend((0..=BETWEEN).map(step).map(round));
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::BranchRow;
    use crate::summary_table::FrequencyUnit;
    use solver::laws::{PolynomialSpring, Term};
    use solver::response::windows::windows;
    use solver::settings::HarmonicSettings;
    use solver::{Backbone, Model, Settings};
    use std::ops::ControlFlow;

    #[test]
    fn runs_end_between_points() {
        let found = runs(&[1.0, 4.0, 2.0, 1.0, 8.0], 2.0);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].first, found[0].last, found[0].best), (0.0, 0.5, 0));
        assert!((found[1].first - 2.0).abs() < 1e-12 && found[1].best == 3);
        assert!((found[1].last - (3.0 + 1.0 / 3.0)).abs() < 1e-12, "{}", found[1].last);
        assert!(runs(&[f64::NAN, f64::NAN], 2.0).is_empty());
    }

    /// Two masses alike on springs that stiffen, pushed alike: motions of one of them leave those against each other.
    #[test]
    fn runs_are_within_pieces_as_windows_are() {
        let spring = || PolynomialSpring { terms: vec![Term { power: 3, coefficient: 0.5 }] };
        let model = Model::builder("pair")
            .dofs(["left", "right"])
            .mass([[1.0, 0.0], [0.0, 1.0]])
            .stiffness([[1.1, -0.1], [-0.1, 1.1]])
            .damping_matrix([[0.002, 0.0], [0.0, 0.002]])
            .force_shape([1.0, 1.0])
            .monitor("left")
            .element("left spring", spring(), [[("left", 1.0)]])
            .element("right spring", spring(), [[("right", 1.0)]])
            .build()
            .unwrap();
        let settings =
            Settings { harmonics: HarmonicSettings { count: 3, ..Default::default() }, ..Default::default() };
        let mut quiet = |_: &_| ControlFlow::Continue(());
        let backbone = Backbone::reaching(&model, &settings.tracking(1), 0.006, &mut quiet).unwrap();
        let curve = BackboneCurve::new(&backbone, &model);
        let begins: Vec<usize> = curve.pieces.iter().map(|piece| piece.points.start).collect();
        assert_eq!(begins.len(), 3);
        let gaps: Vec<usize> = (0..backbone.points.len()).filter(|&i| curve.omega.values[i].is_nan()).collect();
        assert_eq!(gaps, begins[1..]);
        // What would be one run across pieces at an amplitude above all thresholds.
        for amplitude in [0.006, 1e30] {
            let runs = runs_of(&curve, amplitude);
            let places: Vec<[usize; 3]> =
                runs.iter().map(|run| [run.first.ceil() as usize, run.best, run.last as usize]).collect();
            let windows = windows(&backbone, amplitude);
            let expected: Vec<[usize; 3]> =
                windows.iter().map(|window| [window.first, window.best, window.last]).collect();
            assert_eq!(places, expected, "{amplitude}");
            assert_eq!(places.len(), if amplitude < 1.0 { 2 } else { 3 });
            // The account has the same ends, between points.
            for (run, window) in runs.iter().zip(&windows) {
                let (low, high) = super::super::axis::bounds(along(&curve.omega.values, run.first, run.last));
                let is_near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
                let omegas = window.of_points(&backbone);
                // The first point of a piece stands for the gap before it.
                let is_gap = curve.omega.values[window.first].is_nan();
                let is_same = is_near(low, window.omega.0) && is_near(high, window.omega.1);
                assert!(is_gap || is_same, "{low}, {high}: {window:?}");
                assert!(amplitude > 1.0 || window.omega.1 - window.omega.0 > omegas.1 - omegas.0, "{window:?}");
            }
            // Next to the crossing the force does no work, and windows of any forcing but this are separate.
            let told = sentence(&curve, 2, &runs[1], None, &[]).read_in(FrequencyUnit::default());
            let which = if amplitude < 1.0 { "; separate: an isola" } else { "; begins where a curve crosses" };
            assert!(told.contains(which), "{amplitude}: {told}");
        }
        assert!(curve.peaks.iter().all(|peak| !begins.contains(&peak.index)), "{:?}", curve.peaks);
    }

    /// A window is called by what is there, not by what its seeds came upon elsewhere.
    #[test]
    fn a_window_has_the_names_of_branches_of_its_frequencies() {
        let branch = |kind: &str, omega| BranchRow { kind: kind.into(), number: 1, omega, ..BranchRow::default() };
        let branches = vec![branch("main", (0.0, 1.5)), branch("isola", (3.0, 4.0))];
        let outcome = WindowOutcome::Found("isola 1; main".into());
        let (points, omega) = ([0, 2, 1], (1.0, 1.2));
        let window = WindowRow { number: 1, mode: 1, points, omega, omega_best: 1.1, threshold: 1.0, outcome };
        let level = Level { branches, ..Level::default() };
        assert_eq!(name(Some((&level, &window)), 1), "main");
        assert_eq!(
            computed("isola 1; main", &window, &level),
            " Computed: main; its seeds led to isola 1, which has other frequencies."
        );
        assert_eq!(name(None, 3), "window 3");
    }

    #[test]
    fn columns_along_runs() {
        let column = [0.0, 10.0, 20.0, 30.0];
        assert_eq!(along(&column, 0.5, 2.25), [5.0, 10.0, 20.0, 22.5]);
        assert_eq!(along(&column, 2.0, 2.0), [20.0]);
        assert_eq!(along(&column, 1.0, 3.0), [10.0, 20.0, 30.0]);
        assert!(along(&[], 0.0, 0.0)[0].is_nan());
    }
}
