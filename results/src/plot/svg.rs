//! Writes a figure as SVG: nothing transparent, texts as outlines.

use super::clip::{self, Point, Rect};
use super::layout::{GAP, Layout, Place, SAMPLE, TICK_LENGTH};
use super::sizes::{LABEL, TICK, TITLE};
use crate::figure::{
    CAPITALS, Color, Direction, Entry, Field, Font, Kind, LIGHT, LINE, Marker, Panel, Part, Rgb, Series, Shape, Spot,
    Style, View, chosen, label_point, place, run_points,
};
use std::fmt::Write;

/// Axes, and lines from labels to their points.
const FINE: f64 = 0.75;
/// Beyond so many times the size of the panel a point is no place.
const OUTSIDE: f64 = 1e4;
/// Points nearer to each other than this are drawn as one, px.
const NEAR: f64 = 0.2;

/// A figure under construction.
pub struct Canvas<'f> {
    font: &'f Font,
    text: String,
}

/// Where a text stands: what of it is at the point.
#[derive(Clone, Copy)]
enum Align {
    Left,
    Centre,
    Right,
    /// Its middle, written upwards.
    Upwards,
}

impl<'f> Canvas<'f> {
    /// Empty and white.
    pub fn new(font: &'f Font) -> Self {
        Self { font, text: "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n".into() }
    }

    /// What was drawn.
    pub fn end(self) -> String {
        self.text
    }

    fn add(&mut self, line: std::fmt::Arguments<'_>) {
        self.text.write_fmt(line).expect("texts are written to memory");
        self.text.push('\n');
    }

    /// Title and legend.
    pub fn head(&mut self, layout: &Layout<'_>) {
        for (title, middle) in &layout.title {
            self.write(title, TITLE, *middle, Align::Centre, LIGHT.ink);
        }
        for (entry, left) in &layout.legend {
            self.entry(entry, *left);
        }
    }

    fn entry(&mut self, entry: &Entry, (x, y): Point) {
        let (style, color) = (&entry.style, LIGHT.of(entry.style.color));
        if entry.kind == Kind::Band {
            let (top, tint) = (y - 0.35 * TICK, LIGHT.tint(style.color));
            self.rectangle(&Rect { left: x, top, width: SAMPLE, height: 0.7 * TICK }, tint);
        }
        if style.width > 0.0 {
            self.line(&[(x, y), (x + SAMPLE, y)], style, color);
        }
        if let Some(marker) = style.marker {
            self.mark((x + 0.5 * SAMPLE, y), marker, color);
        }
        self.write(&entry.text, TICK, (x + SAMPLE + 5.0, y), Align::Left, LIGHT.ink);
    }

    /// A panel with everything in it.
    pub fn panel(&mut self, panel: &Panel, at: &Place<'_>, view: View<'_>) {
        let frame = &at.frame;
        for span in &panel.spans {
            let axis = if span.axis == Direction::X { at.x } else { at.y };
            let Some(value) = chosen(&span.at, view.choice).copied().flatten() else { continue };
            let share = axis.share(value);
            if (0.0..=1.0).contains(&share) {
                let ends = match span.axis {
                    Direction::X => [(share, 0.0), (share, 1.0)],
                    Direction::Y => [(0.0, share), (1.0, share)],
                };
                self.line(&ends.map(|end| frame.at(end)), &span.style, LIGHT.of(span.style.color));
            }
        }
        let parts = |series| view.parts(series, (at.x, at.y)).into_iter().map(move |part| (series, part));
        let parts: Vec<(&Series, Part)> = panel.series.iter().flat_map(parts).collect();
        // What one curve encloses must not hide another.
        for (series, part) in parts.iter().filter(|(series, _)| series.style.fill) {
            self.area(series, part, frame);
        }
        for (series, part) in &parts {
            self.part(series, part, frame);
        }
        self.axes(at);
        self.labels(panel, at, view);
    }

    /// The inside of a part.
    fn area(&mut self, series: &Series, part: &Part, frame: &Rect) {
        let edge = part.edge.iter().rev().map(|&share| in_frame(share, frame));
        let corners: Vec<Point> = points(series, part, frame).into_iter().chain(edge).collect();
        let area = clip::area(&corners, frame);
        if area.len() > 2 {
            self.add(format_args!("<path d=\"{}Z\" fill=\"{}\"/>", path(&area), LIGHT.tint(part.color)));
        }
    }

    /// Line and marks of a part.
    fn part(&mut self, series: &Series, part: &Part, frame: &Rect) {
        let style = &series.style;
        let points = points(series, part, frame);
        let color = LIGHT.of(part.color);
        if style.width > 0.0 {
            for visible in clip::curve(&thinned(&points), frame) {
                self.line(&visible, style, color);
            }
        }
        if let Some(marker) = style.marker {
            for &point in points.iter().filter(|&&point| frame.holds(point)) {
                self.mark(point, marker, color);
            }
        }
    }

    fn axes(&mut self, at: &Place<'_>) {
        let frame = &at.frame;
        let (left, bottom) = (frame.left, frame.bottom());
        let mut marks = String::new();
        let mut mark = |from: Point, to: Point| {
            write!(marks, "M{:.2} {:.2}L{:.2} {:.2}", from.0, from.1, to.0, to.1).expect("texts are written to memory");
        };
        let length = |text: &Option<String>| if text.is_some() { TICK_LENGTH } else { 0.6 * TICK_LENGTH };
        for tick in &at.x_ticks {
            let x = frame.at((tick.share, 0.0)).0;
            mark((x, bottom), (x, bottom + length(&tick.text)));
        }
        for tick in &at.y_ticks {
            let y = frame.at((0.0, tick.share)).1;
            mark((left, y), (left - length(&tick.text), y));
        }
        let (ink, top, width, height) = (LIGHT.ink, frame.top, frame.width, frame.height);
        self.add(format_args!(
            "<path d=\"M{left:.2} {top:.2}h{width:.2}v{height:.2}h{:.2}Z{marks}\" fill=\"none\" stroke=\"{ink}\" \
             stroke-width=\"{FINE}\"/>",
            -width
        ));
        let numbers = bottom + TICK_LENGTH + 0.5 * LINE * TICK;
        for tick in at.x_ticks.iter().filter(|_| !at.is_bare) {
            let Some(text) = &tick.text else { continue };
            self.write(text, TICK, (frame.at((tick.share, 0.0)).0, numbers), Align::Centre, LIGHT.ink);
        }
        for tick in &at.y_ticks {
            let Some(text) = &tick.text else { continue };
            let point = (left - TICK_LENGTH - GAP, frame.at((0.0, tick.share)).1);
            self.write(text, TICK, point, Align::Right, LIGHT.ink);
        }
        if !at.is_bare {
            let y = numbers + 0.5 * LINE * (TICK + TITLE) + 1.0;
            self.write(&at.x.heading(), TITLE, (left + 0.5 * frame.width, y), Align::Centre, LIGHT.ink);
        }
        let point = (left - at.title.0, frame.top + 0.5 * frame.height);
        self.write(&at.y.heading(), at.title.1, point, Align::Upwards, LIGHT.ink);
    }

    fn labels(&mut self, panel: &Panel, at: &Place<'_>, view: View<'_>) {
        let field = Field { width: at.frame.width, height: at.frame.height, text: LABEL };
        let (own, of_runs) = place(panel, view, (at.x, at.y), field, self.font);
        let runs = run_points(panel, view);
        let own = own.iter().filter_map(|(i, spot)| {
            let label = &panel.labels[*i];
            Some((label_point(label, view.choice, at.x)?, spot, label.text.as_str(), label.color))
        });
        let colors = view.frame.map_or(&[][..], |frame| &frame.runs);
        let of_runs = of_runs.iter().map(|(i, spot)| (runs[*i].0, spot, runs[*i].1, colors[*i].color));
        let all: Vec<(Point, &Spot, &str, Color)> = own.chain(of_runs).collect();
        // Labels keep apart from curves under them, and no line of another crosses them.
        for (_, spot, ..) in &all {
            let area = &spot.area;
            let (left, top) = (at.frame.left + area.left, at.frame.top + area.top);
            let room = Rect { left, top, width: area.right - area.left, height: area.bottom - area.top };
            self.rectangle(&room, LIGHT.paper);
        }
        for (point, spot, text, color) in all {
            let color = LIGHT.of(color);
            if spot.has_leader {
                let from = at.frame.at((at.x.share(point.0), at.y.share(point.1)));
                let to = (from.0 + spot.offset.0, from.1 + spot.offset.1);
                self.line(&[from, to], &Style::line(Color::Ink, FINE), color);
            }
            let middle = at.frame.top + 0.5 * (spot.area.top + spot.area.bottom);
            self.write(text, LABEL, (at.frame.left + spot.area.left, middle), Align::Left, color);
        }
    }

    fn rectangle(&mut self, area: &Rect, fill: Rgb) {
        let Rect { left, top, width, height } = area;
        self.add(format_args!(
            "<rect x=\"{left:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" fill=\"{fill}\"/>"
        ));
    }

    fn line(&mut self, points: &[Point], style: &Style, color: Rgb) {
        let dash: Vec<String> = style.dash.iter().map(f64::to_string).collect();
        let dash = if dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{}\"", dash.join(" ")) };
        self.add(format_args!(
            "<path d=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{dash}/>",
            path(points),
            style.width
        ));
    }

    fn mark(&mut self, (x, y): Point, marker: Marker, color: Rgb) {
        let half = 0.5 * marker.size;
        let fill = if marker.open { LIGHT.paper } else { color };
        let shape = match marker.shape {
            Shape::Circle => {
                self.add(format_args!(
                    "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{half:.2}\" fill=\"{fill}\" stroke=\"{color}\"/>"
                ));
                return;
            }
            Shape::Square => vec![(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)],
            Shape::Triangle => vec![(-1.0, 0.8), (1.0, 0.8), (0.0, -0.95)],
            Shape::InvertedTriangle => vec![(-1.0, -0.8), (1.0, -0.8), (0.0, 0.95)],
            Shape::Cross => {
                let [a, b] = [[(-1.0, -1.0), (1.0, 1.0)], [(-1.0, 1.0), (1.0, -1.0)]]
                    .map(|ends| path(&ends.map(|(right, down)| (x + right * half, y + down * half))));
                self.add(format_args!("<path d=\"{a}{b}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.4\"/>"));
                return;
            }
        };
        let corners: Vec<Point> = shape.into_iter().map(|(right, down)| (x + right * half, y + down * half)).collect();
        self.add(format_args!("<path d=\"{}Z\" fill=\"{fill}\" stroke=\"{color}\"/>", path(&corners)));
    }

    /// A text, its middle between line and capitals at the height of the point.
    fn write(&mut self, text: &str, size: f64, (x, y): Point, align: Align, color: Rgb) {
        let (width, rise) = (self.font.width(text, size), 0.5 * CAPITALS * size);
        let from = match align {
            Align::Left => (x, y + rise),
            Align::Centre => (x - 0.5 * width, y + rise),
            Align::Right => (x - width, y + rise),
            Align::Upwards => (x + rise, y + 0.5 * width),
        };
        let outline = self.font.outline(text, size, from, matches!(align, Align::Upwards));
        if !outline.is_empty() {
            let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
            self.add(format_args!("<path aria-label=\"{text}\" d=\"{outline}\" fill=\"{color}\"/>"));
        }
    }
}

/// Where a point of a part lies; what is far outside has no place.
fn in_frame((right, up): (f64, f64), frame: &Rect) -> Point {
    let is_place = right.abs() < OUTSIDE && up.abs() < OUTSIDE;
    if is_place { frame.at((right, up)) } else { (f64::NAN, f64::NAN) }
}

/// The points of a part, of a closed series back to the first.
fn points(series: &Series, part: &Part, frame: &Rect) -> Vec<Point> {
    let mut points: Vec<Point> = part.points.iter().map(|&share| in_frame(share, frame)).collect();
    if series.kind == Kind::Closed {
        points.extend(points.first().copied());
    }
    points
}

fn path(points: &[Point]) -> String {
    let mut path = String::new();
    for (i, (x, y)) in points.iter().enumerate() {
        let command = if i == 0 { 'M' } else { 'L' };
        write!(path, "{command}{x:.2} {y:.2}").expect("texts are written to memory");
    }
    path
}

/// Without points that are too near to the one before; gaps and ends are kept.
fn thinned(points: &[Point]) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for (i, &point) in points.iter().enumerate() {
        let is_far = kept.last().is_none_or(|last| {
            let distance = (point.0 - last.0).abs().max((point.1 - last.1).abs());
            distance.is_nan() || distance > NEAR
        });
        let is_end = points.get(i + 1).is_none_or(|next| next.0.is_nan() || next.1.is_nan());
        if is_far || is_end {
            kept.push(point);
        }
    }
    kept
}
