//! Forcing and the displacements that laws act on, in modal coordinates.

use crate::formulation::harmonics::complex;
use crate::formulation::state::State;
use crate::structure::Model;
use crate::structure::laws::Law;
use num_complex::Complex64;

/// What a formulation, energies and seeds need of a model's forcing and channels: b̂ = Φᵀb for every channel bᵀx that a law
/// takes as an argument, and Φᵀs.
#[derive(Debug, Clone)]
pub struct Modal {
    modes: usize,
    harmonic: usize,
    forcing: Vec<f64>,
    /// Channels × modes.
    shapes: Vec<f64>,
    /// Gain and offset of each channel's argument while no force acts: argument = gain × displacement − offset.
    open: Vec<(f64, f64)>,
}

impl Modal {
    /// Of a model.
    pub fn new(model: &Model) -> Self {
        let modes = model.size();
        let (mut shapes, mut open) = (Vec::new(), Vec::new());
        for element in model.elements() {
            for (i, combination) in element.channels.iter().enumerate() {
                shapes.extend(model.modes().along(combination));
                open.push(match element.law.rigid() {
                    Some(contact) if i == 0 => (contact.epsilon, contact.epsilon * contact.gap),
                    _ => (1.0, 0.0),
                });
            }
        }
        Self { modes, harmonic: model.forcing().harmonic, forcing: model.modal_force(), shapes, open }
    }

    /// Forcing harmonic m.
    pub fn harmonic(&self) -> usize {
        self.harmonic
    }

    /// Φᵀ s, one entry a mode, N/kg^½ per unit of A.
    pub fn forcing(&self) -> &[f64] {
        &self.forcing
    }

    /// Number of channels: arguments of all laws.
    pub fn channels(&self) -> usize {
        self.open.len()
    }

    /// b̂ of channel `u`, one entry a mode, kg^-½.
    pub fn shape(&self, u: usize) -> &[f64] {
        &self.shapes[u * self.modes..(u + 1) * self.modes]
    }

    /// Gain and offset of channel `u`: its law's argument is gain × displacement − offset while no law exerts a force (contact
    /// normals: ε and ε × gap; 1 and 0 otherwise).
    pub fn open(&self, u: usize) -> (f64, f64) {
        self.open[u]
    }

    /// Arguments of the laws when none of them exerts a force, channels × nc, from modal amplitudes, modes × nc.
    pub fn open_arguments(&self, modal: &[f64]) -> Vec<f64> {
        let nc = modal.len() / self.modes;
        let mut arguments = vec![0.0; self.channels() * nc];
        for (u, series) in arguments.chunks_mut(nc).enumerate() {
            let (gain, offset) = self.open[u];
            self.displacement(u, modal, series);
            series.iter_mut().for_each(|x| *x *= gain);
            series[0] -= offset;
        }
        arguments
    }

    /// Displacement harmonics of channel `u` (nc) from modal amplitudes (modes × nc), m.
    pub fn displacement(&self, u: usize, modal: &[f64], out: &mut [f64]) {
        let nc = out.len();
        crate::linalg::vectorised(
            #[inline(always)]
            || {
                out.fill(0.0);
                for (shape, series) in self.shape(u).iter().zip(modal.chunks(nc)) {
                    crate::linalg::axpy(*shape, series, out);
                }
            },
        );
    }

    /// X_m·s: the motion on the forcing shape at the forcing harmonic (zero if m > H), J per unit of A.
    pub fn forcing_projection(&self, state: &State) -> Complex64 {
        if self.harmonic > state.harmonics {
            return Complex64::default();
        }
        complex(&state.combine(self.forcing.iter().copied()), self.harmonic)
    }
}
