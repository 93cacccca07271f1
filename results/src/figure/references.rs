//! Backbones, and where contact begins, for comparison in figures of amplitudes.

use super::column_store::ColumnStore;
use super::data::{Axis, Direction, Label, Series, Side, Span};
use super::style::{BOLD, Color, FINE, Style};
use super::subject::{BackboneColumns, Subject};
use crate::curves::{BackboneCurve, Column, Monitor};

/// What switches backbones on.
const SWITCH: &str = "Backbone, bold where the largest level shown is predicted to respond";

/// The backbone, and its parts inside of windows.
pub fn backbone_series(backbone: &BackboneColumns) -> Vec<Series> {
    let whole = Series {
        x: vec![backbone.omega.clone()],
        y: backbone.amplitude.clone(),
        style: Style::line(Color::Soft, FINE).with_dash(1),
        switch: Some(SWITCH),
        ..Series::default()
    };
    let inside = Series { style: Style::line(Color::Soft, BOLD), along_runs: true, ..whole.clone() };
    vec![whole, inside]
}

/// The backbones of further modes that come within axes.
pub(super) fn further_within<'r>(
    subject: &Subject<'r>,
    axes: (&Axis, &[Axis]),
) -> impl Iterator<Item = &'r BackboneCurve> {
    subject.further.iter().filter(move |further| is_within(further, axes))
}

/// Whether some of a backbone lies within axes, of any of the monitored dofs.
fn is_within(backbone: &BackboneCurve, (across, up): (&Axis, &[Axis])) -> bool {
    let of = |(axis, heights): (&Axis, &Column)| {
        let mut points = backbone.omega.values.iter().zip(&heights.values);
        points.any(|(&omega, &height)| across.shows(omega) && axis.shows(height))
    };
    up.iter().zip(&backbone.amplitude).any(of)
}

/// The backbone of a further mode.
pub(super) fn further_backbone(backbone: &BackboneCurve, columns: &mut ColumnStore) -> Series {
    Series {
        x: vec![columns.add(backbone.omega.clone())],
        y: columns.add_all(&backbone.amplitude),
        style: Style::line(Color::Soft, FINE).with_dash(1),
        switch: Some(SWITCH),
        ..Series::default()
    }
}

/// A line where each monitored dof touches, if one does.
pub fn touches(monitors: &[Monitor]) -> Option<Span> {
    let at: Vec<Option<f64>> = monitors.iter().map(|monitor| Some(monitor.touch?.at)).collect();
    let style = Style::line(Color::Soft, FINE).with_dash(2);
    at.iter().any(Option::is_some).then_some(Span { axis: Direction::Y, at, by_amplitude: false, style })
}

/// The labels of that line: of dofs that move along the normal, and of those that do not.
pub fn touch_labels(monitors: &[Monitor]) -> Vec<Label> {
    let mut names: Vec<&str> = monitors.iter().filter_map(|monitor| Some(monitor.touch?.name())).collect();
    names.sort_unstable();
    names.dedup();
    let label = |name: &str| {
        let place = |monitor: &Monitor| monitor.touch.filter(|touch| touch.name() == name).map(|touch| touch.at);
        Label {
            text: name.into(),
            x: vec![None],
            y: monitors.iter().map(place).collect(),
            color: Color::Soft,
            level: None,
            side: Side::Above,
        }
    };
    names.into_iter().map(label).collect()
}
