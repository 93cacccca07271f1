//! Contact arcs: the parts of a period during which a trigonometric polynomial is positive, and quadrature over them.
//!
//! A unilateral force sampled on a fixed grid has a Jacobian that jumps whenever one sample changes its state: Newton's
//! method then cycles, and branches show dozens of spurious turning points. Integrated over its exact arcs by Gauss
//! quadrature the force is continuously differentiable and does not depend on the grid; the result is the limit of
//! infinitely many samples.

use crate::formulation::crossings::crossings;
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

/// Arcs on which `series` exceeds `threshold`, from its `samples` on the uniform grid; arcs and openings shorter than a grid cell
/// too.
pub fn positive_arcs(series: &[f64], threshold: f64, samples: &[f64]) -> Coverage {
    let mut crossings = crossings(series, threshold, samples);
    if crossings.is_empty() {
        return if samples[0] > threshold { Coverage::Always } else { Coverage::Never };
    }
    let rising = crossings.iter().position(|crossing| crossing.is_rising).unwrap_or(0);
    crossings.rotate_left(rising);
    let arcs = crossings
        .chunks_exact(2)
        .map(|pair| {
            let (begin, mut end) = (pair[0].tau, pair[1].tau);
            if end < begin {
                end += TAU;
            }
            (begin, end)
        })
        .collect();
    Coverage::Arcs(arcs)
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
    use crate::formulation::harmonics::{Transform, evaluate};
    use crate::formulation::pressure::tests::random;

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

    /// Two arcs in neighbouring cells, one of them far shorter than its cell, whose other neighbour is in contact.
    #[test]
    fn a_short_arc_beside_a_crossing_is_found() {
        let series = [1.598_379_792e-4, 0.654_949_77, -0.347_767_56, 0.0, 0.0, 0.026_554_29, -0.248_585_74];
        let Coverage::Arcs(list) = arcs(&series, 64) else { panic!("no arcs") };
        assert_eq!(list.len(), 3, "{list:?}");
    }

    /// Random series lifted until an extremum just passes the threshold, against a grid on which nothing can be missed.
    #[test]
    fn grazing_is_seen_wherever_it_is() {
        // Numbers between -1 and 1.
        let mut next = random(7);
        for case in 0..1500 {
            let harmonics = 2 + (8.0 * next().abs()) as usize;
            let decay = 0.3 * next().abs();
            let mut coefficient = |k: usize| if next() < -0.5 { 0.0 } else { next() * (-decay * k as f64).exp() };
            let mut series: Vec<f64> = (0..=2 * harmonics).map(|i| coefficient(i / 2)).collect();
            let tau = TAU * next();
            let extremum = (0..40).fold(tau, |tau, _| {
                let [_, slope, curvature] = evaluate(&series, tau);
                tau - (slope / curvature).clamp(-0.3, 0.3)
            });
            if evaluate(&series, extremum)[1].abs() > 1e-12 {
                continue;
            }
            let above = next().signum() * 10f64.powf(-6.0 - 3.0 * next());
            series[0] += above - evaluate(&series, extremum)[0];
            let (coarse, fine) = (arcs(&series, 64), arcs(&series, 16384));
            match (&coarse, &fine) {
                (Coverage::Arcs(coarse), Coverage::Arcs(fine)) => {
                    assert_eq!(coarse.len(), fine.len(), "{case}: {series:?}");
                    for (coarse, fine) in coarse.iter().zip(fine) {
                        let difference = (coarse.0 - fine.0).abs().max((coarse.1 - fine.1).abs());
                        assert!(difference < 1e-9 || (difference - TAU).abs() < 1e-9, "{case}: {coarse:?}, {fine:?}");
                    }
                }
                _ => assert_eq!(coarse, fine, "{case}: {series:?}"),
            }
        }
    }
}
