//! Elastic dry friction: the Jenkins element.

use super::{Before, Instant, Law, ParameterError, Pattern, Response, Slider, require_positive};
use serde::{Deserialize, Serialize};

/// A spring in series with a Coulomb slider: f = clip(f₋ + k (u − u₋), ±F), where f₋ and u₋ are those of the instant
/// before. Hysteresis at any rate: the force depends on the path, not on the velocity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Jenkins {
    /// Stiffness k of the spring, in N/m.
    pub stiffness: f64,
    /// Sliding force F, in N.
    pub limit: f64,
}

impl Law for Jenkins {
    fn arguments(&self) -> usize {
        1
    }

    fn pattern(&self) -> Pattern {
        Pattern::scalar(true, false)
    }

    fn has_memory(&self) -> bool {
        true
    }

    fn slider(&self) -> Option<Slider> {
        Some(Slider { stiffness: self.stiffness, limit: self.limit })
    }

    fn is_odd(&self) -> bool {
        true
    }

    fn validate(&self) -> Result<(), ParameterError> {
        require_positive("stiffness", self.stiffness)?;
        require_positive("limit", self.limit)
    }

    fn stiffness_bound(&self) -> f64 {
        self.stiffness
    }

    fn damping_bound(&self) -> f64 {
        0.0
    }

    #[inline]
    fn respond(&self, now: &Instant, before: &Before) -> Response {
        let mut r = Response::default();
        let stuck = before.force + self.stiffness * (now.u[0] - before.u);
        if stuck.abs() <= self.limit {
            r.force[0] = stuck;
            r.du[0][0] = self.stiffness;
            r.du_before = -self.stiffness;
            r.dforce_before = 1.0;
        } else {
            r.force[0] = self.limit.copysign(stuck);
        }
        r
    }

    #[inline]
    fn respond_along(&self, now: &Instant, before: &Before, along: &Instant, before_along: &Before) -> Response {
        let mut r = Response::default();
        if (before.force + self.stiffness * (now.u[0] - before.u)).abs() <= self.limit {
            r.force[0] = before_along.force + self.stiffness * (along.u[0] - before_along.u);
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
        check_gradients(&Jenkins { stiffness: 1e6, limit: 600.0 }, &scales);
    }

    #[test]
    fn a_full_cycle_dissipates_the_area_of_its_hysteresis_loop() {
        let law = Jenkins { stiffness: 100.0, limit: 1.0 };
        let (amplitude, samples) = (0.05, 20_000);
        let mut before = Before { u: amplitude, force: law.limit };
        let mut work = 0.0;
        for i in 1..=samples {
            let u = amplitude * (std::f64::consts::TAU * f64::from(i) / f64::from(samples)).cos();
            let force = law.respond(&Instant { u: [u, 0.0, 0.0], ..Instant::default() }, &before).force[0];
            work += 0.5 * (force + before.force) * (u - before.u);
            before = Before { u, force };
        }
        // Parallelogram of height 2F and width 2(U − F/k); the trapezoidal rule only errs where sliding starts.
        let area = 4.0 * law.limit * (amplitude - law.limit / law.stiffness);
        assert!((work - area).abs() < 1e-6 * area, "{work} against {area}");
    }
}
