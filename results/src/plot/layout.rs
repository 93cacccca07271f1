//! Where panels, axes and the legend of a figure are.

use super::clip::Rect;
use super::sizes::{TICK, TITLE};
use super::ticks::{Tick, ticks};
use crate::figure::{Axis, Entry, Figure, Font, LINE};

/// Length of ticks.
pub const TICK_LENGTH: f64 = 4.0;
/// Between ticks and their numbers.
pub const GAP: f64 = 3.0;
/// Width of a sample in the legend.
pub const SAMPLE: f64 = 26.0;

/// Room around everything.
const PADDING: f64 = 8.0;
/// Space between panels.
const SPACE: f64 = 14.0;
/// Space between entries of the legend.
const ENTRY_SPACE: f64 = 14.0;
/// The least that makes a panel, inside of its axes.
const LEAST: (f64, f64) = (60.0, 40.0);

/// A figure of some size.
#[derive(Debug)]
pub struct Layout<'f> {
    /// Lines of the title with their middles.
    pub title: Placed<'f, str>,
    /// Entries of the legend with the left ends of their lines.
    pub legend: Placed<'f, Entry>,
    /// Panels.
    pub panels: Vec<Place<'f>>,
}

/// What stands above the panels, each with its point.
type Placed<'f, T> = Vec<(&'f T, (f64, f64))>;

/// A panel in its place.
#[derive(Debug)]
pub struct Place<'f> {
    /// Across.
    pub x: &'f Axis,
    /// Up.
    pub y: &'f Axis,
    /// Inside of the axes.
    pub frame: Rect,
    /// Ticks across.
    pub x_ticks: Vec<Tick>,
    /// Ticks up.
    pub y_ticks: Vec<Tick>,
    /// Whether numbers and title across are those of the panel below.
    pub is_bare: bool,
    /// How far left of the frame the title up is, and the size of its text.
    pub title: (f64, f64),
}

/// A panel without its place.
struct Sizes<'f> {
    x: &'f Axis,
    y: &'f Axis,
    is_bare: bool,
}

impl<'f> Layout<'f> {
    /// Of a size, px; `None` if there is too little room.
    pub fn new(figure: &'f Figure, choice: usize, (width, height): (f64, f64), font: &Font) -> Option<Self> {
        let mut top = PADDING;
        let line = LINE * TITLE;
        let mut title = Vec::new();
        for text in figure.title.iter().flat_map(|title| in_lines(title, width - 2.0 * PADDING, font)) {
            title.push((text, (0.5 * width, top + 0.5 * line)));
            top += line + 2.0;
        }
        let (legend, legend_height) = legend(&figure.legend, width, top, font);
        top += legend_height;

        let columns = figure.columns.max(1);
        let sizes: Vec<Sizes<'f>> = figure
            .panels
            .iter()
            .filter_map(|panel| panel.axes(choice))
            .enumerate()
            .map(|(i, (x, y))| Sizes { x, y, is_bare: figure.linked_x && i + columns < figure.panels.len() })
            .collect();
        let rows = sizes.len().div_ceil(columns).max(1);
        let below = |size: &Sizes<'_>| if size.is_bare { TICK_LENGTH } else { below() };
        let row_below: Vec<f64> = sizes.chunks(columns).map(|row| row.iter().map(below).fold(0.0, f64::max)).collect();
        let above = 0.5 * LINE * TICK;
        let spaces = (rows - 1) as f64 * SPACE + rows as f64 * above + row_below.iter().sum::<f64>();
        let inner_height = (height - top - PADDING - spaces) / rows as f64;

        let y_ticks: Vec<Vec<Tick>> = sizes.iter().map(|size| ticks(size.y, inner_height, None)).collect();
        let left_of = |i: usize| widest(&y_ticks[i], font) + TICK_LENGTH + GAP;
        let column_left = |column: usize| {
            let all = (column..sizes.len()).step_by(columns).map(left_of).fold(0.0, f64::max);
            all + GAP + line
        };
        let lefts: Vec<f64> = (0..columns).map(column_left).collect();
        // The last number across is wider than the panel.
        let right = 18.0;
        let spaces = lefts.iter().sum::<f64>() + columns as f64 * right + (columns - 1) as f64 * 0.5 * SPACE;
        let inner_width = (width - 2.0 * PADDING - spaces) / columns as f64;
        if !(inner_width >= LEAST.0 && inner_height >= LEAST.1) {
            return None;
        }
        let mut panels = Vec::new();
        let mut y = top;
        for (row, below) in row_below.iter().enumerate() {
            let mut x = PADDING;
            for (column, left) in lefts.iter().enumerate() {
                let i = row * columns + column;
                let Some(size) = sizes.get(i) else { break };
                let frame = Rect { left: x + left, top: y + above, width: inner_width, height: inner_height };
                panels.push(Place {
                    x: size.x,
                    y: size.y,
                    frame,
                    x_ticks: ticks(size.x, inner_width, Some(&|text| font.width(text, TICK))),
                    y_ticks: y_ticks[i].clone(),
                    is_bare: size.is_bare,
                    title: (left - 0.5 * line, title_size(size.y, above + inner_height + below, font)),
                });
                x += left + inner_width + right + 0.5 * SPACE;
            }
            y += above + inner_height + below + SPACE;
        }
        Some(Self { title, legend, panels })
    }
}

/// The size of the title of an axis that has so much room: smaller where there is little.
fn title_size(axis: &Axis, room: f64, font: &Font) -> f64 {
    TITLE * (room / font.width(&axis.heading(), TITLE)).min(1.0)
}

/// Room below a panel for numbers and title.
fn below() -> f64 {
    TICK_LENGTH + LINE * TICK + 1.0 + LINE * TITLE
}

fn widest(ticks: &[Tick], font: &Font) -> f64 {
    let texts = ticks.iter().filter_map(|tick| tick.text.as_deref());
    texts.map(|text| font.width(text, TICK)).fold(0.0, f64::max)
}

/// Entries in rows, each row in the middle, and the height of all.
fn legend<'f>(entries: &'f [Entry], width: f64, top: f64, font: &Font) -> (Placed<'f, Entry>, f64) {
    let line = LINE * TICK;
    let room = width - 2.0 * PADDING;
    let mut rows: Vec<Vec<(&Entry, f64)>> = Vec::new();
    let mut used = f64::INFINITY;
    for entry in entries {
        let size = SAMPLE + 5.0 + font.width(&entry.text, TICK) + ENTRY_SPACE;
        if used + size - ENTRY_SPACE > room {
            rows.push(Vec::new());
            used = 0.0;
        }
        used += size;
        if let Some(row) = rows.last_mut() {
            row.push((entry, size));
        }
    }
    let mut placed = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        let all = row.iter().map(|(_, size)| size).sum::<f64>() - ENTRY_SPACE;
        let mut x = (0.5 * (width - all)).max(PADDING);
        for (entry, size) in row {
            placed.push((*entry, (x, top + (i as f64 + 0.5) * line)));
            x += size;
        }
    }
    let height = if rows.is_empty() { 0.0 } else { rows.len() as f64 * line + 4.0 };
    (placed, height)
}

/// The lines of a title: one or, where that is too wide, one for each of its parts.
fn in_lines<'t>(title: &'t str, width: f64, font: &Font) -> Vec<&'t str> {
    if font.width(title, TITLE) <= width { vec![title] } else { title.split("; ").collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Panel, Unit};

    fn figure(panels: usize, columns: usize) -> Figure {
        let axis = || vec![Axis::exact("time", Unit::si("s"), (0.0, 1.0))];
        let panel = || Panel { x: axis(), y: axis(), ..Panel::default() };
        Figure {
            name: "test",
            title: Some("title".into()),
            columns,
            choice: "",
            linked_x: false,
            legend: Vec::new(),
            panels: (0..panels).map(|_| panel()).collect(),
        }
    }

    #[test]
    fn long_titles_have_lines() {
        let font = Font::bundled();
        let title = "A = 20, main, point 3; marched there";
        assert_eq!(in_lines(title, 600.0, &font), [title]);
        let layout = |title: &str| {
            let figure = Figure { title: Some(title.into()), ..figure(1, 1) };
            let layout = Layout::new(&figure, 0, (180.0, 200.0), &font).unwrap();
            (layout.title.len(), layout.panels[0].frame.top)
        };
        let (long, short) = (layout(title), layout("title"));
        assert!(long.0 == 2 && short.0 == 1 && long.1 > short.1, "{long:?} and {short:?}");
    }

    #[test]
    fn panels_are_beside_each_other() {
        let (figure, font) = (figure(4, 2), Font::bundled());
        let layout = Layout::new(&figure, 0, (640.0, 400.0), &font).unwrap();
        let frames: Vec<Rect> = layout.panels.iter().map(|place| place.frame).collect();
        assert!(frames[0].right() < frames[1].left && frames[0].bottom() < frames[2].top, "{frames:?}");
        assert_eq!((frames[0].left, frames[0].top), (frames[2].left, frames[1].top));
        assert!(frames[3].right() <= 632.0 && frames[3].bottom() <= 392.0, "{frames:?}");
        assert!(Layout::new(&figure, 0, (120.0, 120.0), &font).is_none());
    }
}
