//! Whether there is a motion that is its own image between two points of a curve on opposite sides of such motions.
//!
//! Subharmonic responses of three periods of the force come next to the main branch where its multipliers are near the third roots of one,
//! as near as damping lets them, and the difference from their images turns by 60° there: from afar they seem to pass through it,
//! and a step leads over that place onto an image of the curve (on the strong resonance 1:3, Kuznetsov, Elements of Applied
//! Bifurcation Theory, §9.5).

use super::Continuation;
use crate::curve::point::CurvePoint;
use crate::curve::problem::{Problem, SAME_IMAGE, norm};
use crate::curve::sides::{Side, distance};

/// Share of the way to where nothing is left of the distance from an image that a probe goes, as far as its last change tells.
const AIM: f64 = 0.9;

/// Most probes, and how often one that leads elsewhere is taken half as long.
const PROBES: usize = 20;
const HALVINGS: usize = 4;

/// What a probe leaves of the distance at most.
const LEAVES: f64 = 0.8;

/// Distance from an image, in those of motions that are their own, below which Newton's method may not get any nearer.
const NEXT_TO: f64 = 10.0;

/// Where no probe converges: what is left of the distance, as a share of what it was, if a motion is met that is its own image. Newton's
/// method fails next to it.
const LEFT: f64 = 1e-2;

impl<P: Problem> Continuation<'_, P> {
    /// Whether the curve meets a motion that is its own image of this number on its way from one point to a neighbour.
    pub(super) fn meets_own_image(&mut self, from: &CurvePoint, to: &CurvePoint, index: usize) -> bool {
        let [first, beyond] = [from, to].map(|point| distance(self.problem, &point.y, index));
        let (mut at, mut left, mut ahead) = (from.clone(), first, self.step * first / (first + beyond));
        let mut comes_no_nearer = false;
        for _ in 0..PROBES {
            if left <= NEXT_TO * SAME_IMAGE * norm(self.problem.motion_metric(), &at.y) {
                return true;
            }
            let nearer = (0..HALVINGS).find_map(|halvings| {
                let point = self.correct(&at, None, AIM * ahead * 0.5_f64.powi(halvings as i32)).ok()?;
                let next = distance(self.problem, &point.y, index);
                let is_on_curve = self.problem.are_neighbours(&at.y, &point.y)
                    && Side::of(self.problem, &at.y, &point.y) == Side::Same;
                comes_no_nearer |= is_on_curve && next >= LEAVES * left;
                (is_on_curve && next < LEAVES * left).then_some((point, next))
            });
            let Some((point, next)) = nearer else { break };
            ahead = point.step * next / (left - next);
            (at, left, comes_no_nearer) = (point, next, false);
        }
        left < LEFT * first && !comes_no_nearer
    }
}
