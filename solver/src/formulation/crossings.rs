//! Where a trigonometric polynomial passes through a threshold: every crossing, however close to its neighbours.
//!
//! Cells of a uniform grid are split until bounds of the second and third derivative say that nothing more can be inside: the
//! function stays on its side, is monotone, or has one extremum, which is found.

use crate::formulation::harmonics::evaluate;
use std::f64::consts::TAU;

/// An instant at which a function passes through its threshold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossing {
    /// Phase, rad.
    pub tau: f64,
    /// Whether the function is above the threshold after it.
    pub is_rising: bool,
}

/// All crossings of `series` through `threshold` within a period, ascending, from its `samples` on the uniform grid.
pub(super) fn crossings(series: &[f64], threshold: f64, samples: &[f64]) -> Vec<Crossing> {
    let (mut curvature, mut jerk) = (0.0, 0.0);
    for k in 1..=series.len() / 2 {
        let order = k as f64;
        let largest = order * order * series[2 * k - 1].hypot(series[2 * k]);
        curvature += largest;
        jerk += order * largest;
    }
    let mut search = Search { series, threshold, curvature, jerk, found: Vec::new() };
    let n = samples.len();
    let step = TAU / n as f64;
    for i in 0..n {
        let (here, after) = (samples[i] - threshold, samples[(i + 1) % n] - threshold);
        let tau = i as f64 * step;
        let is_crossed = (here > 0.0) != (after > 0.0);
        // Without an extremum in between; most cells are told by their samples.
        if (here - after).abs() > search.rise(2.0 * step) {
            if is_crossed {
                let near = tau + step * here / (here - after);
                search.pass((tau, tau + step), near, here > 0.0);
            }
        } else if is_crossed || here.abs().min(after.abs()) <= search.rise(step) {
            let [low, high] = [(tau, here), (tau + step, after)].map(|(tau, value)| Place { value, ..search.at(tau) });
            search.split(low, high, SPLITS);
        }
    }
    search.found
}

/// How often a cell is halved: what is left then is taken to have one extremum at most.
const SPLITS: usize = 12;

/// What Newton's method may leave of an instant's error, rad.
const ROUNDING: f64 = 1e-15;

/// A function at an instant.
#[derive(Debug, Clone, Copy)]
struct Place {
    tau: f64,
    /// Above the threshold.
    value: f64,
    slope: f64,
    curvature: f64,
}

impl Place {
    fn is_positive(self) -> bool {
        self.value > 0.0
    }
}

struct Search<'a> {
    series: &'a [f64],
    threshold: f64,
    /// Bounds of the second and third derivative.
    curvature: f64,
    jerk: f64,
    found: Vec<Crossing>,
}

impl Search<'_> {
    fn at(&self, tau: f64) -> Place {
        let [value, slope, curvature] = evaluate(self.series, tau);
        Place { tau, value: value - self.threshold, slope, curvature }
    }

    /// How far the function may rise above the higher one of two places at this distance.
    fn rise(&self, width: f64) -> f64 {
        0.125 * width * width * self.curvature
    }

    fn split(&mut self, low: Place, high: Place, splits: usize) {
        let width = high.tau - low.tau;
        let is_crossed = low.is_positive() != high.is_positive();
        if !is_crossed && low.value.abs().min(high.value.abs()) > self.rise(width) {
            return;
        }
        let is_monotone = low.slope.abs().max(high.slope.abs()) > self.curvature * width;
        let is_bent_one_way = low.curvature.abs().max(high.curvature.abs()) > self.jerk * width;
        if is_monotone || is_bent_one_way || splits == 0 {
            match self.extremum(low, high).filter(|_| !is_monotone) {
                Some(extremum) => {
                    self.beside(extremum, low);
                    self.beside(extremum, high);
                }
                None if is_crossed => {
                    let near = low.tau + width * low.value / (low.value - high.value);
                    self.pass((low.tau, high.tau), near, low.is_positive());
                }
                None => {}
            }
        } else {
            let middle = self.at(0.5 * (low.tau + high.tau));
            self.split(low, middle, splits - 1);
            self.split(middle, high, splits - 1);
        }
    }

    /// Where the slope vanishes between two places at which its signs differ.
    fn extremum(&self, low: Place, high: Place) -> Option<Place> {
        let is_positive = low.slope > 0.0;
        // Of the third derivative nothing is known: NaN lets no step be the last one before its time.
        let slope = |tau: f64| {
            let place = self.at(tau);
            (place.slope, place.curvature, f64::NAN)
        };
        let near = 0.5 * (low.tau + high.tau);
        (is_positive != (high.slope > 0.0)).then(|| self.at(root(&slope, (low.tau, high.tau), near, is_positive)))
    }

    /// The crossing between an extremum and the end of its monotone side, if there is one.
    fn beside(&mut self, extremum: Place, end: Place) {
        if extremum.is_positive() == end.is_positive() {
            return;
        }
        // A parabola's, which it nearly is if they are close.
        let distance = (2.0 * extremum.value / extremum.curvature).abs().sqrt();
        if end.tau < extremum.tau {
            self.pass((end.tau, extremum.tau), extremum.tau - distance, end.is_positive());
        } else {
            self.pass((extremum.tau, end.tau), extremum.tau + distance, extremum.is_positive());
        }
    }

    fn pass(&mut self, bracket: (f64, f64), near: f64, is_positive: bool) {
        let place = |tau: f64| {
            let place = self.at(tau);
            (place.value, place.slope, place.curvature)
        };
        let tau = root(&place, bracket, near, is_positive);
        self.found.push(Crossing { tau, is_rising: !is_positive });
    }
}

/// Root of a function with a sign change in a bracket, at whose begin it is positive or not: Newton's method from `near`, kept
/// inside. The function gives its value and two derivatives.
pub(super) fn root(
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
