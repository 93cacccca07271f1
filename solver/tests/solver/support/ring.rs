//! A ring of sectors.

use super::study::with_harmonics;
use solver::laws::{PolynomialSpring, Term};
use solver::response::branch::BranchPoint;
use solver::{Matrix, Model, SearchRange, Settings};
use std::ops::ControlFlow;

/// Stiffness of a sector, with its coupling to both neighbours, N/m.
pub const LINEAR: f64 = 1.1;
/// Stiffness between neighbours as they feel it, N/m.
pub const COUPLING: f64 = -0.05;
/// Of the springs, N/m³.
pub const CUBIC: f64 = 0.5;
/// N s/m.
pub const DAMPING: f64 = 0.006;

/// Goes on whatever it is told.
pub fn quiet(_: &BranchPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Four sectors in a ring, on springs that harden; two opposite ones are driven against each other.
pub fn ring() -> Model {
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: CUBIC }] };
    let coupling = |i: usize, j: usize| match i.abs_diff(j) {
        0 => LINEAR,
        2 => 0.0,
        _ => COUPLING,
    };
    let ring = Model::builder("ring")
        .dofs(["s1", "s2", "s3", "s4"])
        .mass(Matrix::diagonal(&[1.0; 4]))
        .stiffness(Matrix::from_fn(4, 4, coupling))
        .damping_matrix(Matrix::diagonal(&[DAMPING; 4]))
        .force("s1", 1.0)
        .force("s3", -1.0)
        .monitor("s1");
    let sectors = ["s1", "s2", "s3", "s4"].into_iter();
    sectors.fold(ring, |ring, sector| ring.element(sector, spring.clone(), [[(sector, 1.0)]])).build().unwrap()
}

/// So many sectors in a ring, all driven alike, each softly coupled to its neighbours, so that all other modes are below the one that is
/// driven; most of them are double.
pub fn driven_alike(sectors: usize) -> Model {
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: CUBIC }] };
    let coupling = |i: usize, j: usize| match i.abs_diff(j) {
        0 => LINEAR,
        d if d == 1 || d == sectors - 1 => -COUPLING,
        _ => 0.0,
    };
    let ring = Model::builder("ring")
        .mass(Matrix::diagonal(&vec![1.0; sectors]))
        .stiffness(Matrix::from_fn(sectors, sectors, coupling))
        .damping_matrix(Matrix::diagonal(&vec![DAMPING; sectors]))
        .force_shape(vec![1.0; sectors])
        .monitor(0);
    (0..sectors).fold(ring, |ring, i| ring.element(format!("s{i}"), spring.clone(), [vec![(i, 1.0)]])).build().unwrap()
}

/// Around its resonance, with so many harmonics.
pub fn within(harmonics: usize) -> Settings {
    let mut settings = with_harmonics(harmonics);
    (settings.frequency.min, settings.frequency.max) = (Some(0.9), Some(1.8));
    settings
}

/// The same as a range.
pub fn reach() -> SearchRange {
    SearchRange { frequency: (0.9, 1.8), amplitude: 10.0, natural: None, forcing: None }
}
