//! Dry friction regularised by a hyperbolic tangent.

use super::{Before, Instant, Law, MeanForce, ParameterError, Pattern, Response, require_positive};
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

/// Change of velocity, over v₀, up to which [`GAUSS`] is exact to rounding; beyond it the closed form is taken.
const SLOW: f64 = 0.1;

/// Points, over half the interval, and halved weights of the Gauss–Legendre formula of four points.
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.173_927_422_568_726_93),
    (-0.339_981_043_584_856_3, 0.326_072_577_431_273_07),
    (0.339_981_043_584_856_3, 0.326_072_577_431_273_07),
    (0.861_136_311_594_052_6, 0.173_927_422_568_726_93),
];

/// ln cosh x − |x| + ln 2: next to nothing where |x| is large.
fn tail(x: f64) -> f64 {
    (-2.0 * x.abs()).exp().ln_1p()
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

    fn mean_force(&self, velocities: [f64; 2]) -> Option<MeanForce> {
        let [a, b] = velocities.map(|v| v / self.velocity);
        let scale = self.limit / self.velocity;
        if (b - a).abs() > SLOW {
            // Without a change of sign the first part is ±1 but for rounding.
            let straight = if a * b >= 0.0 { (a + b).signum() } else { (b.abs() - a.abs()) / (b - a) };
            let mean = straight + (tail(b) - tail(a)) / (b - a);
            let by = |end: f64, sign: f64| sign * (end.tanh() - mean) / (b - a) * scale;
            return Some(MeanForce { force: self.limit * mean, by_velocity: [by(a, -1.0), by(b, 1.0)] });
        }
        let mut mean = MeanForce { force: 0.0, by_velocity: [0.0; 2] };
        for (point, weight) in GAUSS {
            let share = 0.5 * (1.0 + point);
            let t = (a + share * (b - a)).tanh();
            mean.force += self.limit * weight * t;
            let slope = scale * weight * (1.0 - t * t);
            mean.by_velocity[0] += (1.0 - share) * slope;
            mean.by_velocity[1] += share * slope;
        }
        Some(mean)
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
    fn mean_forces_are_those_of_many_instants() {
        let law = TanhFriction { limit: 10.0, velocity: 0.1 };
        let force = |v| law.respond(&Instant { v: [v, 0.0, 0.0], ..Instant::default() }, &Before::default()).force[0];
        for velocities in [[-0.3, 2.0], [5.0, -7.0], [0.04, 0.04], [0.03, 0.0499], [-0.01, 0.0101], [0.7, 0.72]] {
            let mean = |[a, b]: [f64; 2]| {
                let count = 20_000;
                let at = |i: i32| force(a + (b - a) * (f64::from(i) + 0.5) / f64::from(count));
                (0..count).map(at).sum::<f64>() / f64::from(count)
            };
            let found = law.mean_force(velocities).unwrap();
            assert!((found.force - mean(velocities)).abs() < 1e-6, "{velocities:?}: {found:?}");
            for i in 0..2 {
                let beside = |by: f64| {
                    let mut velocities = velocities;
                    velocities[i] += by;
                    law.mean_force(velocities).unwrap().force
                };
                let slope = (beside(1e-5) - beside(-1e-5)) / 2e-5;
                assert!((found.by_velocity[i] - slope).abs() < 1e-5, "{velocities:?}: {found:?}, not {slope}");
            }
        }
    }

    #[test]
    fn the_two_ways_to_a_mean_force_meet() {
        let law = TanhFriction { limit: 1.0, velocity: 1.0 };
        for from in [-2.0, -0.1, 0.0, 0.3, 1.0, 30.0] {
            let [below, above] =
                [SLOW * (1.0 - 1e-9), SLOW * (1.0 + 1e-9)].map(|by| law.mean_force([from, from + by]).unwrap());
            // The velocities are 2e-10 apart.
            assert!((below.force - above.force).abs() < 2e-10);
            let apart = |i: usize| (below.by_velocity[i] - above.by_velocity[i]).abs();
            assert!(apart(0).max(apart(1)) < 2e-10, "{from}: {below:?} and {above:?}");
        }
        for (from, to) in [(1e4, 1.1e4), (-30.0, -50.0)] {
            let sliding = MeanForce { force: f64::signum(from), by_velocity: [0.0; 2] };
            assert_eq!(law.mean_force([from, to]).unwrap(), sliding);
        }
    }

    #[test]
    fn it_saturates_at_the_limit() {
        let law = TanhFriction { limit: 10.0, velocity: 0.1 };
        let force = |v| law.respond(&Instant { v: [v, 0.0, 0.0], ..Instant::default() }, &Before::default()).force[0];
        assert_eq!([force(-5.0), force(0.0), force(5.0)], [-10.0, 0.0, 10.0]);
        assert!(TanhFriction { limit: 1.0, velocity: 0.0 }.validate().is_err());
    }
}
