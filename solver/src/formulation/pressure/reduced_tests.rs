//! The reduced matrix against the whole one, on motions of a rotor blade that touches for parts of the period.

use super::{PressureForm, Reduction};
use crate::curve::problem::Problem;
use crate::files;
use crate::formulation::Formulation;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::linalg::dot;
use crate::response::backbone::Backbone;
use crate::settings::{HarmonicSettings, Settings};
use std::path::Path;

/// Solutions with the matrix last factorised: step, tangent, weights of two forms, orientation.
fn solutions(form: &mut PressureForm<'_>, forms: &[Vec<f64>; 2]) -> (Vec<Vec<f64>>, f64) {
    let (mut step, mut tangent) = (vec![0.0; form.len()], vec![0.0; form.len()]);
    form.solve(0.3, &mut step, &mut tangent);
    let weights = forms.each_ref().map(|row| form.solve_transposed(row));
    (vec![step, tangent].into_iter().chain(weights).collect(), form.orientation())
}

fn compare(form: &mut PressureForm<'_>, state: &State) -> (usize, usize) {
    let mut y = form.encode(state);
    y.iter_mut().enumerate().for_each(|(i, y)| *y *= 1.0 + 1e-3 * (i as f64).cos());
    form.linearise(&mut y);
    let entries: Vec<f64> = (0..y.len()).map(|i| (0.7 * i as f64).sin()).collect();
    let row: Vec<f64> = form.metric().iter().zip(&entries).map(|(w, e)| w * e).collect();
    // The second one has entries of its own for the arguments.
    let forms = [row.clone(), entries];
    form.factor(&row).unwrap();
    let reduced = match &form.reduction {
        Reduction::Arcs(reduced) => reduced.unknowns.len(),
        _ => form.unknowns.len(),
    };
    let (found, orientation) = solutions(form, &forms);
    form.reduction = Reduction::Whole;
    form.assemble(&row);
    form.lu.factor().unwrap();
    let (expected, whole) = solutions(form, &forms);
    assert_eq!(orientation.signum(), whole.signum());
    for (found, expected) in found.iter().zip(&expected) {
        let difference: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
        let relative = (dot(&difference, &difference) / dot(expected, expected)).sqrt();
        assert!(relative < 1e-7, "{relative:.1e} with {reduced} of {} unknowns", form.unknowns.len());
    }
    (reduced, form.unknowns.len())
}

#[test]
fn solutions_are_those_of_the_whole_matrix() {
    let model = files::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/rotor67")).unwrap();
    let mut settings = Settings::default();
    settings.backbone.max_amplitude = Some(2e-3);
    let backbone = Backbone::compute(&model, &settings).unwrap();
    let scales = Scales::new(&model, 0);
    let mut sizes = Vec::new();
    for unknown in [Unknown::Mode { damped: true }, Unknown::Frequency { forcing: 60.0 }, Unknown::PhaseResonance] {
        for count in [10, 20] {
            let truncation = HarmonicSettings { count, ..HarmonicSettings::default() };
            let mut form = PressureForm::new(&model, truncation, 0, unknown, scales);
            for point in backbone.points.iter().step_by(9) {
                sizes.push(compare(&mut form, &point.point.state.with_harmonics(count)));
            }
        }
    }
    let reduced = sizes.iter().filter(|(reduced, all)| reduced < all).count();
    assert!(3 * reduced > sizes.len(), "{reduced} of {}: {sizes:?}", sizes.len());
    assert!(sizes.iter().any(|(reduced, all)| reduced == all));
}
