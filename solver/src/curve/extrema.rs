//! Extrema of quantities along a curve: found between its points, located along the arc, inserted.

use crate::curve::continuation::{Continuation, CurvePoint};
use crate::curve::problem::Problem;
use crate::curve::sides::Side;
use crate::curve::walk::{Evaluated, TracedPoint};

/// Indices of alternating minima and maxima (true) of a sequence, ignoring wiggles lower than `prominence`; the ends
/// count as extrema.
pub fn turning_points(values: &[f64], prominence: f64) -> Vec<(usize, bool)> {
    let mut found = Vec::new();
    let (mut low, mut high) = (0, 0);
    let mut rising = None;
    for (i, &value) in values.iter().enumerate() {
        if value > values[high] {
            high = i;
        }
        if value < values[low] {
            low = i;
        }
        if rising != Some(true) && value > values[low] + prominence {
            found.push((low, false));
            (rising, high) = (Some(true), i);
        } else if rising != Some(false) && value < values[high] - prominence {
            found.push((high, true));
            (rising, low) = (Some(false), i);
        }
    }
    match rising {
        Some(true) => found.push((high, true)),
        Some(false) => found.push((low, false)),
        None => {}
    }
    found
}

/// A peak stands out where a sequence falls to less than this part of it on both sides.
const RISE: f64 = 2.0;

/// On one side this part is enough if the sequence falls up to its end.
const FLANK: f64 = 1.2;

/// Indices of the peaks of a sequence of positive numbers that stand out, ascending, without the largest of all: an amplitude has one at every
/// resonance.
pub fn further_peaks(values: &[f64]) -> Vec<usize> {
    let largest = (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b]));
    standing_peaks(values).into_iter().filter(|&i| Some(i) != largest).collect()
}

/// The same with the largest of all, if it stands out as well: an end does not.
pub fn standing_peaks(values: &[f64]) -> Vec<usize> {
    let logs: Vec<f64> = values.iter().map(|value| value.ln()).collect();
    let falls = |i: usize, side: &[f64]| side.iter().any(|value| RISE * value < values[i]);
    let turns = turning_points(&logs, RISE.ln()).into_iter().filter(|(_, is_peak)| *is_peak).map(|(i, _)| i);
    let stands = |&i: &usize| {
        let (before, after) = (&values[..i], &values[i + 1..]);
        // Where a curve ends on a flank it would fall on.
        let ends = |is_flank: bool, end: Option<&f64>| is_flank && end.is_some_and(|end| FLANK * end < values[i]);
        match (falls(i, before), falls(i, after)) {
            (true, true) => true,
            (true, false) => ends(after.is_sorted_by(|a, b| a >= b), after.last()),
            (false, true) => ends(before.is_sorted(), before.first()),
            (false, false) => false,
        }
    };
    turns.filter(stands).collect()
}

/// Relative error up to which a parabola predicts a value.
const PREDICTED: f64 = 1e-8;

/// Something to maximise along a curve.
pub type Measure<'f, P, T> = dyn Fn(&mut P, &TracedPoint<T>) -> f64 + 'f;

/// A maximum located along the arc.
#[derive(Debug, Clone)]
pub struct Maximum<T> {
    /// Index of the visited point it was found from.
    pub anchor: usize,
    /// Arc length from there, and the point; `None` if the visited point itself is the maximum.
    pub located: Option<(f64, TracedPoint<T>)>,
}

/// Locates a maximum of `measure` near `visited[anchor]`, whose value `values[1]` is not below those of its neighbours,
/// `values[0]` and `values[2]` at arc lengths `-arcs.0` and `arcs.1`: successive parabolic interpolation, until a parabola that
/// predicted the last value changes it by less than 1e-10 relative.
pub fn locate_maximum<P: Problem, T: Evaluated<P>>(
    continuation: &mut Continuation<'_, P>,
    visited: &[TracedPoint<T>],
    anchor: usize,
    arcs: (f64, f64),
    values: [f64; 3],
    measure: &Measure<'_, P, T>,
) -> Maximum<T> {
    let centre = &visited[anchor];
    let (mut lower, mut best, mut upper) = ((-arcs.0, values[0]), (0.0, values[1]), (arcs.1, values[2]));
    let mut located = None;
    let whole = upper.0 - lower.0;
    // Next to a corner of the curve a point may lie at the vertex of a parabola by chance.
    let mut is_parabola = false;
    for _ in 0..40 {
        let width = upper.0 - lower.0;
        let gain = parabola_gain(lower, best, upper);
        let is_there = is_parabola && gain.is_some_and(|gain| gain < 1e-10 * best.1.abs());
        if width < 1e-6 * whole.min(1.0) || is_there {
            break;
        }
        let farther = if upper.0 - best.0 > best.0 - lower.0 { upper.0 } else { lower.0 };
        let inside = |s: &f64| *s > lower.0 + 1e-3 * width && *s < upper.0 - 1e-3 * width;
        let mut s = parabola_vertex(lower, best, upper).filter(inside).unwrap_or(best.0 + 0.38 * (farther - best.0));
        if (s - best.0).abs() < 1e-3 * width {
            s = best.0 + (1e-2 * width).copysign(farther - best.0);
        }
        // What lies on an image of the curve, or on what that comes near to, is no point of it.
        let is_on_curve = |problem: &P, curve: &CurvePoint| {
            let [from, to] = [&centre.curve.y, &curve.y];
            problem.are_neighbours(from, to) && Side::of(problem, from, to) == Side::Same
        };
        let curve = continuation.probe(&centre.curve, s).ok();
        let curve = curve.filter(|curve| is_on_curve(continuation.problem(), curve));
        let trial_point = curve.map(|curve| {
            let point = T::evaluate(continuation.problem(), &curve);
            TracedPoint { curve, point }
        });
        let value = trial_point.as_ref().map_or(f64::NEG_INFINITY, |point| measure(continuation.problem(), point));
        let trial = (s, value);
        let predicted = parabola_at(s, lower, best, upper);
        is_parabola = (predicted - value).abs() < PREDICTED * best.1.abs();
        let better = trial.1 > best.1;
        match (better, s > best.0) {
            (true, true) => (lower, best) = (best, trial),
            (true, false) => (upper, best) = (best, trial),
            (false, true) => upper = trial,
            (false, false) => lower = trial,
        }
        if let Some(point) = trial_point.filter(|_| better) {
            located = Some((s, point));
        }
    }
    Maximum { anchor, located }
}

/// Inserts located maxima between the visited points (steps are kept consistent with the arc) and returns the index of
/// each of them in the new list, in the order given.
pub fn insert_maxima<T>(visited: Vec<TracedPoint<T>>, maxima: Vec<Maximum<T>>) -> (Vec<TracedPoint<T>>, Vec<usize>) {
    /// Where an entry of the new list comes from.
    #[derive(PartialEq)]
    enum Origin {
        Visited(usize),
        Located(usize),
    }
    let mut arc = 0.0;
    let mut entries: Vec<(f64, TracedPoint<T>, Origin)> = Vec::with_capacity(visited.len() + maxima.len());
    for (i, v) in visited.into_iter().enumerate() {
        arc += v.curve.step;
        entries.push((arc, v, Origin::Visited(i)));
    }
    let mut origins = Vec::with_capacity(maxima.len());
    for (label, Maximum { anchor, located }) in maxima.into_iter().enumerate() {
        origins.push(match located {
            Some((offset, v)) => {
                entries.push((entries[anchor].0 + offset, v, Origin::Located(label)));
                Origin::Located(label)
            }
            None => Origin::Visited(anchor),
        });
    }
    entries.sort_by(|a, b| a.0.total_cmp(&b.0));
    let place = |origin: &Origin| entries.iter().position(|entry| entry.2 == *origin).unwrap_or(0);
    let indices = origins.iter().map(place).collect();
    let mut last = entries.first().map_or(0.0, |entry| entry.0);
    let merged = entries
        .into_iter()
        .map(|(position, mut v, _)| {
            v.curve.step = position - std::mem::replace(&mut last, position);
            v
        })
        .collect();
    (merged, indices)
}

/// Position of the vertex of the parabola through three points.
fn parabola_vertex(a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> Option<f64> {
    let (p, q) = ((b.0 - a.0) * (b.1 - c.1), (b.0 - c.0) * (b.1 - a.1));
    let s = b.0 - 0.5 * ((b.0 - a.0) * p - (b.0 - c.0) * q) / (p - q);
    s.is_finite().then_some(s)
}

/// Value at `s` of the parabola through three points.
fn parabola_at(s: f64, a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> f64 {
    let slope = (c.1 - b.1) / (c.0 - b.0);
    let curvature = (slope - (b.1 - a.1) / (b.0 - a.0)) / (c.0 - a.0);
    b.1 + (s - b.0) * (slope + curvature * (s - c.0))
}

/// How far the vertex of the parabola through three points lies above the middle one.
fn parabola_gain(a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> Option<f64> {
    let s = parabola_vertex(a, b, c)?;
    let curvature = ((c.1 - b.1) / (c.0 - b.0) - (b.1 - a.1) / (b.0 - a.0)) / (c.0 - a.0);
    Some((curvature * (s - b.0) * (s - b.0)).abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::bent::Bent;
    use crate::curve::continuation::ContinuationSettings;

    /// A place along a straight line.
    #[derive(Clone)]
    struct Place(f64);

    impl Evaluated<Bent> for Place {
        fn evaluate(_: &mut Bent, point: &CurvePoint) -> Self {
            Self(point.y[1])
        }

        fn omega(&self) -> f64 {
            1.0
        }

        fn amplitude(&self) -> f64 {
            1.0
        }
    }

    #[test]
    fn what_stands_out_is_a_peak_of_its_own() {
        assert_eq!(further_peaks(&[1.0, 9.0, 2.0, 5.0, 1.0]), [3]);
        assert_eq!(further_peaks(&[1.0, 5.0, 2.0, 9.0, 1.0, 3.0, 0.5]), [1, 5]);
        // Neither what hardly falls before it rises again nor an end is.
        assert_eq!(further_peaks(&[1.0, 9.0, 4.0, 5.0, 3.0, 6.5, 7.0]), [] as [usize; 0]);
        assert_eq!(further_peaks(&[]), [] as [usize; 0]);
        assert_eq!(standing_peaks(&[1.0, 9.0, 2.0, 5.0, 1.0]), [1, 3]);
        assert_eq!(standing_peaks(&[9.0, 2.0, 5.0, 1.0]), [2]);
        // One whose flank a bound has cut off stands out all the same; a bump before an end, and what rises to one, does not.
        assert_eq!(standing_peaks(&[1.0, 2.0, 9.0, 5.0]), [2]);
        assert_eq!(standing_peaks(&[5.0, 9.0, 2.0, 1.0]), [1]);
        assert_eq!(standing_peaks(&[1.0, 2.0, 9.0, 8.0]), [] as [usize; 0]);
        assert_eq!(standing_peaks(&[1.0, 9.0, 6.0, 7.0]), [] as [usize; 0]);
        assert_eq!(standing_peaks(&[7.0, 9.0, 8.0, 7.0]), [] as [usize; 0]);
    }

    /// Where what is largest has a corner, the vertex of a parabola may be one of its points by chance, and is not the maximum.
    #[test]
    fn maxima_at_corners() {
        let height = |at: f64| 1.0 - if at > -0.4 { (at - 0.3).abs() } else { 0.7 };
        let mut line = Bent::new([0.0, 0.0]);
        let visited: Vec<TracedPoint<Place>> = [-1.0, 0.0, 1.0]
            .map(|at| {
                let along = Continuation::start(&mut line, vec![0.0, at], &[0.0, 1.0], ContinuationSettings::default());
                TracedPoint { curve: along.unwrap().current().clone(), point: Place(at) }
            })
            .into();
        let first = visited[0].curve.clone();
        let mut along =
            Continuation::start(&mut line, first.y, &first.tangent, ContinuationSettings::default()).unwrap();
        let values = [-1.0, 0.0, 1.0].map(height);
        assert_eq!(parabola_gain((-1.0, values[0]), (0.0, values[1]), (1.0, values[2])), Some(0.0));
        let measure = |_: &mut Bent, place: &TracedPoint<Place>| height(place.point.0);
        let maximum = locate_maximum(&mut along, &visited, 1, (1.0, 1.0), values, &measure);
        let (offset, found) = maximum.located.unwrap();
        assert!((offset - 0.3).abs() < 1e-5 && (found.point.0 - 0.3).abs() < 1e-5, "{offset}");
    }

    #[test]
    fn parabolas_pass_through_their_points() {
        let at = |s: f64| (s, 3.0 - 2.0 * (s - 0.3).powi(2));
        let value = parabola_at(0.7, at(-1.0), at(0.2), at(2.0));
        assert!((value - at(0.7).1).abs() < 1e-14, "{value}");
    }

    #[test]
    fn turning_points_ignore_wiggles() {
        let values = [1.0, 0.5, 0.2, 0.2001, 0.1999, 0.6, 0.9, 0.8999, 0.95, 0.3];
        assert_eq!(turning_points(&values, 0.01), vec![(0, true), (4, false), (8, true), (9, false)]);
        assert!(turning_points(&[1.0, 1.0001, 1.0], 0.01).is_empty());
    }
}
