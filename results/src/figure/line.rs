//! Straight lines between two points.

/// From one point to another; right and down, px.
pub(super) type Line = [(f64, f64); 2];

/// Whether two lines cross each other between their ends.
pub(super) fn cross(one: Line, other: Line) -> bool {
    let are_apart = |[a, b]: Line, [c, d]: Line| side(a, b, c) * side(a, b, d) < 0.0;
    are_apart(one, other) && are_apart(other, one)
}

/// On which side of the line from `a` to `b` a point lies, by the sign.
fn side(a: (f64, f64), b: (f64, f64), point: (f64, f64)) -> f64 {
    (b.0 - a.0) * (point.1 - a.1) - (b.1 - a.1) * (point.0 - a.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_cross_between_their_ends() {
        let line = [(0.0, 0.0), (10.0, 0.0)];
        assert!(cross(line, [(5.0, -1.0), (6.0, 3.0)]));
        // Beside it, beyond its end, from its end, along it.
        for other in [[(5.0, 1.0), (6.0, 3.0)], [(11.0, -1.0), (11.0, 1.0)], [(0.0, 0.0), (3.0, 4.0)], line] {
            assert!(!cross(line, other), "{other:?}");
        }
    }
}
