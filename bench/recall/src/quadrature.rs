//! Integrals over a period of forces that depend on a displacement: evenly spaced instants for smooth laws, Gauss's
//! rule on every arc of contact for one-sided ones.

use std::f64::consts::{PI, TAU};

/// Instants of a period with their weights, and the harmonics at each of them.
#[derive(Debug, Clone, Default)]
pub struct Nodes {
    /// Weights; they add up to 2π over a whole period.
    pub weights: Vec<f64>,
    /// 1, cos τ, sin τ, cos 2τ, … at every instant, one instant after the other.
    pub basis: Vec<f64>,
    /// Their derivatives by τ.
    pub slopes: Vec<f64>,
}

/// Gauss's rule with eight points on (−1, 1): positive abscissae and weights (Abramowitz & Stegun, table 25.4).
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_650, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887),
    (0.796_666_477_413_627, 0.222_381_034_453_374),
    (0.960_289_856_497_536, 0.101_228_536_290_376),
];

impl Nodes {
    /// Evenly spaced instants.
    pub fn even(count: usize, harmonics: usize) -> Self {
        let mut nodes = Self::default();
        let step = TAU / count as f64;
        (0..count).for_each(|i| nodes.push(i as f64 * step, step, harmonics));
        nodes
    }

    /// The arcs on which a series exceeds a gap; `grid` are evenly spaced instants that find them.
    pub fn beyond(gap: f64, series: &[f64], grid: &Self) -> Self {
        let (harmonics, count) = (series.len() / 2, grid.weights.len());
        let values: Vec<f64> = (0..count).map(|q| dot(grid.at(q), series) - gap).collect();
        let mut nodes = Self::default();
        if values.iter().all(|&value| value > 0.0) {
            nodes.arc(0.0, TAU, harmonics);
        }
        let step = TAU / count as f64;
        let crossing = |q: usize| {
            let (a, b) = (values[q % count], values[(q + 1) % count]);
            root(gap, series, q as f64 * step, (q + 1) as f64 * step, a, b)
        };
        let begins = (0..count).filter(|&q| values[q] <= 0.0 && values[(q + 1) % count] > 0.0);
        for begin in begins {
            let end = (begin + 1..).find(|&q| values[q % count] > 0.0 && values[(q + 1) % count] <= 0.0);
            nodes.arc(crossing(begin), end.map_or(TAU, crossing), harmonics);
        }
        nodes
    }

    /// Harmonics at instant `q`.
    pub fn at(&self, q: usize) -> &[f64] {
        let width = self.basis.len() / self.weights.len();
        &self.basis[q * width..(q + 1) * width]
    }

    /// Their derivatives.
    pub fn slope_at(&self, q: usize) -> &[f64] {
        let width = self.slopes.len() / self.weights.len();
        &self.slopes[q * width..(q + 1) * width]
    }

    /// Gauss's rule on pieces that are short against the highest harmonic.
    fn arc(&mut self, begin: f64, end: f64, harmonics: usize) {
        let pieces = ((end - begin) * harmonics as f64 / PI).ceil().max(1.0);
        let half = 0.5 * (end - begin) / pieces;
        for piece in 0..pieces as usize {
            let middle = begin + (2 * piece + 1) as f64 * half;
            for (abscissa, weight) in GAUSS {
                self.push(middle - half * abscissa, half * weight, harmonics);
                self.push(middle + half * abscissa, half * weight, harmonics);
            }
        }
    }

    fn push(&mut self, tau: f64, weight: f64, harmonics: usize) {
        self.weights.push(weight);
        let (basis, slopes) = harmonics_at(tau, harmonics);
        self.basis.extend(basis);
        self.slopes.extend(slopes);
    }
}

/// 1, cos τ, sin τ, … and their derivatives.
fn harmonics_at(tau: f64, harmonics: usize) -> (Vec<f64>, Vec<f64>) {
    let (sin, cos) = tau.sin_cos();
    let (mut basis, mut slopes) = (vec![1.0], vec![0.0]);
    let (mut c, mut s) = (1.0, 0.0);
    for k in 1..=harmonics {
        (c, s) = (c * cos - s * sin, s * cos + c * sin);
        basis.extend([c, s]);
        slopes.extend([-(k as f64) * s, k as f64 * c]);
    }
    (basis, slopes)
}

/// Where a series crosses a gap between two instants: regula falsi with halving (Illinois).
fn root(gap: f64, series: &[f64], mut low: f64, mut high: f64, mut at_low: f64, mut at_high: f64) -> f64 {
    for _ in 0..60 {
        let middle = (low * at_high - high * at_low) / (at_high - at_low);
        if !middle.is_finite() || (high - low).abs() < 1e-15 {
            break;
        }
        let value = dot(&harmonics_at(middle, series.len() / 2).0, series) - gap;
        if value == 0.0 || value.abs() < 1e-15 * gap.abs() {
            return middle;
        }
        if value * at_high < 0.0 {
            (low, at_low) = (high, at_high);
        } else {
            at_low *= 0.5;
        }
        (high, at_high) = (middle, value);
    }
    high
}

/// Scalar product.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Euclidean length.
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
