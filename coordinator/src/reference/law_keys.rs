//! Keys of the nonlinear laws of `model.toml`. Rigid contact is not among them: it has a section of its own.

use super::key::Absent::{Nothing, Required};
use super::key::Kind::{Number, Table, Tables as Tables_, Whole};
use super::key::{Key, Range, Tables};

/// A law.
const fn law(path: &'static str, meaning: &'static str) -> Key {
    Key { path, kind: Table, default: Nothing, unit: "", meaning, example: "" }
}

/// A parameter: of no law has it a default.
const fn parameter(path: &'static str, range: Range, unit: &'static str, meaning: &'static str) -> Key {
    Key { path, kind: Number(range), default: Required, unit, meaning, example: "0.5" }
}

/// Terms of a polynomial.
const fn terms(path: &'static str) -> Key {
    Key {
        path,
        kind: Tables_(Tables { fewest: 1, ..Tables::ANY }),
        default: Required,
        unit: "",
        meaning: "One or more terms, each a table of power and coefficient.",
        example: "",
    }
}

/// Power of a term.
const fn power(path: &'static str) -> Key {
    Key { path, kind: Whole(Range::within(1.0, 15.0)), default: Required, unit: "", meaning: "Power p.", example: "3" }
}

/// The laws and their parameters, in the order of [`solver::structure::laws::LawKind`].
pub(super) const LAWS: &[Key] = &[
    law(
        "laws.law.penalty_spring",
        "Elastic stop, f = k max(0, u − g). One on the other side of a dof has coefficients = { DOF = -1 } instead of dof.",
    ),
    parameter("laws.law.penalty_spring.stiffness", Range::POSITIVE, "N/m", "Stiffness k."),
    Key {
        example: "1e-3",
        ..parameter("laws.law.penalty_spring.gap", Range::ANY, "m", "Gap g; below zero the spring is pressed at rest.")
    },
    law("laws.law.polynomial_spring", "Polynomial spring, f = Σ c u^p: cubic and others."),
    terms("laws.law.polynomial_spring.terms"),
    power("laws.law.polynomial_spring.terms.power"),
    parameter("laws.law.polynomial_spring.terms.coefficient", Range::ANY, "N/m^p", "Coefficient c."),
    law("laws.law.polynomial_damper", "Polynomial damper, f = Σ c v^p, v being the velocity u'."),
    terms("laws.law.polynomial_damper.terms"),
    power("laws.law.polynomial_damper.terms.power"),
    parameter("laws.law.polynomial_damper.terms.coefficient", Range::ANY, "N/(m/s)^p", "Coefficient c."),
    law(
        "laws.law.tanh_friction",
        "Dry friction at constant normal load, regularised: f = F tanh(v / v0), v being the velocity u'.",
    ),
    parameter("laws.law.tanh_friction.limit", Range::POSITIVE, "N", "Sliding force F."),
    parameter("laws.law.tanh_friction.velocity", Range::POSITIVE, "m/s", "Velocity v0 of the regularisation."),
    law(
        "laws.law.jenkins",
        "Elastic dry friction: a spring in series with a slider. It has hysteresis at any rate: the force depends on the path.",
    ),
    parameter("laws.law.jenkins.stiffness", Range::POSITIVE, "N/m", "Stiffness of the spring."),
    parameter("laws.law.jenkins.limit", Range::POSITIVE, "N", "Force at which the slider slides."),
];
