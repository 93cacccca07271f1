//! Labels of a panel in their places: for a file of a given size, and for a few widths of the page.

use super::column_store::ColumnStore;
use super::data::{Axis, Figure, Label, Panel, Side, Size, chosen};
use super::frames::{Frame, value_at};
use super::geometry::View;
use super::labels::{Field, Room, Spot};
use super::places::{Placement, RunPoint};
use super::text::Font;

/// Inner widths of panels of the page for which labels are placed, px, with the size of texts there.
const WIDTHS: [(f64, f64); 6] =
    [(300.0, 11.7), (480.0, 11.7), (720.0, 12.0), (1080.0, 13.0), (1600.0, 16.0), (2500.0, 20.0)];
/// Heights of panels that are so wide: tall, medium, low.
const HEIGHTS: [[f64; 6]; 3] = [
    [265.0, 290.0, 420.0, 530.0, 700.0, 880.0],
    [235.0, 250.0, 320.0, 380.0, 520.0, 640.0],
    [160.0, 170.0, 220.0, 270.0, 380.0, 440.0],
];
/// Of these widths, those for which labels of windows are placed.
const RUN_WIDTHS: [usize; 3] = [0, 2, 4];
/// A panel this wide has room for so many labels; a wider one for more.
const FEW: usize = 16;
const WIDTH_OF_LABEL: f64 = 40.0;

/// Labels that have room, by index, and where.
pub type Spots = Vec<(usize, Spot)>;

/// Places all labels of a figure for the page: for each option of the choice, each of a few widths and each frame.
pub fn place_for_page(figure: &mut Figure, store: &ColumnStore, frames: &[Frame], font: &Font) {
    for panel in &mut figure.panels {
        // Motions have other values each.
        if panel.series.iter().any(|series| series.signal.is_some()) {
            continue;
        }
        let options = 0..panel.x.len().max(panel.y.len());
        let view = |choice, frame| View { choice, store, frame };
        let all = (0..WIDTHS.len()).map(|width| field(panel.size, width));
        let placements = options
            .clone()
            .flat_map(|choice| all.clone().map(move |field| (choice, field)))
            .map(|(choice, field)| placement(&placed(panel, view(choice, None), field, font).0, choice, field));
        let placements: Vec<Placement> = placements.filter(|placement| !placement.spots.is_empty()).collect();
        let of_frame = |frame| {
            let widths = RUN_WIDTHS.iter().map(|&width| field(panel.size, width));
            let each = options.clone().flat_map(|choice| widths.clone().map(move |field| (choice, field)));
            let runs =
                |(choice, field)| placement(&placed(panel, view(choice, Some(frame)), field, font).1, choice, field);
            each.map(runs).filter(|placement| !placement.spots.is_empty()).collect()
        };
        let of_frames = panel.run_labels.as_ref().map(|_| frames.iter().map(of_frame).collect());
        panel.placements = placements;
        if let (Some(labels), Some(of_frames)) = (&mut panel.run_labels, of_frames) {
            labels.frames = of_frames;
        }
    }
}

fn field(size: Size, width: usize) -> Field {
    let heights = match size {
        Size::Tall => HEIGHTS[0],
        Size::Medium => HEIGHTS[1],
        Size::Low => HEIGHTS[2],
    };
    Field { width: WIDTHS[width].0, height: heights[width], text: WIDTHS[width].1 }
}

fn placement(spots: &[(usize, Spot)], choice: usize, field: Field) -> Placement {
    let entry = |(label, spot): &(usize, Spot)| {
        let (right, down) = (spot.offset.0.round() as i32, spot.offset.1.round() as i32);
        (*label, spot.anchor_name(), right, down, u8::from(spot.has_leader))
    };
    Placement { choice, width: field.width as u32, spots: spots.iter().map(entry).collect() }
}

/// Labels of the page, and labels of windows, that have room in a panel as the page shows it at first.
fn placed(panel: &Panel, view: View<'_>, field: Field, font: &Font) -> (Spots, Spots) {
    let Some((x, y)) = view.axes(panel) else { return Default::default() };
    place(panel, view, (&x.at_first(), &y.at_first()), field, font)
}

/// Places labels on these axes, the panel's own first, then those of the windows: index and spot of those with room.
pub fn place(panel: &Panel, view: View<'_>, axes: (&Axis, &Axis), field: Field, font: &Font) -> (Spots, Spots) {
    let runs = run_points(panel, view);
    if panel.labels.is_empty() && runs.is_empty() {
        return Default::default();
    }
    let (curves, marks) = view.obstacles(panel, axes);
    let mut room = Room::new(field, panel.has_leaders, &curves, &marks);
    let mut take = |at: (f64, f64), text: &str, side| {
        let share = (axes.0.share(at.0), axes.1.share(at.1));
        let is_inside = (-1e-9..=1.0 + 1e-9).contains(&share.0) && (-1e-9..=1.0 + 1e-9).contains(&share.1);
        is_inside.then(|| room.take(share, font.width(text, field.text), side)).flatten()
    };
    let most = FEW.max((field.width / WIDTH_OF_LABEL) as usize);
    let own = panel.labels.iter().enumerate().take(most).filter_map(|(i, label)| {
        let at = point(label, view.choice, axes.0)?;
        Some((i, take(at, &label.text, label.side)?))
    });
    let own: Spots = own.collect();
    let of_runs = runs.iter().enumerate().filter_map(|(i, (at, name))| Some((i, take(*at, name, Side::Above)?)));
    let of_runs = of_runs.collect();
    (own, of_runs)
}

/// The point of a label.
pub fn point(label: &Label, choice: usize, across: &Axis) -> Option<(f64, f64)> {
    let x = chosen(&label.x, choice).copied()?.unwrap_or(across.range.1);
    Some((x, chosen(&label.y, choice).copied().flatten()?))
}

/// Points and names of the windows that have labels.
pub fn run_points<'f>(panel: &Panel, view: View<'f>) -> Vec<((f64, f64), &'f str)> {
    let (Some(labels), Some(frame)) = (&panel.run_labels, view.frame) else { return Vec::new() };
    let Some(series) = panel.series.get(labels.series) else { return Vec::new() };
    let column = |options: &[super::column_store::Ref]| {
        chosen(options, view.choice).map(|of| view.store.values(of, frame.amplitude)).unwrap_or_default()
    };
    let (x, y) = (column(&series.x), column(&series.y));
    let at = |run: &super::frames::Run| match labels.at {
        RunPoint::Best => run.best as f64,
        RunPoint::Middle => 0.5 * (run.first + run.last),
    };
    frame.runs.iter().map(|run| ((value_at(&x, at(run)), value_at(&y, at(run))), run.name.as_str())).collect()
}
