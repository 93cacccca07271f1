//! One period at any point of a branch: displacements against the casing, pressures, spectrum, shape of the tip.

use super::column_store::ColumnStore;
use super::data::{
    Axis, Direction, Entry, Figure, Kind, Label, Panel, Quantity, Series, Side, Signal, Size, Span, Unit,
};
use super::places::Placement;
use super::style::{BOLD, Color, FINE, MARK, MEDIUM, Shape, Style, THIN};
use super::units::convert_length;
use crate::curves::{MarchedPeriod, Motions, Node};
use crate::overview::verdict_words;
use crate::store::verdict_name;
use crate::summary_table::LengthUnit;
use serde::Serialize;
use solver::formulation::harmonics::{complex, evaluate, width};
use std::f64::consts::TAU;

/// Instants of a period at which curves are computed.
const INSTANTS: usize = 512;
/// Instants at which the shape of the tip is drawn, evenly over the period T.
const SHAPES: [&str; 8] = ["0", "T/8", "T/4", "3T/8", "T/2", "5T/8", "3T/4", "7T/8"];
/// Shapes of fewer nodes cross each other too near to the labels: every second one is drawn.
const CROSSING: usize = 4;
/// Room beside the last node for their labels.
const ROOM: f64 = 0.95;
/// Harmonics below this share of the largest are not drawn.
const FLOOR: f64 = 1e-6;
/// Dashes that nodes have in turn.
const DASHES: usize = 3;

/// What a panel shows of one motion: its axis up.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MotionAxis {
    range: (f64, f64),
    unit: Unit,
}

impl MotionAxis {
    /// In this unit, if it is one of lengths and one is chosen.
    pub fn with_length(mut self, chosen: Option<LengthUnit>) -> Self {
        convert_length(&mut self.unit, chosen);
        self
    }
}

/// The figure without a motion.
///
/// # Errors
/// If there is no motion: in words.
pub fn figure(motions: &Motions) -> Result<Figure, String> {
    if motions.points.is_empty() {
        return Err("no branch has been computed yet".into());
    }
    Ok(template(motions))
}

/// The figure of any motion of these nodes.
pub fn template(motions: &Motions) -> Figure {
    let nodes = &motions.nodes;
    let has_contact = nodes.iter().any(|node| node.gap.is_some());
    let mut panels = vec![displacements(nodes, has_contact)];
    panels.extend(has_contact.then(|| pressures(nodes)));
    panels.push(spectrum(nodes, motions.harmonics));
    panels.extend((nodes.len() > 1).then(|| shapes(nodes)));
    let entry = |(k, node): (usize, &Node)| Entry::new(node.name.clone(), Kind::Line, look(k, nodes.len()));
    let legend = nodes.iter().enumerate().map(entry).filter(|_| nodes.len() > 1).collect();
    Figure { name: "motion", title: None, columns: panels.len().min(2), choice: "", linked_x: false, legend, panels }
}

/// The axes up of the panels for one motion.
pub fn axes(figure: &Figure, motions: &Motions, coefficients: &[f64]) -> Vec<MotionAxis> {
    let axis = |panel: &Panel| {
        let axis = up(panel, motions, coefficients);
        MotionAxis { range: axis.range, unit: axis.unit }
    };
    figure.panels.iter().map(axis).collect()
}

/// The figure of one motion, with its columns.
pub fn drawn(mut figure: Figure, motions: &Motions, coefficients: &[f64], store: &mut ColumnStore) -> Figure {
    for panel in &mut figure.panels {
        panel.y = vec![up(panel, motions, coefficients)];
        panel.series.retain(|series| series.signal.is_some_and(|signal| signal.of != Quantity::Shape));
        for series in &mut panel.series {
            let Some(signal) = series.signal.take() else { continue };
            let (x, y) = values(signal, motions, coefficients);
            if signal.of == Quantity::Shapes {
                panel.labels.extend(instants(&x, &y, motions.nodes.len()));
            }
            (series.x, series.y) = (vec![store.exact(x)], vec![store.exact(y)]);
        }
    }
    figure
}

/// With the marched period in the panel of displacements, over those of the balance.
pub fn with_marched(mut figure: Figure, marched: &MarchedPeriod, store: &mut ColumnStore) -> Figure {
    // Dotted, wider and of another colour, so that what lies below is seen.
    let style = Style::line(Color::Category(2), MEDIUM).with_dash(2);
    let Some(panel) = figure.panels.first_mut() else { return figure };
    let highest = marched.displacements.iter().flatten().copied();
    if let Some(axis) = panel.y.first_mut() {
        let (low, high) = highest.fold(axis.range, |(low, high), x| (low.min(x), high.max(x)));
        axis.range = (low, high);
    }
    let x = store.exact(marched.times.clone());
    for displacement in &marched.displacements {
        let y = vec![store.exact(displacement.clone())];
        panel.series.push(Series { x: vec![x.clone()], y, style: style.clone(), ..Series::default() });
    }
    let text = format!("marched in time ({})", verdict_words(verdict_name(marched.verdict)).word);
    figure.legend.push(Entry::new(text, Kind::Line, style));
    figure
}

/// Nodes have the colours of the ramp in their order.
fn look(node: usize, count: usize) -> Style {
    let share = if count < 2 { 1.0 } else { node as f64 / (count - 1) as f64 };
    Style::line(Color::Level(share), THIN).with_dash(node % DASHES)
}

fn of_each(nodes: &[Node], of: Quantity, style: impl Fn(Style) -> Style) -> Vec<Series> {
    let series = |(node, named): (usize, &Node)| Series {
        name: vec![named.name.clone()],
        style: style(look(node, nodes.len())),
        signal: Some(Signal { node, of, instants: None }),
        ..Series::default()
    };
    nodes.iter().enumerate().map(series).collect()
}

fn of_all(of: Quantity, style: Style, instants: Option<usize>) -> Series {
    Series { style, signal: Some(Signal { node: 0, of, instants }), ..Series::default() }
}

fn panel(about: &'static str, x: Axis, y: &str, series: Vec<Series>) -> Panel {
    Panel {
        title: Some(about),
        about,
        size: Size::Medium,
        x: vec![x],
        y: vec![Axis::exact(y, Unit::none(), (0.0, 1.0))],
        series,
        has_leaders: false,
        ..Panel::default()
    }
}

fn period() -> Axis {
    Axis::exact("time (periods)", Unit::none(), (0.0, 1.0))
}

fn displacements(nodes: &[Node], has_contact: bool) -> Panel {
    let about = if has_contact { "Displacement towards the stop" } else { "Displacement" };
    let mut gaps: Vec<f64> = nodes.iter().flat_map(|node| node.gap.iter().chain(&node.stops)).copied().collect();
    gaps.sort_by(f64::total_cmp);
    gaps.dedup();
    let style = Style::line(Color::Soft, FINE).with_dash(2);
    let span = |gap: &f64| Span { axis: Direction::Y, at: vec![Some(*gap)], by_amplitude: false, style: style.clone() };
    let label = |gap: &f64| Label {
        text: "gap".into(),
        x: vec![None],
        y: vec![Some(*gap)],
        color: Color::Soft,
        level: None,
        side: Side::Above,
    };
    let labels: Vec<Label> = gaps.first().map(label).into_iter().collect();
    let placements = labels.iter().map(|_| Placement::fixed(0, "bottom_right", (-4, -2))).collect();
    Panel {
        spans: gaps.iter().map(span).collect(),
        labels,
        placements,
        ..panel(about, period(), "displacement", of_each(nodes, Quantity::Displacement, |style| style))
    }
}

fn pressures(nodes: &[Node]) -> Panel {
    panel("Contact pressure", period(), "contact pressure", of_each(nodes, Quantity::Pressure, |style| style))
}

fn spectrum(nodes: &[Node], harmonics: usize) -> Panel {
    let x = Axis::around("harmonic k", Unit::none(), [-0.4, harmonics as f64 + 0.4]);
    let thin = |style: Style| Style { width: 0.6 * THIN, ..style }.with_marker(Shape::Circle, 0.5 * MARK, false);
    let y = Axis::logarithmic("harmonics |cₖ|", Unit::si("m"), [1e-6, 1e-3]);
    Panel { y: vec![y], ..panel("Spectrum", x, "", of_each(nodes, Quantity::Spectrum, thin)) }
}

fn shapes(nodes: &[Node]) -> Panel {
    let ticks = nodes.iter().enumerate().map(|(k, node)| ((k + 1) as f64, node.name.clone())).collect();
    let along = if nodes.iter().any(|node| node.gap.is_some()) { "node" } else { "monitored dof" };
    let count = if nodes.len() < CROSSING { SHAPES.len() / 2 } else { SHAPES.len() };
    let x = Axis { ticks, ..Axis::exact(along, Unit::none(), (0.8, nodes.len() as f64 + ROOM)) };
    let series = vec![
        of_all(Quantity::Gap, Style::line(Color::Soft, THIN).with_dash(1), None),
        of_all(Quantity::Shapes, Style::line(Color::Shade, THIN), Some(count)),
        of_all(Quantity::Shape, Style::line(Color::Category(1), BOLD).with_marker(Shape::Circle, MARK, false), None),
    ];
    // A label that has to stand away from its shape is led to it.
    Panel { has_leaders: true, ..panel("Shape at instants of the period", x, "displacement", series) }
}

/// Labels of the shapes beside their last node.
fn instants(x: &[f64], y: &[f64], nodes: usize) -> Vec<Label> {
    let last = |(k, text): (usize, &&str)| {
        let place = k * (nodes + 1) + nodes - 1;
        Label {
            text: (*text).into(),
            x: vec![x.get(place).copied()],
            y: vec![y.get(place).copied()],
            color: Color::Soft,
            level: None,
            side: Side::Level,
        }
    };
    let drawn = if nodes < CROSSING { 2 } else { 1 };
    SHAPES.iter().step_by(drawn).enumerate().map(last).collect()
}

/// The axis up of a panel for one motion.
fn up(panel: &Panel, motions: &Motions, coefficients: &[f64]) -> Axis {
    let signals = panel.series.iter().filter_map(|series| series.signal);
    let all = signals.flat_map(|signal| values(signal, motions, coefficients).1);
    let gaps = panel.spans.iter().flat_map(|span| &span.at).copied().flatten();
    let values: Vec<f64> = all.chain(gaps).filter(|value| value.is_finite()).collect();
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let title = panel.y.first().map_or("", |axis| &axis.title);
    match panel.series.first().and_then(|series| series.signal).map(|signal| signal.of) {
        Some(Quantity::Spectrum) => Axis::logarithmic(title, Unit::of_lengths(largest), values),
        Some(Quantity::Pressure) => Axis::around(title, Unit::si("N"), values.into_iter().chain([0.0])),
        _ => Axis::around(title, Unit::of_lengths(largest), values),
    }
}

/// What a series shows of a motion.
fn values(signal: Signal, motions: &Motions, coefficients: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let nc = width(motions.harmonics);
    let part = |node: usize, which: usize| coefficients.chunks(nc).nth(2 * node + which).unwrap_or(&[0.0]);
    let count = motions.nodes.len();
    let over_period = |which: usize| {
        let at = |i: usize| i as f64 / INSTANTS as f64;
        (0..=INSTANTS).map(|i| (at(i), evaluate(part(signal.node, which), TAU * at(i))[0])).unzip()
    };
    let places = (1..=count).map(|place| place as f64);
    match signal.of {
        Quantity::Displacement => over_period(0),
        Quantity::Pressure => {
            let (x, y): (_, Vec<f64>) = over_period(1);
            (x, y.into_iter().map(|pressure| pressure.max(0.0)).collect())
        }
        Quantity::Spectrum => {
            let size = |node: usize, k: usize| match k {
                0 => part(node, 0)[0].abs(),
                k => complex(part(node, 0), k).norm(),
            };
            let all = (0..count).flat_map(|node| (0..=motions.harmonics).map(move |k| size(node, k)));
            let floor = FLOOR * all.fold(0.0, f64::max);
            let drawn = (0..=motions.harmonics).map(|k| (k as f64, size(signal.node, k)));
            drawn.filter(|(_, size)| *size > floor).unzip()
        }
        Quantity::Gap => (places.collect(), motions.nodes.iter().map(|node| node.gap.unwrap_or(f64::NAN)).collect()),
        Quantity::Shape | Quantity::Shapes => {
            let instants = signal.instants.unwrap_or(1);
            let at = |i: usize| {
                let phase = TAU * i as f64 / instants as f64;
                let shape = (0..count).map(move |node| ((node + 1) as f64, evaluate(part(node, 0), phase)[0]));
                shape.chain([(f64::NAN, f64::NAN)])
            };
            (0..instants).flat_map(at).unzip()
        }
    }
}
