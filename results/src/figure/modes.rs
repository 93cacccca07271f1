//! Contributions of the modes along the backbone, with the resonances between them.

use super::column_store::ColumnStore;
use super::data::{Axis, Detail, Entry, Figure, Format, Kind, Label, Panel, Series, Side, Unit};
use super::style::{Color, MARK, MEDIUM, Shape, Style, THIN};
use super::subject::{BackboneColumns, Subject};
use crate::curves::{BackboneCurve, Column, ModeShare, Peak};

/// Contributions below this are not drawn.
const FLOOR: f64 = 1e-6;

/// The figure.
///
/// # Errors
/// If there is no backbone, or one mode alone: in words.
pub fn figure(
    subject: &Subject<'_>,
    store: &mut ColumnStore,
    columns: Option<&BackboneColumns>,
) -> Result<Figure, String> {
    let backbone = subject.backbone()?;
    let columns = columns.ok_or("the run has no backbone yet")?;
    if backbone.modes.len() < 2 {
        return Err("one mode alone makes the backbone".into());
    }
    let (x, over) = columns.over(backbone, subject);
    let count = subject.shown(backbone);
    let shares = backbone.modes.iter().flat_map(|mode| mode.share.values.iter().take(count)).copied();
    let shares = shares.filter(|&share| share > FLOOR);
    let y = Axis::logarithmic("contribution to the motion", Unit::none(), shares);
    let mut series = Vec::new();
    for (i, mode) in backbone.modes.iter().enumerate() {
        let share = store.add(mode.share.clone());
        let ratio = backbone.omega.values.iter().map(|omega| mode.frequency / omega).collect();
        let ratio = store.add(Column::short(ratio));
        series.push(Series {
            name: vec![format!("mode {}", mode.mode + 1)],
            x: over.clone(),
            y: vec![share.clone()],
            style: look(i),
            details: vec![
                Detail::new("contribution", Format::Number, 3, &share),
                Detail::new("frequency", Format::Frequency, 6, &columns.omega),
                Detail::new("frequency of the mode over it", Format::Number, 4, &ratio),
                Detail {
                    values: columns.amplitude[..1].to_vec(),
                    ..Detail::new("amplitude", Format::Length, 4, &share)
                },
            ],
            ..Series::default()
        });
    }
    let places: Vec<usize> = backbone.peaks.iter().map(|peak| peak.index).collect();
    let heights = store.exact(backbone.peaks.iter().map(|peak| peak.share).collect());
    let peaks = Series {
        x: over.iter().map(|column| column.at(&places)).collect(),
        y: vec![heights],
        style: Style::marks(Color::Ink, Shape::Circle, 0.8 * MARK, true),
        ..Series::default()
    };
    let entry = |(i, mode): (usize, &ModeShare)| Entry { frequency: Some(mode.frequency), ..named(i, mode) };
    let mut legend: Vec<Entry> = backbone.modes.iter().enumerate().map(entry).collect();
    if !places.is_empty() {
        legend.push(Entry::new("peak of a mode, with what drives it", Kind::Line, peaks.style.clone()));
        series.push(peaks);
    }
    let values: Vec<Vec<f64>> = over.iter().map(|column| store.values(column, 1.0)).collect();
    let panel = Panel {
        about: "Share of each mode along the backbone",
        x,
        y: vec![y],
        series,
        labels: backbone.peaks.iter().map(|peak| label(backbone, peak, &values)).collect(),
        has_leaders: true,
        ..Panel::default()
    };
    Ok(Figure { name: "modes", title: None, columns: 1, choice: "Over", linked_x: false, legend, panels: vec![panel] })
}

/// The mode followed is black and bold.
fn look(place: usize) -> Style {
    match place {
        0 => Style::line(Color::Ink, MEDIUM),
        _ => Style::line(Color::Category(place - 1), THIN).with_dash(place),
    }
}

fn named(place: usize, mode: &ModeShare) -> Entry {
    Entry::new(format!("mode {}", mode.mode + 1), Kind::Line, look(place))
}

/// Modes are counted from 1. Out of resonance only the largest harmonic is said.
fn label(backbone: &BackboneCurve, peak: &Peak, over: &[Vec<f64>]) -> Label {
    let place = backbone.modes.iter().position(|mode| mode.mode == peak.mode).unwrap_or(0);
    let (mode, harmonic) = (peak.mode + 1, peak.harmonic);
    let multiple = if harmonic == 1 { "ω".into() } else { format!("{harmonic}ω") };
    Label {
        text: if peak.resonant { format!("mode {mode} at {multiple}") } else { format!("mode {mode} ({multiple})") },
        x: over.iter().map(|column| column.get(peak.index).copied()).collect(),
        y: vec![Some(peak.share)],
        color: look(place).color,
        level: None,
        side: Side::Above,
    }
}
