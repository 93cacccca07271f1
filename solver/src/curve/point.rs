//! Points of a curve, as its continuation needs them.

/// A converged point of the curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePoint {
    /// Scaled state.
    pub y: Vec<f64>,
    /// Unit tangent in the direction of travel.
    pub tangent: Vec<f64>,
    /// Newton iterations.
    pub iterations: usize,
    /// Factorisations they needed.
    pub factorisations: usize,
    /// Largest scaled residual.
    pub residual: f64,
    /// Sign of the bordered Jacobian's determinant; a change between points marks a bifurcation.
    pub orientation: f64,
    /// Arc length of the step that led here.
    pub step: f64,
}

impl CurvePoint {
    /// Whether it is one of a state of this length, with finite numbers.
    pub(super) fn is_of(&self, length: usize) -> bool {
        let is_whole = |values: &[f64]| values.len() == length && values.iter().all(|value| value.is_finite());
        is_whole(&self.y) && is_whole(&self.tangent)
    }
}
