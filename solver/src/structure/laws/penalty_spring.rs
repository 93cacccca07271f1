//! Unilateral penalty spring: an elastic stop behind a gap.

use super::{Before, Instant, Law, ParameterError, Pattern, Response, require, require_positive};
use serde::{Deserialize, Serialize};

/// Elastic stop, f = k max(0, u − g).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PenaltySpring {
    /// Stiffness k, in N/m.
    pub stiffness: f64,
    /// Gap g, in m; below zero the spring is pressed at rest.
    pub gap: f64,
}

impl Law for PenaltySpring {
    fn arguments(&self) -> usize {
        1
    }

    fn pattern(&self) -> Pattern {
        Pattern::scalar(true, false)
    }

    fn threshold(&self) -> Option<f64> {
        Some(self.gap)
    }

    fn clearance(&self) -> Option<f64> {
        Some(self.gap)
    }

    fn stiffness_bound(&self) -> f64 {
        self.stiffness
    }

    fn damping_bound(&self) -> f64 {
        0.0
    }

    fn validate(&self) -> Result<(), ParameterError> {
        require_positive("stiffness", self.stiffness)?;
        require("gap", self.gap, self.gap.is_finite(), "a finite gap in m")
    }

    #[inline]
    fn respond(&self, now: &Instant, _: &Before) -> Response {
        let mut r = Response::default();
        let penetration = now.u[0] - self.gap;
        if penetration > 0.0 {
            r.force[0] = self.stiffness * penetration;
            r.du[0][0] = self.stiffness;
        }
        r
    }

    #[inline]
    fn respond_along(&self, now: &Instant, _: &Before, along: &Instant, _: &Before) -> Response {
        let mut r = Response::default();
        if now.u[0] > self.gap {
            r.force[0] = self.stiffness * along.u[0];
        }
        r
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::laws::check::{Scales, check_gradients};

    #[test]
    fn derivatives_match_central_differences() {
        let scales = Scales { u: [1e-3; 3], v: [1.0; 3], speed: 1e3, force: 1e3 };
        check_gradients(&PenaltySpring { stiffness: 1e6, gap: 2e-4 }, &scales);
    }

    #[test]
    fn it_pushes_back_beyond_the_gap_only() {
        let law = PenaltySpring { stiffness: 10.0, gap: 0.5 };
        let force = |u| law.respond(&Instant { u: [u, 0.0, 0.0], ..Instant::default() }, &Before::default()).force[0];
        assert_eq!([force(-2.0), force(0.5), force(1.0)], [0.0, 0.0, 5.0]);
        assert!(PenaltySpring { stiffness: -1.0, gap: 0.0 }.validate().is_err());
    }
}
