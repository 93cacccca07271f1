//! Springs that push away: beyond some displacement with more than the structure holds.

use super::touch::shape;
use super::units::length;
use crate::study::Study;
use solver::structure::laws::{LawKind, Term};
use solver::structure::{Element, Model};

/// Displacements looked at below the static response, evenly by their logarithms over so many decades.
const LOOKED_AT: (i32, f64) = (400, 8.0);
/// A share of the largest entry of a shape that is rounding.
const STILL: f64 = 1e-9;
/// Times that the interval between two of them is halved.
const HALVINGS: usize = 20;

/// Sentences about springs that are passed at the largest level by the static response of the linear structure alone.
pub(super) fn warnings(study: &Study) -> Vec<String> {
    let Some(highest) = study.amplitudes.iter().max_by(|a, b| a.value.total_cmp(&b.value)) else { return Vec::new() };
    let told = |element: &Element| {
        let LawKind::PolynomialSpring(spring) = &element.law else { return None };
        let (compliance, displacement) = statics(&study.model, element)?;
        let response = highest.value * displacement;
        let limit = limit(compliance, &spring.terms, response)?;
        Some(format!(
            "`{}` pushes away beyond {}, with more than the structure holds, and the static response to A = {} alone would be {}: check \
             units and signs",
            element.name,
            length(study, limit, 2),
            highest.text,
            length(study, response, 2)
        ))
    };
    study.model.elements().iter().filter_map(told).collect()
}

/// What a force of 1 N at an element displaces there, m/N, and what one unit of the forcing does, m, both at rest and without laws.
/// `None` where the structure is free to move.
fn statics(model: &Model, element: &Element) -> Option<(f64, f64)> {
    let (along, force, modes) = (shape(model, element), model.modal_force(), model.modes());
    let bent = (0..along.len()).filter(|&j| !modes.is_rigid(j));
    let displacement: f64 = bent.map(|j| along[j] * force[j] / modes.frequencies[j].powi(2)).sum();
    Some((compliance(model, element)?, displacement.abs()))
}

/// What a force of 1 N at an element displaces there at rest, without laws, m/N. `None` where the structure is free to move.
pub(super) fn compliance(model: &Model, element: &Element) -> Option<f64> {
    let (along, modes) = (shape(model, element), model.modes());
    let largest = along.iter().fold(0.0_f64, |largest, b| largest.max(b.abs()));
    let (rigid, bent): (Vec<usize>, Vec<usize>) = (0..along.len()).partition(|&j| modes.is_rigid(j));
    let is_free = rigid.into_iter().any(|j| along[j].abs() > STILL * largest);
    let compliance: f64 = bent.iter().map(|&j| (along[j] / modes.frequencies[j]).powi(2)).sum();
    (!is_free && compliance > 0.0).then_some(compliance)
}

/// The displacement from which on structure and spring together do not pull back, one way at least, if they do not at this one: below it
/// they may let go and catch again.
fn limit(compliance: f64, terms: &[Term], up_to: f64) -> Option<f64> {
    let (count, decades) = LOOKED_AT;
    let pulls_back = |x: f64| {
        let spring: f64 = terms.iter().map(|term| term.coefficient * x.powi(term.power as i32)).sum();
        (x / compliance + spring) * x.signum() > 0.0
    };
    let is_held = |size: f64| pulls_back(size) && pulls_back(-size);
    let size = |i: i32| up_to * 10_f64.powf(decades * (f64::from(i) / f64::from(count) - 1.0));
    if up_to <= 0.0 || is_held(up_to) {
        return None;
    }
    // What nothing holds anywhere is not held by this spring.
    let last = (0..count).rev().find(|&i| is_held(size(i)))?;
    let (mut below, mut above) = (size(last), size(last + 1));
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(below, above);
        *(if is_held(middle) { &mut below } else { &mut above }) = middle;
    }
    Some(above)
}
