//! Value and gradient of the conditions of fold and peak curves, by differences and from the full system.

use super::PressureForm;
use super::tests::{Case, TRACKED, cases, compare_columns, compare_directions, model};
use crate::formulation::displacement::DisplacementForm;
use crate::formulation::scales::Scales;
use crate::formulation::unknown::{Quantity, Unknown};
use crate::formulation::{Formulation, FormulationError};
use crate::settings::Quadrature;
use crate::structure::Model;

const EXTREMA: [Unknown; 3] =
    [Unknown::Extremum(Quantity::Frequency), Unknown::Extremum(Quantity::Amplitude), Unknown::Extremum(Quantity::Rms)];

/// The cases that have second derivatives.
fn smooth_cases() -> impl Iterator<Item = (Case, Model)> {
    cases(&EXTREMA).filter(|case| case.quadrature == Quadrature::Arcs).map(|case| (case, model(case)))
}

#[test]
fn every_column_with_the_condition_matches_differences() {
    let (mut tested, mut skipped) = (0, 0);
    for (seed, (case, model)) in (100..).zip(smooth_cases()) {
        let count = compare_columns(case, &model, seed);
        (tested, skipped) = (tested + count.0, skipped + count.1);
    }
    println!("{tested} columns tested, {skipped} skipped");
    assert!(skipped * 50 < tested, "{skipped} columns skipped, {tested} tested");
}

#[test]
fn directions_and_steps_along_the_condition_match_differences() {
    let count = smooth_cases().count();
    let skipped: usize =
        (200..).zip(smooth_cases()).map(|(seed, (case, model))| compare_directions(case, &model, seed)).sum();
    assert!(skipped * 20 < 2 * count, "{skipped} of {} skipped", 2 * count);
}

#[test]
fn laws_without_second_derivatives_are_named() {
    let refusal = |case: Case| {
        let model = model(case);
        let scales = Scales::new(&model, TRACKED);
        let displacement = DisplacementForm::new(&model, case.truncation(), TRACKED, case.unknown, scales).err();
        assert_eq!(displacement, Some(FormulationError::Unsupported));
        PressureForm::build(&model, case.truncation(), TRACKED, case.unknown, scales).err()
    };
    let case = |other_laws: bool, quadrature: Quadrature| {
        let mut all = cases(&EXTREMA);
        all.find(|case| case.other_laws == other_laws && case.quadrature == quadrature).unwrap()
    };
    assert_eq!(refusal(case(false, Quadrature::Arcs)), None);
    let names = |list: &[&str]| Some(FormulationError::Rough { names: list.iter().map(|&name| name.into()).collect() });
    assert_eq!(refusal(case(true, Quadrature::Arcs)), None);
    assert_eq!(refusal(case(true, Quadrature::Samples)), names(&["ground", "pair", "far", "jenkins", "stop"]));
}
