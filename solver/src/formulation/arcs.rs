//! Contact arcs: the parts of a period during which a trigonometric polynomial is positive, and quadrature over them.
//!
//! A unilateral force sampled on a fixed grid has a Jacobian that jumps whenever one sample changes its state: Newton's
//! method then cycles, and branches show dozens of spurious turning points. Integrated over its exact arcs by Gauss
//! quadrature the force is continuously differentiable and does not depend on the grid; the result is the limit of
//! infinitely many samples.

use crate::formulation::harmonics::evaluate;
use std::f64::consts::{PI, TAU};

/// Parts of a period on which a function is positive.
#[derive(Debug, Clone, PartialEq)]
pub enum Coverage {
    /// Nowhere.
    Never,
    /// Everywhere.
    Always,
    /// On these arcs (begin, end), begin < end < begin + 2π, in increasing order of begin.
    Arcs(Vec<(f64, f64)>),
}

impl Coverage {
    /// Share of the period.
    pub fn fraction(&self) -> f64 {
        match self {
            Coverage::Never => 0.0,
            Coverage::Always => 1.0,
            Coverage::Arcs(arcs) => arcs.iter().map(|(begin, end)| end - begin).sum::<f64>() / TAU,
        }
    }
}

/// Arcs on which `series` exceeds `threshold`, from its `samples` on the uniform grid. Arcs (and openings) shorter than
/// a grid cell are found by refining the extrema that come close enough to the threshold.
pub fn positive_arcs(series: &[f64], threshold: f64, samples: &[f64]) -> Coverage {
    let n = samples.len();
    let step = TAU / n as f64;
    let at = |i: usize| samples[i % n] - threshold;
    let height = |tau: f64| {
        let [value, slope, curvature] = evaluate(series, tau);
        (value - threshold, slope, curvature)
    };
    // How far the function may rise between samples above the higher one of them.
    let curvature: f64 = (1..=series.len() / 2).map(|k| (k * k) as f64 * series[2 * k - 1].hypot(series[2 * k])).sum();
    let rise = 0.125 * step * step * curvature;
    // (instant, whether the function rises through the threshold there)
    let mut crossings: Vec<(f64, bool)> = Vec::new();
    for i in 0..n {
        let (before, here, after) = (at(i + n - 1), at(i), at(i + 1));
        let tau = i as f64 * step;
        let positive = here > 0.0;
        let sign = if positive { -1.0 } else { 1.0 };
        // An extremum between samples that may reach over the threshold.
        let is_extremum = sign * here >= sign * before && sign * here > sign * after;
        let is_between = is_extremum && (before > 0.0) == positive && (after > 0.0) == positive;
        if is_between
            && sign * here + rise >= 0.0
            && let Some(top) = summit(&height, sign, tau, step)
            && sign * height(top).0 > 0.0
        {
            let (begin, end) = if top > tau { (tau, tau + step) } else { (tau - step, tau) };
            crossings.push((root(&height, (begin, top), 0.5 * (begin + top), positive), !positive));
            crossings.push((root(&height, (top, end), 0.5 * (top + end), !positive), positive));
        }
        if positive != (after > 0.0) {
            let near = tau + step * here / (here - after);
            crossings.push((root(&height, (tau, tau + step), near, positive), !positive));
        }
    }
    if crossings.is_empty() {
        return if samples[0] > threshold { Coverage::Always } else { Coverage::Never };
    }
    crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
    let rising = crossings.iter().position(|c| c.1).unwrap_or(0);
    crossings.rotate_left(rising);
    let arcs = crossings
        .chunks_exact(2)
        .map(|pair| {
            let (begin, mut end) = (pair[0].0, pair[1].0);
            if end < begin {
                end += TAU;
            }
            (begin, end)
        })
        .collect();
    Coverage::Arcs(arcs)
}

/// What Newton's method may leave of an instant's error, rad.
const ROUNDING: f64 = 1e-15;

/// Root of a function with a sign change in a bracket, at whose begin it is positive or not: Newton's method from `near`, kept
/// inside. The function gives its value and two derivatives.
fn root(
    function: &impl Fn(f64) -> (f64, f64, f64),
    (mut low, mut high): (f64, f64),
    near: f64,
    is_positive: bool,
) -> f64 {
    let mut tau = near.clamp(low, high);
    for _ in 0..60 {
        let (value, slope, curvature) = function(tau);
        if (value > 0.0) == is_positive {
            low = tau;
        } else {
            high = tau;
        }
        let newton = tau - value / slope;
        let is_inside = newton >= low && newton <= high;
        let next = if is_inside { newton } else { 0.5 * (low + high) };
        let step = next - tau;
        let error = 0.5 * (curvature / slope).abs() * step * step;
        if step.abs() < 1e-14 || (is_inside && error < ROUNDING) {
            return next;
        }
        tau = next;
    }
    tau
}

/// The highest point (for a negative `sign` the lowest) beside a sample that is higher than its neighbours, on the side to which
/// the function rises there: the first one, as there may be others in the same cell.
fn summit(height: &impl Fn(f64) -> (f64, f64, f64), sign: f64, tau: f64, step: f64) -> Option<f64> {
    const PARTS: usize = 4;
    let towards = if sign * height(tau).1 > 0.0 { 1.0 } else { -1.0 };
    let at = |part: usize| tau + towards * step * part as f64 / PARTS as f64;
    let beyond = (1..=PARTS).find(|&part| sign * towards * height(at(part)).1 <= 0.0)?;
    let (from, to) = (at(beyond - 1), at(beyond));
    extremum(height, from.min(to), from.max(to))
}

/// Zero of the slope between `low` and `high`, if it changes its sign there.
fn extremum(height: &impl Fn(f64) -> (f64, f64, f64), low: f64, high: f64) -> Option<f64> {
    // Of the third derivative nothing is known: NaN lets no step be the last one before its time.
    let slope = |tau: f64| {
        let (_, slope, curvature) = height(tau);
        (slope, curvature, f64::NAN)
    };
    let is_positive = slope(low).0 > 0.0;
    (is_positive != (slope(high).0 > 0.0)).then(|| root(&slope, (low, high), 0.5 * (low + high), is_positive))
}

/// Nodes and weights of Gauss–Legendre quadrature on [−1, 1].
#[derive(Debug, Clone, PartialEq)]
pub struct GaussLegendre {
    /// Nodes, ascending.
    pub nodes: Vec<f64>,
    /// Weights.
    pub weights: Vec<f64>,
}

impl GaussLegendre {
    /// Rule with `count` points: roots of the Legendre polynomial by Newton's method.
    pub fn new(count: usize) -> Self {
        let mut nodes = vec![0.0; count];
        let mut weights = vec![0.0; count];
        for i in 0..count.div_ceil(2) {
            let mut x = (PI * (i as f64 + 0.75) / (count as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..20 {
                let (mut p, mut previous) = (1.0, 0.0);
                for k in 1..=count {
                    (p, previous) = (((2 * k - 1) as f64 * x * p - (k - 1) as f64 * previous) / k as f64, p);
                }
                slope = count as f64 * (x * p - previous) / (x * x - 1.0);
                let update = p / slope;
                x -= update;
                if update.abs() < 1e-15 {
                    break;
                }
            }
            let weight = 2.0 / ((1.0 - x * x) * slope * slope);
            (nodes[i], nodes[count - 1 - i]) = (-x, x);
            (weights[i], weights[count - 1 - i]) = (weight, weight);
        }
        Self { nodes, weights }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formulation::harmonics::Transform;

    #[test]
    fn gauss_rules_integrate_polynomials_exactly() {
        for count in [1, 2, 5, 16, 31] {
            let rule = GaussLegendre::new(count);
            for degree in 0..2 * count {
                let sum: f64 = rule.nodes.iter().zip(&rule.weights).map(|(x, w)| w * x.powi(degree as i32)).sum();
                let exact = if degree % 2 == 0 { 2.0 / (degree + 1) as f64 } else { 0.0 };
                assert!((sum - exact).abs() < 1e-13, "{count} points, degree {degree}: {sum}");
            }
        }
    }

    fn arcs(series: &[f64], samples: usize) -> Coverage {
        let mut transform = Transform::new(series.len() / 2, samples);
        let (mut values, mut unused) = (vec![0.0; samples], vec![0.0; samples]);
        transform.synthesise(series, None, &mut values, &mut unused);
        positive_arcs(series, 0.0, &values)
    }

    #[test]
    fn arcs_of_a_shifted_cosine() {
        // cos τ + a > 0 on |τ| < arccos(−a).
        for a in [-0.999_999f64, -0.9, 0.0, 0.5, 0.999_999] {
            let half = (-a).acos();
            let Coverage::Arcs(list) = arcs(&[a, 1.0, 0.0], 16) else { panic!("no arcs for {a}") };
            assert_eq!(list.len(), 1);
            assert!((list[0].1 - list[0].0 - 2.0 * half).abs() < 1e-10, "{a}: {list:?}");
        }
        assert_eq!(arcs(&[-1.000_001, 1.0, 0.0], 16), Coverage::Never);
        assert_eq!(arcs(&[1.000_001, 1.0, 0.0], 16), Coverage::Always);
    }

    #[test]
    fn a_coarse_grid_finds_what_a_fine_one_does() {
        let series = [-0.35, 0.3, 0.2, -0.1, 0.25, 0.3, -0.2, 0.15, 0.1];
        let (coarse, fine) = (arcs(&series, 32), arcs(&series, 8192));
        let (Coverage::Arcs(coarse), Coverage::Arcs(fine)) = (coarse, fine) else { panic!("no arcs") };
        assert_eq!(coarse.len(), fine.len());
        let total = |list: &[(f64, f64)]| list.iter().map(|(b, e)| e - b).sum::<f64>();
        assert!((total(&coarse) - total(&fine)).abs() < 1e-12);
    }

    /// A minimum just before a sample and an arc just after it, all within two cells.
    #[test]
    fn an_arc_beside_an_extremum_of_the_other_kind_is_found() {
        let mut series = [
            0.0, 0.476_317, 0.001_053, -0.155_254, -0.000_641, -0.008_653, -0.000_056, 0.019_558, 0.000_12, 0.002_997,
            0.000_022,
        ];
        let at_sample = evaluate(&series, std::f64::consts::FRAC_PI_4)[0];
        for above in [1e-4, 1e-6, 1e-9, 0.0, -1e-9, -1e-6, -3e-5] {
            series[0] = above - at_sample;
            let Coverage::Arcs(coarse) = arcs(&series, 64) else { panic!("no arcs") };
            let Coverage::Arcs(fine) = arcs(&series, 8192) else { panic!("no arcs") };
            assert_eq!(coarse.len(), fine.len(), "{above}: {coarse:?}, {fine:?}");
            for (coarse, fine) in coarse.iter().zip(&fine) {
                assert!((coarse.0 - fine.0).abs() + (coarse.1 - fine.1).abs() < 1e-9, "{above}: {coarse:?}, {fine:?}");
            }
        }
    }
}
