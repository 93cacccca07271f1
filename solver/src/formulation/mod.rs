//! Harmonic balance: the equations of a structure for a truncated Fourier series, in two formulations.

pub mod aft;
pub mod arcs;
mod crossings;
pub mod displacement;
pub mod harmonics;
pub mod linear;
pub mod modal;
mod narrow;
mod panels;
pub mod pressure;
pub mod receptance;
pub mod scales;
pub(crate) mod slider;
mod span;
pub mod state;
pub mod unknown;

use crate::curve::problem::Problem;
use crate::linalg::LinalgError;
use crate::settings::HarmonicSettings;
use crate::structure::Model;
use aft::Aft;
use modal::Modal;
use scales::Scales;
use state::State;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use thiserror::Error;
use unknown::Unknown;

/// Why a model or a kind of unknowns does not fit a formulation.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FormulationError {
    /// The pressures of some contacts cannot be told apart from the forces on the dofs.
    #[error(
        "the normal forces of the contacts {} cannot be told apart: they push along the same dofs (or along those of \
         friction forces); use the pressure form, which keeps every pressure as an unknown", names.join(", ")
    )]
    Inseparable {
        /// Names of the elements.
        names: Vec<String>,
    },
    /// There is nothing to keep: no nonlinear element.
    #[error("the model has no nonlinear element; its response is linear")]
    Linear,
    /// This form knows forced responses at fixed A or ω, and damped modes.
    #[error(
        "the displacement form has no conservative or phase-resonance backbone, and no fold or peak curve; use the pressure \
         form"
    )]
    Unsupported,
    /// Fold and peak curves need second derivatives that some laws do not have.
    #[error(
        "fold and peak curves need second derivatives, which {} have by arcs only (harmonics.quadrature = \
         arcs): by samples their derivatives jump", names.join(", ")
    )]
    Rough {
        /// Names of the elements.
        names: Vec<String>,
    },
    /// The eigenvalue problem behind the left inverse did not converge.
    #[error("the directions of the contacts could not be separated")]
    NoConvergence,
}

/// What a harmonic balance is of, in whatever formulation.
pub struct System<'m> {
    /// The structure.
    pub model: &'m Model,
    /// Forcing and channels in modal coordinates.
    pub modal: Arc<Modal>,
    /// Number of harmonics H.
    pub harmonics: usize,
    /// Mode that scales and phase conditions go by, from 0.
    pub tracked: usize,
    /// Which parameters are unknown, and the value of the one that is not.
    pub unknown: Unknown,
    /// Scales of the unknowns.
    pub scales: Scales,
    /// Whether with a motion its mirror image, half a period of the forcing later, is a solution as well: see [`Model::is_odd`].
    pub is_symmetric: bool,
}

impl<'m> System<'m> {
    fn new(model: &'m Model, truncation: HarmonicSettings, tracked: usize, unknown: Unknown, scales: Scales) -> Self {
        let modal = Arc::new(Modal::new(model));
        Self { model, modal, harmonics: truncation.count, tracked, unknown, scales, is_symmetric: model.is_odd() }
    }

    /// Number of motions that are the same solution: time shifts by whole periods of the forcing, m in a period of the response,
    /// and for a symmetric structure as many by half a period more, mirrored. Of free motions those that keep their phase condition: half
    /// a period later, and for a symmetric structure mirrored, or both.
    fn images(&self) -> usize {
        let shifts = if self.unknown.is_autonomous() { 2 } else { self.modal.harmonic() };
        if self.is_symmetric { 2 * shifts } else { shifts }
    }

    /// How image `index` comes about: a shift of the phase, and whether it is mirrored.
    fn image_of(&self, index: usize) -> (f64, bool) {
        match (self.unknown.is_autonomous(), self.is_symmetric) {
            (true, false) => (PI * index as f64, false),
            (true, true) => [(0.0, false), (PI, true), (PI, false), (0.0, true)][index],
            (false, false) => (TAU * index as f64 / self.modal.harmonic() as f64, false),
            (false, true) => (PI * index as f64 / self.modal.harmonic() as f64, index % 2 == 1),
        }
    }

    /// Image `index` of a state or direction whose first `motion` entries are series.
    fn image(&self, y: &[f64], motion: usize, index: usize) -> Vec<f64> {
        let (phase, is_mirrored) = self.image_of(index);
        let mut image = y.to_vec();
        for series in image[..motion].chunks_mut(harmonics::width(self.harmonics)) {
            harmonics::shift_phase(series, phase);
            if is_mirrored {
                series.iter_mut().for_each(|x| *x = -*x);
            }
        }
        image
    }
}

/// A harmonic balance: what curves of periodic solutions are traced with, whatever its unknowns are. Model, truncation,
/// kind of unknown parameters and the value of the fixed one are given when it is made.
pub trait Formulation<'m>: Problem + Sized {
    /// System for `model` at a truncation; mode `tracked` (from 0) is the one that scales and phase conditions go by.
    ///
    /// # Errors
    /// If the formulation does not fit the model, or has no such unknowns.
    fn build(
        model: &'m Model,
        truncation: HarmonicSettings,
        tracked: usize,
        unknown: Unknown,
        scales: Scales,
    ) -> Result<Self, FormulationError>;

    /// What it is the harmonic balance of.
    fn system(&self) -> &System<'m>;

    /// The structure.
    fn model<'s>(&'s self) -> &'m Model
    where
        'm: 's,
    {
        self.system().model
    }

    /// Forcing and channels in modal coordinates.
    fn modal<'s>(&'s self) -> &'s Modal
    where
        'm: 's,
    {
        &self.system().modal
    }

    /// Number of harmonics H.
    fn harmonics<'s>(&'s self) -> usize
    where
        'm: 's,
    {
        self.system().harmonics
    }

    /// Which parameters are unknown, and the value of the one that is not.
    fn unknown<'s>(&'s self) -> Unknown
    where
        'm: 's,
    {
        self.system().unknown
    }

    /// Scales of the unknowns.
    fn scales<'s>(&'s self) -> &'s Scales
    where
        'm: 's,
    {
        &self.system().scales
    }

    /// Frequency–time work space.
    fn aft(&mut self) -> &mut Aft;

    /// Scaled state vector of a solution, [`Problem::len`] numbers.
    fn encode(&self, state: &State) -> Vec<f64>;

    /// Solution of a scaled state vector.
    ///
    /// # Errors
    /// If dofs that are not among the unknowns have an undamped resonance there.
    fn decode(&mut self, y: &[f64]) -> Result<State, LinalgError>;

    /// Direction in which the motion of a scaled state grows, its parameters unchanged.
    fn growth(&self, y: &[f64]) -> Vec<f64>;

    /// Force harmonics of the laws at a converged scaled state, channels × nc, N (left-hand side).
    fn forces(&mut self, y: &[f64]) -> Vec<f64>;
}
