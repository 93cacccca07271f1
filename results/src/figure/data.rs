//! A figure as data: panels with axes, series, lines across, and labels in their places. Numbers are SI; each axis knows the
//! unit in which they are shown. The file and the page draw what stands here, and nothing else.

use super::column_store::Ref;
use super::places::{Placement, RunLabels};
use super::style::{Color, Style};
use serde::Serialize;

/// A figure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// What it is called.
    pub name: &'static str,
    /// What is written above it.
    pub title: Option<String>,
    /// Panels in a row.
    pub columns: usize,
    /// What the reader chooses, in words, where panels have several axes across or up. Then every list of axes, columns
    /// and places has one element, or one for each of them.
    pub choice: &'static str,
    /// Whether all panels show the same part along x.
    pub linked_x: bool,
    /// What lines and marks mean.
    pub legend: Vec<Entry>,
    /// Panels, row by row.
    pub panels: Vec<Panel>,
}

/// A line of the legend.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Entry {
    /// What it means.
    pub text: String,
    /// What kind of series it is of.
    pub kind: Kind,
    /// How that looks.
    pub style: Style,
    /// Whether it is drawn only where a forcing amplitude is looked at: always on the page, in files of some figures.
    #[serde(skip)]
    pub by_amplitude: bool,
    /// A frequency that stands behind the text in brackets, rad/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency: Option<f64>,
}

/// A panel.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Panel {
    /// What is written above it where panels stand apart.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<&'static str>,
    /// What it shows, for those who cannot see it.
    pub about: &'static str,
    /// How high it is.
    pub size: Size,
    /// Across: one axis, or several of which one is chosen.
    pub x: Vec<Axis>,
    /// Up: one axis, or several of which one is chosen.
    pub y: Vec<Axis>,
    /// Curves and marks, from below to above.
    pub series: Vec<Series>,
    /// Lines across the panel, below everything.
    pub spans: Vec<Span>,
    /// Labels, the most important first.
    pub labels: Vec<Label>,
    /// Whether labels may be far from their points, with a line that leads there.
    #[serde(skip)]
    pub has_leaders: bool,
    /// Where labels have room on the page.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub placements: Vec<Placement>,
    /// Labels of the windows of the forcing amplitude looked at.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run_labels: Option<RunLabels>,
}

/// How high a panel is on the page.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Size {
    /// For figures that people look at for long.
    Tall,
    /// For most.
    #[default]
    Medium,
    /// For panels one below the other.
    Low,
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axis {
    /// What a choice calls it.
    pub name: String,
    /// Quantity.
    pub title: String,
    /// Unit in which it is shown.
    pub unit: Unit,
    /// Lowest and highest value.
    pub range: (f64, f64),
    /// What the page shows at first, if that is more.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub whole: Option<(f64, f64)>,
    /// How values are spread.
    pub scale: Scale,
    /// Names at places, instead of numbers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ticks: Vec<(f64, String)>,
    /// The quantity, if it is one of which people ask for a range.
    #[serde(skip)]
    pub measure: Option<Measure>,
}

/// A quantity along axes, of which people ask for a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Frequency of the motion.
    Frequency,
    /// Amplitude of a monitored dof.
    Response,
    /// Forcing amplitude.
    Forcing,
}

/// A unit: shown = SI × factor.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unit {
    /// `mm`.
    pub name: String,
    /// How many of it make the SI unit.
    pub factor: f64,
}

/// How values are spread along an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// Evenly by their logarithms.
    Log,
}

/// A curve or marks.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Series {
    /// What its points make.
    pub kind: Kind,
    /// What it is, where its points are looked at: one name, or one for each axis up.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub name: Vec<String>,
    /// Values across: one column, or one for each axis.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub x: Vec<Ref>,
    /// Values up: one column, or one for each axis.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub y: Vec<Ref>,
    /// The other edge of a band.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub y2: Vec<Ref>,
    /// How it looks.
    pub style: Style,
    /// The level that it belongs to, by index.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level: Option<usize>,
    /// The branch whose points they are, by index.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branch: Option<usize>,
    /// For each axis up whether it is not drawn, for it would lie on another one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hidden: Vec<bool>,
    /// Whether it is drawn along the windows of the forcing amplitude looked at, in their colours.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub along_runs: bool,
    /// What switches it on, on the page.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub switch: Option<&'static str>,
    /// Points that are something special, and what.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub marks: Vec<(usize, &'static str)>,
    /// What is said of a point.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub details: Vec<Detail>,
    /// More points between those computed, for the eye only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smooth: Option<Smooth>,
    /// What of a motion it shows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub signal: Option<Signal>,
}

/// What points make.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A curve, with gaps where there is no number; marks alone, if its width is 0.
    #[default]
    Line,
    /// A closed curve, whose end is not its start once more.
    Closed,
    /// The area between two curves.
    Band,
}

/// A line of what is said of a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Detail {
    /// Quantity.
    pub label: &'static str,
    /// How its values are written.
    pub format: Format,
    /// Unit after the number, where the format has none.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub unit: &'static str,
    /// Significant digits.
    pub digits: u8,
    /// One column, or one for each axis up.
    pub values: Vec<Ref>,
}

/// How values are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Format {
    /// m, mm, µm, nm.
    Length,
    /// rad/s and Hz.
    Frequency,
    /// J, mJ, …
    Energy,
    /// %.
    Share,
    /// 1/s.
    Rate,
    /// Without a unit.
    Number,
}

/// Points between computed ones.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Smooth {
    /// The computed point before each.
    pub after: Vec<usize>,
    /// Values across, as of the series.
    pub x: Vec<Ref>,
    /// Values up, as of the series.
    pub y: Vec<Ref>,
}

/// What a series shows of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Signal {
    /// Node, by index; of no meaning for what all nodes make.
    pub node: usize,
    /// Quantity.
    pub of: Quantity,
    /// Instants of the period that are shown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub instants: Option<usize>,
}

/// A quantity of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Displacement over the period.
    Displacement,
    /// Contact pressure over the period.
    Pressure,
    /// Sizes of the harmonics.
    Spectrum,
    /// Displacements of all nodes at one instant.
    Shape,
    /// Displacements of all nodes at instants of the period.
    Shapes,
    /// Clearances of all nodes.
    Gap,
}

/// A line across a panel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Span {
    /// The axis that it is at a value of.
    pub axis: Direction,
    /// One value, or one for each axis; `None`: none.
    pub at: Vec<Option<f64>>,
    /// Whether it is at the forcing amplitude looked at.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub by_amplitude: bool,
    /// How it looks.
    pub style: Style,
}

/// One of the two axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// Across.
    X,
    /// Up.
    Y,
}

/// A text at a point, wherever beside it there is room.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Label {
    /// What it says.
    pub text: String,
    /// Its point, one value or one for each axis; `None`: at the right edge.
    pub x: Vec<Option<f64>>,
    /// Its point, one value or one for each axis; `None`: not shown.
    pub y: Vec<Option<f64>>,
    /// Its colour.
    pub color: Color,
    /// The level that it belongs to, by index.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level: Option<usize>,
    /// Where it stands best.
    #[serde(skip)]
    pub side: Side,
}

/// On which side of its point a label stands best.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Side {
    /// Above.
    #[default]
    Above,
    /// Below.
    Below,
    /// On the right.
    Right,
    /// On the right, at the same height: where labels of several points lie one above the other.
    Level,
}

/// The one that is chosen among several, or the only one.
pub fn chosen<T>(options: &[T], choice: usize) -> Option<&T> {
    options.get(choice).or_else(|| options.first())
}

impl Entry {
    /// Of what is drawn in every case.
    pub fn new(text: impl Into<String>, kind: Kind, style: Style) -> Self {
        Self { text: text.into(), kind, style, by_amplitude: false, frequency: None }
    }
}

impl Series {
    /// Whether it is drawn on the axes that are chosen.
    pub fn is_drawn(&self, choice: usize) -> bool {
        chosen(&self.hidden, choice) != Some(&true)
    }
}

impl Panel {
    /// The axes that are chosen, if there are any.
    pub fn axes(&self, choice: usize) -> Option<(&Axis, &Axis)> {
        Some((chosen(&self.x, choice)?, chosen(&self.y, choice)?))
    }
}

impl Unit {
    /// Without a name.
    pub fn none() -> Self {
        Self::si("")
    }

    /// Of the SI.
    pub fn si(name: &str) -> Self {
        Self { name: name.into(), factor: 1.0 }
    }
}
