//! Series as points: columns resolved, cut to windows, as shares of the axes.

use super::column_store::{ColumnStore, Ref};
use super::data::{Axis, Direction, Panel, Series, chosen};
use super::frames::{Frame, Run, along};
use super::labels::{Mark, Obstacle};
use super::style::{Color, FINE, Style};

/// What panels are looked at with.
#[derive(Debug, Clone, Copy)]
pub struct View<'v> {
    /// The option of the reader's choice.
    pub choice: usize,
    /// The columns.
    pub store: &'v ColumnStore,
    /// The forcing amplitude looked at, if there is one.
    pub frame: Option<&'v Frame>,
}

/// Points of a curve, in shares of the axes, right and up; NaN in gaps.
pub type Shares = Vec<(f64, f64)>;

/// A part of a series as it is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Its points.
    pub points: Shares,
    /// Of a band, those of its other edge.
    pub edge: Shares,
    /// Its colour.
    pub color: Color,
}

impl View<'_> {
    fn column(&self, options: &[Ref]) -> Vec<f64> {
        let amplitude = self.frame.map_or(f64::NAN, |frame| frame.amplitude);
        chosen(options, self.choice).map(|of| self.store.values(of, amplitude)).unwrap_or_default()
    }

    /// The axes of a panel that are chosen, if there are any.
    pub fn axes<'p>(&self, panel: &'p Panel) -> Option<(&'p Axis, &'p Axis)> {
        panel.axes(self.choice)
    }

    /// The parts of a series: one, or one for each window; none of one that is not drawn.
    pub fn parts(&self, series: &Series, (across, up): (&Axis, &Axis)) -> Vec<Part> {
        if !series.is_drawn(self.choice) {
            return Vec::new();
        }
        let (x, y, y2) = (self.column(&series.x), self.column(&series.y), self.column(&series.y2));
        let shares = |x: &[f64], y: &[f64]| -> Shares {
            x.iter().zip(y).map(|(&x, &y)| (across.share(x), up.share(y))).collect()
        };
        if !series.along_runs {
            let points = with_smooth(series, &shares(&x, &y), &|of| shares(&self.column(&of.x), &self.column(&of.y)));
            return vec![Part { points, edge: shares(&x, &y2), color: series.style.color }];
        }
        // Cut as shares: on a logarithmic axis, values between points are not on the line between them.
        let part = |run: &Run| {
            let cut = |points: &Shares| -> Shares {
                let of = |column: Vec<f64>| along(&column, run.first, run.last);
                let (x, y) = points.iter().copied().unzip();
                if points.is_empty() { Vec::new() } else { of(x).into_iter().zip(of(y)).collect() }
            };
            Part { points: cut(&shares(&x, &y)), edge: cut(&shares(&x, &y2)), color: run.color }
        };
        self.frame.map(|frame| frame.runs.iter().map(part).collect()).unwrap_or_default()
    }

    /// What labels of a panel keep away from: curves and upright lines, and marks. What is switched on later does not count.
    pub fn obstacles(&self, panel: &Panel, axes: (&Axis, &Axis)) -> (Vec<Obstacle>, Vec<Mark>) {
        let upright = panel.spans.iter().filter(|span| span.axis == Direction::X);
        let at = upright.filter_map(|span| chosen(&span.at, self.choice).copied().flatten());
        let upright = |x: f64| Obstacle { points: vec![(x, 0.0), (x, 1.0)], may_have_label: false, is_faint: false };
        let mut curves: Vec<Obstacle> = at.map(|value| upright(axes.0.share(value))).collect();
        let mut marks = Vec::new();
        for series in panel.series.iter().filter(|series| series.switch.is_none() && series.y2.is_empty()) {
            for part in self.parts(series, axes) {
                if series.style.width > 0.0 {
                    let Style { color, width, .. } = series.style;
                    let is_faint = color == Color::Shade && width <= FINE;
                    curves.push(Obstacle { points: part.points, may_have_label: may_have_label(color), is_faint });
                } else {
                    let size = series.style.marker.map_or(0.0, |marker| marker.size);
                    marks.extend(part.points.into_iter().map(|at| Mark { at, size }));
                }
            }
        }
        (curves, marks)
    }
}

/// Whether a label may be taken for that of a curve of this colour: not of what stands back or lies over another one.
fn may_have_label(color: Color) -> bool {
    matches!(color, Color::Ink | Color::Alert | Color::Level(_) | Color::Category(_))
}

fn with_smooth(series: &Series, points: &Shares, resolve: &dyn Fn(&super::data::Smooth) -> Shares) -> Shares {
    let Some(smooth) = &series.smooth else { return points.clone() };
    let between = resolve(smooth);
    let mut more = smooth.after.iter().zip(between).peekable();
    let mut all = Vec::with_capacity(points.len() + smooth.after.len());
    for (i, &point) in points.iter().enumerate() {
        all.push(point);
        while let Some((_, inserted)) = more.next_if(|(after, _)| **after <= i) {
            all.push(inserted);
        }
    }
    all
}
