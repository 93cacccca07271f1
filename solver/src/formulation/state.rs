//! A periodic (or decaying) solution in physical units.

use crate::formulation::harmonics::{Transform, evaluate, max_abs, shift_phase, width};
use crate::structure::Model;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Frequency, decay rate and forcing amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Frequency ω, rad/s.
    pub omega: f64,
    /// Decay rate ζ, 1/s.
    pub decay: f64,
    /// Forcing amplitude A.
    pub forcing: f64,
}

impl Parameters {
    /// λ_k = k(−ζ + iω).
    pub fn lambda(&self, k: usize) -> Complex64 {
        k as f64 * Complex64::new(-self.decay, self.omega)
    }
}

/// Harmonics of a solution: everything needed to restart from it or to rebuild any displacement.
///
/// Rotating the phase, storing and sending a solution need nothing else; displacements are x = Φ y.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Number of harmonics H; every series has nc = 2H + 1 numbers.
    pub harmonics: usize,
    /// Response frequency ω, rad/s.
    pub omega: f64,
    /// Decay rate ζ, 1/s (zero for forced responses).
    pub decay: f64,
    /// Forcing amplitude A (zero on a backbone).
    pub forcing: f64,
    /// Harmonics of the laws' arguments, channels × nc (contact: predicted pressure in N; displacements in m).
    pub arguments: Vec<f64>,
    /// Harmonics of the modal amplitudes, n × nc, kg^½·m.
    pub modal: Vec<f64>,
}

impl State {
    /// Frequency, decay rate and forcing amplitude.
    pub fn parameters(&self) -> Parameters {
        Parameters { omega: self.omega, decay: self.decay, forcing: self.forcing }
    }

    /// The same motion with time shifted: X_k ← X_k e^{ikφ}.
    pub fn shifted(&self, phase: f64) -> State {
        let mut state = self.clone();
        let nc = width(self.harmonics);
        for series in state.arguments.chunks_mut(nc).chain(state.modal.chunks_mut(nc)) {
            shift_phase(series, phase);
        }
        state
    }

    /// The same motion as a series of `harmonics` harmonics: those that it has, as far as there are as many, others are zero.
    pub fn with_harmonics(&self, harmonics: usize) -> State {
        let (from, to) = (width(self.harmonics), width(harmonics));
        let longer = |series: &[f64]| {
            series.chunks(from).flat_map(|s| s.iter().copied().chain(std::iter::repeat(0.0)).take(to)).collect()
        };
        State { harmonics, arguments: longer(&self.arguments), modal: longer(&self.modal), ..*self }
    }

    /// The same motion as one that lasts `times` as long and repeats itself so often: X_k becomes harmonic `times` k, as far as there
    /// are `harmonics` of them.
    pub fn repeated(&self, times: usize, harmonics: usize) -> State {
        let (from, to) = (width(self.harmonics), width(harmonics));
        let spread = |all: &[f64]| {
            let mut spread = vec![0.0; all.len() / from * to];
            for (series, target) in all.chunks(from).zip(spread.chunks_mut(to)) {
                target[0] = series[0];
                for (k, pair) in (1..=harmonics / times).zip(series[1..].chunks(2)) {
                    target[2 * times * k - 1..=2 * times * k].copy_from_slice(pair);
                }
            }
            spread
        };
        State {
            harmonics,
            omega: self.omega / times as f64,
            decay: self.decay / times as f64,
            forcing: self.forcing,
            arguments: spread(&self.arguments),
            modal: spread(&self.modal),
        }
    }

    /// (1 − share) self + share other, parameters included.
    pub fn interpolate(&self, other: &State, share: f64) -> State {
        let mix = |a: f64, b: f64| a + share * (b - a);
        let series = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(&a, &b)| mix(a, b)).collect();
        State {
            harmonics: self.harmonics,
            omega: mix(self.omega, other.omega),
            decay: mix(self.decay, other.decay),
            forcing: mix(self.forcing, other.forcing),
            arguments: series(&self.arguments, &other.arguments),
            modal: series(&self.modal, &other.modal),
        }
    }

    /// Harmonics of mode `j`.
    pub fn mode(&self, j: usize) -> &[f64] {
        let nc = width(self.harmonics);
        &self.modal[j * nc..(j + 1) * nc]
    }

    /// Harmonics of the displacement of a dof, nc = 2H + 1 numbers, m.
    pub fn displacement(&self, model: &Model, dof: usize) -> Vec<f64> {
        self.combine(model.modes().shapes.row(dof).iter().copied())
    }

    /// The same of every dof.
    pub fn displacements(&self, model: &Model) -> Vec<Vec<f64>> {
        (0..model.size()).map(|dof| self.displacement(model, dof)).collect()
    }

    /// Displacement (m) and velocity (m/s) of a dof at `count` instants, evenly spread over a period from t = 0 on. A decaying motion is
    /// taken as periodic: ζ is left out.
    pub fn over_period(&self, model: &Model, dof: usize, count: usize) -> Vec<[f64; 2]> {
        let series = self.displacement(model, dof);
        let instant = |i: usize| std::f64::consts::TAU * i as f64 / count as f64;
        (0..count)
            .map(|i| {
                let [x, slope, _] = evaluate(&series, instant(i));
                [x, self.omega * slope]
            })
            .collect()
    }

    /// Largest |x| of a dof over a period, between instants too, m.
    pub fn amplitude(&self, model: &Model, dof: usize) -> f64 {
        let samples = (8 * self.harmonics).next_power_of_two().max(64);
        max_abs(&self.displacement(model, dof), &mut Transform::new(self.harmonics, samples))
    }

    /// Harmonics of Σ_j shape_j y_j: a displacement if `shape` is a row of Φ.
    pub fn combine(&self, shape: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let nc = width(self.harmonics);
        let mut out = vec![0.0; nc];
        for (factor, series) in shape.into_iter().zip(self.modal.chunks(nc)) {
            crate::linalg::axpy(factor, series, &mut out);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formulation::harmonics::complex;

    #[test]
    fn longer_series_are_the_same_motion() {
        let state = State {
            harmonics: 1,
            omega: 2.0,
            decay: 0.0,
            forcing: 1.0,
            arguments: vec![1.0, 2.0, 3.0],
            modal: vec![4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
        };
        let longer = state.with_harmonics(2);
        assert_eq!(longer.modal, [4.0, 5.0, 6.0, 0.0, 0.0, 7.0, 8.0, 9.0, 0.0, 0.0]);
        assert_eq!(complex(longer.mode(1), 1), complex(state.mode(1), 1));
    }
}
