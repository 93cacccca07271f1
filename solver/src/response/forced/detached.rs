//! Branches that are followed from a response on them, both ways: up to bounds that the settings give, to where they close, or to
//! where they branch off others.

use super::Forced;
use crate::curve::continuation::Continuation;
use crate::curve::problem::Failure;
use crate::curve::walk::{TracedCurve, both_ways, walk};
use crate::formulation::Formulation;
use crate::formulation::state::State;
use crate::response::branch::{Branch, BranchKind, BranchPoint, Observer, Outcome, Stop};
use crate::response::symmetry::{Asymmetry, up_to_branch_point, without_turns_at_crossings};

impl<'m, F: Formulation<'m>> Forced<'m, F> {
    /// The branch through a converged state: forwards, and if it does not close, backwards as well. Bounds that the settings
    /// give end it; others do not.
    ///
    /// # Errors
    /// If the state does not converge again.
    pub fn branch_through(&mut self, state: &State, observer: &mut Observer<'_>) -> Result<Branch, Failure> {
        self.branch_within(self.given(), state, observer)
    }

    /// The branch through a converged state, whatever bounds the settings give.
    ///
    /// # Errors
    /// If the state does not converge again.
    pub fn branch_beyond(&mut self, state: &State, observer: &mut Observer<'_>) -> Result<Branch, Failure> {
        self.branch_within(self.widest(), state, observer)
    }

    /// A response of every part of a branch that lies within the range of the study.
    pub fn within_range(&mut self, branch: &Branch) -> Vec<State> {
        let (low, high) = self.reach.frequency;
        let is_inside = |point: &BranchPoint| (low..=high).contains(&point.omega());
        let parts = branch.points.chunk_by(|a, b| is_inside(a) == is_inside(b)).filter(|part| is_inside(&part[0]));
        let middles: Vec<State> = parts.map(|part| part[part.len() / 2].state.clone()).collect();
        middles.into_iter().filter(|state| self.contains(state)).collect()
    }

    /// The branch through a converged state within these frequencies, rad/s. One that was entered next to a motion that is its own image
    /// is followed from elsewhere: there, two curves meet.
    fn branch_within(
        &mut self,
        frequency: (f64, f64),
        state: &State,
        observer: &mut Observer<'_>,
    ) -> Result<Branch, Failure> {
        let mut branch = self.walked_within(frequency, state, observer)?;
        let mut asymmetry = Asymmetry::of(&self.problem, &branch);
        if let Some(farther) = asymmetry.farther(&branch).filter(|_| !branch.is_cancelled())
            && let Ok(again) = self.walked_within(frequency, &branch.points[farther].state, observer)
        {
            branch = again;
            asymmetry = Asymmetry::of(&self.problem, &branch);
        }
        asymmetry.end(&mut branch);
        without_turns_at_crossings(self.model(), &mut branch);
        Ok(branch)
    }

    /// The branch through a converged state, one way and the other, up to where it branches off others.
    fn walked_within(
        &mut self,
        frequency: (f64, f64),
        state: &State,
        observer: &mut Observer<'_>,
    ) -> Result<Branch, Failure> {
        let y = self.problem.encode(state);
        let (upwards, growth) = (self.problem.parameter_row(), self.problem.growth(&y));
        let (bounds, settings) = (self.bounds(frequency, true), self.settings.continuation);
        let mut one_way = |continuation: &mut Continuation<'_, F>| {
            continuation.record(&self.recorder);
            up_to_branch_point(continuation, |continuation, ending| walk(continuation, &bounds, observer, ending))
        };
        let mut walk = |direction: &[f64]| both_ways(&mut self.problem, y.clone(), direction, &settings, &mut one_way);
        // At a fold the branch turns back in frequency.
        let walked = walk(&upwards).or_else(|_| walk(&growth))?;
        let kind = BranchKind::of_detached(&walked.outcome, self.is_cut(&walked));
        Ok(self.finish(walked, kind))
    }

    /// Whether a curve ends at a bound that the settings give.
    fn is_cut(&self, walked: &TracedCurve<BranchPoint>) -> bool {
        let Outcome::Open(first, last) = walked.outcome else { return false };
        let (given, (low, high)) = (self.settings.frequency, self.reach.frequency);
        let ends = [(first, walked.visited.first()), (last, walked.visited.last())];
        ends.into_iter().any(|(stop, end)| match (stop, end) {
            (Stop::FrequencyBound, Some(end)) => {
                let at = end.point.omega();
                (given.min.is_some() && at <= low * (1.0 + 1e-6)) || (given.max.is_some() && at >= high * (1.0 - 1e-6))
            }
            (Stop::AmplitudeBound, _) => self.settings.branch.max_amplitude.is_some(),
            _ => false,
        })
    }
}
