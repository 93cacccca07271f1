//! Whether a point lies on a curve that is known by its points: by converging onto the curve in the plane through the point,
//! which works at folds and between close sheets, where comparing at equal frequency does not.

use crate::curve::newton::{Constraint, Newton, NewtonSettings};
use crate::curve::point::direction_at;
use crate::curve::problem::{Problem, norm, weighted};

/// Largest distance of a curve from the chord between two of its neighbouring points, relative to the chord: steps that turn
/// more are refused.
const SAG: f64 = 0.3;

/// How far beyond the ends of a chord a point may lie: where two chords meet at an angle, points outside of it are beside
/// both.
const OVERLAP: f64 = 0.1;

/// Two solutions that differ by less, relative to the size of their motion and to the chord, are the same.
const SAME: f64 = 1e-6;

/// A convergence that moves by less than this share of the chord has stayed on the sheet that it was predicted on.
const NEAR: f64 = 0.05;

/// Most bisections of a chord until predictions are that near.
const DEPTH: usize = 8;

/// Tells whether curves pass through given points.
#[derive(Debug, Default)]
pub struct Identity {
    newton: Newton,
}

impl Identity {
    /// Number of the point of a curve between which and the next one a solution lies, or an image of it, if it lies on the curve.
    pub fn position<P: Problem>(
        &mut self,
        problem: &mut P,
        settings: &NewtonSettings,
        points: &[&[f64]],
        is_closed: bool,
        target: &[f64],
    ) -> Option<usize> {
        let targets = problem.distinct_images(target);
        let last = if is_closed { points.first() } else { None };
        let successors = points.iter().skip(1).chain(last);
        points
            .iter()
            .zip(successors)
            .position(|(a, b)| targets.iter().any(|target| self.passes(problem, settings, [a, b], target)))
    }

    /// Whether the curve between two of its neighbouring points `a` and `b` passes through the solution `target`.
    pub fn passes<P: Problem>(
        &mut self,
        problem: &mut P,
        settings: &NewtonSettings,
        [a, b]: [&[f64]; 2],
        target: &[f64],
    ) -> bool {
        if !is_beside(problem.metric(), a, b, target) {
            return false;
        }
        if [a, b].into_iter().any(|end| is_same(problem, end, target, distance(problem.metric(), a, b))) {
            return true;
        }
        let chord = difference(b, a);
        let Some(ends) = self.tangents(problem, [a, b], &chord) else { return false };
        self.converges_to(problem, settings, [a, b], ends, target, DEPTH)
    }

    /// Unit tangents at two points, the way of a chord.
    fn tangents<P: Problem>(&mut self, problem: &mut P, points: [&[f64]; 2], chord: &[f64]) -> Option<[Vec<f64>; 2]> {
        let row = weighted(problem.metric(), chord);
        let mut tangent = |y: &[f64]| direction_at(problem, y.to_vec(), &row);
        Some([tangent(points[0])?, tangent(points[1])?])
    }

    fn converges_to<P: Problem>(
        &mut self,
        problem: &mut P,
        settings: &NewtonSettings,
        [a, b]: [&[f64]; 2],
        tangents: [Vec<f64>; 2],
        target: &[f64],
        depth: usize,
    ) -> bool {
        let chord = difference(b, a);
        let length = norm(problem.metric(), &chord);
        let share = projection(problem.metric(), a, &chord, target);
        let Some((y, shift)) = self.on_plane(problem, settings, [a, b], &tangents, share, Some(target)) else {
            return false;
        };
        if is_same(problem, &y, target, length) && shift <= NEAR * length {
            return true;
        }
        if depth == 0 || shift <= NEAR * length {
            return false;
        }
        let Some((middle, _)) = self.on_plane(problem, settings, [a, b], &tangents, 0.5, None) else { return false };
        let Some([tangent, _]) = self.tangents(problem, [&middle, &middle], &chord) else { return false };
        let [first, last] = tangents;
        let halves = [([a, &middle], [first, tangent.clone()]), ([&middle, b], [tangent, last])];
        halves.into_iter().any(|(ends, tangents)| {
            is_beside(problem.metric(), ends[0], ends[1], target)
                && self.converges_to(problem, settings, ends, tangents, target, depth - 1)
        })
    }

    /// The curve's point in the plane normal to a chord at `share` of it (through `through`, if given), and how far it lies
    /// from the cubic through both ends.
    fn on_plane<P: Problem>(
        &mut self,
        problem: &mut P,
        settings: &NewtonSettings,
        [a, b]: [&[f64]; 2],
        tangents: &[Vec<f64>; 2],
        share: f64,
        through: Option<&[f64]>,
    ) -> Option<(Vec<f64>, f64)> {
        let chord = difference(b, a);
        let length = norm(problem.metric(), &chord);
        let row: Vec<f64> = weighted(problem.metric(), &chord).into_iter().map(|w| w / length).collect();
        let predicted = hermite([a, b], tangents, length, share);
        let mut y = predicted.clone();
        let origin = through.unwrap_or(&predicted);
        let constraint = Constraint::Hyperplane { row: &row, origin };
        self.newton.solve(problem, &mut y, constraint, settings).ok()?;
        let shift = distance(problem.metric(), &y, &predicted);
        Some((y, shift))
    }
}

/// Whether a point lies near enough to a chord to be on the curve between its ends.
pub fn is_beside(metric: &[f64], a: &[f64], b: &[f64], target: &[f64]) -> bool {
    // One pass over the entries: this is asked of every chord of a curve.
    let (mut along, mut square, mut away) = (0.0, 0.0, 0.0);
    for (((w, a), b), t) in metric.iter().zip(a).zip(b).zip(target) {
        let (chord, offset) = (b - a, t - a);
        along += w * chord * offset;
        square += w * chord * chord;
        away += w * offset * offset;
    }
    if square == 0.0 {
        return away == 0.0;
    }
    let share = along / square;
    let beside = (away - share * along).max(0.0);
    (-OVERLAP..=1.0 + OVERLAP).contains(&share) && beside <= SAG * SAG * square
}

fn is_same<P: Problem>(problem: &P, y: &[f64], target: &[f64], length: f64) -> bool {
    let motion = norm(problem.motion_metric(), target);
    distance(problem.motion_metric(), y, target) <= SAME * motion
        && distance(problem.metric(), y, target) <= SAME * motion.max(length)
}

fn projection(metric: &[f64], a: &[f64], chord: &[f64], target: &[f64]) -> f64 {
    let offset = difference(target, a);
    let product = |v: &[f64]| metric.iter().zip(chord).zip(v).map(|((w, c), v)| w * c * v).sum::<f64>();
    product(&offset) / product(chord)
}

/// Cubic through two points with unit tangents there, `length` apart.
fn hermite([a, b]: [&[f64]; 2], [from, to]: &[Vec<f64>; 2], length: f64, s: f64) -> Vec<f64> {
    let (s2, s3) = (s * s, s * s * s);
    let weights = [2.0 * s3 - 3.0 * s2 + 1.0, 3.0 * s2 - 2.0 * s3, length * (s3 - 2.0 * s2 + s), length * (s3 - s2)];
    let ends = a.iter().zip(b).map(|(a, b)| weights[0] * a + weights[1] * b);
    let slopes = from.iter().zip(to).map(|(f, t)| weights[2] * f + weights[3] * t);
    ends.zip(slopes).map(|(end, slope)| end + slope).collect()
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn distance(metric: &[f64], a: &[f64], b: &[f64]) -> f64 {
    norm(metric, &difference(a, b))
}
