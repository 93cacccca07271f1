//! Integrated between its switches, a law has the harmonics of infinitely many samples.

use super::{Aft, ElementForce, Rate};
use crate::formulation::harmonics::{basis, differentiate};
use crate::formulation::pressure::tests::random;
use crate::settings::{HarmonicSettings, Quadrature};
use crate::structure::laws::{Before, Instant, Jenkins, Law, PolynomialDamper, PolynomialSpring, TanhFriction, Term};
use std::f64::consts::TAU;

const HARMONICS: usize = 6;
const RATE: Rate = Rate { omega: 3.0, harmonic: 1.0 };

fn forces(law: &impl Law, series: &[f64], quadrature: Quadrature, samples: usize) -> ElementForce {
    let mut out = ElementForce::default();
    Aft::new(HarmonicSettings { count: HARMONICS, samples, quadrature }).evaluate(law, series, RATE, &mut out);
    out
}

fn largest(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// Largest difference.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Motions of decaying harmonics, one of them nearly at rest twice a period.
fn motions() -> impl Iterator<Item = Vec<f64>> {
    let mut next = random(3);
    (0..12).map(move |case| {
        let decay = 0.3 + 0.2 * f64::from(case % 4);
        (0..=2 * HARMONICS).map(|i| next() * (-decay * (i / 2) as f64).exp()).collect()
    })
}

#[test]
fn regularised_friction_however_sharp_has_the_harmonics_of_many_samples() {
    for velocity in [1.0, 0.1, 1e-2] {
        let law = TanhFriction { limit: 2.0, velocity };
        for series in motions() {
            let (exact, sampled) =
                (forces(&law, &series, Quadrature::Arcs, 64), forces(&law, &series, Quadrature::Samples, 1 << 17));
            let pairs = [
                ("force", &exact.force, &sampled.force, largest(&exact.force)),
                ("jacobian", &exact.jacobian, &sampled.jacobian, largest(&exact.jacobian)),
                // What ω changes cancels over a period: little is left of it if the friction is sharp.
                ("domega", &exact.domega, &sampled.domega, largest(&exact.force) / RATE.omega),
            ];
            for (what, exact, sampled, scale) in pairs {
                let difference = difference(exact, sampled) / scale;
                assert!(difference < 1e-12, "v₀ = {velocity}: {what} differs by {difference:e}");
            }
        }
    }
}

#[test]
fn a_slider_has_the_harmonics_of_many_samples() {
    for limit in [0.1, 0.7, 3.0] {
        let law = Jenkins { stiffness: 2.0, limit };
        for series in motions() {
            let samples = 1 << 15;
            let (exact, sampled) =
                (forces(&law, &series, Quadrature::Arcs, 64), forces(&law, &series, Quadrature::Samples, samples));
            // The sampled slider comes to rest, and begins to slide, at samples.
            let forces = difference(&exact.force, &sampled.force) / largest(&exact.force);
            let jacobians = difference(&exact.jacobian, &sampled.jacobian) / largest(&exact.jacobian);
            let difference = forces.max(jacobians);
            assert!(difference < 40.0 / samples as f64, "F = {limit}: {difference:e}");
        }
    }
}

/// Forces of a law of one argument and their derivatives, summed instant by instant.
fn summed(law: &impl Law, series: &[f64], samples: usize) -> (Vec<f64>, Vec<f64>) {
    let nc = series.len();
    let (mut value, mut slope, mut shape) = (vec![0.0; nc], vec![0.0; nc], vec![0.0; nc]);
    let (mut force, mut jacobian) = (vec![0.0; nc], vec![0.0; nc * nc]);
    differentiate(series, &mut slope);
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    for n in 0..samples {
        let instant = TAU * n as f64 / samples as f64;
        basis(instant, &mut value);
        let mut now = Instant::default();
        (now.u[0], now.v[0]) = (dot(series, &value), RATE.omega * dot(&slope, &value));
        let response = law.respond(&now, &Before::default());
        for column in 0..nc {
            let mut unit = vec![0.0; nc];
            unit[column] = 1.0;
            differentiate(&unit, &mut shape);
            let change = response.du[0][0] * value[column] + response.dv[0][0] * RATE.omega * dot(&shape, &value);
            for row in 0..nc {
                let weight = if row == 0 { 1.0 } else { 2.0 } / samples as f64;
                jacobian[row * nc + column] += weight * value[row] * change;
            }
        }
        for row in 0..nc {
            force[row] += if row == 0 { 1.0 } else { 2.0 } / samples as f64 * value[row] * response.force[0];
        }
    }
    (force, jacobian)
}

/// Largest relative errors of forces and Jacobian against sums over more samples than a law needs.
fn errors(law: &impl Law, series: &[f64]) -> [f64; 2] {
    let (found, (force, jacobian)) = (forces(law, series, Quadrature::Arcs, 512), summed(law, series, 512));
    [(found.force, force), (found.jacobian, jacobian)]
        .map(|(found, summed)| difference(&found, &summed) / largest(&summed))
}

#[test]
fn polynomials_are_exact_on_few_samples() {
    for (power, series) in
        [1, 2, 3, 4, 5, 15].into_iter().flat_map(|power| motions().map(move |series| (power, series)))
    {
        let terms = vec![Term { power, coefficient: 0.7 }, Term { power: 1, coefficient: -0.2 }];
        for errors in
            [errors(&PolynomialSpring { terms: terms.clone() }, &series), errors(&PolynomialDamper { terms }, &series)]
        {
            assert!(errors.iter().all(|error| *error < 1e-12), "power {power}: {errors:?}");
        }
    }
}
