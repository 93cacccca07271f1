//! Points of every shipped model fulfil the harmonic balance as it is written once more for these tests, with all laws, and
//! what is not a solution does not.

use crate::support::balance::Balance;
use crate::support::study::{Study, shipped, with_harmonics};
use solver::response::branch::BranchPoint;
use solver::settings::{HarmonicSettings, Quadrature};
use solver::{Model, Settings};

/// Largest share of the largest term that a point of the level leaves over.
fn worst(study: &Study, forcing: f64) -> f64 {
    let level = study.level(forcing);
    let points: Vec<&BranchPoint> = level.iter().flat_map(|listed| &listed.branch.points).collect();
    let balance = Balance::new(&study.model);
    // All laws are at work somewhere; a few dozen points are enough.
    let step = points.len().div_ceil(40);
    let leave = |point: &&BranchPoint| balance.residual(&point.state).relative();
    let largest = points.iter().step_by(step).map(leave).fold(0.0, f64::max);
    println!("{}, A = {forcing}: {} points, {largest:.1e}", study.model.name(), points.len());
    largest
}

fn check(model: Model, settings: Settings, forcing: f64, tolerance: f64) {
    let study = Study::new(model, settings);
    let found = worst(&study, forcing);
    assert!(found < tolerance, "{}: {found:e}", study.model.name());
    // The same motion is none at a forcing or a frequency that is off by a thousandth.
    let level = study.level(forcing);
    let peak = &level.iter().map(|listed| listed.branch.peak()).next().unwrap().state;
    let balance = Balance::new(&study.model);
    let mut driven = peak.clone();
    driven.forcing *= 1.001;
    let left = balance.residual(&driven).left;
    let forced = balance.residual(peak).forcing;
    assert!((left / (1e-3 * forced) - 1.0).abs() < 0.1, "{}: {left:e} of {forced:e}", study.model.name());
    let mut faster = peak.clone();
    faster.omega *= 1.001;
    assert!(balance.residual(&faster).left > 1e-3 * forced, "{}", study.model.name());
}

#[test]
fn springs_and_dampers() {
    check(shipped("duffing", &[]), with_harmonics(7), 0.1, 1e-9);
    check(shipped("nonlinear_damper", &[]), with_harmonics(7), 0.012, 1e-9);
    check(shipped("nltva", &[]), with_harmonics(7), 0.15, 1e-9);
}

#[test]
fn stops() {
    // Kinks are summed over to third order in the time between 4096 instants, and impacts are short.
    check(shipped("impact_subharmonic", &[]), with_harmonics(20), 1.0, 1e-7);
    check(shipped("cantilever_stop", &[]), with_harmonics(10), 0.2, 1e-8);
    let mut settings = with_harmonics(10);
    settings.backbone.modes = solver::ModeChoice::one(2);
    check(shipped("two_masses_stop", &[]), settings, 0.005, 1e-8);
}

#[test]
fn dry_friction() {
    // The slider of the balance that checks comes to rest, and begins to slide, at one of its 4096 samples.
    check(shipped("friction_mass", &[]), with_harmonics(3), 0.2, 1e-6);
    let mut settings = with_harmonics(3);
    settings.harmonics = HarmonicSettings { samples: 4096, quadrature: Quadrature::Samples, ..settings.harmonics };
    check(shipped("friction_mass", &[]), settings, 0.2, 1e-9);
}

#[test]
fn a_blade_that_rubs() {
    check(shipped("rotor67", &[]), Settings::default(), 60.0, 1e-8);
}
