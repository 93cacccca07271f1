//! On which side of the motions that are their own images a walk is.

use crate::curve::problem::{Problem, SAME_IMAGE, inner, norm};

/// Cosines between the differences of two neighbouring motions from an image: from the larger one on they lie on the same side of the
/// motions that are their own images, up to the smaller one on opposite sides.
const SAME: f64 = 0.5;
const OPPOSITE: f64 = -0.9;

/// Where a motion is, as seen from its neighbour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Side {
    /// On the same side of all motions that are their own images, or both are.
    Same,
    /// It is its own image of this number, which its neighbour is not: the curve meets such motions, or comes so near to them that a step
    /// has led onto them.
    Neither(usize),
    /// Beyond one that is its own image of this number; or a step has led over the place where the curve comes next to such motions
    /// without meeting them, and onto an image of it.
    Opposite(usize),
    /// The step is too long to tell.
    Unknown,
}

impl Side {
    /// The side that `to` is on as seen from `from`; of what several images tell, the last one counts.
    pub(crate) fn of<P: Problem>(problem: &P, from: &[f64], to: &[f64]) -> Self {
        let metric = problem.motion_metric();
        let of_image = |index| {
            let (before, after) = (away(problem, from, index), away(problem, to, index));
            let [length, next] = [&before, &after].map(|away| norm(metric, away));
            if length <= SAME_IMAGE * norm(metric, from) {
                return Self::Same;
            }
            if next <= SAME_IMAGE * norm(metric, to) {
                return Self::Neither(index);
            }
            match inner(metric, &before, &after) / (length * next) {
                cosine if cosine >= SAME => Self::Same,
                cosine if cosine <= OPPOSITE => Self::Opposite(index),
                _ => Self::Unknown,
            }
        };
        (1..problem.images()).map(of_image).max().unwrap_or(Self::Same)
    }
}

/// From a motion to its image of this number.
pub(crate) fn away<P: Problem>(problem: &P, y: &[f64], index: usize) -> Vec<f64> {
    problem.image(y, index).iter().zip(y).map(|(image, y)| image - y).collect()
}

/// How far a motion is from its image of this number.
pub(super) fn distance<P: Problem>(problem: &P, y: &[f64], index: usize) -> f64 {
    norm(problem.motion_metric(), &away(problem, y, index))
}
