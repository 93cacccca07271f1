//! Labels where there is room: beside their points, within the panel, off the curves and off each other.

use super::axis::line_height;
use super::panel::{Label, Panel};
use super::style::{LABEL, text};
use plotive::des::PlotIdx;
use plotive::des::annot::{self, Anchor, Annotation, plot};
use plotive::drawing::PreparedFigure;
use plotive::fontdb::Database;
use plotive::geom::{Point, Rect, Size};
use plotive::style::theme;
use plotive::text::line::{Align, LineText, VerAlign};
use plotive::text::{Error, Font};

/// Distances of a label from its point that are tried, in units of the figure, and how many crossings of curves each is
/// as bad as.
const DISTANCES: [(f32, usize); 2] = [(3.0, 0), (8.0, 3)];
/// Half of what a marker covers at least.
const MARK: f32 = 4.0;
/// Distance from the edges of the panel, where ticks are.
const EDGE: f32 = 5.0;
/// Directions that are tried, the best first: right and down of the point.
const DIRECTIONS: [(f32, f32); 8] =
    [(0.0, -1.0), (1.0, -1.0), (-1.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (0.0, 1.0)];
/// Distance of the points at which a curve is tested, in units of the figure.
const STEP: f32 = 3.0;

/// Where a panel is in a figure that is laid out.
///
/// A prepared figure says only which panel a point is in, so the edges are searched for.
pub fn frame(figure: &PreparedFigure, panel: PlotIdx) -> Option<Rect> {
    let size = figure.size();
    let is_inside = |x: f32, y: f32| figure.hit_test_idx(Point { x, y }) == Some(panel);
    let grid = (0..64 * 64).map(|n| ((n % 64) as f32 / 64.0 * size.width(), (n / 64) as f32 / 64.0 * size.height()));
    let (x, y) = grid.into_iter().find(|&(x, y)| is_inside(x, y))?;
    let left = edge(x, 0.0, |x| is_inside(x, y));
    let right = edge(x, size.width(), |x| is_inside(x, y));
    let top = edge(y, 0.0, |y| is_inside(x, y));
    let bottom = edge(y, size.height(), |y| is_inside(x, y));
    Some(Rect::from_xywh(left, top, right - left, bottom - top))
}

/// The last place inside on the way from one inside to one outside.
fn edge(mut inside: f32, mut outside: f32, is_inside: impl Fn(f32) -> bool) -> f32 {
    for _ in 0..24 {
        let middle = 0.5 * (inside + outside);
        if is_inside(middle) { inside = middle } else { outside = middle }
    }
    inside
}

/// The labels of a panel that have room, placed.
///
/// # Errors
/// If the font cannot be read.
pub fn placed(panel: &Panel, frame: &Rect, fonts: &Database) -> Result<Vec<Annotation>, Error> {
    let size = frame.size();
    let curves: Vec<Point> = panel.traces.iter().flat_map(|trace| dense(trace, &size)).collect();
    let mut taken: Vec<Rect> = panel.marks.iter().map(|&mark| around(place(mark, &size))).collect();
    let mut annotations = Vec::new();
    for label in &panel.labels {
        let Some(spot) = spot(label, panel, &size, &curves, &taken, fonts)? else { continue };
        let text = text(&label.text, LABEL, label.color);
        let text = annot::Label::new(text, plot(spot.left()), plot(spot.top())).with_anchor(Anchor::TopLeft);
        let text = text.with_frame(Some(halo()), None);
        annotations.push(text.into());
        taken.push(spot);
    }
    Ok(annotations)
}

/// The best place of a label, in the coordinates of its panel.
fn spot(
    label: &Label,
    panel: &Panel,
    size: &Size,
    curves: &[Point],
    taken: &[Rect],
    fonts: &Database,
) -> Result<Option<Rect>, Error> {
    let align = (Align::Start, VerAlign::Baseline);
    let width = LineText::new(label.text.clone(), align, LABEL, Font::default(), fonts)?.width();
    let point = place((panel.x.share(label.at.0), panel.y.share(label.at.1)), size);
    let spots = DISTANCES.iter().flat_map(|&(distance, penalty)| {
        DIRECTIONS.iter().map(move |&(right, down)| {
            let x = point.x - 0.5 * width + right * (0.5 * width + distance);
            let y = point.y - 0.5 * line_height() + down * (0.5 * line_height() + 0.6 * distance);
            (Rect::from_xywh(x, y, width, line_height()), penalty)
        })
    });
    let has_room = |spot: &Rect| {
        let is_across = spot.left() >= EDGE && spot.right() <= size.width() - EDGE;
        let is_within = is_across && spot.top() >= 1.0 && spot.bottom() <= size.height() - 1.0;
        is_within && !taken.iter().any(|other| overlap(spot, other))
    };
    let crossings = |spot: &Rect| curves.iter().filter(|point| spot.contains_point(point)).count();
    let best = spots.filter(|(spot, _)| has_room(spot)).min_by_key(|(spot, penalty)| crossings(spot) + penalty);
    Ok(best.map(|(spot, _)| spot))
}

/// What keeps a label apart from curves under it.
fn halo() -> theme::Fill {
    theme::Fill::solid(plotive::color::WHITE.into())
}

/// What a marker covers.
fn around(point: Point) -> Rect {
    Rect::from_xywh(point.x - MARK, point.y - MARK, 2.0 * MARK, 2.0 * MARK)
}

fn overlap(a: &Rect, b: &Rect) -> bool {
    a.left() < b.right() && b.left() < a.right() && a.top() < b.bottom() && b.top() < a.bottom()
}

fn place((right, up): (f64, f64), size: &Size) -> Point {
    Point { x: right as f32 * size.width(), y: (1.0 - up) as f32 * size.height() }
}

/// Points along the visible part of a curve.
fn dense(trace: &[(f64, f64)], size: &Size) -> Vec<Point> {
    let points: Vec<Point> = trace.iter().map(|&share| place(share, size)).collect();
    let is_near =
        |p: &Point| (-0.5..=1.5).contains(&(p.x / size.width())) && (-0.5..=1.5).contains(&(p.y / size.height()));
    let between = |pair: &[Point]| {
        let (a, b) = (pair[0], pair[1]);
        let steps = ((b.x - a.x).abs().max((b.y - a.y).abs()) / STEP).ceil().max(1.0) as usize;
        let at = move |i: usize| i as f32 / steps as f32;
        (0..steps)
            .map(move |i| Point { x: a.x + at(i) * (b.x - a.x), y: a.y + at(i) * (b.y - a.y) })
            .collect::<Vec<_>>()
    };
    points.windows(2).filter(|pair| is_near(&pair[0]) && is_near(&pair[1])).flat_map(between).collect()
}
