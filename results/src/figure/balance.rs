//! Energies along the backbone: what has to be supplied against the work of the forcing.

use super::axis::bounds;
use super::column_store::ColumnStore;
use super::data::{Axis, Entry, Figure, Kind, Panel, Series, Unit};
use super::places::{RunLabels, RunPoint};
use super::style::{BOLD, Color, MEDIUM, Style};
use super::subject::{BackboneColumns, Subject};

/// Energies that span more than this factor are drawn logarithmically.
const WIDE: f64 = 20.0;
/// Energies below this share of the largest are not shown.
const FLOOR: f64 = 1e-6;

/// The figure.
///
/// # Errors
/// If there is no backbone: in words.
pub fn figure(subject: &Subject<'_>, store: &ColumnStore, columns: Option<&BackboneColumns>) -> Result<Figure, String> {
    let backbone = subject.backbone()?;
    let columns = columns.ok_or("the run has no backbone yet")?;
    let (x, over) = columns.over(backbone, subject);
    let amplitude = subject.first_level().map_or(1.0, |level| subject.levels[level].value);
    let work = store.values(&columns.work.by_amplitude(), amplitude);
    let count = subject.shown(backbone);
    let y = energies(backbone.needed.values.iter().copied().take(count).chain(work.into_iter().take(count)));

    let name = vec!["backbone".to_string()];
    let supplied = Style::line(Color::Category(4), MEDIUM).with_dash(1);
    let needed = Style::line(Color::Ink, MEDIUM);
    let line = |y, style| Series { x: over.clone(), y: vec![y], style, ..Series::default() };
    let wells = Series {
        kind: Kind::Band,
        y2: vec![columns.work.by_amplitude()],
        along_runs: true,
        ..line(columns.needed.clone(), Style::area(Color::Category(1)))
    };
    let series = vec![
        wells,
        line(columns.work.by_amplitude(), supplied.clone()),
        Series { name, details: columns.details(), ..line(columns.needed.clone(), needed.clone()) },
        // Wells that are shallow, or short, show by their line.
        Series { along_runs: true, ..line(columns.needed.clone(), Style::line(Color::Category(1), BOLD)) },
    ];
    let entry = Entry::new;
    let panel = Panel {
        title: Some("Energy per period"),
        about: "Energy balance along the backbone",
        x,
        y: vec![y],
        series,
        run_labels: Some(RunLabels { series: 2, at: RunPoint::Best, frames: Vec::new() }),
        has_leaders: true,
        ..Panel::default()
    };
    Ok(Figure {
        name: "balance",
        title: None,
        columns: 1,
        choice: "Over",
        linked_x: false,
        legend: vec![
            entry("to be supplied, A*·W", Kind::Line, needed),
            entry("supplied, A·W", Kind::Line, supplied),
            entry("supply is larger: windows, a colour each", Kind::Band, Style::area(Color::Soft)),
        ],
        panels: vec![panel],
    })
}

fn energies(values: impl Iterator<Item = f64> + Clone) -> Axis {
    const TITLE: &str = "energy per period";
    let positive = values.clone().filter(|&value| value > 0.0);
    let (low, high) = bounds(positive);
    let unit = Unit::si("J");
    if high > WIDE * low {
        Axis::logarithmic(TITLE, unit, values.filter(|&value| value > FLOOR * high))
    } else {
        Axis::around(TITLE, unit, values.chain([0.0]))
    }
}
