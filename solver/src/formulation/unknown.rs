//! What is unknown beside the harmonics, in either formulation.

use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use rustfft::num_complex::Complex64;

/// Which parameters are unknown beside the harmonics.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unknown {
    /// Forced response, ω free at fixed forcing amplitude.
    Frequency,
    /// Forced response, A free at fixed ω.
    Forcing,
    /// Nonlinear normal mode: E = 0, ω and ζ free, phase fixed by Re q = 0; with or without the linear damping.
    Mode {
        /// Whether the linear damping acts.
        damped: bool,
    },
    /// Forced response in quadrature with the forcing, Re(X_m·s) = 0, ω and A free.
    PhaseResonance,
}

impl Unknown {
    /// The parameters, in their order in the state.
    pub fn parameters(self) -> &'static [Parameter] {
        match self {
            Unknown::Frequency => &[Parameter::Frequency],
            Unknown::Forcing => &[Parameter::Forcing],
            Unknown::Mode { .. } => &[Parameter::Frequency, Parameter::Decay],
            Unknown::PhaseResonance => &[Parameter::Frequency, Parameter::Forcing],
        }
    }

    /// Whether there is no forcing.
    pub fn is_autonomous(self) -> bool {
        matches!(self, Unknown::Mode { .. })
    }

    /// Scaled parameters of a solution.
    pub fn encode(self, state: &State, scales: &Scales) -> impl Iterator<Item = f64> {
        self.parameters().iter().map(move |&parameter| {
            let value = match parameter {
                Parameter::Frequency => state.omega,
                Parameter::Decay => state.decay,
                Parameter::Forcing => state.forcing,
            };
            value / parameter.unit(scales)
        })
    }
}

/// An unknown parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// ω.
    Frequency,
    /// ζ.
    Decay,
    /// A.
    Forcing,
}

impl Parameter {
    /// Unit of the scaled parameter.
    pub fn unit(self, scales: &Scales) -> f64 {
        match self {
            Parameter::Frequency | Parameter::Decay => scales.frequency,
            Parameter::Forcing => scales.forcing,
        }
    }

    /// ∂λ_k/∂parameter, λ_k = k(−ζ + iω).
    pub fn rate(self, k: usize) -> Complex64 {
        match self {
            Parameter::Frequency => Complex64::new(0.0, k as f64),
            Parameter::Decay => Complex64::new(-(k as f64), 0.0),
            Parameter::Forcing => Complex64::default(),
        }
    }
}
