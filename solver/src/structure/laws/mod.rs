//! Nonlinear laws: pure functions of one instant and, for laws with memory, the one before.
//!
//! A law sees up to three *arguments* (relative displacements; for rigid contact the first one is the predicted contact
//! pressure of the DLFT, in newtons) and their time derivatives, and returns as many forces, counted on the left-hand
//! side of the balance D X + F = E, with exact derivatives. Parameters are plain serde structs; the choice of law is
//! made once per element, outside the sample loop.

#[cfg(test)]
mod check;
mod contact;
mod jenkins;
mod penalty_spring;
mod polynomial;
mod tanh_friction;

pub use contact::Friction;
pub use polynomial::Term;

use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt::Display;
use thiserror::Error;

/// Largest number of arguments of a law: normal and two tangential directions.
pub const MAX_ARGUMENTS: usize = 3;

/// What a law sees of one instant.
#[derive(Debug, Clone, Copy, Default)]
pub struct Instant {
    /// Arguments: relative displacements in m (contact: argument 0 is the predicted pressure in N).
    pub u: [f64; MAX_ARGUMENTS],
    /// Time derivatives of the arguments, in m/s.
    pub v: [f64; MAX_ARGUMENTS],
    /// Rotor speed Ω in rad/s: the forcing frequency.
    pub speed: f64,
}

/// What a law with memory sees of the instant before. Laws without memory ignore it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Before {
    /// Argument 0 one sample earlier, in m.
    pub u: f64,
    /// Force 0 one sample earlier, in N.
    pub force: f64,
}

/// Forces and their exact derivatives at one instant.
#[derive(Debug, Clone, Copy, Default)]
pub struct Response {
    /// Forces on the left-hand side of the balance, in N.
    pub force: [f64; MAX_ARGUMENTS],
    /// `∂force[i]/∂u[j]`.
    pub du: [[f64; MAX_ARGUMENTS]; MAX_ARGUMENTS],
    /// `∂force[i]/∂v[j]`.
    pub dv: [[f64; MAX_ARGUMENTS]; MAX_ARGUMENTS],
    /// `∂force[i]/∂speed`.
    pub dspeed: [f64; MAX_ARGUMENTS],
    /// `∂force[0]/∂(argument 0 one sample earlier)`; laws with memory only.
    pub du_before: f64,
    /// `∂force[0]/∂(force 0 one sample earlier)`; laws with memory only.
    pub dforce_before: f64,
}

/// Which derivatives of a law can differ from zero: the others are never transformed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Pattern {
    /// Entries of [`Response::du`].
    pub du: [[bool; MAX_ARGUMENTS]; MAX_ARGUMENTS],
    /// Entries of [`Response::dv`].
    pub dv: [[bool; MAX_ARGUMENTS]; MAX_ARGUMENTS],
}

impl Pattern {
    /// Pattern of a scalar law.
    pub fn scalar(du: bool, dv: bool) -> Self {
        let mut pattern = Self::default();
        pattern.du[0][0] = du;
        pattern.dv[0][0] = dv;
        pattern
    }
}

/// A parameter of a law that is out of its range.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{parameter} = {value} is out of range: expected {expected}")]
pub struct ParameterError {
    /// Name of the parameter, as in the model file; entries of lists by their number.
    pub parameter: Cow<'static, str>,
    /// Its value.
    pub value: String,
    /// What would be right.
    pub expected: &'static str,
}

/// Refuses a parameter unless it is in range.
fn require(
    parameter: &'static str,
    value: impl Display,
    in_range: bool,
    expected: &'static str,
) -> Result<(), ParameterError> {
    if in_range {
        Ok(())
    } else {
        Err(ParameterError { parameter: parameter.into(), value: value.to_string(), expected })
    }
}

/// Refuses a parameter unless it is finite and above zero.
fn require_positive(parameter: &'static str, value: f64) -> Result<(), ParameterError> {
    require(parameter, value, value > 0.0 && value.is_finite(), "a finite number above zero")
}

/// What formulations need of a rigid contact: its pressures are found with the motion, not given by it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidContact<'l> {
    /// Clearance at rest, m.
    pub gap: f64,
    /// Numerical stiffness of the predicted pressure, N/m.
    pub epsilon: f64,
    /// Friction, if there is any.
    pub friction: Option<&'l Friction>,
}

/// A spring in series with a slider.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slider {
    /// Stiffness of the spring, N/m.
    pub stiffness: f64,
    /// Force at which it slides, N.
    pub limit: f64,
}

/// Mean force of a law while its velocity changes evenly, with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanForce {
    /// Mean of force 0, N.
    pub force: f64,
    /// Its derivatives by the velocities before and after, N·s/m.
    pub by_velocity: [f64; 2],
}

/// A nonlinear law.
pub trait Law {
    /// Number of arguments (and of forces), 1 to [`MAX_ARGUMENTS`].
    fn arguments(&self) -> usize;
    /// Derivatives that can differ from zero.
    fn pattern(&self) -> Pattern;
    /// Whether the force depends on the instant before.
    fn has_memory(&self) -> bool {
        false
    }
    /// For unilateral laws the value of argument 0 below which nothing acts.
    fn threshold(&self) -> Option<f64> {
        None
    }
    /// For a law whose force turns over between the signs of the velocity within a small change of it: that change v₀, m/s. It
    /// is analytic in v/v₀ but for imaginary parts of ±π/2 and beyond.
    fn turnover(&self) -> Option<f64> {
        None
    }
    /// Of such a law, which has one argument and depends on its velocity alone: the mean of the force while the velocity changes
    /// evenly from the first to the second value, m/s.
    fn mean_force(&self, _velocities: [f64; 2]) -> Option<MeanForce> {
        None
    }
    /// For a law that is a slider behind a spring: both.
    fn slider(&self) -> Option<Slider> {
        None
    }
    /// Whether the forces do not change when all velocities and the rotor speed are multiplied by one factor: then they
    /// have no explicit ω-derivative.
    fn is_homogeneous_in_rate(&self) -> bool {
        false
    }
    /// Whether the forces change their signs, and nothing else, when all arguments, their derivatives and what is remembered do.
    fn is_odd(&self) -> bool {
        false
    }
    /// Degree of the forces as polynomials in the arguments and their derivatives; none if they are no polynomials.
    fn degree(&self) -> Option<u32> {
        None
    }
    /// What a rigid contact is made of; none for a law that is a function of the motion.
    fn rigid(&self) -> Option<RigidContact<'_>> {
        None
    }
    /// For a law that acts beyond a gap only: the gap at rest, m.
    fn clearance(&self) -> Option<f64> {
        None
    }
    /// Largest |∂force/∂u|, N/m, as far as it is known without the motion: it limits the step of time marching.
    fn stiffness_bound(&self) -> f64;
    /// Largest |∂force/∂v|, N·s/m, as far as it is known without the motion: it limits the step of time marching.
    fn damping_bound(&self) -> f64;
    /// Checks that every parameter is in its range.
    ///
    /// # Errors
    /// The first parameter that is not.
    fn validate(&self) -> Result<(), ParameterError>;
    /// Forces and derivatives at one instant.
    fn respond(&self, now: &Instant, before: &Before) -> Response;
    /// Second derivatives: the derivative of every entry of [`respond`](Self::respond) in the direction
    /// (`along`, `before_along`).
    fn respond_along(&self, now: &Instant, before: &Before, along: &Instant, before_along: &Before) -> Response;
}

/// The laws: a row for each gives its module, its type and what it is.
macro_rules! laws {
    ($dollar:tt $($(#[$doc:meta])* $module:ident::$name:ident,)*) => {
        $(pub use $module::$name;)*

        /// Parameters of every law, as they stand in files and messages.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum LawKind {
            $($(#[$doc])* $name($name),)*
        }

        $(impl From<$name> for LawKind {
            fn from(law: $name) -> Self {
                Self::$name(law)
            }
        })*

        /// Evaluates `$body` with `$law` bound to the concrete law inside the [`LawKind`] `$kind`: code generic over
        /// `L: Law` is instantiated once per law, and the choice is made once per element instead of once per sample.
        macro_rules! with_law {
            ($dollar kind:expr, $dollar law:ident => $dollar body:expr) => {
                match $dollar kind {
                    $($crate::structure::laws::LawKind::$name($dollar law) => $dollar body,)*
                }
            };
        }
    };
}

laws! {
    $
    /// Rigid unilateral contact, with or without permanent-sliding friction.
    contact::Contact,
    /// Unilateral penalty spring.
    penalty_spring::PenaltySpring,
    /// Polynomial spring.
    polynomial::PolynomialSpring,
    /// Polynomial damper.
    polynomial::PolynomialDamper,
    /// Dry friction regularised by a hyperbolic tangent.
    tanh_friction::TanhFriction,
    /// Elastic dry friction.
    jenkins::Jenkins,
}
pub(crate) use with_law;

/// What people call laws, and the laws that they mean by it, in the order in which a name is searched for the words.
const CALLED: [(&[&str], &str); 5] = [
    (&["damp", "viscous"], "polynomial_damper"),
    (&["jenkin", "iwan", "masing", "hyster", "slider"], "jenkins"),
    (&["friction", "coulomb", "tanh", "slip"], "tanh_friction"),
    (&["stop", "gap", "impact", "unilateral", "bilinear", "penalty", "contact"], "penalty_spring"),
    (&["cubic", "quadratic", "quintic", "duffing", "poly", "spring", "stiffness"], "polynomial_spring"),
];

/// The law that is probably meant by a name that none has.
pub(super) fn meant(name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    CALLED.iter().find(|(words, _)| words.iter().any(|word| name.contains(word))).map(|(_, law)| *law)
}

/// For code that asks once per element; sample loops take the concrete law out with `with_law!`.
impl Law for LawKind {
    fn arguments(&self) -> usize {
        with_law!(self, law => law.arguments())
    }

    fn pattern(&self) -> Pattern {
        with_law!(self, law => law.pattern())
    }

    fn has_memory(&self) -> bool {
        with_law!(self, law => law.has_memory())
    }

    fn threshold(&self) -> Option<f64> {
        with_law!(self, law => law.threshold())
    }

    fn turnover(&self) -> Option<f64> {
        with_law!(self, law => law.turnover())
    }

    fn mean_force(&self, velocities: [f64; 2]) -> Option<MeanForce> {
        with_law!(self, law => law.mean_force(velocities))
    }

    fn slider(&self) -> Option<Slider> {
        with_law!(self, law => law.slider())
    }

    fn is_homogeneous_in_rate(&self) -> bool {
        with_law!(self, law => law.is_homogeneous_in_rate())
    }

    fn is_odd(&self) -> bool {
        with_law!(self, law => law.is_odd())
    }

    fn degree(&self) -> Option<u32> {
        with_law!(self, law => law.degree())
    }

    fn rigid(&self) -> Option<RigidContact<'_>> {
        with_law!(self, law => law.rigid())
    }

    fn clearance(&self) -> Option<f64> {
        with_law!(self, law => law.clearance())
    }

    fn stiffness_bound(&self) -> f64 {
        with_law!(self, law => law.stiffness_bound())
    }

    fn damping_bound(&self) -> f64 {
        with_law!(self, law => law.damping_bound())
    }

    fn validate(&self) -> Result<(), ParameterError> {
        with_law!(self, law => law.validate())
    }

    fn respond(&self, now: &Instant, before: &Before) -> Response {
        with_law!(self, law => law.respond(now, before))
    }

    fn respond_along(&self, now: &Instant, before: &Before, along: &Instant, before_along: &Before) -> Response {
        with_law!(self, law => law.respond_along(now, before, along, before_along))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_people_use_are_understood() {
        let laws =
            ["cubic", "Duffing", "cubic_damper", "elastic_stop", "coulomb_friction", "iwan", "magnet"].map(meant);
        let meant = [
            "polynomial_spring",
            "polynomial_spring",
            "polynomial_damper",
            "penalty_spring",
            "tanh_friction",
            "jenkins",
        ];
        assert_eq!(laws[..6], meant.map(Some));
        assert_eq!(laws[6], None);
        for (_, law) in CALLED {
            let told = toml::from_str::<std::collections::BTreeMap<String, LawKind>>(&format!("law = {{ {law} = 1 }}"));
            assert!(!told.unwrap_err().to_string().contains("unknown variant"), "{law}");
        }
    }

    #[test]
    fn laws_are_read_by_their_snake_case_names_and_unknown_keys_are_refused() {
        #[derive(Deserialize)]
        struct File {
            law: LawKind,
        }
        let read = |text: &str| toml::from_str::<File>(text).map(|file| file.law);
        let spring = read("law = { penalty_spring = { stiffness = 2.0, gap = 0.1 } }").unwrap();
        assert_eq!(spring, LawKind::PenaltySpring(PenaltySpring { stiffness: 2.0, gap: 0.1 }));
        let damper = read("law.polynomial_damper.terms = [{ power = 3, coefficient = 0.5 }]").unwrap();
        assert_eq!(
            damper,
            LawKind::PolynomialDamper(PolynomialDamper { terms: vec![Term { power: 3, coefficient: 0.5 }] })
        );
        let error = read("law = { jenkins = { stiffness = 2.0, limit = 0.1, gap = 1.0 } }").unwrap_err();
        assert!(error.to_string().contains("unknown field `gap`"), "{error}");
    }
}
