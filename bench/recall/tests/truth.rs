//! The program that finds the truth, against closed forms; what it has stored; and the comparison.

use recall::balance::Balance;
use recall::comparison::compare;
use recall::confirm::closed_through;
use recall::draw;
use recall::known::{Extent, Known};
use recall::model::{Damping, Element, Forcing, Law, Matrices, Model, Shape, Term};
use recall::product::Row;
use recall::quadrature::{Nodes, dot};
use recall::record::{Isola, Kind, Level, Record, Resonance};
use recall::shooting;
use recall::starts::{converged, responses};
use recall::structure::Structure;
use recall::survey::HARMONICS;
use recall::walk::{Bounds, Curve, End, walk};
use std::collections::BTreeMap;

fn model(ratio: f64, law: Law) -> Model {
    let dofs = BTreeMap::from([("x1".to_string(), 1.0)]);
    Model {
        name: String::new(),
        monitors: vec!["x1".into()],
        matrices: Matrices { mass: vec![vec![1.0]], stiffness: vec![vec![1.0]] },
        damping: Damping { default_ratio: ratio },
        forcing: Forcing { shape: Shape { dofs: dofs.clone() }, harmonic: 1 },
        laws: vec![Element { name: String::new(), coefficients: dofs, law }],
    }
}

fn one_mass(ratio: f64, law: Law) -> Structure {
    Structure::new(&model(ratio, law))
}

fn cubic(coefficient: f64) -> Law {
    Law::PolynomialSpring { terms: vec![Term { power: 3, coefficient }] }
}

/// Every column of the Jacobian is the difference quotient of the residual: springs, stops, dampers, a forcing on
/// harmonic 2 or 3.
#[test]
fn the_jacobian_is_the_derivative_of_the_residual() {
    for number in 1..=16 {
        let drawn = draw::structure(number);
        let structure = Structure::new(&drawn.model);
        let balance = Balance::new(&structure, 4, drawn.forcings[0]);
        let y: Vec<f64> = (0..=balance.size()).map(|i| 0.6 + 0.5 * (1.7 * i as f64).sin()).collect();
        let at = balance.evaluate(&y);
        let scale = at.residual.iter().map(|r| r.abs()).fold(0.0, f64::max);
        for j in 0..=balance.size() {
            let step = 1e-6;
            let moved = |by: f64| {
                let mut y = y.clone();
                y[j] += by;
                balance.evaluate(&y).residual
            };
            for (i, (above, below)) in moved(step).iter().zip(moved(-step)).enumerate() {
                let difference = (above - below) / (2.0 * step);
                // Rounding leaves 1e-16/1e-6, curvature 1e-12, of numbers up to some hundreds.
                let off = (difference - at.jacobian[(i, j)]).abs();
                assert!(off < 1e-6 * (1.0 + scale), "structure {number}, entry {i}, {j}: off by {off:.1e}");
            }
        }
    }
}

/// The mean of max(0, cos τ − g) is (√(1 − g²) − g arccos g)/π.
#[test]
fn arcs_of_contact_are_integrated_exactly() {
    for gap in [-0.5, 0.0, 0.3, 0.99] {
        let mut series = vec![0.0; 11];
        series[1] = 1.0;
        let nodes = Nodes::beyond(gap, &series, &Nodes::even(160, 5));
        let force = |q: usize| nodes.weights[q] * (dot(nodes.at(q), &series) - gap);
        let mean = (0..nodes.weights.len()).map(force).sum::<f64>() / std::f64::consts::TAU;
        let exact = ((1.0 - gap * gap).sqrt() - gap * gap.acos()) / std::f64::consts::PI;
        assert!((mean - exact).abs() < 1e-12, "gap {gap}: {mean} instead of {exact}");
    }
}

/// With one harmonic the peak of the Duffing oscillator obeys ω² = 1 + ¾a², 2ξωa = A, but for ξ² beside 1 (1e-4).
#[test]
fn the_main_branch_has_the_peak_of_the_duffing_oscillator() {
    let (ratio, peak) = (0.01, 1.5f64);
    let omega = (1.0 + 0.75 * peak * peak).sqrt();
    let structure = one_mass(ratio, cubic(1.0));
    let balance = Balance::new(&structure, 1, 2.0 * ratio * omega * peak);
    let (start, _) = converged(&balance, &[0.0, balance.forcing / 0.75, 0.0, 0.5]).unwrap();
    let bounds = Bounds { omega: (0.1, 3.0), size: 10.0, points: 5000 };
    let (points, end) = walk(&balance, &start, &[0.0, 0.0, 0.0, 1.0], &bounds);
    assert_eq!(end, End::Above);
    let found = Extent::of(&balance, &points).peak;
    assert!((found.1 - peak).abs() < 3e-4 && (found.0 - omega).abs() < 0.02, "{found:?}");
}

/// A damper whose force has extrema has an isola between them: 0.018 V − ¾ 0.01 V³ + ⅝ 0.00144 V⁵ from 0.0048 to
/// 0.0114. Starts find it, its curve closes, and time integration has its orbits.
#[test]
fn starts_find_the_isola_of_a_damper() {
    let terms = vec![Term { power: 3, coefficient: -0.01 }, Term { power: 5, coefficient: 0.00144 }];
    let structure = one_mass(0.009, Law::PolynomialDamper { terms });
    let closed = |forcing: f64| {
        let balance = Balance::new(&structure, 5, forcing);
        let mut known = Known::new(&balance, Bounds { omega: (0.3, 3.0), size: 10.0, points: 4000 });
        responses(&balance, (0.8, 1.2), (0.1, 10.0), 1)
            .take(300)
            .flatten()
            .for_each(|(y, tangent)| known.add(&y, &tangent));
        let closed: Vec<_> = known.curves.iter().filter(|(curve, _)| curve.is_closed()).collect();
        closed.iter().for_each(|(curve, _)| {
            let side = &curve.points[curve.points.len() / 3];
            assert!(shooting::deviation(&balance, side).is_some_and(|deviation| deviation < 0.01));
        });
        closed.len()
    };
    assert_eq!([0.0045, 0.006, 0.0095, 0.012].map(closed), [0, 1, 1, 0]);
}

/// The same isola from a motion that is near it; from one of the main branch none, nor from one that is nowhere near anything.
#[test]
fn what_is_listed_beyond_the_truth_is_followed_anew() {
    let (low, high) = (0.3, 3.0);
    let terms = vec![Term { power: 3, coefficient: -0.01 }, Term { power: 5, coefficient: 0.00144 }];
    let (forcing, model) = (0.006, model(0.009, Law::PolynomialDamper { terms }));
    let record = Record { number: 0, kind: Kind::Damper, model, range: [low, high], levels: Vec::new() };
    let structure = Structure::new(&record.model);
    let balance = Balance::new(&structure, HARMONICS, forcing);
    let mut known = Known::new(&balance, Bounds { omega: (low, high), size: 10.0, points: 4000 });
    responses(&balance, (0.8, 1.2), (0.1, 10.0), 1).take(300).flatten().for_each(|(y, t)| known.add(&y, &t));
    let (closed, open): (Vec<_>, Vec<_>) = known.curves.iter().partition(|(curve, _)| curve.is_closed());
    let near = |curve: &Curve| -> Vec<f64> { curve.points[curve.points.len() / 2].iter().map(|y| 1.001 * y).collect() };
    let isola = closed_through(&record, forcing, &[near(&closed[0].0)], &|_| true).unwrap();
    let [low, high] = isola.omega;
    let extent = Extent::of(&balance, &closed[0].0.points);
    assert!(isola.counts() && (low - extent.omega.0).abs() + (high - extent.omega.1).abs() < 1e-4 * high, "{isola:?}");
    let nowhere = vec![1.0; balance.size() + 1];
    assert!(closed_through(&record, forcing, &[near(&open[0].0)], &|_| true).is_none());
    assert!(closed_through(&record, forcing, &[nowhere], &|_| true).is_none());
    // The main branch is listed as an isola; the isola twice.
    let row = |omega: [f64; 2], peak: f64| Row {
        amplitude: forcing,
        branch: 1,
        kind: "isola".into(),
        omega_min: Some(omega[0]),
        omega_max: Some(omega[1]),
        amplitude_max: Some(peak),
        omega_at_max: None,
        peak_standing: "at".into(),
    };
    let rows = [row(isola.omega, isola.peak[1]), row(isola.omega, isola.peak[1]), row([0.5, 2.0], 0.3)];
    let level = Level { forcing, starts: 1, main: None, isolas: Vec::new(), open: 1, crowded: false };
    let mut compared = compare(&level, &rows);
    let motions = |row: &Row| {
        Ok::<_, std::convert::Infallible>(vec![near(if row.omega_min == Some(0.5) {
            &open[0].0
        } else {
            &closed[0].0
        })])
    };
    compared.confirm(&record, motions).unwrap();
    assert_eq!((compared.confirmed.len(), compared.extra.len()), (1, 2));
}

/// The linear oscillator's amplitude is A/|1 − ω² + 2iξω|; integration has it to the fourth order of its steps.
#[test]
fn time_integration_has_the_linear_response() {
    let (ratio, omega) = (0.05, 0.8f64);
    let structure = one_mass(ratio, cubic(0.0));
    let balance = Balance::new(&structure, 2, 0.3);
    let (y, _) = converged(&balance, &[0.0, 0.5, 0.5, 0.0, 0.0, omega]).unwrap();
    let omega = y[balance.size()];
    let exact = 0.3 / (1.0 - omega * omega).hypot(2.0 * ratio * omega);
    let balanced = recall::known::amplitude(&balance, &y);
    // The largest of 64 samples is low by (π/64)²/2 at most.
    assert!((balanced / exact - 1.0).abs() < 2e-3, "{balanced} instead of {exact}");
    assert!(shooting::deviation(&balance, &y).unwrap() < 2e-3);
}

#[test]
fn a_number_decides_everything_about_a_structure() {
    for number in 1..=200 {
        let drawn = draw::structure(number);
        assert_eq!(drawn, draw::structure(number), "structure {number} depends on something else");
        let structure = Structure::new(&drawn.model);
        assert!((1..=4).contains(&structure.size()) && structure.frequencies[0] > 0.0, "structure {number}");
        assert!((1e-3..=0.05).contains(&structure.ratio) && drawn.range[0] < drawn.range[1], "structure {number}");
        let is_at_rest = structure.elements.iter().all(|(_, law)| law.respond(0.0, 0.0).0 == 0.0);
        assert!(is_at_rest, "structure {number}");
    }
}

#[test]
fn what_is_stored_is_enough_and_is_of_these_structures() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/truth");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| std::fs::read_to_string(entry.unwrap().path()).unwrap());
    let texts: Vec<String> = files.collect();
    let records: Vec<Record> = texts.iter().map(|text| serde_json::from_str(text).unwrap()).collect();
    for (record, text) in records.iter().zip(&texts) {
        // Numbers are compared as they are written.
        let drawn = draw::structure(record.number);
        let model = serde_json::to_string(&drawn.model).unwrap();
        assert!(text.contains(&model), "{} is another structure than is drawn now", record.number);
    }
    let levels = records.iter().flat_map(|record| &record.levels).filter(|level| !level.crowded);
    let counted: Vec<&Isola> = levels.flat_map(|level| &level.isolas).filter(|isola| isola.counts()).collect();
    assert!(counted.len() >= 100 && records.len() >= 50, "{} isolas of {} structures", counted.len(), records.len());
    for resonance in [Resonance::FirstMode, Resonance::OtherMode, Resonance::SubHarmonic, Resonance::SuperHarmonic] {
        assert!(counted.iter().any(|isola| isola.resonance == resonance), "none of {resonance:?}");
    }
    // Time integration shares nothing with the balance but the laws.
    for isola in counted {
        assert!(isola.marched[0] >= 2 && isola.deviation <= 0.08, "{isola:?}");
    }
}

#[test]
fn isolas_are_matched_once_by_range_and_peak() {
    let isola = |low: f64, peak: f64| {
        serde_json::json!({"resonance": "first_mode", "omega": [low, low + 0.1], "peak": [low, peak], "standing": "isola",
            "marched": [4, 4], "deviation": 0.0, "hits": 9})
    };
    let level = serde_json::json!({"forcing": 2.0, "starts": 100, "main": [1.0, 0.5], "open": 0,
        "crowded": false, "isolas": [isola(1.0, 3.0), isola(1.3, 4.0)]});
    let level = serde_json::from_value(level).unwrap();
    let row = |kind: &str, low: f64, peak: f64| Row {
        amplitude: 2.0,
        branch: 1,
        kind: kind.into(),
        omega_min: Some(low),
        omega_max: Some(low + 0.1),
        amplitude_max: Some(peak),
        omega_at_max: Some(low),
        peak_standing: "at".into(),
    };
    let rows = [
        row("main", 0.1, 0.6),
        row("isola", 1.001, 3.02),
        row("isola", 1.001, 3.02),
        row("unfinished", 1.3, 4.0),
        row("isola", 1.5, 4.0),
    ];
    let compared = compare(&level, &rows);
    let found: Vec<bool> = compared.found.iter().map(|(_, row)| row.is_some()).collect();
    assert_eq!(found, [true, false]);
    assert_eq!(compared.extra.len(), 2);
    assert_eq!(compared.wrong_main.and_then(|row| row.amplitude_max), Some(0.6));
}
