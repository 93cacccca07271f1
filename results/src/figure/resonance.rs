//! Frequency and size of the largest response over the forcing amplitude, three ways.

use super::axis::{bounds, frequency, largest};
use super::column_store::{ColumnStore, Ref};
use super::data::{
    Axis, Detail, Direction, Entry, Figure, Format, Kind, Label, Measure, Panel, Series, Side, Size, Span, Unit,
};
use super::style::{Color, FINE, MARK, MEDIUM, Shape, Style};
use super::subject::Subject;
use crate::curves::Resonance;
use crate::overview::{BranchRow, Level};
use solver::response::branch::BranchKind;
use solver::response::windows::{Event, EventKind};

/// Levels that span more than so many decades are shown logarithmically.
const DECADES: f64 = 2.0;
/// Of what the energy balance predicts below the lowest level, this factor is shown.
const NEAR: f64 = 4.0;
/// Of levels that lie close together no more than so many times their range is shown below them, to tell them apart; those that lie closer
/// than this share of the lowest are taken to be so far apart.
const BESIDE: f64 = 3.0;
const CLOSE: f64 = 0.05;
/// Axes begin at zero unless the lowest forcing amplitude shown is more than this share of the highest.
const FROM_ZERO: f64 = 0.3;
/// Room for the labels of births and merges below and above the curves, as a share of the axis.
const HEADROOM: f64 = 0.1;
/// Points of a curve that have marks at most.
const MARKED: usize = 60;

/// What one way of looking for the largest response finds, and how it is drawn.
struct ResonanceCurve<'w> {
    name: String,
    resonance: &'w Resonance,
    style: Style,
}

/// The figure.
///
/// # Errors
/// If there is nothing to compare: in words.
pub fn figure(subject: &Subject<'_>, store: &mut ColumnStore) -> Result<Figure, String> {
    let monitor = subject.monitors.first().map_or("", |monitor| &monitor.name);
    let events = subject.backbone.map_or(&[][..], |backbone| &backbone.events);
    let (low, high) = bounds(subject.levels.iter().map(|level| level.value));
    let lowest =
        if has_branches(subject) { (low / NEAR).max(low - BESIDE * (high - low).max(CLOSE * low)) } else { 0.0 };
    let events: Vec<(&Event, String)> =
        events.iter().map(|event| (event, subject.threshold(event.threshold))).collect();
    drawn(&curves(subject), (monitor, subject.harmonic, subject.forcing_unit), &events, lowest, store)
}

/// The same of several runs: what each is called, its largest response, and how that looks; `of`: monitored dofs, the harmonic that is
/// forced, and the unit of the forcing.
///
/// # Errors
/// If none of them has a branch: in words.
pub(super) fn compared(
    runs: &[(String, Resonance, Style)],
    of: (&str, usize, &str),
    store: &mut ColumnStore,
) -> Result<Figure, String> {
    let curves = runs.iter().map(|(name, curve, style)| ResonanceCurve {
        name: name.clone(),
        resonance: curve,
        style: style.clone(),
    });
    let curves: Vec<_> = curves.filter(|curve| !curve.resonance.value.is_empty()).collect();
    drawn(&curves, of, &[], 0.0, store)
}

/// Whether there is anything but what the energy balance predicts.
fn has_branches(subject: &Subject<'_>) -> bool {
    !subject.resonance.continuation.value.is_empty()
}

/// The figure, of the forcing amplitudes from `lowest` on.
fn drawn(
    curves: &[ResonanceCurve<'_>],
    (monitor, harmonic, unit): (&str, usize, &str),
    events: &[(&Event, String)],
    lowest: f64,
    store: &mut ColumnStore,
) -> Result<Figure, String> {
    let values =
        |of: fn(&Resonance) -> &[f64]| curves.iter().flat_map(move |curve| of(curve.resonance).iter().copied());
    let amplitudes = values(|curve| &curve.amplitude);
    if values(|curve| &curve.value).next().is_none() {
        return Err("the run has neither a backbone nor a branch yet".into());
    }
    let shown = values(|curve| &curve.value).filter(|&value| value >= lowest);
    let x = forcing(shown, Unit::si(unit)).of(Measure::Forcing);
    let mut frequency = Axis::around(frequency(harmonic), Unit::si("rad/s"), values(|curve| &curve.omega));
    frequency = frequency.of(Measure::Frequency);
    let unit = Unit::of_lengths(largest(amplitudes.clone()));
    let amplitude = Axis::around(format!("largest |{monitor}|"), unit, amplitudes.chain([0.0]));
    let amplitude = amplitude.of(Measure::Response);

    let is_shown = |(event, _): &&(&Event, String)| (0.0..=1.0).contains(&x.share(event.threshold));
    let named: Vec<&(&Event, String)> = events.iter().filter(is_shown).collect();
    let shown: Vec<&Event> = named.iter().map(|(event, _)| *event).collect();
    if !named.is_empty() {
        let (low, high) = frequency.range;
        let room = HEADROOM * (high - low);
        frequency.range = (low - room, high + room);
    }
    let panel = |y: Axis, about| Panel {
        about,
        size: Size::Low,
        x: vec![x.clone()],
        spans: shown.iter().map(|event| span(event)).collect(),
        y: vec![y],
        has_leaders: false,
        ..Panel::default()
    };
    let labels = named.iter().map(|(event, told)| label(event, told, &frequency)).collect();
    let mut above = Panel { labels, ..panel(frequency, "Resonance over forcing: frequency") };
    let mut below = panel(amplitude, "Resonance over forcing: largest amplitude");
    for curve in curves {
        let columns = [&curve.resonance.value, &curve.resonance.omega, &curve.resonance.amplitude];
        let [x, omega, amplitude] = columns.map(|values| store.exact(values.clone()));
        above.series.push(series(curve, &x, &omega, (&omega, &amplitude)));
        below.series.push(series(curve, &x, &amplitude, (&omega, &amplitude)));
        let places = &curve.resonance.at_least;
        if !places.is_empty() {
            let marks = |y: &Ref| Series {
                x: vec![x.at(places)],
                y: vec![y.at(places)],
                style: at_least(curve.style.color),
                ..Series::default()
            };
            above.series.push(marks(&omega));
            below.series.push(marks(&amplitude));
        }
    }
    let entry = |curve: &ResonanceCurve<'_>| Entry::new(curve.name.clone(), Kind::Line, curve.style.clone());
    let mut legend: Vec<Entry> = curves.iter().map(entry).collect();
    if curves.iter().any(|curve| !curve.resonance.at_least.is_empty()) {
        legend.push(Entry::new("at least: known only as far as its branch", Kind::Line, at_least(Color::Ink)));
    }
    for (kind, text) in [(EventKind::Birth, "▲ window born"), (EventKind::Merge, "▼ windows merge")] {
        let event = shown.iter().find(|event| event.kind == kind);
        legend.extend(event.map(|event| Entry::new(text, Kind::Line, span(event).style)));
    }
    Ok(Figure {
        name: "resonance",
        title: None,
        columns: 1,
        choice: "",
        linked_x: true,
        legend,
        panels: vec![above, below],
    })
}

/// Marks what may be larger.
fn at_least(color: Color) -> Style {
    Style::marks(color, Shape::Triangle, 1.8 * MARK, true)
}

fn curves<'s>(subject: &Subject<'s>) -> Vec<ResonanceCurve<'s>> {
    let resonance = subject.resonance;
    let line = |category| Style::line(Color::Category(category), MEDIUM);
    let peaks = || subject.levels.iter().filter_map(Level::peak).filter(|peak| peak.kind != BranchKind::Main.name());
    // What branches off another response may be larger than any isola.
    let found =
        match (peaks().all(BranchRow::is_isola), subject.levels.iter().any(|level| level.isolas().next().is_some())) {
            (true, _) => "with isolas",
            (false, true) => "with isolas and others",
            (false, false) => "with other branches",
        };
    let circles = line(0).with_dash(2).with_marker(Shape::Circle, 0.9 * MARK, true);
    let curves = [
        ResonanceCurve {
            name: "energy balance alone".into(),
            resonance: &resonance.balance,
            style: line(2).with_dash(1),
        },
        ResonanceCurve {
            name: found.into(),
            resonance: &resonance.isolas,
            style: line(1).with_marker(Shape::Square, MARK, false),
        },
        ResonanceCurve { name: "main branches alone".into(), resonance: &resonance.continuation, style: circles },
    ];
    let is_there = |curve: &ResonanceCurve<'_>| !curve.resonance.value.is_empty();
    let unmarked = |curve: ResonanceCurve<'s>| match curve.resonance.value.len() {
        0..=MARKED => curve,
        _ => ResonanceCurve { style: Style { marker: None, ..curve.style }, ..curve },
    };
    curves.into_iter().filter(is_there).map(unmarked).collect()
}

fn forcing(values: impl Iterator<Item = f64> + Clone, unit: Unit) -> Axis {
    let (low, high) = bounds(values.clone().filter(|&value| value > 0.0));
    let title = "forcing amplitude A";
    if (high / low).log10() > DECADES {
        Axis::logarithmic(title, unit, values)
    } else {
        let zero = (low <= FROM_ZERO * high).then_some(0.0);
        Axis::around(title, unit, values.chain(zero))
    }
}

fn series(curve: &ResonanceCurve<'_>, x: &Ref, y: &Ref, (omega, amplitude): (&Ref, &Ref)) -> Series {
    Series {
        name: vec![curve.name.clone()],
        x: vec![x.clone()],
        y: vec![y.clone()],
        style: curve.style.clone(),
        details: vec![
            Detail::new("A", Format::Number, 4, x),
            Detail::new("frequency", Format::Frequency, 6, omega),
            Detail::new("largest amplitude", Format::Length, 4, amplitude),
        ],
        ..Series::default()
    }
}

fn span(event: &Event) -> Span {
    let dash = if event.kind == EventKind::Birth { 2 } else { 1 };
    let style = Style::line(Color::Shade, FINE).with_dash(dash);
    Span { axis: Direction::X, at: vec![Some(event.threshold)], by_amplitude: false, style }
}

/// Births are named at the foot, merges at the head of their lines.
fn label(event: &Event, told: &str, axis: &Axis) -> Label {
    let (mark, y, side) = match event.kind {
        EventKind::Birth => ("▲", axis.range.0, Side::Right),
        EventKind::Merge => ("▼", axis.range.1, Side::Right),
    };
    Label {
        text: format!("{mark} {told}"),
        x: vec![Some(event.threshold)],
        y: vec![Some(y)],
        color: Color::Soft,
        level: None,
        side,
    }
}
