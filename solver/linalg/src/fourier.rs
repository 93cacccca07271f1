//! Discrete Fourier transforms.

use num_complex::Complex64;
use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

/// A discrete Fourier transform of N complex samples and its inverse, in place; neither is scaled.
#[derive(Clone)]
pub struct Fourier {
    forward: Arc<dyn Fft<f64>>,
    inverse: Arc<dyn Fft<f64>>,
    scratch: Vec<Complex64>,
}

impl Fourier {
    /// The transform of so many samples.
    pub fn new(samples: usize) -> Self {
        let mut planner = FftPlanner::new();
        let (forward, inverse) = (planner.plan_fft_forward(samples), planner.plan_fft_inverse(samples));
        let scratch = forward.get_inplace_scratch_len().max(inverse.get_inplace_scratch_len());
        Self { forward, inverse, scratch: vec![Complex64::default(); scratch] }
    }

    /// Number of samples N.
    pub fn samples(&self) -> usize {
        self.forward.len()
    }

    /// Z_l = Σ_n z_n exp(−2πi l n/N), in the place of N samples z.
    pub fn forward(&mut self, samples: &mut [Complex64]) {
        self.forward.process_with_scratch(samples, &mut self.scratch);
    }

    /// z_n = Σ_l Z_l exp(2πi l n/N), in the place of N coefficients Z.
    pub fn inverse(&mut self, coefficients: &mut [Complex64]) {
        self.inverse.process_with_scratch(coefficients, &mut self.scratch);
    }
}
