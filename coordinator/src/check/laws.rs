//! What is probably not meant of laws.

use super::softening::compliance;
use super::units::length;
use super::weight::Weight;
use crate::study::Study;
use results::overview::pressed_at_rest;
use results::words::{digits, number};
use solver::settings::Quadrature;
use solver::structure::Element;
use solver::structure::laws::{Law, LawKind};

/// Stiffness of a law, in that of the structure there, below which it matters to no motion.
const SOFT: f64 = 5e-5;
/// The same in damping ratios.
const NARROW: f64 = 0.1;

/// Radius of a sliding contact over its gap, below which motions are not small beside it.
const SLOW: f64 = 10.0;

/// Sentences about polynomials: of dampers that feed energy in, and of all laws if they hardly do anything.
pub(super) fn warnings(study: &Study, weight: Option<&Weight>) -> Vec<String> {
    let even = study.model.elements().iter().filter_map(even_damper);
    let linear = weight.and_then(|weight| weight.practically_linear(study));
    even.chain(pressed(study)).chain(soft(study)).chain(reversing(study)).chain(linear).collect()
}

/// Contacts whose sliding motions of the size of the gap may turn round: sentences. The tip moves by ρ m ω, and back at less than ω times its
/// displacement.
fn reversing(study: &Study) -> impl Iterator<Item = String> + '_ {
    let harmonic = study.model.forcing().harmonic as f64;
    let is_smooth = study.settings.harmonics.quadrature == Quadrature::Arcs;
    let contacts = study.model.elements().iter().filter(move |_| is_smooth);
    contacts.filter_map(move |element| {
        let contact = element.law.rigid()?;
        let radius = contact.friction?.radius;
        (radius * harmonic < SLOW * contact.gap).then(|| {
            format!(
                "`{}`: its radius, {}, is less than {SLOW} times the gap, {}: motions of that size may turn the sliding round while it presses, \
                 which harmonics.quadrature = \"arcs\" takes for smooth, and \"samples\" does not",
                element.name,
                length(study, radius, 3),
                length(study, contact.gap, 3)
            )
        })
    })
}

/// Elastic stops that are pressed at rest, which is seldom meant: sentences.
pub(super) fn pressed(study: &Study) -> impl Iterator<Item = String> + '_ {
    pressed_at_rest(&study.model).map(|(element, gap)| {
        format!(
            "`{}`: its gap is negative ({}), so that it presses at rest, and the structure there is another one than the modes are of; if a stop \
             on the other side is meant, it has the opposite coefficient (`coefficients = {{ DOF = -1 }}` instead of `dof`), and a positive gap",
            element.name,
            length(study, gap, 3)
        )
    })
}

/// Elastic stops and joints that are so soft that they change next to nothing, which is seldom meant: sentences.
pub(super) fn soft(study: &Study) -> impl Iterator<Item = String> + '_ {
    let model = &study.model;
    // A frequency moves by half of this share, which has to be little beside the width of a resonance as well.
    let ratios = model.damping().rates().into_iter().zip(&model.modes().frequencies);
    let damped = ratios.filter(|(rate, omega)| **omega > 0.0 && *rate > 0.0).map(|(rate, omega)| rate / (2.0 * omega));
    let width = damped.reduce(f64::min).unwrap_or(0.0);
    model.elements().iter().filter_map(move |element| {
        let stiffness = match &element.law {
            LawKind::PenaltySpring(spring) => spring.stiffness,
            LawKind::Jenkins(joint) => joint.stiffness,
            _ => return None,
        };
        let structure = 1.0 / compliance(model, element)?;
        let share = stiffness / structure;
        (share < SOFT && share < NARROW * width).then(|| {
            format!(
                "`{}`: its stiffness, {} N/m, is {} of that of the structure there, {} N/m, and changes next to nothing: are the units N/m?",
                element.name,
                number(stiffness),
                digits(share, 1),
                number(structure)
            )
        })
    })
}

/// A force that does not change its sign with the velocity drives the motion one way.
fn even_damper(element: &Element) -> Option<String> {
    let LawKind::PolynomialDamper(damper) = &element.law else { return None };
    let term = damper.terms.iter().find(|term| term.power % 2 == 0 && term.coefficient != 0.0)?;
    Some(format!(
        "`{}`: a polynomial_damper of the even power {} feeds energy in during half of each period",
        element.name, term.power
    ))
}
