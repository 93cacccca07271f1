//! Closed curves whose two strands lie so close to each other that thick lines would be one, and gaps in one strand would cut the other.

use super::data::Axis;

/// Panels of files are about so large inside of their axes, px. On the page lines grow with texts, and so do panels.
const PANEL: (f64, f64) = (560.0, 330.0);
/// How many times as far apart as they are wide strands are at least.
const APART: f64 = 2.0;

/// The width of the line of a closed curve: as given, or less where its strands would touch, down to the second width.
pub(super) fn width(points: (&[f64], &[f64]), axes: (&Axis, &Axis), (full, least): (f64, f64)) -> f64 {
    // A hundredth of a px is not seen.
    let width = (100.0 * apart(points, axes) / APART).round() / 100.0;
    width.min(full).max(least.min(full))
}

/// How far apart strands are on average, px: the area over half of the length of the curve.
fn apart((x, y): (&[f64], &[f64]), (across, up): (&Axis, &Axis)) -> f64 {
    let place = |(&x, &y): (&f64, &f64)| (PANEL.0 * across.share(x), PANEL.1 * up.share(y));
    let points: Vec<(f64, f64)> = x.iter().zip(y).map(place).filter(|(x, y)| (x + y).is_finite()).collect();
    let next = points.iter().cycle().skip(1);
    let steps = || points.iter().zip(next.clone());
    let area: f64 = steps().map(|(a, b)| 0.5 * (a.0 * b.1 - a.1 * b.0)).sum();
    let length: f64 = steps().map(|(a, b)| (b.0 - a.0).hypot(b.1 - a.1)).sum();
    if length > 0.0 { 2.0 * area.abs() / length } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::data::Unit;
    use super::*;

    #[test]
    fn lines_are_thin_where_strands_are_close() {
        let axes = [PANEL.0, PANEL.1].map(|length| Axis::exact("", Unit::none(), (0.0, length)));
        // A bar as long as 200 px, and so high.
        let of =
            |high: f64| width((&[0.0, 200.0, 200.0, 0.0], &[0.0, 0.0, high, high]), (&axes[0], &axes[1]), (2.2, 0.75));
        assert_eq!([of(20.0), of(0.1)], [2.2, 0.75]);
        assert!((1.2..1.5).contains(&of(2.7)), "{}", of(2.7));
        assert_eq!(width((&[], &[]), (&axes[0], &axes[1]), (0.5, 0.75)), 0.5);
    }
}
