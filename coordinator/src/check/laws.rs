//! What is probably not meant of laws.

use super::softening::compliance;
use super::touch::{pressed_at_rest, shape};
use crate::study::Study;
use results::words::{digits, number};
use solver::formulation::Formulation;
use solver::formulation::harmonics::complex;
use solver::formulation::linear::forced_response;
use solver::formulation::pressure::PressureForm;
use solver::formulation::scales::Scales;
use solver::formulation::unknown::Unknown;
use solver::structure::Element;
use solver::structure::laws::{LawKind, Term};

/// Where polynomials take as much as the damping only at so many times the linear response, the structure is linear for all that can be
/// seen of it.
const LINEAR: f64 = 100.0;
/// Times the linear response that are looked at, at most.
const FARTHEST: f64 = 1e4;

/// Stiffness of a law, in that of the structure there, below which it matters to no motion.
const SOFT: f64 = 5e-5;
/// The same in damping ratios.
const NARROW: f64 = 0.1;

/// Sentences about polynomials: of dampers that feed energy in, and of all laws if they hardly do anything.
pub(super) fn warnings(study: &Study, followed: &[usize]) -> Vec<String> {
    let even = study.model.elements().iter().filter_map(even_damper);
    even.chain(pressed(study)).chain(soft(study)).chain(practically_linear(study, followed)).collect()
}

/// Elastic stops that are pressed at rest, which is seldom meant: sentences.
pub(super) fn pressed(study: &Study) -> impl Iterator<Item = String> + '_ {
    pressed_at_rest(&study.model).map(|(element, gap)| {
        format!(
            "`{}`: its gap is negative ({} m), so that it presses at rest, and the structure there is another one than the modes are of; a stop on \
             the other side has `coefficients = {{ DOF = -1 }}` instead of `dof`, and a positive gap",
            element.name,
            digits(gap, 3)
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

/// Whether all laws are polynomials that matter only far above the linear response at the largest level, at every resonance followed.
fn practically_linear(study: &Study, followed: &[usize]) -> Option<String> {
    let (model, settings) = (&study.model, &study.settings);
    let laws: Vec<(&Element, &[Term], bool)> = model.elements().iter().map(polynomial).collect::<Option<_>>()?;
    let highest = study.amplitudes.iter().max_by(|a, b| a.value.total_cmp(&b.value))?;
    let unknown = Unknown::Frequency { forcing: highest.value };
    let scales = Scales::new(model, settings.tracked(model));
    let problem = PressureForm::build(model, settings.harmonics, settings.tracked(model), unknown, scales).ok()?;
    let m = model.forcing().harmonic;
    let multiples = followed.iter().map(|&mode| {
        let omega = model.modes().frequencies[mode] / m as f64;
        let response = forced_response(&problem, highest.value, omega).ok()?;
        let displacement = |modal: Vec<f64>| complex(&response.combine(modal), m).norm();
        let supplied = highest.value * displacement(model.modal_force());
        let of_law = |multiple: f64, (element, terms, is_damper): &(&Element, &[Term], bool)| {
            let argument = displacement(shape(model, element));
            let rate = if *is_damper { argument * omega * m as f64 } else { argument };
            // What is linear is part of the linear response, if of one that is not computed here.
            let force = |term: &Term| term.coefficient.abs() * (multiple * rate).powi(term.power as i32);
            terms.iter().filter(|term| term.power > 1).map(force).sum::<f64>() * multiple * argument
        };
        let is_linear = |multiple: &f64| {
            laws.iter().map(|law| of_law(*multiple, law)).sum::<f64>() < multiple * multiple * supplied
        };
        let grown = std::iter::successors(Some(LINEAR), |multiple| Some(2.0 * multiple));
        Some(grown.take_while(|multiple| *multiple < FARTHEST).take_while(is_linear).last().unwrap_or(0.0))
    });
    let least = multiples.collect::<Option<Vec<f64>>>()?.into_iter().reduce(f64::min)?;
    let names: Vec<String> = laws.iter().map(|(element, ..)| format!("`{}`", element.name)).collect();
    (!laws.is_empty() && least >= LINEAR).then(|| {
        format!(
            "practically linear: at A = {} the laws would matter only where the response is {} times the linear one or more; check units of \
             {}",
            highest.text,
            digits(least, 1),
            names.join(", ")
        )
    })
}

/// A law that is a polynomial, and whether it is one of the velocity.
fn polynomial(element: &Element) -> Option<(&Element, &[Term], bool)> {
    match &element.law {
        LawKind::PolynomialSpring(spring) => Some((element, &spring.terms, false)),
        LawKind::PolynomialDamper(damper) => Some((element, &damper.terms, true)),
        _ => None,
    }
}
