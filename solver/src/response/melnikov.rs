//! Melnikov energy balance over one period (paper [27–31]).

use crate::formulation::Formulation;
use crate::formulation::harmonics::width;
use crate::formulation::state::State;
use crate::settings::Criterion;
use crate::structure::Damping;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Energies of one period at a backbone point, in J.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Energies {
    /// Dissipated by the linear damping: R_lin = π ω Σ k² (a_kᵀ C a_k + b_kᵀ C b_k).
    pub linear: f64,
    /// Dissipated by the nonlinear forces: R_nl = π Σ k (b_k·fa_k − a_k·fb_k); negative if friction feeds energy in.
    pub nonlinear: f64,
    /// Largest work of the forcing per unit amplitude, W/A = π m |X_m·s|.
    pub work_per_amplitude: f64,
    /// |R_lin + R_nl − 2πωζ Σ k³ X_kᴴ M X_k − W sin ψ| over |R_lin| + |R_nl|, R_lin with the damping that acts on the
    /// backbone, W sin ψ the work of the forcing if it acts: zero at an exact point.
    pub certificate: f64,
}

impl Energies {
    /// Threshold amplitude A*: forced responses are predicted for A > A*. Infinite where the forcing does no work.
    pub fn threshold(&self, criterion: Criterion) -> f64 {
        let dissipated = self.dissipated(criterion);
        if self.work_per_amplitude > 0.0 { dissipated / self.work_per_amplitude } else { f64::INFINITY }
    }

    /// What the forcing has to do at least, by a criterion.
    pub fn dissipated(&self, criterion: Criterion) -> f64 {
        match criterion {
            Criterion::Balance => (self.linear + self.nonlinear).abs(),
            Criterion::Sufficient => self.linear.abs() + self.nonlinear.abs(),
        }
    }

    /// (R_lin + R_nl)/(W/A): sine of the phase between forcing and motion, times A.
    pub fn balance(&self) -> f64 {
        (self.linear + self.nonlinear) / self.work_per_amplitude
    }

    /// Energies of a converged state; `y` is the same state as `problem` encodes it.
    pub fn evaluate<'m>(problem: &mut impl Formulation<'m>, y: &[f64], state: &State) -> Self {
        let forces = problem.forces(y);
        let (model, modal) = (problem.model(), problem.modal());
        let (omega, nc) = (state.omega, width(state.harmonics));
        let linear = dissipation(model.damping(), state);
        let acting = if problem.unknown().is_damped() { linear } else { 0.0 };
        let mut nonlinear = 0.0;
        for (u, force) in forces.chunks(nc).enumerate() {
            if force.iter().all(|&f| f == 0.0) {
                continue;
            }
            let x = state.combine(modal.shape(u).iter().copied());
            for k in 1..=state.harmonics {
                let (a, b) = (2 * k - 1, 2 * k);
                nonlinear += PI * k as f64 * (x[b] * force[a] - x[a] * force[b]);
            }
        }
        let weighted: f64 = state
            .modal
            .chunks(nc)
            .flat_map(|y| {
                (1..=state.harmonics).map(move |k| (k as f64).powi(3) * (y[2 * k - 1].powi(2) + y[2 * k].powi(2)))
            })
            .sum();
        let stored = 2.0 * PI * omega * state.decay * weighted;
        let (m, projection) = (modal.harmonic() as f64, modal.forcing_projection(state));
        // What the forcing puts in, if there is one.
        let input = PI * m * state.forcing * -projection.im;
        let scale = linear.abs() + nonlinear.abs();
        Self {
            linear,
            nonlinear,
            work_per_amplitude: PI * m * projection.norm(),
            certificate: if scale > 0.0 { (acting + nonlinear - stored - input).abs() / scale } else { 0.0 },
        }
    }
}

/// R_lin in modal coordinates.
fn dissipation(damping: &Damping, state: &State) -> f64 {
    let product = |i: usize, j: usize| -> f64 {
        let (x, y) = (state.mode(i), state.mode(j));
        (1..=state.harmonics).map(|k| (k * k) as f64 * (x[2 * k - 1] * y[2 * k - 1] + x[2 * k] * y[2 * k])).sum()
    };
    let sum: f64 = damping.entries().map(|(i, j, c)| c * product(i, j)).sum();
    PI * state.omega * sum
}
