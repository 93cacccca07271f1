//! What is narrow on a frequency response: how far a step may go without passing over a lightly damped resonance.
//!
//! Arc length does not see it: on both flanks of a resonance the response is small, tangents are alike, and only the phase is
//! turned by π. So the change of the motion relative to its own size limits the steps, and near the linear resonances of
//! modes that the forces excite, the frequency by their distance and half-width.

use crate::formulation::System;
use crate::formulation::harmonics::{complex, width};
use crate::formulation::state::Parameters;
use crate::formulation::unknown::Unknown;
use crate::linalg::dot;
use num_complex::Complex64;

/// Largest relative change of the motion that a step is planned for.
const PLANNED: f64 = 0.25;

/// Largest relative change of the motion between neighbouring points.
const ALLOWED: f64 = 0.5;

/// Largest share of the distance to a resonance (in frequency) that a step may go.
const APPROACH: f64 = 0.5;

/// Resonances that could not exceed this share of the motion are not looked at: those of the forcing's own harmonic, and
/// those of other harmonics, which only nonlinear forces excite.
const NEGLIGIBLE: [f64; 2] = [1e-3, 5e-2];

/// Harmonics below this share of the motion are not looked at.
const SEEN: f64 = 1e-3;

/// A harmonic that changes by more than so many times its own size turns round: within a step that only a resonance does.
const TURNED: f64 = 1.2;

/// Steps shorter than this, relative to the frequency, lead over nothing.
const LEAST: f64 = 1e-6;

/// How far, relative to the frequency, laws may shift a resonance.
const SHIFTED: f64 = 0.25;

/// Size of the oscillation in a state: its series (nc numbers each) without their means.
fn oscillation(metric: &[f64], nc: usize, y: &[f64]) -> f64 {
    difference(metric, nc, y, None)
}

fn difference(metric: &[f64], nc: usize, a: &[f64], b: Option<&[f64]>) -> f64 {
    let square: f64 =
        (0..metric.len()).filter(|i| i % nc != 0).map(|i| metric[i] * (a[i] - b.map_or(0.0, |b| b[i])).powi(2)).sum();
    square.sqrt()
}

/// Whether two states of a frequency response may be neighbours; `metric` measures their motions.
pub(super) fn are_neighbours(system: &System<'_>, metric: &[f64], from: &[f64], to: &[f64]) -> bool {
    if !matches!(system.unknown, Unknown::Frequency { .. }) {
        return true;
    }
    let nc = width(system.harmonics);
    let size = oscillation(metric, nc, from).max(oscillation(metric, nc, to));
    difference(metric, nc, from, Some(to)) <= ALLOWED * size
}

/// Whether a harmonic that the forcing does not act on turns round between two states, farther apart in frequency than the width
/// of a resonance of its that laws may have shifted to between them.
///
/// A curve on which a harmonic passes through zero is not held up by this: the shorter the step, the smaller the harmonic at both of
/// its ends.
pub(super) fn hops(system: &System<'_>, metric: &[f64], [from, to]: [&[f64]; 2]) -> bool {
    if !matches!(system.unknown, Unknown::Frequency { .. }) {
        return false;
    }
    let nc = width(system.harmonics);
    let size = oscillation(metric, nc, from).max(oscillation(metric, nc, to));
    let of_harmonic = |k: usize, value: &dyn Fn(usize) -> f64| {
        let entries = (0..metric.len() / nc).flat_map(|series| [series * nc + 2 * k - 1, series * nc + 2 * k]);
        entries.map(|i| metric[i] * value(i).powi(2)).sum::<f64>().sqrt()
    };
    let omega = [from, to].map(|y| y[metric.len()] * system.scales.frequency);
    let others = (1..=system.harmonics).filter(|k| *k != system.modal.harmonic());
    let mut turned = others.filter(|&k| {
        let largest = of_harmonic(k, &|i| from[i]).max(of_harmonic(k, &|i| to[i]));
        largest > SEEN * size && of_harmonic(k, &|i| to[i] - from[i]) > TURNED * largest
    });
    let (low, high) = (omega[0].min(omega[1]), omega[0].max(omega[1]));
    turned.any(|k| {
        (0..system.model.size()).any(|j| {
            let (omega_j, decay) = system.model.resonance(j);
            let (resonance, half_width) = (omega_j / k as f64, decay.abs() / k as f64);
            let is_near = ((1.0 - SHIFTED) * low..=(1.0 + SHIFTED) * high).contains(&resonance);
            is_near && high - low > half_width.max(LEAST * high)
        })
    })
}

/// Longest step from a state of a frequency response along its unit tangent; `modal` has its modal amplitudes (modes × nc).
pub(super) fn longest_step(
    system: &System<'_>,
    metric: &[f64],
    [y, tangent]: [&[f64]; 2],
    modal: &[f64],
    at: Parameters,
) -> f64 {
    if !matches!(system.unknown, Unknown::Frequency { .. }) {
        return f64::INFINITY;
    }
    let nc = width(system.harmonics);
    let by_motion = PLANNED * oscillation(metric, nc, y) / oscillation(metric, nc, tangent);
    let rate = tangent[metric.len()].abs() * system.scales.frequency;
    let by_resonance = distance_allowed(system, modal, at.omega) / rate;
    // A quotient of zeros limits nothing.
    [by_motion, by_resonance].into_iter().filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min)
}

/// How far the frequency may change, rad/s.
fn distance_allowed(system: &System<'_>, modal: &[f64], omega: f64) -> f64 {
    let (model, nc) = (system.model, width(system.harmonics));
    // Without means, as everywhere here: a preload says nothing of resonances.
    let size = modal.chunks(nc).map(|series| dot(&series[1..], &series[1..])).sum::<f64>().sqrt();
    let mut allowed = f64::INFINITY;
    for (j, series) in modal.chunks(nc).enumerate() {
        let (omega_j, decay) = model.resonance(j);
        let damping = 2.0 * decay.abs();
        for k in 1..=system.harmonics {
            let frequency = k as f64 * omega;
            let stiffness = Complex64::new(omega_j * omega_j - frequency * frequency, damping * frequency);
            // Amplitude that the forces acting on the mode now would have at its resonance.
            let resonant = stiffness.norm() * complex(series, k).norm() / (damping * omega_j).max(f64::MIN_POSITIVE);
            let negligible = NEGLIGIBLE[usize::from(k != system.modal.harmonic())];
            if resonant > negligible * size {
                let distance = APPROACH * (omega_j / k as f64 - omega).abs();
                let half_width = 0.5 * damping / k as f64;
                allowed = allowed.min(distance.max(half_width).max(1e-9 * omega));
            }
        }
    }
    allowed
}

#[cfg(test)]
mod tests {
    use crate::curve::problem::Problem;
    use crate::formulation::Formulation;
    use crate::formulation::harmonics::width;
    use crate::formulation::pressure::PressureForm;
    use crate::formulation::scales::Scales;
    use crate::formulation::unknown::Unknown;
    use crate::linalg::Matrix;
    use crate::settings::Settings;
    use crate::structure::Model;
    use crate::structure::laws::{PolynomialSpring, Term};

    /// Two states of a mass on a cubic spring (ω₁ = 1 rad/s), each by its frequency and the third harmonic of a motion of 1.
    fn hops(ratio: f64, from: (f64, f64), to: (f64, f64)) -> bool {
        let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 1.0 }] };
        let model = Model::builder("mass")
            .mass(Matrix::diagonal(&[1.0]))
            .stiffness(Matrix::diagonal(&[1.0]))
            .damping_ratio(ratio)
            .force(0, 1.0)
            .element("spring", spring, [vec![(0, 1.0)]])
            .build()
            .unwrap();
        let harmonics = Settings::default().harmonics;
        let (unknown, scales) = (Unknown::Frequency { forcing: 1.0 }, Scales::new(&model, 0));
        let frequency = scales.frequency;
        let problem = PressureForm::build(&model, harmonics, 0, unknown, scales).unwrap();
        let state = |(omega, third): (f64, f64)| {
            let mut y = vec![0.0; problem.len()];
            let end = problem.motion_metric().len();
            // Modal amplitudes come last.
            let modal = end - width(harmonics.count);
            (y[modal + 1], y[modal + 5], y[end]) = (1.0, third, omega / frequency);
            y
        };
        problem.hops(&state(from), &state(to))
    }

    #[test]
    fn a_harmonic_that_turns_round_near_a_resonance_has_hopped() {
        // The third harmonic of 0.35 rad/s is near the resonance; the half-width of which is 1e-5/3 rad/s.
        let cases = [
            ((0.35, 0.05), (0.351, -0.05), true),
            // Small as it decreases, or on one side.
            ((0.35, 0.05), (0.351, 0.001), false),
            ((0.35, 0.05), (0.351, 0.02), false),
            // Too small to be seen, narrower than the resonance, or far from it.
            ((0.35, 5e-4), (0.351, -5e-4), false),
            ((0.35, 0.05), (0.350001, -0.05), false),
            ((0.9, 0.05), (0.901, -0.05), false),
            // Over a resonance that is near neither end.
            ((0.2, 0.05), (0.6, -0.05), true),
        ];
        for (from, to, expected) in cases {
            assert_eq!(hops(1e-5, from, to), expected, "{from:?} to {to:?}");
            assert_eq!(hops(1e-5, to, from), expected, "{to:?} to {from:?}");
        }
        // Without damping as well; with much of it the resonance is wider than the step.
        assert!(hops(0.0, (0.35, 0.05), (0.351, -0.05)));
        assert!(!hops(0.05, (0.35, 0.05), (0.351, -0.05)));
    }
}
