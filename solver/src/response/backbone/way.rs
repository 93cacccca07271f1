//! How curves of free motions are walked, and which of them are of interest.

use crate::curve::continuation::Continuation;
use crate::curve::problem::{Problem, inner};
use crate::curve::walk::{Bounds, relative_distance};
use crate::formulation::state::State;
use crate::formulation::{Formulation, linear};
use crate::response::branch::TracedPoint;
use crate::response::melnikov::Energies;
use crate::settings::Settings;
use std::f64::consts::PI;

/// Up to a least threshold of this many times the highest forcing amplitude curves of free motions are followed.
pub(super) const FAR: f64 = 100.0;

/// Relative distance of a motion from that with which it was looked for, at most.
const ALIKE: f64 = 0.5;

/// How curves of free motions are walked.
pub(super) struct Way<'w> {
    /// The settings.
    pub settings: &'w Settings,
    /// Where walks end.
    pub bounds: Bounds,
    /// Highest forcing amplitude that curves across are for.
    pub forcing: f64,
}

/// Tells a walk that it has come to rest: on the other side are the same motions, half a period later.
#[derive(Default)]
pub(super) struct Rest {
    before: Option<Vec<f64>>,
}

impl Rest {
    /// Whether the next point of a walk is beyond.
    pub fn is_passed<P: Problem>(&mut self, problem: &P, y: &[f64]) -> bool {
        let before = self.before.replace(y.to_vec());
        before.is_some_and(|before| inner(problem.motion_metric(), &before, y) < 0.0)
    }
}

impl Way<'_> {
    /// A motion that is so many times as large as `state` and like it otherwise, if there is one within the bounds of the frequency.
    pub(super) fn larger<'m, F: Formulation<'m>>(
        &self,
        problem: &mut F,
        state: &State,
        factor: f64,
    ) -> Option<Vec<f64>> {
        let y = problem.encode(&linear::times(problem, state.clone(), factor));
        let direction = problem.growth(&y);
        let started = Continuation::start(problem, y.clone(), &direction, self.settings.continuation).ok()?;
        let found = started.current().y.clone();
        let is_alike = relative_distance(problem.motion_metric(), &found, &y) < ALIKE;
        (is_alike && self.is_within(problem, &found)).then_some(found)
    }

    /// Whether the frequency of a motion is within the bounds.
    pub(super) fn is_within<'m, F: Formulation<'m>>(&self, problem: &mut F, y: &[f64]) -> bool {
        let (low, high) = self.bounds.frequency;
        problem.decode(y).is_ok_and(|state| (low..=high).contains(&state.omega))
    }

    /// Whether forcing of interest may drive a motion.
    pub(super) fn is_of_interest<'m, F: Formulation<'m>>(&self, problem: &mut F, y: &[f64]) -> bool {
        problem.decode(y).is_ok_and(|state| self.least_of(problem, y, &state) <= FAR * self.forcing)
    }

    /// Whether no forcing of interest drives such a motion.
    pub(super) fn is_beyond<'m, F: Formulation<'m>>(&self, problem: &mut F, at: &TracedPoint) -> bool {
        self.least_threshold(problem, at) > FAR * self.forcing
    }

    /// Threshold A* of a point.
    pub(super) fn threshold<'m, F: Formulation<'m>>(&self, problem: &mut F, at: &TracedPoint) -> f64 {
        Energies::evaluate(problem, &at.curve.y, &at.point.state).threshold(self.settings.backbone.criterion)
    }

    /// Threshold A* of a point if the forcing did as much work as one of its size can: W/A = π m |s| |X|. On motions that cross each other
    /// one and the same force may do very different work.
    pub(super) fn least_threshold<'m, F: Formulation<'m>>(&self, problem: &mut F, at: &TracedPoint) -> f64 {
        self.least_of(problem, &at.curve.y, &at.point.state)
    }

    fn least_of<'m, F: Formulation<'m>>(&self, problem: &mut F, y: &[f64], state: &State) -> f64 {
        let energies = Energies::evaluate(problem, y, state);
        let needed = energies.dissipated(self.settings.backbone.criterion);
        let size = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>().sqrt();
        let (modal, m) = (problem.modal(), problem.modal().harmonic() as f64);
        let work = PI * m * size(modal.forcing()) * size(&state.modal);
        needed / work
    }
}
