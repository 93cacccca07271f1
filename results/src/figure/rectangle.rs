//! Rectangles in a panel, px.

/// A rectangle; right and down from the panel's upper left corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rect {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Right edge.
    pub right: f64,
    /// Lower edge.
    pub bottom: f64,
}

impl Rect {
    /// Whether a point is inside.
    pub fn holds(&self, point: &(f64, f64)) -> bool {
        (self.left..self.right).contains(&point.0) && (self.top..self.bottom).contains(&point.1)
    }

    /// How far a point is outside.
    pub fn distance(&self, (x, y): (f64, f64)) -> f64 {
        let across = (self.left - x).max(x - self.right).max(0.0);
        across.hypot((self.top - y).max(y - self.bottom).max(0.0))
    }

    /// Whether they have room in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        let is_beside = self.left >= other.right || other.left >= self.right;
        !(is_beside || self.top >= other.bottom || other.top >= self.bottom)
    }
}
