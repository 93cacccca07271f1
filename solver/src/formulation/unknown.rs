//! What is unknown beside the harmonics, in either formulation.

use crate::formulation::scales::Scales;
use crate::formulation::state::{Parameters, State};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Which parameters are unknown beside the harmonics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unknown {
    /// Forced response, ω free.
    Frequency {
        /// Forcing amplitude A.
        forcing: f64,
    },
    /// Forced response, ω free, with a force of the same shape on harmonic 1 as well: between a motion of the fundamental and a
    /// sub-harmonic one.
    Blended {
        /// Forcing amplitude A.
        forcing: f64,
        /// Complex amplitude of the force on harmonic 1, in units of A.
        fundamental: Complex64,
    },
    /// Forced response, A free.
    Forcing {
        /// Frequency ω, rad/s.
        omega: f64,
    },
    /// Nonlinear normal mode: E = 0, ω and ζ free, phase fixed by Re q = 0; with or without the linear damping.
    Mode {
        /// Whether the linear damping acts.
        damped: bool,
    },
    /// Forced response in quadrature with the forcing, Re(X_m·s) = 0, ω and A free.
    PhaseResonance,
    /// Forced response where a quantity has an extremum along the branch at fixed A, ω and A free: the curve of the folds,
    /// or of the peaks, of all levels.
    Extremum(Quantity),
}

/// What has an extremum along a branch of forced responses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// ω: folds, where ∂R/∂x is singular.
    Frequency,
    /// Displacement of the first monitored dof at the instant of a largest |x| (by the envelope theorem its maximum over the
    /// period has the same gradient): peaks.
    Amplitude,
    /// Root mean square of the displacement of the first monitored dof: peaks a little beside those of the amplitude, but
    /// smooth everywhere, where the largest |x| may move to another instant. At births and merges all extrema coincide.
    Rms,
}

impl Quantity {
    /// Name of its extrema.
    pub const fn extremum(self) -> &'static str {
        match self {
            Self::Frequency => "fold",
            Self::Amplitude | Self::Rms => "peak",
        }
    }
}

impl Unknown {
    /// The parameters, in their order in the state.
    pub fn parameters(self) -> &'static [Parameter] {
        match self {
            Unknown::Frequency { .. } | Unknown::Blended { .. } => &[Parameter::Frequency],
            Unknown::Forcing { .. } => &[Parameter::Forcing],
            Unknown::Mode { .. } => &[Parameter::Frequency, Parameter::Decay],
            Unknown::PhaseResonance | Unknown::Extremum(_) => &[Parameter::Frequency, Parameter::Forcing],
        }
    }

    /// Whether there is no forcing.
    pub fn is_autonomous(self) -> bool {
        matches!(self, Unknown::Mode { .. })
    }

    /// Complex amplitude of a force on harmonic 1 beside that of amplitude A, in units of it.
    pub fn fundamental(self) -> Complex64 {
        match self {
            Unknown::Blended { fundamental, .. } => fundamental,
            _ => Complex64::default(),
        }
    }

    /// Whether the linear damping acts.
    pub fn is_damped(self) -> bool {
        self != Unknown::Mode { damped: false }
    }

    /// Frequency, decay rate and forcing amplitude before any unknown one is set.
    pub fn fixed(self, scales: &Scales) -> Parameters {
        let rest = Parameters { omega: scales.frequency, decay: 0.0, forcing: 0.0 };
        match self {
            Unknown::Frequency { forcing } | Unknown::Blended { forcing, .. } => Parameters { forcing, ..rest },
            Unknown::Forcing { omega } => Parameters { omega, ..rest },
            Unknown::Mode { .. } | Unknown::PhaseResonance | Unknown::Extremum(_) => rest,
        }
    }

    /// Scaled unknown parameters of a solution.
    pub fn encode(self, state: &State, scales: &Scales) -> impl Iterator<Item = f64> {
        let values = state.parameters();
        self.parameters().iter().map(move |&parameter| parameter.of(&values) / parameter.unit(scales))
    }

    /// Sets the unknown parameters from their scaled values.
    pub fn decode(self, scaled: &[f64], scales: &Scales, values: &mut Parameters) {
        for (&parameter, value) in self.parameters().iter().zip(scaled) {
            *parameter.of_mut(values) = value * parameter.unit(scales);
        }
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
    fn of(self, values: &Parameters) -> f64 {
        match self {
            Parameter::Frequency => values.omega,
            Parameter::Decay => values.decay,
            Parameter::Forcing => values.forcing,
        }
    }

    fn of_mut(self, values: &mut Parameters) -> &mut f64 {
        match self {
            Parameter::Frequency => &mut values.omega,
            Parameter::Decay => &mut values.decay,
            Parameter::Forcing => &mut values.forcing,
        }
    }

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
