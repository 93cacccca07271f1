//! Derivatives of the displacement form against central differences, on the models of the pressure form's tests.

use super::DisplacementForm;
use crate::curve::problem::Problem;
use crate::formulation::Formulation;
use crate::formulation::pressure::PressureForm;
use crate::formulation::pressure::tests::{
    COMMON, TRACKED, assert_adjoint, assert_column, cases, derivative, model, moved, random, random_state,
};
use crate::formulation::scales::Scales;
use crate::linalg::dot;

#[test]
fn every_column_of_the_bordered_jacobian_matches_differences() {
    let (mut tested, mut skipped, mut partly_open) = (0, 0, 0);
    for (seed, case) in (100..).zip(cases(&COMMON)) {
        let model = model(case);
        let state = random_state(case, &model, seed);
        let scales = Scales::new(&model, TRACKED);
        let mut form = DisplacementForm::new(&model, case.truncation(), TRACKED, case.unknown, scales).unwrap();
        let mut y = form.encode(&state);
        assert!(form.linearise(&mut y).is_finite());
        for part in form.parts.iter().filter(|part| part.contact.is_some()) {
            let start = part.first * form.nc;
            let share = form.aft.coverage(&form.arguments[start..start + form.nc], 0.0).fraction();
            partly_open += usize::from(share > 0.0 && share < 1.0);
        }
        let mut next = random(78);
        let row: Vec<f64> = y.iter().map(|_| next()).collect();
        form.assemble(&row);
        let size = y.len();
        let matrix = form.lu.entries().to_vec();
        form.lu.factor().unwrap();
        let (mut step, mut tangent) = (vec![0.0; size], vec![0.0; size]);
        form.solve(0.3, &mut step, &mut tangent);
        let residual: Vec<f64> = form.scaled_residual().collect();
        let other: Vec<f64> = y.iter().map(|_| next()).collect();
        assert_adjoint(&form.solve_transposed(&other), &other, (&residual, 0.3), (&step, &tangent));
        for column in 0..size {
            let mut unit = vec![0.0; size];
            unit[column] = 1.0;
            let differences = derivative(|h| {
                let mut y = moved(&y, h, &unit);
                form.linearise(&mut y);
                form.scaled_residual().chain([dot(&row, &y)]).collect()
            });
            let exact: Vec<f64> = (0..size).map(|i| matrix[i * size + column]).collect();
            match differences {
                Some(differences) => {
                    assert_column(&exact, &differences, (case, column, size));
                    tested += 1;
                }
                None => skipped += 1,
            }
        }
    }
    assert!(skipped * 10 < tested, "{skipped} columns skipped, {tested} tested");
    assert!(partly_open >= 96, "only {partly_open} contacts touch for part of the period");
}

#[test]
fn states_survive_the_way_there_and_back() {
    for (seed, case) in (300..).zip(cases(&COMMON)) {
        let model = model(case);
        let state = random_state(case, &model, seed);
        let scales = Scales::new(&model, TRACKED);
        let mut form = DisplacementForm::new(&model, case.truncation(), TRACKED, case.unknown, scales).unwrap();
        let y = form.encode(&state);
        let decoded = form.decode(&y).unwrap();
        let again = form.encode(&decoded);
        for (a, b) in y.iter().zip(&again) {
            assert!((a - b).abs() < 1e-10 * (1.0 + a.abs()), "{case:?}: {a} became {b}");
        }
        // Both forms lay out a state in the same way.
        let pressure = PressureForm::new(&model, case.truncation(), TRACKED, case.unknown, scales);
        assert_eq!(pressure.encode(&decoded).len(), pressure.len());
    }
}
