//! From a branch point of a curve onto the curve that crosses it there.
//!
//! Along a curve the determinant of the Jacobian bordered by the tangent changes its sign where another curve crosses (H. B. Keller,
//! Applications of Bifurcation Theory, 359–384, 1977). There the Jacobian has two null directions. One is the tangent; the other one is taken
//! from the Jacobian at states beside the curve, whose null direction lies in the plane of both: no second derivatives are asked for.

use crate::curve::newton::{Constraint, Newton, NewtonSettings};
use crate::curve::point::direction_at;
use crate::curve::problem::{Problem, inner, norm, weighted};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// How far beside the curve the Jacobian is asked, as a share of the motion.
const ASIDE: f64 = 1e-3;

/// How many states beside the curve are tried.
const TRIES: u64 = 4;

/// Least sine of the angle between tangent and null direction there, for the second null direction to be told by it.
const TOLD: f64 = 1e-2;

/// How far along the second null direction the other curve is looked for, as shares of the motion, in this order.
const SHARES: [f64; 5] = [0.03, 0.1, 0.01, 0.3, 0.003];

/// How far from there it may be met, as a share of the way.
const NEAR: f64 = 2.0;

/// The sides of a branch point on which the other curve is looked for.
pub const SIDES: [f64; 2] = [1.0, -1.0];

/// A curve that crosses another one.
pub struct Crossing<'c> {
    /// Where they cross.
    from: &'c [f64],
    /// Unit vector along the one that crosses, normal to the other one.
    across: Vec<f64>,
}

impl<'c> Crossing<'c> {
    /// At a branch point of a curve with this unit tangent; `None` if the Jacobian does not tell the second null direction.
    pub fn at<P: Problem>(problem: &mut P, from: &'c [f64], tangent: &[f64]) -> Option<Self> {
        let row = weighted(problem.metric(), tangent);
        let motion = problem.motion_metric().len();
        let size = ASIDE * norm(problem.motion_metric(), from);
        let across = (0..TRIES).find_map(|seed| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let mut aside: Vec<f64> = (0..from.len()).map(|_| random.gen_range(-1.0..1.0)).collect();
            aside[motion..].fill(0.0);
            let length = norm(problem.metric(), &aside);
            let beside = from.iter().zip(&aside).map(|(y, aside)| y + size / length * aside).collect();
            let direction = direction_at(problem, beside, &row)?;
            let cosine = inner(problem.metric(), &direction, tangent);
            let normal: Vec<f64> = direction.iter().zip(tangent).map(|(direction, t)| direction - cosine * t).collect();
            let sine = norm(problem.metric(), &normal);
            (sine > TOLD).then(|| normal.iter().map(|entry| entry / sine).collect())
        });
        across.map(|across| Self { from, across })
    }

    /// The way onto the curve on one of the two sides.
    pub fn way(&self, side: f64) -> Vec<f64> {
        self.across.iter().map(|entry| side * entry).collect()
    }

    /// A solution on one of the two sides that `is_new`, in a plane normal to the way.
    pub fn beside<P: Problem>(
        &self,
        problem: &mut P,
        settings: &NewtonSettings,
        side: f64,
        is_new: &mut dyn FnMut(&mut P, &[f64]) -> bool,
    ) -> Option<Vec<f64>> {
        let way = self.way(side);
        let row = weighted(problem.metric(), &way);
        SHARES.into_iter().find_map(|share| {
            let length = share * norm(problem.motion_metric(), self.from);
            let predicted: Vec<f64> = self.from.iter().zip(&way).map(|(from, way)| from + length * way).collect();
            let mut y = predicted.clone();
            let constraint = Constraint::Hyperplane { row: &row, origin: &predicted };
            Newton::default().solve(problem, &mut y, constraint, settings).ok()?;
            let missed: Vec<f64> = y.iter().zip(&predicted).map(|(y, predicted)| y - predicted).collect();
            let is_near = norm(problem.metric(), &missed) <= NEAR * length;
            (is_near && is_new(problem, &y)).then_some(y)
        })
    }
}
