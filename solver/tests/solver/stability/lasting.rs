//! What is called stable stays where it is, what is called unstable leaves: marching over hundreds of periods from points of
//! the branches of the models that are shipped, pushed a little.

use solver::stability::along::{AlongSettings, along};
use solver::stability::multipliers::Verdict;
use solver::{Backbone, Branch, Level, Model, Orbit, Settings, files};
use std::ops::ControlFlow;
use std::path::Path;

/// Relative size of the push.
const PUSH: f64 = 1e-4;
/// Periods marched.
const PERIODS: usize = 500;
/// Within this distance a motion has not left its orbit: near a fold a push is amplified before it dies out.
const NEAR: f64 = 1e-2;
/// A push is smaller than at first once it has been damped by e^−5.
const DAMPED: f64 = 5.0;

/// A model that is shipped.
pub fn model(name: &str) -> Model {
    files::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name)).unwrap()
}

/// A level of it at defaults.
pub fn level(model: &Model, forcing: f64) -> Level {
    let settings = Settings::default();
    let backbone = Backbone::compute(model, &settings).unwrap();
    Level::compute(model, &settings, &backbone, forcing).unwrap()
}

/// How far a motion that starts beside an orbit is from it after some periods, in shares of the orbit's own size; the
/// displacements and, over ω, the velocities of all modes.
fn distance_after(model: &Model, orbit: &Orbit, periods: usize) -> f64 {
    let n = model.size();
    let size = |state: &[f64]| {
        let of = |values: &[f64], scale: f64| values.iter().map(|value| (value * scale).powi(2)).sum::<f64>();
        (of(&state[..n], 1.0) + of(&state[n..2 * n], 1.0 / orbit.omega)).sqrt()
    };
    let whole = size(&orbit.state);
    let mut start = orbit.state.clone();
    // Of all modes, in displacement and velocity, and of no symmetry.
    for (j, value) in start[..2 * n].iter_mut().enumerate() {
        let scale = if j < n { 1.0 } else { orbit.omega };
        *value += PUSH * whole * scale / (1.0 + j as f64);
    }
    let mut marching = orbit.marching(model).unwrap();
    marching.restart(&start).unwrap();
    for _ in 0..periods {
        marching.period().unwrap();
    }
    let apart: Vec<f64> = marching.state().iter().zip(&orbit.state).map(|(a, b)| a - b).collect();
    size(&apart) / whole
}

/// Marches from every point of a branch that has a verdict; how many were stable, and unstable.
fn check(model: &Model, branch: &Branch, points: usize, what: &str) -> [usize; 2] {
    let settings = AlongSettings { points, most: 2 * points, ..AlongSettings::default() };
    let found = along(model, &settings, branch, &mut |_| ControlFlow::Continue(()));
    let mut counts = [0, 0];
    for point in &found.points {
        let Some(polished) = &point.polish.polished else { continue };
        let place = || format!("{what}, point {}: {:?}", point.index, polished.multipliers[0]);
        match point.polish.verdict {
            Verdict::Stable => {
                let left = distance_after(model, &polished.orbit, PERIODS);
                let is_damped = -polished.multipliers[0].modulus().ln() * PERIODS as f64 > DAMPED;
                assert!(left < if is_damped { PUSH } else { NEAR }, "{} was left by {left:e}", place());
                counts[0] += 1;
            }
            // A push grows by |μ| a period: as long as it takes to a hundred times its size, and as much again.
            Verdict::Unstable => {
                let rate = polished.multipliers[0].modulus().ln();
                let periods = (2.0 * 100f64.ln() / rate).ceil();
                if periods <= 2.0 * PERIODS as f64 {
                    let left = distance_after(model, &polished.orbit, periods as usize);
                    assert!(left > 10.0 * PUSH, "{} was left by {left:e} only", place());
                    counts[1] += 1;
                }
            }
            Verdict::Marginal | Verdict::NoOrbitNearby | Verdict::NotComparable => {}
        }
    }
    counts
}

/// The branches of a level of a model, at so many points at first; at least so many are stable, and unstable.
fn check_level(name: &str, forcing: f64, points: usize, least: [usize; 2]) {
    let model = model(name);
    let level = level(&model, forcing);
    let mut counts = [0, 0];
    for (id, branch) in level.branches() {
        let [stable, unstable] = check(&model, branch, points, &format!("{name}, A = {forcing}, {id}"));
        counts = [counts[0] + stable, counts[1] + unstable];
    }
    println!("{name}, A = {forcing}: {counts:?}");
    assert!(counts[0] >= least[0] && counts[1] >= least[1], "{name}: {counts:?}");
}

#[test]
fn a_nonlinear_damper() {
    check_level("nonlinear_damper", 0.007, 12, [10, 2]);
}

#[test]
fn a_tuned_absorber() {
    check_level("nltva", 0.18, 12, [5, 5]);
}

#[test]
fn two_blades() {
    check_level("two_blades", 0.034, 12, [5, 5]);
}

#[test]
fn dampers_with_two_isolas() {
    check_level("damper_two_isolas", 0.016, 12, [5, 1]);
}

#[test]
fn two_dampers() {
    check_level("two_dampers", 0.068, 12, [5, 1]);
}

#[test]
fn a_duffing_oscillator() {
    check_level("duffing", 0.1, 12, [5, 1]);
}

#[test]
fn a_rod_before_a_stop() {
    check_level("cantilever_stop", 1.0, 12, [1, 1]);
}

#[test]
fn a_subharmonic_of_a_chain() {
    check_level("chain_subharmonic", 1.5, 16, [15, 20]);
}

#[test]
fn a_subharmonic_of_a_duffing_oscillator() {
    check_level("duffing_subharmonic", 1.5, 12, [5, 0]);
}

#[test]
fn a_subharmonic_of_a_stop() {
    check_level("stop_subharmonic", 0.3, 12, [5, 0]);
}

#[test]
fn a_mass_with_friction() {
    check_level("friction_mass", 1.0, 12, [10, 0]);
}

#[test]
fn a_subharmonic_with_impacts() {
    check_level("impact_subharmonic", 0.2, 24, [10, 0]);
}

#[test]
fn two_masses_before_a_stop() {
    check_level("two_masses_stop", 0.1, 12, [5, 0]);
}

#[test]
fn rotor_67() {
    check_level("rotor67", 20.0, 2, [1, 1]);
}

#[test]
fn rotor_67_of_another_thickness() {
    check_level("rotor67_thickness", 40.0, 2, [1, 1]);
}
