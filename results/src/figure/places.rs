//! Where labels stand on the page, as data.

use serde::Serialize;

/// Labels that have room in a panel of some width.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Placement {
    /// The option of the reader's choice.
    pub choice: usize,
    /// Inner width of the panel, px.
    pub width: u32,
    /// Which label, what of it is at the end of the offset, offset from its point right and down, px, and whether a line
    /// leads there.
    pub spots: Vec<(usize, &'static str, i32, i32, u8)>,
}

/// Labels of the windows of the forcing amplitude looked at: at a point of a series in each.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunLabels {
    /// The series, by index.
    pub series: usize,
    /// Where on it.
    pub at: RunPoint,
    /// Places of labels, for each frame.
    pub frames: Vec<Vec<Placement>>,
}

/// A point of a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RunPoint {
    /// That of smallest threshold.
    Best,
    /// Between its ends.
    Middle,
}
