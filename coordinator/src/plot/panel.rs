//! A panel of a figure: axes, curves, marks and labels.

use super::axis::Axis;
use super::style::{FINE, INK, solid, tint};
use plotive::Rgba8;
use plotive::des::annot::{self, Annotation};
use plotive::des::plot::BoxBorder;
use plotive::des::series::{Area, AreaY2, Line, Scatter};
use plotive::des::{Plot, Series, data_inline};
use plotive::style::series::{Marker, Stroke};
use plotive::style::theme;

/// Beyond so many times the size of the panel a point is no place: plotive computes with 32 bits.
const OUTSIDE: f64 = 1e4;
/// Points nearer to each other than this share of the axes are drawn as one.
const NEAR: f64 = 4e-4;

/// A text at a point, wherever beside it there is room.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// What it says.
    pub text: String,
    /// The point, in the units of the axes.
    pub at: (f64, f64),
    /// Its colour.
    pub color: Rgba8,
}

/// A panel under construction.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Across.
    pub x: Axis,
    /// Up.
    pub y: Axis,
    /// Curves and markers, from below to above.
    pub series: Vec<Series>,
    /// Lines across the panel.
    pub annotations: Vec<Annotation>,
    /// Labels, the most important first; those without room are left out.
    pub labels: Vec<Label>,
    /// Whether labels may be far from their points, with a line that leads there.
    pub has_leaders: bool,
    /// Where curves run, as shares of the axes: labels keep away from them.
    pub traces: Vec<Vec<(f64, f64)>>,
    /// Where markers are, likewise: labels never cover them.
    pub marks: Vec<(f64, f64)>,
}

impl Panel {
    /// Empty.
    pub fn new(x: Axis, y: Axis) -> Self {
        Self {
            x,
            y,
            series: Vec::new(),
            annotations: Vec::new(),
            labels: Vec::new(),
            has_leaders: true,
            traces: Vec::new(),
            marks: Vec::new(),
        }
    }

    /// A curve through points; gaps where one of the numbers is none. The name is for the legend.
    pub fn line(&mut self, x: &[f64], y: &[f64], stroke: Stroke, name: Option<&str>) {
        let Some((x, y)) = self.visible(x, y) else { return };
        let line = Line::new(data_inline(x), data_inline(y)).with_stroke(stroke);
        self.series.push(match name {
            Some(name) => line.with_name(name).into(),
            None => line.into(),
        });
    }

    /// A curve with markers at its points, or a marker alone. The name is for the legend.
    pub fn chain(&mut self, x: &[f64], y: &[f64], (stroke, marker): (Stroke, Marker), name: Option<&str>) {
        if self.visible(x, y).is_none() {
            return self.points(x, y, marker, name);
        }
        let (x, y) = self.on_the_axes(x, y, true);
        let line = Line::new(data_inline(x), data_inline(y)).with_stroke(stroke).with_marker(marker);
        self.series.push(match name {
            Some(name) => line.with_name(name).into(),
            None => line.into(),
        });
    }

    /// A closed curve, whose end is not its start once more, with its inside.
    pub fn closed(&mut self, x: &[f64], y: &[f64], color: Rgba8, width: f32) {
        let around = |values: &[f64]| values.iter().chain(values.first()).copied().collect::<Vec<f64>>();
        let Some((x, y)) = self.visible(&around(x), &around(y)) else { return };
        // Back along a level line the path encloses nothing but the loop itself.
        let level = AreaY2::Baseline(y[0]);
        let area = Area::new(data_inline(x), data_inline(y), level).with_fill(tint(color));
        self.series.push(area.with_y1_stroke(solid(color, width)).into());
    }

    /// The area between two curves over the same values.
    pub fn between(&mut self, x: &[f64], low: &[f64], high: &[f64], color: Rgba8) {
        let is_drawn = |i: &usize| [x[*i], self.y.share(low[*i]), self.y.share(high[*i])].iter().all(|v| v.is_finite());
        let kept: Vec<usize> = (0..x.len()).filter(is_drawn).collect();
        if kept.len() < 2 {
            return;
        }
        let of = |values: &[f64]| data_inline(kept.iter().map(|&i| values[i]).collect::<Vec<f64>>());
        self.series.push(Area::new(of(x), of(low), of(high).into()).with_fill(tint(color)).into());
    }

    /// Markers. The name is for the legend.
    pub fn points(&mut self, x: &[f64], y: &[f64], marker: Marker, name: Option<&str>) {
        let (x, y) = self.on_the_axes(x, y, false);
        if x.is_empty() {
            return;
        }
        self.marks.extend(x.iter().zip(&y).map(|(&x, &y)| (self.x.share(x), self.y.share(y))));
        let scatter = Scatter::new(data_inline(x), data_inline(y)).with_marker(marker);
        self.series.push(match name {
            Some(name) => scatter.with_name(name).into(),
            None => scatter.into(),
        });
    }

    /// A level line across the panel, under everything.
    pub fn level(&mut self, y: f64, color: Rgba8, pattern: plotive::style::LinePattern) {
        if (self.y.low..=self.y.high).contains(&y) {
            let stroke: theme::Stroke = (color.into(), FINE, pattern).into();
            self.annotations.push(annot::Line::horizontal(y).with_stroke(stroke).into());
        }
    }

    /// A label at a point.
    pub fn label(&mut self, text: impl Into<String>, at: (f64, f64), color: Rgba8) {
        self.labels.push(Label { text: text.into(), at, color });
    }

    /// The panel as plotive takes it, without its labels.
    pub fn design(&self) -> Plot {
        let border = BoxBorder((INK.into(), FINE).into());
        let plot = Plot::new(self.series.clone())
            .with_x_axis(self.x.design())
            .with_y_axis(self.y.design())
            .with_insets(None)
            .with_border(border.into());
        self.annotations.iter().cloned().chain(self.y.numbers()).fold(plot, Plot::with_annotation)
    }

    /// Points, without those that have no place on the axes, or with gaps for them.
    fn on_the_axes(&self, x: &[f64], y: &[f64], has_gaps: bool) -> (Vec<f64>, Vec<f64>) {
        let point = |(&x, &y): (&f64, &f64)| {
            let is_place = [self.x.share(x), self.y.share(y)].iter().all(|share| share.abs() < OUTSIDE);
            (is_place || has_gaps).then_some(if is_place { (x, y) } else { (f64::NAN, f64::NAN) })
        };
        x.iter().zip(y).filter_map(point).unzip()
    }

    /// The points that make a difference, if they make a curve; what has no place on the axes becomes a gap.
    fn visible(&mut self, x: &[f64], y: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let shares: Vec<(f64, f64)> = x.iter().zip(y).map(|(&x, &y)| (self.x.share(x), self.y.share(y))).collect();
        let kept = thinned(&shares);
        let is_place = |i: usize| [shares[i].0, shares[i].1].iter().all(|share| share.abs() < OUTSIDE);
        // plotive panics at a path without a segment.
        kept.windows(2).any(|pair| is_place(pair[0]) && is_place(pair[1])).then(|| {
            self.traces.push(kept.iter().map(|&i| shares[i]).collect());
            let column =
                |values: &[f64]| kept.iter().map(|&i| if is_place(i) { values[i] } else { f64::NAN }).collect();
            (column(x), column(y))
        })
    }
}

/// Indices of points that are not too near to the one before; gaps and ends are kept.
fn thinned(shares: &[(f64, f64)]) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    for (i, &(x, y)) in shares.iter().enumerate() {
        let is_far = kept.last().is_none_or(|&last| {
            let distance = (x - shares[last].0).abs().max((y - shares[last].1).abs());
            distance.is_nan() || distance > NEAR
        });
        let is_end = shares.get(i + 1).is_none_or(|next| next.0.is_nan() || next.1.is_nan());
        if is_far || is_end {
            kept.push(i);
        }
    }
    kept
}
