//! Curves of free motions that are known, so that none is followed twice.

use crate::curve::identity::Identity;
use crate::curve::newton::NewtonSettings;
use crate::curve::problem::{Problem, inner};
use crate::curve::walk::{TracedCurve, relative_distance};
use crate::response::branch::{BranchPoint, Outcome};

/// Relative distance of a motion from a multiple of the linear one, up to which it is that.
const LINEAR: f64 = 1e-6;

/// A backbone, and what crosses it as far as that is known.
pub(super) struct Known<'c> {
    /// The first motion of the backbone: smaller ones are multiples of it.
    linear: &'c [f64],
    /// The points of every curve, and whether it is closed.
    curves: Vec<(Vec<&'c [f64]>, bool)>,
    settings: NewtonSettings,
    identity: Identity,
}

impl<'c> Known<'c> {
    /// Of a backbone and the curves across that were found.
    pub fn new(
        first: &'c TracedCurve<BranchPoint>,
        across: impl Iterator<Item = &'c TracedCurve<BranchPoint>>,
        settings: NewtonSettings,
    ) -> Self {
        let points = |curve: &'c TracedCurve<BranchPoint>| {
            let points = curve.visited.iter().map(|visited| &visited.curve.y[..]).collect();
            (points, curve.outcome == Outcome::Closed)
        };
        let curves = std::iter::once(first).chain(across).map(points).collect();
        Self { linear: &first.visited[0].curve.y, curves, settings, identity: Identity::default() }
    }

    /// Whether a motion, or an image of it, is on one of them.
    pub fn has<P: Problem>(&mut self, problem: &mut P, y: &[f64]) -> bool {
        self.is_linear(problem, y)
            || self.curves.iter().any(|(points, is_closed)| {
                self.identity.position(problem, &self.settings, points, *is_closed, y).is_some()
            })
    }

    fn is_linear<P: Problem>(&self, problem: &P, y: &[f64]) -> bool {
        let metric = problem.motion_metric();
        let share = inner(metric, y, self.linear) / inner(metric, self.linear, self.linear);
        let multiple: Vec<f64> = self.linear.iter().map(|entry| share * entry).collect();
        share.abs() < 1.0 && relative_distance(metric, &multiple, y) < LINEAR
    }
}
