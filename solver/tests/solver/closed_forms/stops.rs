//! Rigid stops, against exact free motion.

use super::common::*;
use solver::curve::problem::Problem;
use solver::formulation::Formulation;
use solver::formulation::harmonics::width;
use solver::formulation::state::State;
use solver::response::backbone::Backbone;
use solver::response::branch::Side;
use solver::response::forced::{Forced, SearchRange};
use std::f64::consts::PI;

/// Frequency of the undamped free motion before a rigid stop, a the excursion away from it: x = −a cos ω₀t from −a to the
/// gap takes (π − arccos(gap/a))/ω₀, half a period.
fn bouncing(natural: f64, gap: f64, a: f64) -> f64 {
    natural * PI / (PI - (gap / a).acos())
}

/// Frequency of a backbone at an amplitude, by cubic interpolation between four points.
fn frequency_at(backbone: &Backbone, amplitude: f64) -> f64 {
    let points: Vec<(f64, f64)> = backbone.points.iter().map(|p| (p.point.amplitude(), p.point.omega())).collect();
    let above = points.iter().position(|p| p.0 > amplitude).unwrap();
    let near = &points[above - 2..above + 2];
    let weight = |i: usize| {
        let others = (0..4).filter(|&j| j != i);
        others.map(|j| (amplitude - near[j].0) / (near[i].0 - near[j].0)).product::<f64>()
    };
    (0..4).map(|i| weight(i) * near[i].1).sum()
}

#[test]
fn a_mass_bouncing_on_a_rigid_stop() {
    // Before the stop between two masses x1 = q/√2: half of the gap between them.
    for (name, mode, gap) in [("impact_subharmonic", 1, 1.0), ("two_masses_stop", 2, 0.05)] {
        let model = load(name);
        let curves = [5, 10, 20, 40, 80].map(|count| {
            let mut settings = conservative(count);
            settings.backbone.modes = solver::ModeChoice::one(mode);
            backbone(&model, &settings)
        });
        for amplitude in [1.5 * gap, 2.0 * gap, 4.0 * gap] {
            let exact = bouncing(model.modes().frequencies[mode - 1], gap, amplitude);
            let found = curves.each_ref().map(|curve| frequency_at(curve, amplitude));
            let errors = found.map(|omega| omega / exact - 1.0);
            let extrapolated = (2.0 * found[4] - found[3]) / exact - 1.0;
            println!("{name}, a = {amplitude}: {errors:.5?}, extrapolated {extrapolated:.5}");
            // An impulse has harmonics that do not decay. What is cut off makes the stop softer: the frequency comes from
            // below, at an order in 1/H that rises from 0.7 (H = 5 to 10) to 0.9 (40 to 80), towards 1.
            for pair in errors.windows(2) {
                let order = (pair[0] / pair[1]).log2();
                assert!(pair[0] < pair[1] && pair[1] < 0.0 && order > 0.6 && order < 1.0, "{errors:?}");
            }
            assert!(errors[3].abs() < 0.0215 && errors[4].abs() < 0.0115, "{errors:?}");
            // First-order extrapolation from the last two.
            assert!(extrapolated.abs() < 2e-3, "{extrapolated}");
        }
    }
}

#[test]
fn contact_between_two_bodies_is_that_of_one_body_before_a_stop() {
    let two = load("two_masses_stop");
    // In q = (x1 − x2)/√2 the gap is 1/√2 of that between the masses, and a pressure λ there is √2 λ here: ε is doubled.
    let one = oscillator(3.0, 0.005, contact(0.1 / 2f64.sqrt(), 6.0));
    let mut settings = with_harmonics(20);
    let reference = backbone(&one, &settings);
    let branch = Forced::new(&one, &settings, SearchRange::new(&settings, &reference).unwrap(), 0.005)
        .main_branch(Side::Below, &mut quiet)
        .unwrap();
    settings.backbone.modes = solver::ModeChoice::one(2);
    let mut forced = Forced::new(&two, &settings, SearchRange::new(&settings, &reference).unwrap(), 0.005);
    // The forcing shape M φ_2 follows the sign of φ_2 = ±(1, −1)/√2, and so does q.
    let sign = two.modes().shapes[(0, 1)].signum();
    let mut touching = 0;
    for point in &branch.points {
        let mut modal = vec![0.0; width(20)];
        modal.extend(point.state.modal.iter().map(|q| sign * q));
        let arguments = point.state.arguments.iter().map(|p| p / 2f64.sqrt()).collect();
        let y = forced.problem().encode(&State { arguments, modal, ..point.state.clone() });
        let mut completed = y.clone();
        let residual = forced.problem().linearise(&mut completed);
        // Where modal amplitudes follow from the forces they agree as far as the residual of one body allows, 1e-11.
        let moved = y.iter().zip(&completed).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(residual < 1e-10 && moved < 1e-10, "{} rad/s: {residual:e} {moved:e}", point.omega());
        touching += usize::from(point.contact()[0] > 0.0);
    }
    assert!(touching > 100 && branch.peak().amplitude() > 0.14, "{touching} {}", branch.peak().amplitude());
}
