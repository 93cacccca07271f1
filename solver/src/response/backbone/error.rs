//! Why a backbone does not begin.

use crate::curve::problem::Failure;
use crate::formulation::FormulationError;
use crate::settings::SettingsError;
use crate::structure::Model;
use thiserror::Error;

/// Why there is no backbone at all.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BackboneError {
    /// A setting is out of its range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The formulation does not have this backbone.
    #[error(transparent)]
    Formulation(#[from] FormulationError),
    /// Not even the first point, close to the linear mode, converged.
    #[error("the backbone of mode {mode} does not start near its linear range ({omega:.6} rad/s): {failure}{}", what_is_missing(.drifting))]
    Start {
        /// Mode, from 1.
        mode: usize,
        /// Its eigenfrequency, rad/s.
        omega: f64,
        /// Why.
        failure: Failure,
        /// A rigid-body mode, from 1, that nothing resists: where the structure is on average is not determined.
        drifting: Option<usize>,
    },
    /// The forced response given is not close to quadrature with the forcing.
    #[error("no phase-resonant response near {omega:.6} rad/s: {failure}")]
    Resonance {
        /// Frequency of the forced response, rad/s.
        omega: f64,
        /// Why.
        failure: Failure,
    },
}

/// What would be right where a structure drifts, for its message.
fn what_is_missing(drifting: &Option<usize>) -> String {
    drifting.map_or(String::new(), |mode| {
        format!(
            "; nothing resists the rigid-body motion of mode {mode}, so that the mean position is not determined: hold it by a \
             soft spring, or by a law"
        )
    })
}

/// The first rigid-body mode, from 1, that no nonlinear element feels.
pub(super) fn drifting(model: &Model) -> Option<usize> {
    let feels = |j: usize, channel: &Vec<(usize, f64)>| {
        let terms = channel.iter().map(|&(dof, b)| b * model.modes().shapes[(dof, j)]);
        let (sum, size) = terms.fold((0.0, 0.0), |(sum, size), term: f64| (sum + term, size + term.abs()));
        sum.abs() > 1e-9 * size
    };
    let is_felt =
        |j: usize| model.elements().iter().flat_map(|element| &element.channels).any(|channel| feels(j, channel));
    (0..model.size()).find(|&j| model.modes().is_rigid(j) && !is_felt(j)).map(|j| j + 1)
}
