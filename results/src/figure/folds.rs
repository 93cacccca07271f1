//! Fold curves: the amplitude at which branches turn back, over the forcing amplitude, with births and merges as computed.

use super::axis::largest;
use super::column_store::ColumnStore;
use super::data::{Axis, Detail, Entry, Figure, Format, Kind, Label, Measure, Panel, Series, Side, Size, Unit};
use super::references::{touch_labels, touches};
use super::style::{Color, MARK, MEDIUM, Shape, Style};
use super::subject::Subject;
use crate::overview::{BIRTH, DEATH, EventWords, MERGE, events_of, forcing_label, merge_verb};
use crate::store::CurvePoint;

/// How what happens along a curve is marked: words, mark, whether it is hollow.
pub const MARKS: [(EventWords, Shape, bool); 3] =
    [(BIRTH, Shape::Triangle, false), (DEATH, Shape::Cross, false), (MERGE, Shape::InvertedTriangle, true)];

/// How places are marked where two folds of one branch meet: neither births nor ends, and not labelled.
pub const CUSPS: (&str, Shape, bool, &str) = ("cusp", Shape::Square, true, "cusps, computed (two folds meet)");

/// Follows the forcing amplitude of what was not found with twice the harmonics (H is their number).
const UNKNOWN: &str = " (2H: not found)";

/// What is said of labels with a number that is one with twice the harmonics, or that has none.
const TWICE: &str = "; 2H: with twice the harmonics";

/// The figure.
///
/// # Errors
/// If there is no fold curve: in words.
pub fn figure(subject: &Subject<'_>, store: &mut ColumnStore) -> Result<Figure, String> {
    if subject.curves.is_empty() {
        return Err(subject.nothing("the list of fold curves", "the run has no fold curve"));
    }
    let points = || subject.curves.iter().flat_map(|curve| &curve.points);
    let x =
        Axis::logarithmic("forcing amplitude A", Unit::si(subject.forcing_unit), points().map(|point| point.forcing));
    let x = x.of(Measure::Forcing);
    let highest = largest(points().map(|point| point.amplitude));
    let monitor = subject.monitors.first().map_or("", |monitor| &monitor.name);
    let y = Axis::exact(format!("amplitude of {monitor}"), Unit::of_lengths(highest), (0.0, 1.08 * highest));
    let y = y.of(Measure::Response);

    let line = Style::line(Color::Category(3), MEDIUM);
    let mut legend = vec![Entry::new("folds, computed", Kind::Line, line.clone())];
    let mut series: Vec<Series> = subject.curves.iter().map(|curve| of_points(&curve.points, &line, store)).collect();
    let mut labels = Vec::new();
    for (words, shape, is_hollow) in MARKS {
        let found: Vec<CurvePoint> = events_of(subject.curves, words.kind.name()).into_iter().cloned().collect();
        if found.is_empty() {
            continue;
        }
        let style = Style::marks(Color::Category(3), shape, 1.4 * MARK, is_hollow);
        legend.push(Entry::new(explained(words, found.iter()), Kind::Line, style.clone()));
        let named = |point| event_label(subject, words, point, (point.forcing, point.amplitude), Side::Right);
        labels.extend(found.iter().map(named));
        series.push(of_points(&found, &style, store));
    }
    let (wanted, shape, is_hollow, name) = CUSPS;
    let cusps: Vec<CurvePoint> = events_of(subject.curves, wanted).into_iter().cloned().collect();
    if !cusps.is_empty() {
        let style = Style::marks(Color::Category(3), shape, MARK, is_hollow);
        legend.push(Entry::new(name, Kind::Line, style.clone()));
        series.push(of_points(&cusps, &style, store));
    }
    // Curves along which something begins to touch lie on the line of the gap.
    let first = subject.monitors.get(..1).unwrap_or_default();
    labels.extend(touch_labels(first));
    let panel = Panel {
        about: "Fold curves: amplitude at which branches turn back, over the forcing amplitude.",
        size: Size::Tall,
        x: vec![x],
        y: vec![y],
        series,
        spans: touches(first).into_iter().collect(),
        labels,
        has_leaders: true,
        ..Panel::default()
    };
    Ok(Figure { name: "folds", title: None, columns: 1, choice: "", linked_x: false, legend, panels: vec![panel] })
}

fn of_points(points: &[CurvePoint], style: &Style, store: &mut ColumnStore) -> Series {
    let mut column = |of: fn(&CurvePoint) -> f64| store.exact(points.iter().map(of).collect());
    let (forcing, omega, amplitude) = (column(|p| p.forcing), column(|p| p.omega), column(|p| p.amplitude));
    Series {
        x: vec![forcing.clone()],
        y: vec![amplitude.clone()],
        style: style.clone(),
        details: vec![
            Detail::new("A", Format::Number, 5, &forcing),
            Detail::new("frequency", Format::Frequency, 6, &omega),
            Detail::new("amplitude", Format::Length, 4, &amplitude),
        ],
        ..Series::default()
    }
}

/// The name of marks in the legend, with what stands on their labels explained if it has to be.
pub(super) fn explained<'p>(words: EventWords, mut points: impl Iterator<Item = &'p CurvePoint>) -> String {
    let has_twice = |point: &CurvePoint| point.doubled.is_none() || forcing_label(point, DIGITS).contains("2H");
    let twice = if points.any(has_twice) { TWICE } else { "" };
    format!("{}, computed{twice}", words.many)
}

/// Digits of forcing amplitudes on labels.
const DIGITS: i32 = 4;

/// Names a computed event of a fold curve at its place in a figure, with the doubt where it was not found with twice the harmonics.
pub(super) fn event_label(
    subject: &Subject<'_>,
    words: EventWords,
    point: &CurvePoint,
    (x, y): (f64, f64),
    side: Side,
) -> Label {
    let verb = if words == MERGE { merge_verb(subject.curves, point) } else { words.verb };
    let doubt = if point.doubled.is_none() { UNKNOWN } else { "" };
    Label {
        text: format!("{verb} at {}{doubt}", forcing_label(point, DIGITS)),
        x: vec![Some(x)],
        y: vec![Some(y)],
        color: Color::Category(3),
        level: None,
        side,
    }
}
