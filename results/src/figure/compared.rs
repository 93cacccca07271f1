//! Figures of several runs together, one colour a run.

use super::coincidence::Coincidence;
use super::column_store::ColumnStore;
use super::data::{Axis, Direction, Entry, Figure, Kind, Label, Side, Span};
use super::response::{Outline, branch_series, called, is_crowd, make_room};
use super::smooth::smooth;
use super::stability::Marking;
use super::style::{BOLD, Color, FINE, MEDIUM, Shape, Style};
use super::subject::Subject;
use super::{resonance, style};
use crate::curves::Curve;
use std::collections::BTreeMap;

/// A run among others.
#[derive(Debug, Clone, Copy)]
pub struct Compared<'r> {
    /// What it is called.
    pub name: &'r str,
    /// What there is of it.
    pub subject: Subject<'r>,
}

/// The figures that several runs have together, with their columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ComparedFigures {
    /// Columns that they share.
    pub columns: ColumnStore,
    /// By name: `response` and `resonance`.
    pub drawn: BTreeMap<&'static str, Figure>,
    /// By name, why there is nothing to draw.
    pub nothing: BTreeMap<&'static str, String>,
}

impl ComparedFigures {
    /// Of runs; `levels` are the forcing amplitudes of all of them.
    pub fn new(runs: &[Compared<'_>], levels: &[f64]) -> Self {
        let mut all = Self::default();
        let figures =
            [("response", response(runs, levels, &mut all.columns)), ("resonance", resonances(runs, &mut all.columns))];
        for (name, figure) in figures {
            match figure {
                Ok(figure) => drop(all.drawn.insert(name, figure)),
                Err(why) => drop(all.nothing.insert(name, why)),
            }
        }
        all
    }
}

/// The colour of a run: another one for each of a few.
fn color(run: usize) -> Color {
    Color::Category(run)
}

/// Amplitude of the first monitored dof over frequency.
fn response(runs: &[Compared<'_>], levels: &[f64], store: &mut ColumnStore) -> Result<Figure, String> {
    let colors: Vec<Vec<Color>> =
        runs.iter().enumerate().map(|(k, run)| vec![color(k); run.subject.levels.len()]).collect();
    let drawn = runs.iter().zip(&colors).filter(|(run, _)| !run.subject.branches.is_empty());
    let outlines: Vec<Figure> = drawn
        .map(|(run, colors)| Outline::new(run.subject.branches.iter(), &run.subject, colors).figure(None))
        .collect();
    let Some(mut figure) = outlines.first().cloned() else { return Err("none of the runs has a branch yet".into()) };
    let panel = &mut figure.panels[0];
    let of_all = |of: fn(&Figure) -> &Axis| spanned(outlines.iter().map(of));
    panel.x = vec![of_all(|figure| &figure.panels[0].x[0])];
    panel.y = vec![Axis {
        title: format!("amplitude of {}", monitors(runs).join(", ")),
        ..of_all(|figure| &figure.panels[0].y[0])
    }];
    panel.about = "Forced responses of several runs: amplitude over frequency, one colour a run.";
    let place = |value: f64| levels.iter().position(|known| *known == value);
    let branches: usize = runs.iter().map(|run| run.subject.branches.iter().filter(|b| b.kind != "main").count()).sum();
    let axes = (panel.x[0].clone(), panel.y.clone());
    let marking = Marking::of(runs.iter().flat_map(|run| run.subject.branches));
    let mut labels: Vec<Label> = Vec::new();
    for (k, Compared { name, subject }) in runs.iter().enumerate() {
        let all: Vec<&Curve> = subject.branches.iter().collect();
        let same = Coincidence::of(&all, 1);
        for (i, branch) in all.iter().enumerate() {
            let level = subject.levels.get(branch.level);
            let amplitude = level.map_or("", |level| &level.amplitude);
            let mut curve = branch_series(branch, amplitude, color(k), is_crowd(branches), store);
            curve.name = same.names(&all, i).iter().map(|own| format!("{name}: {}", called(amplitude, own))).collect();
            curve.level = level.and_then(|level| place(level.value));
            curve.y.truncate(1);
            curve.style.fill = false;
            make_room(&mut curve, branch, (&axes.0, &axes.1[0]));
            let heights = branch.amplitude.first().map_or(&[][..], |column| &column.values);
            smooth(&mut curve, (&branch.omega.values, &[heights]), (&axes.0, &axes.1), store);
            let over = marking.over(branch, &curve, (&axes.0, &axes.1), store);
            panel.series.extend(std::iter::once(curve).chain(over).map(|series| same.veiled(i, series)));
        }
        let own = Outline::new(subject.branches.iter(), subject, &colors[k]).figure(None).panels.swap_remove(0).labels;
        labels.extend(own.into_iter().filter_map(|label| {
            let level = subject.levels.get(label.level?)?;
            Some(Label { level: place(level.value), ..label })
        }));
    }
    let own = touch_lines(runs);
    if !own.is_empty() {
        panel.spans = own.iter().map(|(span, _)| span.clone()).collect();
        panel.labels = own.into_iter().map(|(_, label)| label).chain(labels).collect();
    } else {
        let gap = panel.labels.iter().find(|label| label.level.is_none()).cloned();
        panel.labels = gap.into_iter().chain(labels).collect();
    }
    figure.choice = "";
    figure.legend = entries(runs, |k| Style::line(color(k), BOLD));
    let thin = Entry::new("main branch", Kind::Line, Style::line(Color::Ink, style::THIN));
    let bold = Entry::new("isola and others", Kind::Line, Style::line(Color::Ink, BOLD));
    figure.legend.extend([thin, bold]);
    figure.legend.extend(marking.entries(Color::Ink));
    Ok(figure)
}

/// A line where each run touches in its colour, where that differs; none where it does not.
fn touch_lines(runs: &[Compared<'_>]) -> Vec<(Span, Label)> {
    let touch = |run: &Compared<'_>| run.subject.monitors.first().and_then(|monitor| monitor.touch);
    let first = runs.first().and_then(touch);
    if runs.iter().all(|run| touch(run) == first) {
        return Vec::new();
    }
    let of_run = |(k, run): (usize, &Compared<'_>)| {
        let touch = touch(run)?;
        let y = vec![Some(touch.at)];
        let style = Style::line(color(k), FINE).with_dash(2);
        let text = format!("{} of {}", touch.name(), run.name);
        let label = Label { text, x: vec![None], y: y.clone(), color: color(k), level: None, side: Side::Above };
        Some((Span { axis: Direction::Y, at: y, by_amplitude: false, style }, label))
    };
    runs.iter().enumerate().filter_map(of_run).collect()
}

/// An axis that holds others, in the unit of the one that reaches farthest.
fn spanned<'a>(axes: impl Iterator<Item = &'a Axis> + Clone) -> Axis {
    let widest = axes.clone().max_by(|a, b| a.range.1.total_cmp(&b.range.1)).expect("there is a figure");
    let joined = |ends: fn(&Axis) -> (f64, f64)| {
        let ends = axes.clone().map(ends);
        ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (l, h)| (low.min(l), high.max(h)))
    };
    let whole = widest.whole.map(|_| joined(|axis| axis.whole.unwrap_or(axis.range)));
    Axis { range: joined(|axis| axis.range), whole, ..widest.clone() }
}

/// Frequency and size of the largest response over the forcing.
fn resonances(runs: &[Compared<'_>], store: &mut ColumnStore) -> Result<Figure, String> {
    let way = |(k, run): (usize, &Compared<'_>)| {
        let style = Style::line(color(k), MEDIUM).with_dash(k);
        let shapes = [Shape::Square, Shape::Circle, Shape::Triangle, Shape::InvertedTriangle, Shape::Cross];
        let style = style.with_marker(shapes[k % shapes.len()], style::MARK, false);
        (run.name.to_string(), run.subject.resonance.isolas.clone(), style)
    };
    let ways: Vec<_> = runs.iter().enumerate().map(way).collect();
    let harmonic = runs.first().map_or(1, |run| run.subject.harmonic);
    let unit = runs.first().map_or("", |run| run.subject.forcing_unit);
    let unit = if runs.iter().all(|run| run.subject.forcing_unit == unit) { unit } else { "" };
    resonance::compared(&ways, (&monitors(runs).join("|, |"), harmonic, unit), store)
}

/// The dofs whose amplitudes runs have, each once.
fn monitors<'r>(runs: &[Compared<'r>]) -> Vec<&'r str> {
    let mut names: Vec<&str> = Vec::new();
    for monitor in runs.iter().filter_map(|run| run.subject.monitors.first()) {
        if !names.contains(&monitor.name.as_str()) {
            names.push(&monitor.name);
        }
    }
    names
}

fn entries(runs: &[Compared<'_>], style: impl Fn(usize) -> Style) -> Vec<Entry> {
    let entry = |(k, run): (usize, &Compared<'_>)| Entry::new(run.name, Kind::Line, style(k));
    runs.iter().enumerate().map(entry).collect()
}
