//! How series look: colours by their role, widths, dashes and marks. One style for files and the page.

use serde::Serialize;

/// Lines that are there for comparison.
pub const FINE: f64 = 0.75;
/// Main branches.
pub const THIN: f64 = 1.1;
/// Curves that a figure is about.
pub const MEDIUM: f64 = 1.6;
/// Isolas.
pub const BOLD: f64 = 2.2;
/// Marks.
pub const MARK: f64 = 6.0;

/// A colour, by what it says.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Color {
    /// Curves that a figure is about, and texts.
    #[default]
    Ink,
    /// What stands back.
    Soft,
    /// What stands far back.
    Shade,
    /// What is not found.
    Alert,
    /// The background: gaps in lines.
    Paper,
    /// A forcing level, from 0 (the lowest) to 1 (the highest).
    Level(f64),
    /// The same, faded: what is not known of it.
    PaleLevel(f64),
    /// One of a few that are told apart.
    Category(usize),
    /// The same, faded.
    PaleCategory(usize),
}

impl Color {
    /// Faded, for what is not known of a curve of this colour.
    pub fn pale(self) -> Self {
        match self {
            Self::Level(share) => Self::PaleLevel(share),
            Self::Category(index) => Self::PaleCategory(index),
            Self::Ink | Self::Soft => Self::Shade,
            other => other,
        }
    }
}

/// How a series looks. Lengths are px in files (1/96 inch).
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Style {
    /// Colour.
    pub color: Color,
    /// Of the line; 0: none.
    pub width: f64,
    /// Lengths of dashes and gaps; none: solid.
    pub dash: &'static [f64],
    /// Marks at the points.
    pub marker: Option<Marker>,
    /// Whether the inside has the colour, light.
    pub fill: bool,
}

/// Marks at points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Marker {
    /// Shape.
    pub shape: Shape,
    /// How wide.
    pub size: f64,
    /// Whether its inside is empty.
    pub open: bool,
}

/// Shapes of marks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// ●
    Circle,
    /// ■
    Square,
    /// ▲
    Triangle,
    /// ▼
    InvertedTriangle,
    /// ×
    Cross,
}

impl Style {
    /// A solid line.
    pub fn line(color: Color, width: f64) -> Self {
        Self { color, width, ..Self::default() }
    }

    /// Marks without a line.
    pub fn marks(color: Color, shape: Shape, size: f64, open: bool) -> Self {
        Self::line(color, 0.0).with_marker(shape, size, open)
    }

    /// Gaps in a line of this width that lies below: it looks dashed.
    pub fn gaps(width: f64) -> Self {
        Self { dash: &GAPS, ..Self::line(Color::Paper, width + SPILL) }
    }

    /// A light area of a colour, without an edge.
    pub fn area(color: Color) -> Self {
        Self { color, fill: true, ..Self::default() }
    }

    /// With one of the patterns that are told apart without colours; 0 is solid.
    pub fn with_dash(self, index: usize) -> Self {
        Self { dash: DASHES[index % DASHES.len()], ..self }
    }

    /// With marks at the points.
    pub fn with_marker(self, shape: Shape, size: f64, open: bool) -> Self {
        Self { marker: Some(Marker { shape, size, open }), ..self }
    }
}

/// Lengths of gaps and of what is left between them.
const GAPS: [f64; 2] = [2.5, 4.0];
/// By how much what covers a line is wider, so that nothing of its edges shines through.
const SPILL: f64 = 0.6;
/// The same of what is pale, which has to look no bolder than the line below it: of its edges little shines through.
pub(super) const EDGE: f64 = 0.25;

/// Patterns that are told apart without colours.
const DASHES: [&[f64]; 5] = [&[], &[5.0, 2.5], &[1.2, 1.8], &[6.0, 2.0, 1.2, 2.0], &[9.0, 3.0]];
