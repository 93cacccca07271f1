//! Amplitude over frequency along the backbone, with the windows of the forcing amplitude looked at.

use super::data::{Axis, Entry, Figure, Kind, Panel, Series};
use super::places::{RunLabels, RunPoint};
use super::references::{touch_labels, touches};
use super::style::{BOLD, Color, Style, THIN};
use super::subject::{BackboneColumns, Subject};

/// The figure.
///
/// # Errors
/// If there is no backbone: in words.
pub fn figure(subject: &Subject<'_>, columns: Option<&BackboneColumns>) -> Result<Figure, String> {
    let backbone = subject.backbone()?;
    let columns = columns.ok_or("the run has no backbone yet")?;
    let count = subject.shown(backbone);
    let frequencies = Axis::around("", super::data::Unit::none(), backbone.omega.values.iter().copied().take(count));
    let line =
        |style| Series { x: vec![columns.omega.clone()], y: columns.amplitude.clone(), style, ..Series::default() };
    let (thin, bold) = (Style::line(Color::Ink, THIN), Style::line(Color::Category(1), 2.0 * BOLD));
    let series = vec![
        Series { along_runs: true, ..line(bold.clone()) },
        Series { name: vec!["backbone".into()], details: columns.details(), ..line(thin.clone()) },
    ];
    let entry = |text: &str, style| Entry::new(text, Kind::Line, style);
    let panel = Panel {
        title: Some("Where that is on the backbone"),
        about: "Backbone with the windows of the chosen forcing amplitude",
        x: vec![Axis::of_frequencies(frequencies.range, subject.harmonic)],
        y: subject.amplitudes(|m| backbone.amplitude[m].values.iter().copied().take(count)),
        series,
        spans: touches(subject.monitors).into_iter().collect(),
        labels: touch_labels(subject.monitors),
        run_labels: Some(RunLabels { series: 1, at: RunPoint::Middle, frames: Vec::new() }),
        has_leaders: true,
        ..Panel::default()
    };
    Ok(Figure {
        name: "backbone",
        title: None,
        columns: 1,
        choice: "Amplitude of",
        linked_x: false,
        legend: vec![
            entry(if backbone.is_crossed() { "backbone, curves beside it" } else { "backbone" }, thin),
            entry("windows, a colour each", Style { color: Color::Soft, ..bold }),
        ],
        panels: vec![panel],
    })
}
