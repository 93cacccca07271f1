//! Cuts curves and areas at the edges of a panel, so that nothing beyond is written.

/// A point, px.
pub type Point = (f64, f64);

/// A rectangle, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rect {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

impl Rect {
    /// Right edge.
    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    /// Lower edge.
    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// A point by its shares of the width and the height, right and up.
    pub fn at(&self, (right, up): (f64, f64)) -> Point {
        (self.left + right * self.width, self.top + (1.0 - up) * self.height)
    }

    /// Whether a point is inside or on the edge.
    pub fn holds(&self, (x, y): Point) -> bool {
        (self.left - 0.01..=self.right() + 0.01).contains(&x) && (self.top - 0.01..=self.bottom() + 0.01).contains(&y)
    }

    /// Inside of each edge, how far: left, right, top, bottom.
    fn depths(&self, (x, y): Point) -> [f64; 4] {
        [x - self.left, self.right() - x, y - self.top, self.bottom() - y]
    }
}

/// The visible parts of a curve; gaps where a coordinate is no number.
pub fn curve(points: &[Point], frame: &Rect) -> Vec<Vec<Point>> {
    let mut parts: Vec<Vec<Point>> = Vec::new();
    let mut end: Option<Point> = None;
    for pair in points.windows(2) {
        let Some((from, to)) = segment(pair[0], pair[1], frame) else {
            end = None;
            continue;
        };
        match parts.last_mut() {
            Some(part) if end == Some(from) => part.push(to),
            _ => parts.push(vec![from, to]),
        }
        // What left the panel begins anew when it comes back.
        end = (to == pair[1]).then_some(to);
    }
    parts
}

/// The part of a segment that is inside.
fn segment(a: Point, b: Point, frame: &Rect) -> Option<(Point, Point)> {
    let (at_a, at_b) = (frame.depths(a), frame.depths(b));
    let (mut first, mut last) = (0.0, 1.0);
    for (a, b) in at_a.into_iter().zip(at_b) {
        if !(a.is_finite() && b.is_finite()) || (a < 0.0 && b < 0.0) {
            return None;
        }
        let share = a / (a - b);
        if a < 0.0 {
            first = f64::max(first, share);
        } else if b < 0.0 {
            last = f64::min(last, share);
        }
    }
    let at = |share: f64| (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1));
    let ends = (if first > 0.0 { at(first) } else { a }, if last < 1.0 { at(last) } else { b });
    (first <= last).then_some(ends)
}

/// The visible part of an area with these corners; those that are no numbers are left out.
pub fn area(corners: &[Point], frame: &Rect) -> Vec<Point> {
    let mut corners: Vec<Point> = corners.iter().copied().filter(|(x, y)| x.is_finite() && y.is_finite()).collect();
    for edge in 0..4 {
        let mut inside = Vec::with_capacity(corners.len());
        for (i, &to) in corners.iter().enumerate() {
            let from = corners[(i + corners.len() - 1) % corners.len()];
            let (a, b) = (frame.depths(from)[edge], frame.depths(to)[edge]);
            if (a < 0.0) != (b < 0.0) {
                let share = a / (a - b);
                inside.push((from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1)));
            }
            if b >= 0.0 {
                inside.push(to);
            }
        }
        corners = inside;
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Rect = Rect { left: 0.0, top: 0.0, width: 10.0, height: 10.0 };

    #[test]
    fn curves_end_at_the_edge() {
        let parts = curve(&[(-5.0, 5.0), (5.0, 5.0), (5.0, 20.0), (6.0, 20.0), (6.0, 5.0), (7.0, 5.0)], &FRAME);
        assert_eq!(parts, [vec![(0.0, 5.0), (5.0, 5.0), (5.0, 10.0)], vec![(6.0, 10.0), (6.0, 5.0), (7.0, 5.0)]]);
        let parts = curve(&[(1.0, 1.0), (f64::NAN, 2.0), (3.0, 3.0), (4.0, 3.0)], &FRAME);
        assert_eq!(parts, [vec![(3.0, 3.0), (4.0, 3.0)]]);
        assert!(curve(&[(-5.0, 1.0), (1.0, -5.0)], &FRAME).is_empty());
        assert!(curve(&[(1.0, 1.0)], &FRAME).is_empty());
    }

    #[test]
    fn areas_end_at_the_edge() {
        let corners = area(&[(5.0, 5.0), (15.0, 5.0), (15.0, 15.0), (5.0, 15.0)], &FRAME);
        assert!(corners.len() >= 4 && corners.iter().all(|&corner| FRAME.holds(corner)), "{corners:?}");
        assert!(area(&[(20.0, 20.0), (30.0, 20.0), (30.0, 30.0)], &FRAME).is_empty());
        assert!(area(&[(f64::NAN, 0.0)], &FRAME).is_empty());
    }
}
