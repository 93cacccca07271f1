//! One period at any point of a branch: how far gaps close, displacements, pressures, spectrum, shape of the tip.

use super::column_store::ColumnStore;
use super::data::{
    Axis, Direction, Entry, Figure, Kind, Label, Panel, Quantity, Series, Side, Signal, Size, Span, Unit,
};
use super::style::{BOLD, Color, FINE, MARK, MEDIUM, Shape, Style, THIN};
use super::units::convert_length;
use crate::curves::{MarchedPeriod, Motions, Node};
use crate::overview::verdict_words;
use crate::store::verdict_name;
use crate::summary_table::LengthUnit;
use serde::Serialize;
use solver::formulation::harmonics::{complex, evaluate, width};
use std::f64::consts::TAU;
use std::ops::Range;

/// Panels of displacements: of contact nodes, and of monitored dofs.
const CLOSING: &str = "Closing of the gap";
const DISPLACEMENT: &str = "Displacement of monitored dofs";
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
    let touching = motions.touching();
    let mut panels = Vec::new();
    if touching > 0 {
        panels.extend([closing(nodes, touching), pressures(nodes, touching)]);
    }
    panels.extend((touching < nodes.len()).then(|| displacements(nodes, touching)));
    panels.push(spectrum(nodes, motions.harmonics));
    panels.extend((motions.along().len() > 1).then(|| shapes(motions)));
    let entry = |(k, node): (usize, &Node)| Entry::new(node.name.clone(), Kind::Line, look(k, nodes.len()));
    let nodes_told = nodes.iter().enumerate().map(entry).filter(|_| nodes.len() > 1);
    let has_lines = |name| panels.iter().any(|panel: &Panel| panel.about == name && !panel.spans.is_empty());
    let lines = [(CLOSING, "gap", gap()), (DISPLACEMENT, "contact begins", begin())];
    let lines = lines.into_iter().filter(|line| has_lines(line.0));
    let legend = nodes_told.chain(lines.map(|(_, text, style)| Entry::new(text, Kind::Line, style))).collect();
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
                panel.labels.extend(instants(&x, &y, motions.along().len()));
            }
            (series.x, series.y) = (vec![store.exact(x)], vec![store.exact(y)]);
        }
    }
    figure
}

/// With the marched period in the panels of displacements, over those of the balance.
pub fn with_marched(mut figure: Figure, motions: &Motions, marched: &MarchedPeriod, store: &mut ColumnStore) -> Figure {
    // Dotted, wider and of another colour, so that what lies below is seen.
    let style = Style::line(Color::Category(2), MEDIUM).with_dash(2);
    let x = store.exact(marched.times.clone());
    let (touching, others) = marched.displacements.split_at(motions.touching());
    for (title, displacements) in [(CLOSING, touching), (DISPLACEMENT, others)] {
        let Some(panel) = figure.panels.iter_mut().find(|panel| panel.about == title) else { continue };
        if let Some(axis) = panel.y.first_mut() {
            let all = displacements.iter().flatten().copied();
            axis.range = all.fold(axis.range, |(low, high), x| (low.min(x), high.max(x)));
        }
        for displacement in displacements {
            let y = vec![store.exact(displacement.clone())];
            panel.series.push(Series { x: vec![x.clone()], y, style: style.clone(), ..Series::default() });
        }
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

fn of_each(nodes: &[Node], range: Range<usize>, of: Quantity, style: impl Fn(Style) -> Style) -> Vec<Series> {
    let series = |node: usize| Series {
        name: vec![nodes[node].name.clone()],
        style: style(look(node, nodes.len())),
        signal: Some(Signal { node, of, instants: None }),
        ..Series::default()
    };
    range.map(series).collect()
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

/// The line of a gap.
fn gap() -> Style {
    Style::line(Color::Soft, THIN).with_dash(1)
}

/// The line where contact begins.
fn begin() -> Style {
    Style::line(Color::Soft, FINE).with_dash(2)
}

/// How far contact nodes go towards what they touch, with their gaps.
fn closing(nodes: &[Node], touching: usize) -> Panel {
    let series = of_each(nodes, 0..touching, Quantity::Displacement, |style| style);
    let spans = lines(nodes.iter().filter_map(|node| node.gap), &gap());
    Panel { spans, ..panel(CLOSING, period(), "closing of the gap", series) }
}

/// Of monitored dofs, with the places where stops begin to act.
fn displacements(nodes: &[Node], touching: usize) -> Panel {
    let series = of_each(nodes, touching..nodes.len(), Quantity::Displacement, |style| style);
    let spans = lines(nodes[touching..].iter().flat_map(|node| &node.stops).copied(), &begin());
    Panel { spans, ..panel(DISPLACEMENT, period(), "displacement", series) }
}

/// Lines across at these values.
fn lines(values: impl Iterator<Item = f64>, style: &Style) -> Vec<Span> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let line = |at| Span { axis: Direction::Y, at: vec![Some(at)], by_amplitude: false, style: style.clone() };
    values.into_iter().map(line).collect()
}

fn pressures(nodes: &[Node], touching: usize) -> Panel {
    let series = of_each(nodes, 0..touching, Quantity::Pressure, |style| style);
    panel("Contact pressure", period(), "contact pressure", series)
}

fn spectrum(nodes: &[Node], harmonics: usize) -> Panel {
    let x = Axis::around("harmonic k", Unit::none(), [-0.4, harmonics as f64 + 0.4]);
    let thin = |style: Style| Style { width: 0.6 * THIN, ..style }.with_marker(Shape::Circle, 0.5 * MARK, false);
    let y = Axis::logarithmic("harmonics |cₖ|", Unit::si("m"), [1e-6, 1e-3]);
    Panel { y: vec![y], ..panel("Spectrum", x, "", of_each(nodes, 0..nodes.len(), Quantity::Spectrum, thin)) }
}

fn shapes(motions: &Motions) -> Panel {
    let nodes = motions.along();
    let ticks = nodes.iter().enumerate().map(|(k, node)| ((k + 1) as f64, node.name.clone())).collect();
    let (along, up) = match motions.touching() {
        0 => ("monitored dof", "displacement"),
        _ => ("contact node", "closing of the gap"),
    };
    let count = if nodes.len() < CROSSING { SHAPES.len() / 2 } else { SHAPES.len() };
    let x = Axis { ticks, ..Axis::exact(along, Unit::none(), (0.8, nodes.len() as f64 + ROOM)) };
    let series = vec![
        of_all(Quantity::Gap, gap(), None),
        of_all(Quantity::Shapes, Style::line(Color::Shade, THIN), Some(count)),
        of_all(Quantity::Shape, Style::line(Color::Category(1), BOLD).with_marker(Shape::Circle, MARK, false), None),
    ];
    // A label that has to stand away from its shape is led to it.
    Panel { has_leaders: true, ..panel("Shape at instants of the period", x, up, series) }
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
    let along = motions.along();
    let over_period = |which: usize| {
        let at = |i: usize| i as f64 / INSTANTS as f64;
        (0..=INSTANTS).map(|i| (at(i), evaluate(part(signal.node, which), TAU * at(i))[0])).unzip()
    };
    let places = (1..=along.len()).map(|place| place as f64);
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
            let all = (0..motions.nodes.len()).flat_map(|node| (0..=motions.harmonics).map(move |k| size(node, k)));
            let floor = FLOOR * all.fold(0.0, f64::max);
            let drawn = (0..=motions.harmonics).map(|k| (k as f64, size(signal.node, k)));
            drawn.filter(|(_, size)| *size > floor).unzip()
        }
        Quantity::Gap => (places.collect(), along.iter().map(|node| node.gap.unwrap_or(f64::NAN)).collect()),
        Quantity::Shape | Quantity::Shapes => {
            let instants = signal.instants.unwrap_or(1);
            let at = |i: usize| {
                let phase = TAU * i as f64 / instants as f64;
                let shape = (0..along.len()).map(move |node| ((node + 1) as f64, evaluate(part(node, 0), phase)[0]));
                shape.chain([(f64::NAN, f64::NAN)])
            };
            (0..instants).flat_map(at).unzip()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Study;

    #[test]
    fn gaps_close_beside_what_monitored_dofs_do() {
        let study = Study::new("two_masses_stop", 3, &["0.02"]);
        let motions = Motions::new(&study.model, 3);
        let figure = template(&motions);
        let up = |panel: &Panel| (panel.about, panel.y[0].title.clone(), panel.series.len());
        let panels: Vec<(&str, String, usize)> = figure.panels.iter().map(up).collect();
        let expected = [
            (CLOSING, "closing of the gap", 1),
            ("Contact pressure", "contact pressure", 1),
            (DISPLACEMENT, "displacement", 2),
            ("Spectrum", "harmonics |cₖ|", 3),
        ];
        assert_eq!(panels, expected.map(|(about, title, count)| (about, title.to_string(), count)));
        let legend = figure.legend.iter().map(|entry| entry.text.as_str());
        assert_eq!(legend.collect::<Vec<_>>(), ["stop", "x1", "x2", "gap"]);
        // Marched displacements lie over those of the same places.
        let marched = MarchedPeriod {
            omega: 1.0,
            verdict: solver::stability::multipliers::Verdict::Stable,
            times: vec![0.0, 1.0],
            displacements: vec![vec![1.0, 2.0], vec![3.0, 4.0], vec![5.0, 6.0]],
        };
        let mut store = ColumnStore::default();
        let figure = with_marched(figure, &motions, &marched, &mut store);
        let last = |panel: &Panel| store.values(&panel.series.last().unwrap().y[0], 1.0);
        assert_eq!([0, 2].map(|panel| last(&figure.panels[panel])), [[1.0, 2.0], [5.0, 6.0]]);
    }
}
