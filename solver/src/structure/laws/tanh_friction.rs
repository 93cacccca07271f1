//! Dry friction regularised by a hyperbolic tangent.

use super::{Before, Instant, Law, ParameterError, Pattern, Response, require_positive};
use serde::{Deserialize, Serialize};

/// Regularised Coulomb friction at constant normal load, f = F tanh(v/v₀).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TanhFriction {
    /// Sliding force F, in N.
    pub limit: f64,
    /// Regularisation velocity v₀, in m/s.
    pub velocity: f64,
}

impl Law for TanhFriction {
    fn arguments(&self) -> usize {
        1
    }

    fn pattern(&self) -> Pattern {
        Pattern::scalar(false, true)
    }

    fn turnover(&self) -> Option<f64> {
        Some(self.velocity)
    }

    fn is_odd(&self) -> bool {
        true
    }

    fn stiffness_bound(&self) -> f64 {
        0.0
    }

    fn damping_bound(&self) -> f64 {
        self.limit / self.velocity
    }

    fn validate(&self) -> Result<(), ParameterError> {
        require_positive("limit", self.limit)?;
        require_positive("velocity", self.velocity)
    }

    #[inline]
    fn respond(&self, now: &Instant, _: &Before) -> Response {
        let mut r = Response::default();
        let t = (now.v[0] / self.velocity).tanh();
        r.force[0] = self.limit * t;
        r.dv[0][0] = self.limit / self.velocity * (1.0 - t * t);
        r
    }

    #[inline]
    fn respond_along(&self, now: &Instant, _: &Before, along: &Instant, _: &Before) -> Response {
        let mut r = Response::default();
        let t = (now.v[0] / self.velocity).tanh();
        let rate = (1.0 - t * t) * along.v[0] / self.velocity;
        r.force[0] = self.limit * rate;
        r.dv[0][0] = -2.0 * t * rate * self.limit / self.velocity;
        r
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::laws::check::{Scales, check_gradients};

    #[test]
    fn derivatives_match_central_differences() {
        let scales = Scales { u: [1e-3; 3], v: [0.3; 3], speed: 1e3, force: 10.0 };
        check_gradients(&TanhFriction { limit: 10.0, velocity: 0.1 }, &scales);
    }

    #[test]
    fn it_saturates_at_the_limit() {
        let law = TanhFriction { limit: 10.0, velocity: 0.1 };
        let force = |v| law.respond(&Instant { v: [v, 0.0, 0.0], ..Instant::default() }, &Before::default()).force[0];
        assert_eq!([force(-5.0), force(0.0), force(5.0)], [-10.0, 0.0, 10.0]);
        assert!(TanhFriction { limit: 1.0, velocity: 0.0 }.validate().is_err());
    }
}
