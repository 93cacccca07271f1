//! Parts of a period on which a law that turns over within a small change of velocity is smooth.
//!
//! Sampled on a uniform grid, regularised friction steps from one sign to the other between two samples: its harmonics
//! then depend on where the samples lie, and along a branch they ripple. Here the period is halved until each part keeps
//! its distance from the complex instants at which the law is singular; Gauss quadrature converges geometrically on each.

use crate::formulation::harmonics::evaluate;
use std::f64::consts::{PI, TAU};

/// Parts of the period to begin with.
const COARSEST: usize = 8;

/// How often they are halved: what is left then is narrower than rounding lets any law see.
const HALVINGS: usize = 40;

/// Radius, in half-widths of a part, of the disc about its middle that has to be free of singularities: an ellipse with foci at
/// its ends and this half-axis has ρ = 4.8, by whose square the error of Gauss quadrature falls with every point.
const CLEARANCE: f64 = 2.5;

/// What the velocity may change by within the disc, in widths of the law: its singularities are ±iπ/2 away from real velocities.
const CHANGE: f64 = 1.4;

/// Factor e^ROUNDING by which the error of a uniform grid has to fall to be that of rounding.
const ROUNDING: f64 = 36.0;

/// Whether such a function is smooth enough for so many samples of the period: their error falls by e^(−sN) with the number N of
/// samples, s the distance of the singularities from real instants.
pub fn is_sampled_well(slope: &[f64], width: f64, samples: usize) -> bool {
    let height = ROUNDING / samples as f64;
    let imaginary = |k: usize| slope[2 * k - 1].hypot(slope[2 * k]) * (k as f64 * height).sinh();
    (1..=slope.len() / 2).map(imaginary).sum::<f64>() < CHANGE * width
}

/// Parts (begin, end) of the period, ascending, on which a function of `slope` / `width` is smooth that is analytic but for
/// imaginary parts of ±π/2 and beyond. `slope` is a series, `width` above zero in its unit.
pub fn panels(slope: &[f64], width: f64) -> Vec<(f64, f64)> {
    let step = TAU / COARSEST as f64;
    let mut search = Search { slope, width, found: Vec::new() };
    for i in 0..COARSEST {
        search.split(i as f64 * step, (i + 1) as f64 * step, HALVINGS);
    }
    search.found
}

struct Search<'a> {
    slope: &'a [f64],
    width: f64,
    found: Vec<(f64, f64)>,
}

impl Search<'_> {
    fn split(&mut self, begin: f64, end: f64, halvings: usize) {
        let middle = 0.5 * (begin + end);
        if halvings == 0 || self.is_smooth(middle, CLEARANCE * (middle - begin)) {
            self.found.push((begin, end));
        } else {
            self.split(begin, middle, halvings - 1);
            self.split(middle, end, halvings - 1);
        }
    }

    /// Whether a disc is free of singularities: within it the velocity either changes little, or does not vanish.
    fn is_smooth(&self, middle: f64, radius: f64) -> bool {
        let [value, slope, _] = evaluate(self.slope, middle);
        let change = radius * (slope.abs() + 0.5 * radius * self.curvature(radius));
        change < (CHANGE * self.width).max(value.abs())
    }

    /// Bound of the second derivative at complex instants whose imaginary part is at most `height`.
    fn curvature(&self, height: f64) -> f64 {
        (1..=self.slope.len() / 2)
            .map(|k| {
                let kf = k as f64;
                kf * kf * self.slope[2 * k - 1].hypot(self.slope[2 * k]) * (kf * height.min(PI)).cosh()
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_the_period_and_are_short_only_where_the_velocity_vanishes() {
        // Velocity cos τ: zero at π/2 and 3π/2.
        for width in [10.0, 1.0, 1e-2, 1e-4, 1e-6] {
            let parts = panels(&[0.0, 1.0, 0.0], width);
            assert_eq!((parts[0].0, parts[parts.len() - 1].1), (0.0, TAU));
            assert!(parts.windows(2).all(|pair| pair[0].1 == pair[1].0));
            let shortest = parts.iter().map(|(b, e)| e - b).fold(TAU, f64::min);
            assert!(shortest > 0.1 * width.min(1.0), "{width}: {shortest}");
            assert!(parts.len() < 40 + (40.0 * (1.0 / width).log10().max(0.0)) as usize, "{width}: {}", parts.len());
        }
    }

    #[test]
    fn a_grid_is_enough_for_gentle_friction_only() {
        // Singular where cos τ = iπ/2 · width: at a distance of about that.
        for (width, samples, is_enough) in [(1.0, 64, true), (0.1, 64, false), (0.1, 512, true), (0.01, 512, false)] {
            assert_eq!(is_sampled_well(&[0.0, 1.0, 0.0], width, samples), is_enough, "{width}, {samples}");
        }
    }

    #[test]
    fn a_body_at_rest_needs_no_short_parts() {
        assert_eq!(panels(&[0.0; 5], 1e-3).len(), COARSEST);
    }
}
