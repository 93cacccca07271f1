//! Responses between neighbouring points of a branch.

use super::Forced;
use crate::curve::newton::{Constraint, Newton};
use crate::curve::problem::{inner, norm, weighted};
use crate::curve::walk::interpolate;
use crate::formulation::Formulation;
use crate::formulation::harmonics::complex;
use crate::formulation::state::State;

impl<'m, F: Formulation<'m>> Forced<'m, F> {
    /// Of the chord between two motions, the share at which it passes nearest to the motion `near`, and the relative distance there;
    /// phases as in [`Forced::motion_distance`].
    pub fn nearest_on_chord(&self, a: &State, b: &State, near: &State, mode: usize) -> (f64, f64) {
        let metric = self.problem.motion_metric();
        let encoded = |state: &State| self.problem.encode(&state.shifted(-complex(state.mode(mode), 1).arg()));
        let [a, b, near] = [a, b, near].map(encoded);
        let [chord, offset] = [&b, &near].map(|to| to.iter().zip(&a).map(|(to, a)| to - a).collect::<Vec<f64>>());
        let square = inner(metric, &chord, &chord);
        let share = if square > 0.0 { (inner(metric, &chord, &offset) / square).clamp(0.0, 1.0) } else { 0.0 };
        let rest: Vec<f64> = offset.iter().zip(&chord).map(|(offset, chord)| offset - share * chord).collect();
        (share, norm(metric, &rest) / norm(metric, &near))
    }

    /// The response of a branch between two of its neighbouring points, at `share` of the chord; `None` if it does not converge, or on
    /// another curve.
    pub fn response_between(&mut self, a: &State, b: &State, share: f64) -> Option<State> {
        let newton = self.settings.continuation.newton;
        let [a, b] = [a, b].map(|state| self.problem.encode(state));
        let chord: Vec<f64> = b.iter().zip(&a).map(|(b, a)| b - a).collect();
        let (row, origin) = (weighted(self.problem.metric(), &chord), interpolate(&a, &b, share));
        let mut y = origin.clone();
        let plane = Constraint::Hyperplane { row: &row, origin: &origin };
        Newton::default().solve(&mut self.problem, &mut y, plane, &newton).ok()?;
        let is_between = self.identity.passes(&mut self.problem, &newton, [&a, &b], &y);
        if is_between { self.problem.decode(&y).ok() } else { None }
    }
}
