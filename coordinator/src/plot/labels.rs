//! Labels where there is room: beside their points, within the panel, off the curves and off each other.

use super::axis::line_height;
use super::panel::{Label, Panel};
use super::style::{FINE, LABEL, text};
use plotive::Rgba8;
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
const DISTANCES: [(f32, usize); 5] = [(3.0, 0), (8.0, 2), (20.0, 5), (40.0, 8), (70.0, 12)];
/// From this distance on a line leads from the label to its point.
const FAR: f32 = 10.0;
/// A label that covers more of the curves than so many of their points is left out.
const COVERED: usize = 8;
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
    let mut room = Room::of(panel, frame.size());
    let mut annotations = Vec::new();
    for label in &panel.labels {
        let align = (Align::Start, VerAlign::Baseline);
        let width = LineText::new(label.text.clone(), align, LABEL, Font::default(), fonts)?.width();
        let point = place((panel.x.share(label.at.0), panel.y.share(label.at.1)), &room.size);
        // A point that has no place on the axes has no label.
        let Some(spot) = Some(point).filter(is_somewhere).and_then(|point| room.best(point, width)) else { continue };
        annotations.extend(leader(&spot, point, label.color));
        annotations.push(written(label, &spot));
        room.leaders.extend(way(&spot, point));
        room.taken.push(spot);
    }
    Ok(annotations)
}

fn is_somewhere(point: &Point) -> bool {
    point.x.is_finite() && point.y.is_finite()
}

/// What is where in a panel, in its coordinates.
struct Room {
    size: Size,
    reach: f32,
    curves: Vec<Point>,
    taken: Vec<Rect>,
    leaders: Vec<Point>,
}

impl Room {
    fn of(panel: &Panel, size: Size) -> Self {
        Self {
            reach: if panel.has_leaders { f32::INFINITY } else { FAR },
            curves: panel.traces.iter().flat_map(|trace| dense(trace, &size)).collect(),
            taken: panel.marks.iter().map(|&mark| place(mark, &size)).filter(is_somewhere).map(around).collect(),
            leaders: Vec::new(),
            size,
        }
    }

    /// The place of a label of this width that covers least of the curves and is not far from its point.
    fn best(&self, point: Point, width: f32) -> Option<Rect> {
        let near = DISTANCES.iter().filter(|(distance, _)| *distance < self.reach);
        let spots = near.flat_map(|&(distance, penalty)| {
            DIRECTIONS.iter().map(move |&(right, down)| {
                let x = point.x - 0.5 * width + right * (0.5 * width + distance);
                let y = point.y - 0.5 * line_height() + down * (0.5 * line_height() + 0.6 * distance);
                (Rect::from_xywh(x, y, width, line_height()), penalty)
            })
        });
        let covered = |spot: &Rect| self.curves.iter().filter(|point| spot.contains_point(point)).count();
        let rated = spots.filter(|(spot, _)| self.is_free(spot, point)).map(|(spot, far)| (covered(&spot), far, spot));
        let clear = rated.filter(|(covered, ..)| *covered <= COVERED);
        clear.min_by_key(|(covered, far, _)| covered + far).map(|(.., spot)| spot)
    }

    /// Whether a label may be here, with the line that leads to its point.
    fn is_free(&self, spot: &Rect, point: Point) -> bool {
        let is_across = spot.left() >= EDGE && spot.right() <= self.size.width() - EDGE;
        let is_within = is_across && spot.top() >= 1.0 && spot.bottom() <= self.size.height() - 1.0;
        let is_taken = |other: &Rect| overlap(spot, other) || way(spot, point).iter().any(|p| other.contains_point(p));
        is_within && !self.taken.iter().any(is_taken) && !self.leaders.iter().any(|p| spot.contains_point(p))
    }
}

fn written(label: &Label, spot: &Rect) -> Annotation {
    let text = text(&label.text, LABEL, label.color);
    let label = annot::Label::new(text, plot(spot.left()), plot(spot.top())).with_anchor(Anchor::TopLeft);
    label.with_frame(Some(halo()), None).into()
}

/// From the edge of a label to its point, if it is far.
fn gap(spot: &Rect, point: Point) -> Option<(Point, f32)> {
    let edge = Point { x: point.x.clamp(spot.left(), spot.right()), y: point.y.clamp(spot.top(), spot.bottom()) };
    let distance = (point.x - edge.x).hypot(point.y - edge.y);
    (distance > FAR).then_some((edge, distance))
}

/// Points of the line that leads from a label to its point, up to the marker there.
fn way(spot: &Rect, point: Point) -> Vec<Point> {
    let Some((edge, distance)) = gap(spot, point) else { return Vec::new() };
    let count = ((distance - 2.0 * MARK) / STEP).max(0.0) as usize;
    let at = |i: usize| i as f32 * STEP / distance;
    (1..count)
        .map(|i| Point { x: edge.x + at(i) * (point.x - edge.x), y: edge.y + at(i) * (point.y - edge.y) })
        .collect()
}

/// A line from a label that is far away to its point.
fn leader(spot: &Rect, point: Point, color: Rgba8) -> Option<Annotation> {
    let (edge, _) = gap(spot, point)?;
    let stroke: theme::Stroke = (color.into(), FINE).into();
    let line = annot::Arrow::new(plot(point.x), plot(point.y), point.x - edge.x, point.y - edge.y);
    Some(line.with_head_size(0.0).with_stroke(stroke).into())
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
