//! The compressed matrix against the whole one: on small random models with every kind of law, and on a rotor blade all of whose
//! nodes touch.

use super::compressed::row_space;
use super::tests::{ALL, border, cases, form, model, random};
use super::{PressureForm, Reduction};
use crate::curve::problem::Problem;
use crate::files;
use crate::formulation::Formulation;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::linalg::dot;
use crate::settings::{HarmonicSettings, Quadrature};
use crate::structure::Model;
use std::path::Path;

/// Numbers of unknowns, compressed and all.
type Sizes = (usize, usize);

/// Solutions with the matrix last factorised: step, tangent, weights of two forms, orientation.
fn solutions(form: &mut PressureForm<'_>, forms: &[Vec<f64>; 2]) -> (Vec<Vec<f64>>, f64) {
    let (mut step, mut tangent) = (vec![0.0; form.len()], vec![0.0; form.len()]);
    form.solve(0.3, &mut step, &mut tangent);
    let weights = forms.each_ref().map(|row| form.solve_transposed(row));
    (vec![step, tangent].into_iter().chain(weights).collect(), form.orientation())
}

/// Largest relative difference of the solutions with the compressed matrix from those with the whole one, and the sizes.
fn difference(form: &mut PressureForm<'_>, row: &[f64], seed: u64) -> (f64, Sizes) {
    let mut next = random(seed);
    // The second form has entries of its own for the arguments.
    let forms = [border(form, seed), (0..form.len()).map(|_| next()).collect()];
    form.assemble(row);
    form.factored.clone_from(&form.unknowns);
    form.lu.factor().unwrap();
    let (expected, whole) = solutions(form, &forms);
    let compressed = form.compressed();
    let sizes = (compressed.unknowns.len(), form.unknowns.len());
    form.assemble_compressed(&compressed, row);
    form.lu.factor().unwrap();
    form.reduction = Reduction::Elements(compressed);
    let (found, orientation) = solutions(form, &forms);
    form.reduction = Reduction::Whole;
    assert_eq!(orientation.signum(), whole.signum());
    let relative = |(found, expected): (&Vec<f64>, &Vec<f64>)| {
        let difference: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
        (dot(&difference, &difference) / dot(expected, expected)).sqrt()
    };
    (found.iter().zip(&expected).map(relative).fold(0.0, f64::max), sizes)
}

#[test]
fn random_models_have_the_solutions_of_the_whole_matrix() {
    let mut smaller = 0;
    for (seed, case) in (300..).zip(cases(&ALL)) {
        let model = model(case);
        let (mut form, _) = form(case, &model, seed);
        let row = border(&form, 77);
        let (difference, (compressed, all)) = difference(&mut form, &row, seed);
        assert!(difference < 1e-8, "{case:?}: {difference:.1e} with {compressed} of {all} unknowns");
        smaller += usize::from(compressed < all);
    }
    assert!(2 * smaller > cases(&ALL).count(), "{smaller}");
}

/// A motion of the rotor during which all nodes touch for parts of the period that differ, sliding to and fro.
fn all_touching(model: &Model, harmonics: usize, next: &mut impl FnMut() -> f64) -> State {
    let nc = 2 * harmonics + 1;
    let mut arguments = vec![0.0; 3 * model.elements().len() * nc];
    for series in arguments.chunks_mut(3 * nc) {
        (series[0], series[1], series[2]) = (-600.0 + 200.0 * next(), 1000.0, 500.0 * next());
        series[3..nc].iter_mut().enumerate().for_each(|(h, p)| *p = 100.0 * next() / (1 + h) as f64);
        series[nc..].iter_mut().enumerate().for_each(|(h, x)| *x = 1e-4 * next() / (1 + h % nc).pow(2) as f64);
    }
    let modal = (0..model.size() * nc).map(|h| 1e-6 * next() / (1 + h % nc) as f64).collect();
    State { harmonics, omega: 2400.0, decay: 3.0, forcing: 60.0, arguments, modal }
}

#[test]
fn a_blade_has_the_solutions_of_the_whole_matrix() {
    let model = files::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/rotor67")).unwrap();
    let mut next = random(11);
    for unknown in [Unknown::Mode { damped: true }, Unknown::Frequency { forcing: 60.0 }, Unknown::PhaseResonance] {
        for quadrature in [Quadrature::Arcs, Quadrature::Samples] {
            let truncation = HarmonicSettings { count: 20, quadrature, ..HarmonicSettings::default() };
            let mut form = PressureForm::new(&model, truncation, 0, unknown, Scales::new(&model, 0));
            let mut y = form.encode(&all_touching(&model, 20, &mut next));
            form.linearise(&mut y);
            assert!(form.active().iter().all(|active| *active));
            let row = border(&form, 5);
            let (difference, (compressed, all)) = difference(&mut form, &row, 9);
            println!("{difference:.1e} with {compressed} of {all} unknowns");
            assert!(difference < 1e-7, "{difference:.1e} with {compressed} of {all} unknowns");
            assert!(2 * compressed < all, "{compressed} of {all}");
            // So many unknowns are compressed by themselves, and few are not.
            form.factor(&row).unwrap();
            assert!(matches!(&form.reduction, Reduction::Elements(found) if found.unknowns.len() == compressed));
        }
    }
}

#[test]
fn rows_are_spanned_up_to_the_threshold() {
    let (rows, width, rank) = (60, 13, 5);
    let mut next = random(3);
    let mut numbers = |count: usize| -> Vec<f64> { (0..count).map(|_| next()).collect() };
    let (left, right, rest) = (numbers(rows * rank), numbers(rank * width), numbers(rows * width));
    for (size, expected) in [(0.0, rank), (1e-12, rank), (1e-6, width)] {
        let mut matrix = vec![0.0; rows * width];
        crate::linalg::multiply(&left, &right, rank, &mut matrix);
        matrix.iter_mut().zip(&rest).for_each(|(m, r)| *m += size * r);
        let basis = row_space(&matrix, width, 1e-10);
        assert_eq!(basis.len(), expected * width, "{size:e}");
        for row in matrix.chunks(width) {
            let mut left = row.to_vec();
            basis.chunks(width).for_each(|known| crate::linalg::axpy(-dot(known, row), known, &mut left));
            assert!(dot(&left, &left).sqrt() < 1e-10 * rows as f64);
        }
        for (i, a) in basis.chunks(width).enumerate() {
            for (j, b) in basis.chunks(width).enumerate() {
                assert!((dot(a, b) - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
    }
    assert!(row_space(&[0.0; 12], 4, 0.0).is_empty());
}
