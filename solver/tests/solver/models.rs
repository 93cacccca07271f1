//! Every model folder loads, and what is known in closed form about it holds.

use solver::files;
use solver::linalg::dot;
use solver::structure::laws::LawKind;
use solver::structure::{Damping, Model};
use std::path::{Path, PathBuf};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name)
}

fn load(name: &str, overrides: &[(&str, &str)]) -> Model {
    files::load_with(&folder(name), overrides).unwrap_or_else(|error| panic!("{error}"))
}

fn assert_close(value: f64, expected: f64, relative: f64) {
    assert!((value / expected - 1.0).abs() < relative, "{value} is not {expected} to {relative}");
}

#[test]
fn every_folder_loads_with_orthonormal_modes() {
    let mut count = 0;
    for entry in std::fs::read_dir(folder("")).unwrap() {
        let dir = entry.unwrap().path();
        // Beside the folders there are scripts.
        if !dir.is_dir() {
            continue;
        }
        let model = files::load(&dir).unwrap_or_else(|error| panic!("{error}"));
        let shapes = &model.modes().shapes;
        let product = shapes.transpose().matmul(&model.mass().matmul(shapes));
        for i in 0..model.size() {
            for j in 0..model.size() {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((product[(i, j)] - expected).abs() < 1e-12, "{}: modes {i}, {j}", model.name());
            }
        }
        assert!(model.modes().frequencies.is_sorted());
        assert!(!model.elements().is_empty(), "{} is linear", model.name());
        count += 1;
    }
    assert!(count >= 8, "only {count} models");
}

#[test]
fn rotor67_has_its_published_frequencies() {
    // SciPy's generalised eigenvalues, by the finite element code that made the matrices.
    let expected = [
        2333.3301985364524,
        6356.13366153924,
        10773.75729307975,
        14509.3452801403,
        17375.09109781374,
        20431.539221383704,
        23216.551307653444,
        28017.981626343517,
        30289.314856819856,
        31258.54643785799,
    ];
    let model = load("rotor67", &[]);
    for (frequency, expected) in model.modes().frequencies.iter().zip(expected) {
        assert_close(*frequency, expected, 1e-6);
    }
    // The frequencies that the paper lists.
    let tuned = load("rotor67", &[("matrices.stiffness", "rom_K_tuned.mtx")]);
    let paper = [(1, 2039.8), (2, 6343.7), (3, 10745.3), (4, 14830.3), (5, 18680.9), (7, 23579.1), (8, 29975.8)];
    for (mode, expected) in paper {
        assert_close(tuned.modes().frequencies[mode - 1], expected, 1e-6);
    }
}

#[test]
fn rotor67_is_set_up_like_the_paper() {
    let model = load("rotor67", &[]);
    assert_eq!((model.size(), model.elements().len()), (39, 9));
    assert_eq!(model.monitors(), [0]);
    // Leading edge outwards in mode 1, in 1/sqrt(kg), from the finite element code.
    assert_close(model.modes().shapes[(0, 0)], 0.7686561762970655, 1e-6);
    assert_eq!(model.forcing().shape, model.mass().mul_vec(&model.modes().shapes.column(0)));
    assert_eq!(model.forcing().harmonic, 1);
    for j in 0..model.size() {
        let force = dot(&model.modes().shapes.column(j), &model.forcing().shape);
        assert!((force - if j == 0 { 1.0 } else { 0.0 }).abs() < 1e-12, "modal force {j} is {force}");
    }
    let Damping::Modal(damping) = model.damping() else { panic!("damping is modal") };
    for (j, (d, w)) in damping.iter().zip(&model.modes().frequencies).enumerate() {
        assert_close(d / (2.0 * w), if j < 2 { 1e-3 } else { 5e-3 }, 1e-14);
    }
    for (node, element) in model.elements().iter().enumerate() {
        assert_eq!(element.name, format!("b{node}"));
        assert_eq!(element.channels, (0..3).map(|k| vec![(3 * node + k, 1.0)]).collect::<Vec<_>>());
        let LawKind::Contact(contact) = &element.law else { panic!("contact") };
        assert_eq!((contact.gap, contact.epsilon), (4e-4, 1e7));
        let friction = contact.friction.as_ref().unwrap();
        assert_eq!((friction.coefficient, friction.sense), (0.15, -1.0));
        assert!((0.247..0.255).contains(&friction.radius));
    }
}

#[test]
fn overrides_change_a_model() {
    let frictionless = load("rotor67", &[("contact.friction", "0")]);
    for element in frictionless.elements() {
        assert_eq!(element.channels.len(), 1);
        let LawKind::Contact(contact) = &element.law else { panic!("contact") };
        assert!(contact.friction.is_none());
    }
    let model = load("rotor67", &[("contact.sense", "1"), ("contact.nodes.3.gap", "5e-4"), ("name", "mine")]);
    assert_eq!(model.name(), "mine");
    let LawKind::Contact(contact) = &model.elements()[3].law else { panic!("contact") };
    assert_eq!((contact.gap, contact.friction.as_ref().unwrap().sense), (5e-4, 1.0));
}

#[test]
fn the_cantilever_has_the_frequencies_of_a_beam() {
    let model = load("cantilever_stop", &[]);
    let (ei, rho_a, length) = (210e9 * 0.02 * 0.01_f64.powi(3) / 12.0, 7800.0 * 0.02 * 0.01, 1.0_f64);
    // The error of ten cubic elements is (β l)⁴/1440: 8.6e-7, 3.4e-5 and 2.6e-4 for the first three modes.
    let known = [(1.8751040687119611, 1e-6), (4.694091132974175, 4e-5), (7.854757438237613, 3e-4)];
    for (frequency, (beta, tolerance)) in model.modes().frequencies.iter().zip(known) {
        assert_close(*frequency, beta * beta * (ei / (rho_a * length.powi(4))).sqrt(), tolerance);
    }
    let LawKind::Contact(contact) = &model.elements()[0].law else { panic!("contact") };
    // Cubic shape functions are exact under a force at a node: 3 E I / L³.
    assert_close(contact.epsilon, 3.0 * ei / length.powi(3), 1e-9);
}

#[test]
fn two_bodies_touch_along_their_relative_displacement() {
    let model = load("two_masses_stop", &[]);
    assert_eq!(model.elements()[0].channels, [vec![(0, 1.0), (1, -1.0)]]);
    assert_close(model.modes().frequencies[1], 3.0_f64.sqrt(), 1e-14);
    assert!((model.forcing().shape[0] + model.forcing().shape[1]).abs() < 1e-14);
}

#[test]
fn the_absorber_follows_from_its_mass_ratio() {
    // Equal-peak tuning: Habib, Detroux, Viguié & Kerschen, MSSP 52-53, 2015; the folder holds rounded values.
    let e = 0.05_f64;
    let root = (4.0 + 3.0 * e).sqrt();
    let stiffness = 8.0 * e * (16.0 + 23.0 * e + 9.0 * e * e + 2.0 * (2.0 + e) * root)
        / (3.0 * (1.0 + e).powi(2) * (64.0 + 80.0 * e + 27.0 * e * e));
    let damping = (stiffness * e * (8.0 + 9.0 * e - 4.0 * root) / (4.0 * (1.0 + e))).sqrt();
    let model = load("nltva", &[]);
    assert_close(model.stiffness()[(1, 1)], stiffness, 2e-3);
    assert_eq!(model.elements()[1].channels, [vec![(0, 1.0), (1, -1.0)]]);
    let Damping::Full(modal) = model.damping() else { panic!("the absorber couples the modes") };
    // The trace of Φᵀ C Φ is that of M⁻¹ C.
    assert_close(modal[(0, 0)] + modal[(1, 1)], 0.002 + damping * (1.0 + 1.0 / e), 4e-3);
}
