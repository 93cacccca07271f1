//! Rigid unilateral contact with permanent-sliding friction, by the dynamic Lagrangian frequency–time method (DLFT).

use super::{Before, Instant, Law, Pattern, Response};
use serde::{Deserialize, Serialize};

/// Rigid unilateral contact (METHOD: gap g = c − x_N ≥ 0, pressure λ ≥ 0, λ g = 0).
///
/// Argument 0 is the predicted pressure p = λ − ε g in N, so that λ = max(0, p) whatever the unknowns of the
/// formulation are; arguments 1 and 2 are the tangential displacements. Paper equations [16–19], [33, 34].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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

    fn is_homogeneous_in_rate(&self) -> bool {
        true
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
}
