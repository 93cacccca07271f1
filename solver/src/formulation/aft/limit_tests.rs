//! Integrated between its switches, a law has the harmonics of infinitely many samples.

use super::{Aft, ElementForce, Rate};
use crate::formulation::pressure::tests::random;
use crate::settings::{HarmonicSettings, Quadrature};
use crate::structure::laws::{Jenkins, Law, TanhFriction};

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
