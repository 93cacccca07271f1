//! Symmetries that a curve keeps.

use crate::curve::problem::{Problem, SAME_IMAGE, norm};

/// The images of a problem that leave a state as it is, besides the state itself. All of the curve through it has them, up to
/// where others branch off: there the tangent is undetermined in their direction, and a walk that is not kept from it goes on
/// along whichever curve rounding chooses.
#[derive(Debug, Clone, Default)]
pub struct Stabiliser(Vec<usize>);

impl Stabiliser {
    /// Of a state.
    pub fn of<P: Problem>(problem: &P, y: &[f64]) -> Self {
        let metric = problem.motion_metric();
        let is_same = |index: &usize| {
            let apart: Vec<f64> = problem.image(y, *index).iter().zip(y).map(|(a, b)| a - b).collect();
            norm(metric, &apart) <= SAME_IMAGE * norm(metric, y)
        };
        Self((1..problem.images()).filter(is_same).collect())
    }

    /// Takes out of a point and its unit tangent what is not symmetric.
    pub fn keep<P: Problem>(&self, problem: &P, y: &mut [f64], tangent: &mut [f64]) {
        if self.0.is_empty() {
            return;
        }
        self.project(problem, y);
        self.project(problem, tangent);
        let length = norm(problem.metric(), tangent);
        tangent.iter_mut().for_each(|t| *t /= length);
    }

    /// Makes of a state, or a direction, the mean of its images.
    pub fn project<P: Problem>(&self, problem: &P, y: &mut [f64]) {
        let images: Vec<Vec<f64>> = self.0.iter().map(|&index| problem.image(y, index)).collect();
        let share = 1.0 / (images.len() + 1) as f64;
        for (i, y) in y.iter_mut().enumerate() {
            *y = share * (*y + images.iter().map(|image| image[i]).sum::<f64>());
        }
    }
}
