//! Multipliers of a smooth motion three times over: Hill's matrix of the balance, the linearised equation integrated along the
//! balance's motion, and the marcher's own orbit.

use super::common::{assert_close, fundamental, main_branch};
use super::models::spring;
use solver::formulation::harmonics::{Transform, add_product_matrix, evaluate, width};
use solver::linalg::{Matrix, eigenvalues};
use solver::stability::polish::{Around, PolishSettings, polish};
use solver::{Model, Settings, State};
use std::f64::consts::TAU;

/// x'' + c x' + x + x³ = A cos ωt.
const C: f64 = 0.05;

/// Multipliers by modulus: e^{sT} of the two eigenvalues s with the smallest imaginary parts of
/// (s + D)² + c (s + D) + w = 0, D the derivative of a series and w = 1 + 3x² by which it is multiplied.
fn hill(series: &[f64], omega: f64) -> [f64; 2] {
    let harmonics = series.len() / 2;
    let (n, samples) = (width(harmonics), 1024);
    let weight: Vec<f64> =
        (0..samples).map(|i| 1.0 + 3.0 * evaluate(series, TAU * i as f64 / samples as f64)[0].powi(2)).collect();
    let mut coefficients = vec![Default::default(); 2 * harmonics + 1];
    let mut unused = coefficients.clone();
    Transform::new(harmonics, samples).analyse(&weight, &weight, &mut coefficients, &mut unused);
    let mut product = vec![0.0; n * n];
    add_product_matrix(&coefficients, None, &mut product, n);
    // a_k ← k b_k ω, b_k ← −k a_k ω.
    let slope = Matrix::from_fn(n, n, |i, j| match i.div_ceil(2) {
        k if k == j.div_ceil(2) && i != j => omega * k as f64 * if i < j { 1.0 } else { -1.0 },
        _ => 0.0,
    });
    let square = slope.matmul(&slope);
    let companion = Matrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, true) => 0.0,
        (true, false) => f64::from(u8::from(i + n == j)),
        (false, true) => -square[(i - n, j)] - C * slope[(i - n, j)] - product[(i - n) * n + j],
        (false, false) => -2.0 * slope[(i - n, j - n)] - if i == j { C } else { 0.0 },
    });
    let mut exponents = eigenvalues(&companion).unwrap();
    exponents.sort_by(|a, b| a.im.abs().total_cmp(&b.im.abs()));
    let moduli = [exponents[0], exponents[1]].map(|s| (s.re * TAU / omega).exp());
    [moduli[0].max(moduli[1]), moduli[0].min(moduli[1])]
}

/// The same from the linearised equation along the series, by the classical Runge–Kutta method.
fn integrated(series: &[f64], omega: f64) -> [f64; 2] {
    let stiffness = |t: f64| 1.0 + 3.0 * evaluate(series, omega * t)[0].powi(2);
    let columns = fundamental(C, stiffness, TAU / omega, 4000);
    let mut moduli: Vec<f64> =
        eigenvalues(&Matrix::from_fn(2, 2, |i, j| columns[j][i])).unwrap().iter().map(|mu| mu.norm()).collect();
    moduli.sort_by(|a, b| b.total_cmp(a));
    [moduli[0], moduli[1]]
}

#[test]
fn hills_matrix_direct_integration_and_the_marched_orbit_agree_on_smooth_motions() {
    let model = Model::builder("Duffing")
        .mass([[1.0]])
        .stiffness([[1.0]])
        .damping_ratio(0.5 * C)
        .force("x1", 1.0)
        .element("spring", spring(1.0), ["x1"])
        .build()
        .unwrap();
    let mut settings = Settings::default();
    settings.harmonics.count = 20;
    (settings.frequency.min, settings.frequency.max) = (Some(0.6), Some(3.0));
    let branch = main_branch(&model, &settings, 0.2);
    let mut fine = PolishSettings::default();
    fine.marching.min_steps_per_period = Some(8192);
    let (mut unstable, mut compared) = (0, 0);
    for index in (0..branch.points.len()).step_by(branch.points.len() / 12) {
        let state: &State = &branch.points[index].state;
        let series = state.displacement(&model, 0);
        let (a, b) = (hill(&series, state.omega), integrated(&series, state.omega));
        for (a, b) in a.iter().zip(b) {
            assert_close(*a, b, 1e-8, "Hill's matrix against integration");
        }
        // The marcher errs by (ωh)²/24 of the frequency, 2e-8 of it here; near a fold it comes to an orbit whose distance is
        // more than that, and a real multiplier moves with its root.
        let polished = polish(&model, &fine, state, Around::default()).polished;
        if let Some(polished) = polished.filter(|polished| polished.distance < 1e-5) {
            assert_close(polished.multipliers[0].modulus(), a[0], 1e-4, "the marched orbit against Hill's matrix");
            compared += 1;
            unstable += usize::from(a[0] > 1.0);
        }
    }
    println!("{compared} compared, {unstable} of them unstable");
    assert!(compared >= 8 && unstable >= 2, "{compared} {unstable}");
}
