//! Settings of a continuation.

use crate::curve::newton::NewtonSettings;
use serde::{Deserialize, Serialize};

/// Direction in which the next point is predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Predictor {
    /// Tangent, from the Jacobian already factorised.
    #[default]
    Tangent,
    /// Secant through the last two points (paper \[7\]).
    Secant,
}

/// Scalar equation of the corrector.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Corrector {
    /// Keller's hyperplane normal to the predictor.
    #[default]
    Hyperplane,
    /// Sphere round the last point (paper \[8\]).
    Sphere,
}

/// Settings of the continuation; steps are scaled arc lengths.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ContinuationSettings {
    /// First step. Default 0.02.
    pub initial_step: f64,
    /// Smallest step: a branch that needs a smaller one has stalled. Default 1e-7. Where the problem itself allows no more
    /// than a shorter step than `max_step`, it is smaller by as much.
    pub min_step: f64,
    /// Largest step. Default 0.1. Of forced responses whose state, frequency and means included, is larger than five times its scales, a
    /// fifth of that size times as much.
    pub max_step: f64,
    /// Factorisations a point that leave the step as it is. Default 2.
    pub target_factorisations: usize,
    /// Smallest cosine between a step and the tangent it started with. Default 0.9.
    pub min_cosine: f64,
    /// Predictor. Default tangent.
    pub predictor: Predictor,
    /// Corrector. Default hyperplane.
    pub corrector: Corrector,
    /// Newton's method.
    pub newton: NewtonSettings,
}

impl Default for ContinuationSettings {
    fn default() -> Self {
        Self {
            initial_step: 0.02,
            min_step: 1e-7,
            max_step: 0.1,
            target_factorisations: 2,
            min_cosine: 0.9,
            predictor: Predictor::default(),
            corrector: Corrector::default(),
            newton: NewtonSettings { max_iterations: 10, ..NewtonSettings::default() },
        }
    }
}
