//! Polynomial springs and dampers: cubic and others.

use super::{Before, Instant, Law, ParameterError, Pattern, Response, require};
use serde::{Deserialize, Serialize};

/// One term c z^p.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Term {
    /// Power p, ≥ 1.
    pub power: u32,
    /// Coefficient c, in N/m^p (springs) or N/(m/s)^p (dampers).
    pub coefficient: f64,
}

/// Polynomial spring, f = Σ c u^p.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PolynomialSpring {
    /// Terms of the force in the displacement.
    pub terms: Vec<Term>,
}

/// Polynomial damper, f = Σ c v^p.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PolynomialDamper {
    /// Terms of the force in the velocity.
    pub terms: Vec<Term>,
}

/// Largest power: beyond it, a force is better described by another law.
const MAX_POWER: u32 = 15;

/// Value and derivative of Σ c z^p.
#[inline]
fn evaluate(terms: &[Term], z: f64) -> (f64, f64) {
    terms.iter().fold((0.0, 0.0), |(value, slope), &Term { power, coefficient }| {
        let below = coefficient * z.powi(power as i32 - 1);
        (value + below * z, slope + f64::from(power) * below)
    })
}

/// Derivatives of value and slope of Σ c z^p along `along`.
#[inline]
fn evaluate_along(terms: &[Term], z: f64, along: f64) -> (f64, f64) {
    let curvature = terms
        .iter()
        .filter(|term| term.power > 1)
        .map(|&Term { power, coefficient }| f64::from(power * (power - 1)) * coefficient * z.powi(power as i32 - 2));
    (evaluate(terms, z).1 * along, curvature.sum::<f64>() * along)
}

/// Slope of the linear terms: that of the others depends on the motion.
fn linear(terms: &[Term]) -> f64 {
    terms.iter().filter(|term| term.power == 1).map(|term| term.coefficient.abs()).sum()
}

fn is_odd(terms: &[Term]) -> bool {
    terms.iter().all(|term| term.power % 2 == 1)
}

fn degree(terms: &[Term]) -> Option<u32> {
    terms.iter().map(|term| term.power).max()
}

fn validate(terms: &[Term]) -> Result<(), ParameterError> {
    require("terms", "[]", !terms.is_empty(), "at least one term, like {power = 3, coefficient = 1}")?;
    for (index, &Term { power, coefficient }) in terms.iter().enumerate() {
        require("power", power, (1..=MAX_POWER).contains(&power), "a whole number from 1 to 15")
            .and_then(|()| require("coefficient", coefficient, coefficient.is_finite(), "a finite number"))
            .map_err(|e| ParameterError { parameter: format!("terms[{index}].{}", e.parameter).into(), ..e })?;
    }
    Ok(())
}

impl Law for PolynomialSpring {
    fn arguments(&self) -> usize {
        1
    }

    fn pattern(&self) -> Pattern {
        Pattern::scalar(true, false)
    }

    fn is_odd(&self) -> bool {
        is_odd(&self.terms)
    }

    fn degree(&self) -> Option<u32> {
        degree(&self.terms)
    }

    fn stiffness_bound(&self) -> f64 {
        linear(&self.terms)
    }

    fn damping_bound(&self) -> f64 {
        0.0
    }

    fn validate(&self) -> Result<(), ParameterError> {
        validate(&self.terms)
    }

    #[inline]
    fn respond(&self, now: &Instant, _: &Before) -> Response {
        let mut r = Response::default();
        (r.force[0], r.du[0][0]) = evaluate(&self.terms, now.u[0]);
        r
    }

    #[inline]
    fn respond_along(&self, now: &Instant, _: &Before, along: &Instant, _: &Before) -> Response {
        let mut r = Response::default();
        (r.force[0], r.du[0][0]) = evaluate_along(&self.terms, now.u[0], along.u[0]);
        r
    }
}

impl Law for PolynomialDamper {
    fn arguments(&self) -> usize {
        1
    }

    fn pattern(&self) -> Pattern {
        Pattern::scalar(false, true)
    }

    fn is_odd(&self) -> bool {
        is_odd(&self.terms)
    }

    fn degree(&self) -> Option<u32> {
        degree(&self.terms)
    }

    fn stiffness_bound(&self) -> f64 {
        0.0
    }

    fn damping_bound(&self) -> f64 {
        linear(&self.terms)
    }

    fn validate(&self) -> Result<(), ParameterError> {
        validate(&self.terms)
    }

    #[inline]
    fn respond(&self, now: &Instant, _: &Before) -> Response {
        let mut r = Response::default();
        (r.force[0], r.dv[0][0]) = evaluate(&self.terms, now.v[0]);
        r
    }

    #[inline]
    fn respond_along(&self, now: &Instant, _: &Before, along: &Instant, _: &Before) -> Response {
        let mut r = Response::default();
        (r.force[0], r.dv[0][0]) = evaluate_along(&self.terms, now.v[0], along.v[0]);
        r
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::laws::check::{Scales, check_gradients};

    fn terms() -> Vec<Term> {
        [(1, 0.5), (2, -2.0), (3, 4.0), (5, 1.0)].map(|(power, coefficient)| Term { power, coefficient }).to_vec()
    }

    #[test]
    fn derivatives_match_central_differences() {
        let scales = Scales { u: [1.0; 3], v: [1.0; 3], speed: 1e3, force: 1.0 };
        check_gradients(&PolynomialSpring { terms: terms() }, &scales);
        check_gradients(&PolynomialDamper { terms: terms() }, &scales);
    }

    #[test]
    fn values_are_those_of_the_polynomial() {
        assert_eq!(evaluate(&terms(), 2.0), (1.0 - 8.0 + 32.0 + 32.0, 0.5 - 8.0 + 48.0 + 80.0));
        // 0^0 = 1: a linear term keeps its slope at the origin.
        assert_eq!(evaluate(&terms(), 0.0), (0.0, 0.5));
        assert_eq!(evaluate_along(&terms(), 0.0, 3.0), (1.5, -12.0));
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        let law = PolynomialSpring { terms: vec![Term { power: 0, coefficient: 1.0 }] };
        assert_eq!(
            law.validate().unwrap_err().to_string(),
            "terms[0].power = 0 is out of range: expected a whole number from 1 to 15"
        );
        assert!(PolynomialDamper { terms: vec![] }.validate().is_err());
    }
}
