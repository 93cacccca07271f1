//! Rigid unilateral contact with permanent-sliding friction, by the dynamic Lagrangian frequency–time method (DLFT).

use super::{Before, Instant, Law, ParameterError, Pattern, Response, RigidContact, require};
use serde::{Deserialize, Serialize};

/// Rigid unilateral contact (gap g = c − x_N ≥ 0, pressure λ ≥ 0, λ g = 0).
///
/// Argument 0 is the predicted pressure p = λ − ε g in N, so that λ = max(0, p) whatever the unknowns of the
/// formulation are; arguments 1 and 2 are the tangential displacements. Paper equations [16–19], [33, 34].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Clearance at rest c, in m.
    pub gap: f64,
    /// Numerical stiffness ε of the prediction, in N/m: changes the filtering of the truncated series, not its limit.
    pub epsilon: f64,
    /// Friction, if the node has tangential dofs and a coefficient above zero.
    pub friction: Option<Friction>,
}

/// Permanent sliding of a blade tip on its casing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// Coefficient μ.
    pub coefficient: f64,
    /// Radius ρ of the node, in m.
    pub radius: f64,
    /// σ = ±1: sign of the node's sliding velocity relative to the casing along its first tangential dof.
    pub sense: f64,
}

impl Law for Contact {
    fn arguments(&self) -> usize {
        if self.friction.is_some() { 3 } else { 1 }
    }

    fn pattern(&self) -> Pattern {
        let mut pattern = Pattern::scalar(true, false);
        if self.friction.is_some() {
            for i in [1, 2] {
                pattern.du[i][0] = true;
                pattern.dv[i][1] = true;
                pattern.dv[i][2] = true;
            }
        }
        pattern
    }

    fn threshold(&self) -> Option<f64> {
        Some(0.0)
    }

    fn is_homogeneous_in_rate(&self) -> bool {
        true
    }

    fn rigid(&self) -> Option<RigidContact<'_>> {
        Some(RigidContact { gap: self.gap, epsilon: self.epsilon, friction: self.friction.as_ref() })
    }

    fn clearance(&self) -> Option<f64> {
        Some(self.gap)
    }

    /// Zero: its pressures are solved for.
    fn stiffness_bound(&self) -> f64 {
        0.0
    }

    fn damping_bound(&self) -> f64 {
        0.0
    }

    fn validate(&self) -> Result<(), ParameterError> {
        let clearance = self.gap >= 0.0 && self.gap.is_finite();
        require("gap", self.gap, clearance, "a clearance in m, zero or above")?;
        require(
            "epsilon",
            self.epsilon,
            self.epsilon > 0.0 && self.epsilon.is_finite(),
            "a finite N/m value above zero",
        )?;
        if let Some(Friction { coefficient, radius, sense }) = self.friction {
            let sliding = coefficient > 0.0 && coefficient.is_finite();
            require("friction.coefficient", coefficient, sliding, "above zero (leave `friction` out for none)")?;
            require("friction.radius", radius, radius > 0.0 && radius.is_finite(), "a finite radius above zero, in m")?;
            require("friction.sense", sense, sense.abs() == 1.0, "1 or -1")?;
        }
        Ok(())
    }

    #[inline]
    fn respond(&self, now: &Instant, _: &Before) -> Response {
        let mut r = Response::default();
        let pressure = now.u[0];
        if pressure <= 0.0 {
            return r;
        }
        r.force[0] = pressure;
        r.du[0][0] = 1.0;
        if let Some(friction) = &self.friction {
            let slide = friction.sense * friction.radius;
            let v = [now.v[1] + slide * now.speed, now.v[2]];
            let norm = v[0].hypot(v[1]);
            let w = [v[0] / norm, v[1] / norm];
            let scale = friction.coefficient * pressure / norm;
            for i in 0..2 {
                r.force[i + 1] = friction.coefficient * pressure * w[i];
                r.du[i + 1][0] = friction.coefficient * w[i];
                for j in 0..2 {
                    let identity = if i == j { 1.0 } else { 0.0 };
                    r.dv[i + 1][j + 1] = scale * (identity - w[i] * w[j]);
                }
                r.dspeed[i + 1] = r.dv[i + 1][1] * slide;
            }
        }
        r
    }

    #[inline]
    fn respond_along(&self, now: &Instant, _: &Before, along: &Instant, _: &Before) -> Response {
        let mut r = Response::default();
        let pressure = now.u[0];
        if pressure <= 0.0 {
            return r;
        }
        r.force[0] = along.u[0];
        if let Some(friction) = &self.friction {
            let slide = friction.sense * friction.radius;
            let v = [now.v[1] + slide * now.speed, now.v[2]];
            let dv = [along.v[1] + slide * along.speed, along.v[2]];
            let norm = v[0].hypot(v[1]);
            let w = [v[0] / norm, v[1] / norm];
            let dnorm = w[0] * dv[0] + w[1] * dv[1];
            let dw = [(dv[0] - w[0] * dnorm) / norm, (dv[1] - w[1] * dnorm) / norm];
            let scale = friction.coefficient * pressure / norm;
            let dscale = (friction.coefficient * along.u[0] - scale * dnorm) / norm;
            for i in 0..2 {
                r.force[i + 1] = friction.coefficient * (along.u[0] * w[i] + pressure * dw[i]);
                r.du[i + 1][0] = friction.coefficient * dw[i];
                for j in 0..2 {
                    let identity = if i == j { 1.0 } else { 0.0 };
                    r.dv[i + 1][j + 1] = dscale * (identity - w[i] * w[j]) - scale * (dw[i] * w[j] + w[i] * dw[j]);
                }
                r.dspeed[i + 1] = r.dv[i + 1][1] * slide;
            }
        }
        r
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::laws::check::{Scales, check_gradients};

    /// Sliding speed and local velocities of the same order: no derivative is negligible.
    const SCALES: Scales = Scales { u: [1e3, 1e-4, 1e-4], v: [0.5, 0.4, 0.3], speed: 20.0, force: 1e3 };

    fn contact(friction: Option<Friction>) -> Contact {
        Contact { gap: 4e-4, epsilon: 1e7, friction }
    }

    #[test]
    fn derivatives_match_central_differences() {
        check_gradients(&contact(None), &SCALES);
        for sense in [1.0, -1.0] {
            check_gradients(&contact(Some(Friction { coefficient: 0.15, radius: 0.03, sense })), &SCALES);
        }
    }

    #[test]
    fn friction_has_magnitude_mu_lambda_along_the_sliding_velocity() {
        let law = contact(Some(Friction { coefficient: 0.15, radius: 0.25, sense: -1.0 }));
        let now = Instant { u: [200.0, 0.0, 0.0], speed: 2000.0, ..Instant::default() };
        let force = law.respond(&now, &Before::default()).force;
        assert_eq!(force, [200.0, -0.15 * 200.0, 0.0]);
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        let law = contact(Some(Friction { coefficient: 0.15, radius: 0.25, sense: 0.5 }));
        assert_eq!(law.validate().unwrap_err().to_string(), "friction.sense = 0.5 is out of range: expected 1 or -1");
        assert!(contact(None).validate().is_ok());
        assert!(Contact { epsilon: 0.0, ..contact(None) }.validate().is_err());
    }
}
