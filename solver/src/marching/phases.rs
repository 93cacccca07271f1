//! Phases of the forcing at the time steps of a period.

use std::f64::consts::TAU;

/// Steps of a period up to which the cosines of their phases are kept: half a megabyte.
const KEPT: usize = 1 << 16;

/// cos(mωt_n) for the steps of a period.
pub struct Phases {
    /// Steps in a period of the response.
    pub steps: usize,
    harmonic: usize,
    kept: Vec<f64>,
}

impl Phases {
    /// For `steps` time steps in a period and the forcing on this harmonic.
    pub fn new(steps: usize, harmonic: usize) -> Self {
        let mut phases = Self { steps, harmonic, kept: Vec::new() };
        if steps <= KEPT {
            phases.kept = (0..steps).map(|index| phases.compute(index)).collect();
        }
        phases
    }

    /// cos(mωt_n) at step n since the start.
    #[inline(always)]
    pub fn cosine(&self, index: usize) -> f64 {
        let index = index % self.steps;
        self.kept.get(index).copied().unwrap_or_else(|| self.compute(index))
    }

    fn compute(&self, index: usize) -> f64 {
        // The phase is reduced in integers: it does not drift over many periods.
        let turns = (self.harmonic * index % self.steps) as f64 / self.steps as f64;
        (TAU * turns).cos()
    }
}
