//! The derivative of a marched period against central differences.

use super::models::*;
use solver::laws::LawKind;
use solver::{Marching, MarchingSettings, Model};

const OMEGA: f64 = 20.0;

/// Compares the monodromy matrix of the period that follows three others with central differences; returns the share of
/// the period in contact. Displacements, velocities and memory are measured in their sizes on the way, and the bound is
/// relative to the largest entry then.
#[track_caller]
fn assert_exact(model: &Model, forcing: f64, bound: f64) -> f64 {
    let settings = MarchingSettings { min_steps_per_period: Some(600), ..MarchingSettings::default() };
    let mut marching = Marching::new(model, &settings, forcing, OMEGA).unwrap();
    let n = model.size();
    marching.set_state(&vec![0.0; n], &vec![0.1; n]).unwrap();
    for _ in 0..3 {
        marching.period().unwrap();
    }
    let state = marching.state();
    marching.restart(&state).unwrap();
    let tangent = marching.monodromy().unwrap();
    assert_eq!(tangent.rows(), marching.state_size());
    let mut end = |shift: f64, j: usize| {
        let mut from = state.clone();
        from[j] += shift;
        marching.restart(&from).unwrap();
        let contact = marching.period().unwrap().contact;
        (marching.state(), contact.iter().fold(0.0f64, |a, &b| a.max(b)))
    };
    let (mut worst, mut largest) = (0.0f64, 0.0f64);
    let sizes = [(0, n), (n, 2 * n), (2 * n, state.len())]
        .map(|(a, b)| state[a..b].iter().fold(0.0f64, |m, x| m.max(x.abs())).max(1e-9));
    let size = |i: usize| sizes[(i / n).min(2)];
    for j in 0..state.len() {
        let step = 1e-6 * size(j);
        let (after, before) = (end(step, j).0, end(-step, j).0);
        let exact: Vec<f64> = (0..state.len()).map(|i| tangent[(i, j)] * size(j) / size(i)).collect();
        largest = exact.iter().fold(largest, |m, x| m.max(x.abs()));
        for i in 0..state.len() {
            let difference = (after[i] - before[i]) / (2e-6 * size(i));
            worst = worst.max((difference - exact[i]).abs());
        }
    }
    println!("{worst:e} of {largest:e}");
    assert!(worst < bound * largest, "{worst:e} of {largest:e}");
    end(0.0, 0).1
}

/// Smallest and largest x1 − x2 (m), and the sliders' smallest and largest force (N), in the period that is compared.
fn reached(model: &Model) -> [f64; 4] {
    let settings = MarchingSettings { min_steps_per_period: Some(600), ..MarchingSettings::default() };
    let mut marching = Marching::new(model, &settings, 60.0, OMEGA).unwrap();
    let n = model.size();
    marching.set_state(&vec![0.0; n], &vec![0.1; n]).unwrap();
    for _ in 0..3 {
        marching.period().unwrap();
    }
    let mut reached = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
    for _ in 0..marching.steps_per_period() {
        marching.step().unwrap();
        let (x, state) = (marching.displacements(), marching.state());
        let force = state.get(2 * n).copied().unwrap_or(0.0);
        for (i, value) in [x[0] - x[1], force].into_iter().enumerate() {
            reached[2 * i] = reached[2 * i].min(value);
            reached[2 * i + 1] = reached[2 * i + 1].max(value);
        }
    }
    reached
}

#[test]
fn laws_are_differentiated_where_they_act_and_where_they_do_not() {
    let on = |law: LawKind| chain(vec![(law, vec![vec![(0, 1.0), (1, -1.0)]])]);
    let [least, largest, ..] = reached(&on(penalty(2e3, 0.002)));
    assert!(least < 0.0 && largest > 0.003, "{least} {largest}");
    // It slips both ways, and sticks for the way back of 4 N.
    let [least, largest, low, high] = reached(&on(jenkins(800.0, 2.0)));
    assert!(low == -2.0 && high == 2.0 && largest - least > 2.0 * 2.0 / 800.0, "{low} {high} {least} {largest}");
}

#[test]
fn every_explicit_law_is_differentiated_exactly() {
    let on = |law: LawKind| (law, vec![vec![(0, 1.0), (1, -1.0)]]);
    for law in [
        spring(5e4),
        damper(0.3),
        tanh_friction(2.0, 1.0),
        tanh_friction(2.0, 0.02),
        penalty(2e3, 0.002),
        jenkins(800.0, 2.0),
    ] {
        println!("{law:?}");
        // Central differences of smooth laws err by the square of the step.
        assert_exact(&chain(vec![on(law.clone())]), 60.0, 1e-7);
        assert_exact(&coupled(chain(vec![on(law)])), 60.0, 1e-7);
    }
}

#[test]
fn laws_with_and_without_memory_are_differentiated_together() {
    let laws = vec![
        (jenkins(800.0, 2.0), vec![vec![(0, 1.0)]]),
        (damper(0.3), vec![vec![(1, 1.0)]]),
        (stop(0.01), vec![vec![(2, 1.0)]]),
        (jenkins(500.0, 1.0), vec![vec![(2, 1.0), (1, -1.0)]]),
    ];
    let contact = assert_exact(&chain(laws), 60.0, 1e-7);
    assert!(contact > 0.02 && contact < 0.9, "{contact}");
}

#[test]
fn contact_with_and_without_friction_is_differentiated_exactly() {
    let two = vec![(stop(0.01), vec![vec![(2, 1.0)]]), (stop(0.012), vec![vec![(0, 1.0), (1, -0.3)]])];
    let rubs = |radius, sense| {
        let channels = vec![vec![(2, 1.0)], vec![(0, 1.0), (1, -1.0)], vec![(1, 1.0)]];
        vec![(rubbing(0.01, radius, sense), channels), (stop(0.012), vec![vec![(0, 1.0)]])]
    };
    // Sliding that turns all the time, and sliding that hardly does.
    for elements in [two, rubs(0.05, 1.0), rubs(0.05, -1.0), rubs(5.0, 1.0)] {
        for model in [chain(elements.clone()), coupled(chain(elements))] {
            let contact = assert_exact(&model, 60.0, 1e-7);
            assert!(contact > 0.02 && contact < 0.9, "{contact}");
        }
    }
}
