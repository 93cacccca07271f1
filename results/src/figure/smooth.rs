//! Points between computed ones where a curve turns visibly, so that the eye sees no corners. Computed points all stay.

use super::column_store::ColumnStore;
use super::data::{Axis, Kind, Series, Smooth};
use crate::curves::Column;

/// How large a panel is for which curves are smooth, px: larger than most, since readers zoom.
const PANEL: (f64, f64) = (1600.0, 900.0);
/// Turns below this angle are not seen, degrees.
const SEEN: f64 = 2.0;
/// Turns above are corners.
const CORNER: f64 = 50.0;
/// Segments below this length are not seen, px.
const SHORT: f64 = 1.5;
/// Points put into a segment at most.
const MOST: usize = 6;
/// Farther from its segment than this share of its length no point is put.
const FAR: f64 = 0.12;

type Point = (f64, f64);

/// Adds points to a curve, for its axis across and each axis up. Its columns are given by their values.
pub fn smooth(series: &mut Series, (x, y): (&[f64], &[&[f64]]), axes: (&Axis, &[Axis]), store: &mut ColumnStore) {
    let curves: Vec<Vec<Point>> = y.iter().zip(axes.1).map(|(y, up)| pixels(x, y, (axes.0, up))).collect();
    let is_closed = series.kind == Kind::Closed;
    let counts: Vec<usize> = (0..x.len())
        .map(|i| curves.iter().map(|curve| count(&neighbours(curve, i, is_closed))).max().unwrap_or(0))
        .collect();
    let after: Vec<usize> = (0..x.len()).flat_map(|i| std::iter::repeat_n(i, counts[i])).collect();
    if after.is_empty() {
        return;
    }
    let mut smooth = Smooth { after, x: Vec::new(), y: Vec::new() };
    for (curve, up) in curves.iter().zip(axes.1) {
        let between = (0..x.len()).flat_map(|i| inserted(&neighbours(curve, i, is_closed), counts[i]));
        let (x, y): (Vec<f64>, Vec<f64>) =
            between.map(|(right, up_px)| (axes.0.value_at(right / PANEL.0), up.value_at(up_px / PANEL.1))).unzip();
        smooth.x.push(store.exact(x));
        smooth.y.push(store.add(Column::short(y)));
    }
    series.smooth = Some(smooth);
}

fn pixels(x: &[f64], y: &[f64], axes: (&Axis, &Axis)) -> Vec<Point> {
    x.iter().zip(y).map(|(&x, &y)| (PANEL.0 * axes.0.share(x), PANEL.1 * axes.1.share(y))).collect()
}

/// The ends of segment `i` with the points before and after; NaN where there is none.
fn neighbours(curve: &[Point], i: usize, is_closed: bool) -> [Point; 4] {
    let count = curve.len() as isize;
    let at = |k: isize| {
        let place = if is_closed { k.rem_euclid(count.max(1)) } else { k };
        usize::try_from(place).ok().and_then(|place| curve.get(place)).copied().unwrap_or((f64::NAN, f64::NAN))
    };
    [-1, 0, 1, 2].map(|k| at(i as isize + k))
}

fn length(a: Point, b: Point) -> f64 {
    (b.0 - a.0).hypot(b.1 - a.1)
}

/// The angle by which a curve turns at b, degrees; 0 where nobody sees it.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    let (u, v) = ((b.0 - a.0, b.1 - a.1), (c.0 - b.0, c.1 - b.1));
    let is_seen = length(a, b) > SHORT && length(b, c) > SHORT;
    let angle = (u.0 * v.1 - u.1 * v.0).atan2(u.0 * v.0 + u.1 * v.1).abs().to_degrees();
    if is_seen && angle.is_finite() { angle } else { 0.0 }
}

/// How many points a segment needs.
fn count(&[a, b, c, d]: &[Point; 4]) -> usize {
    let angle = turn(a, b, c).max(turn(b, c, d));
    let is_curve = (SEEN..CORNER).contains(&angle) && length(b, c).is_finite();
    // Points that nobody could tell apart are none.
    if is_curve { ((angle / SEEN).ceil() as usize).min((length(b, c) / SHORT) as usize).min(MOST) } else { 0 }
}

/// Points of a centripetal Catmull–Rom spline, evenly along its parameter; on the segment itself where the spline strays or
/// has no neighbour.
fn inserted(&[a, b, c, d]: &[Point; 4], count: usize) -> Vec<Point> {
    let mirrored = |p: Point, q: Point| (2.0 * p.0 - q.0, 2.0 * p.1 - q.1);
    let is_there = |p: Point| p.0.is_finite() && p.1.is_finite();
    let a = if is_there(a) && turn(a, b, c) < CORNER { a } else { mirrored(b, c) };
    let d = if is_there(d) && turn(b, c, d) < CORNER { d } else { mirrored(c, b) };
    let step = |p: Point, q: Point| length(p, q).sqrt().max(1e-9);
    let t1 = step(a, b);
    let t2 = t1 + step(b, c);
    let t3 = t2 + step(c, d);
    let mix = |p: Point, q: Point, (from, to): (f64, f64), t: f64| {
        let share = (t - from) / (to - from);
        (p.0 + share * (q.0 - p.0), p.1 + share * (q.1 - p.1))
    };
    let point = |k: usize| {
        let share = (k + 1) as f64 / (count + 1) as f64;
        let t = t1 + share * (t2 - t1);
        let [ab, bc, cd] = [mix(a, b, (0.0, t1), t), mix(b, c, (t1, t2), t), mix(c, d, (t2, t3), t)];
        let (abc, bcd) = (mix(ab, bc, (0.0, t2), t), mix(bc, cd, (t1, t3), t));
        let curved = mix(abc, bcd, (t1, t2), t);
        let straight = (b.0 + share * (c.0 - b.0), b.1 + share * (c.1 - b.1));
        if distance(curved, b, c) <= FAR * length(b, c) { curved } else { straight }
    };
    (0..count).map(point).collect()
}

/// How far a point is from a segment.
fn distance(point: Point, from: Point, to: Point) -> f64 {
    let (along, size) = ((to.0 - from.0, to.1 - from.1), length(from, to));
    let share = ((point.0 - from.0) * along.0 + (point.1 - from.1) * along.1) / (size * size);
    let share = share.clamp(0.0, 1.0);
    length(point, (from.0 + share * along.0, from.1 + share * along.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Unit, View};

    /// A curve over these points, smoothed.
    fn smoothed(x: &[f64], y: &[f64], kind: Kind) -> (Series, ColumnStore) {
        let mut store = ColumnStore::default();
        let (of_x, of_y) = (store.exact(x.to_vec()), store.exact(y.to_vec()));
        let mut series = Series { kind, x: vec![of_x], y: vec![of_y], ..Series::default() };
        smooth(&mut series, (x, &[y]), (&axis(), &[axis()]), &mut store);
        (series, store)
    }

    fn axis() -> Axis {
        Axis::exact("", Unit::none(), (-1.0, 1.0))
    }

    #[test]
    fn a_coarse_circle_becomes_round() {
        let angles = (0..24).map(|i| f64::from(i) / 24.0 * std::f64::consts::TAU);
        let (x, y): (Vec<f64>, Vec<f64>) = angles.map(|angle| (0.9 * angle.cos(), 0.9 * angle.sin())).unzip();
        let (series, store) = smoothed(&x, &y, Kind::Closed);
        let view = View { choice: 0, store: &store, frame: None };
        let points = &view.parts(&series, (&axis(), &axis()))[0].points;
        assert!(points.len() > 24 * 5, "{}", points.len());
        assert!(x.iter().zip(&y).all(|(&x, &y)| points.contains(&(axis().share(x), axis().share(y)))));
        for (right, up) in points {
            let radius = (2.0 * right - 1.0).hypot(2.0 * up - 1.0);
            assert!((radius - 0.9).abs() < 2e-3, "{radius}");
        }
    }

    #[test]
    fn corners_gaps_and_straight_lines_stay() {
        let corner = smoothed(&[-0.9, 0.0, 0.0], &[0.0, 0.0, 0.9], Kind::Line).0;
        assert_eq!(corner.smooth, None);
        let straight = smoothed(&[-0.9, -0.3, 0.3, 0.9], &[-0.9, -0.3, 0.3, 0.9], Kind::Line).0;
        assert_eq!(straight.smooth, None);
        let gap = smoothed(&[-0.9, f64::NAN, 0.3, 0.9], &[-0.9, 0.0, 0.3, 1e300], Kind::Line).0;
        assert_eq!(gap.smooth, None);
    }

    #[test]
    fn no_point_strays() {
        let x: Vec<f64> = (0..40).map(|i| f64::from(i) / 20.0 - 1.0).collect();
        let y: Vec<f64> = x.iter().map(|x| (9.0 * x).sin() * (1.0 - x.abs()) * 0.9).collect();
        let (series, store) = smoothed(&x, &y, Kind::Line);
        let smooth = series.smooth.unwrap();
        let (sx, sy) = (store.values(&smooth.x[0], 1.0), store.values(&smooth.y[0], 1.0));
        let place = |x: f64, y: f64| pixels(&[x], &[y], (&axis(), &axis()))[0];
        assert!(!sx.is_empty());
        for ((&i, x_in), y_in) in smooth.after.iter().zip(sx).zip(sy) {
            let (from, to) = (place(x[i], y[i]), place(x[i + 1], y[i + 1]));
            assert!(distance(place(x_in, y_in), from, to) <= 1.01 * FAR * length(from, to));
        }
    }
}
