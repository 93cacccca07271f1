//! Linear response, against a dense solve.

use super::common::*;
use solver::formulation::harmonics::complex;
use solver::formulation::linear::forced_response;
use solver::formulation::pressure::PressureForm;
use solver::formulation::scales::Scales;
use solver::formulation::state::State;
use solver::formulation::unknown::Unknown;
use solver::linalg::Matrix;
use solver::response::branch::Side;
use solver::response::forced::{Forced, SearchRange};
use solver::structure::Model;

/// A chain of five masses between two walls; the dampers give modal damping or a C that no modes diagonalise.
fn chain(proportional: bool) -> (Model, Matrix) {
    let n = 5;
    let masses = [1.0, 2.0, 0.5, 1.5, 1.0];
    let tridiagonal = |values: [f64; 6]| {
        Matrix::from_fn(n, n, |i, j| match (i + 1).saturating_sub(j) {
            1 if i == j => values[i] + values[i + 1],
            2 if i == j + 1 => -values[i],
            0 if j == i + 1 => -values[j],
            _ => 0.0,
        })
    };
    let stiffness = tridiagonal([1000.0, 1500.0, 800.0, 1200.0, 900.0, 1100.0]);
    let dashpots = tridiagonal([0.0, 3.0, 0.0, 0.2, 1.0, 0.0]);
    let ratios: Vec<f64> = (1..=n).map(|j| 0.004 * j as f64).collect();
    let mass = Matrix::diagonal(&masses);
    let model = Model::builder("chain").mass(mass.clone()).stiffness(stiffness);
    let damped =
        if proportional { model.damping_ratios(ratios.clone()) } else { model.damping_matrix(dashpots.clone()) };
    let model = damped
        .force_shape([0.0, 1.0, 0.0, -0.3, 0.2])
        // Far out of reach: the model is linear, but its contact is part of every system solved.
        .element("element", contact(1.0, 1e3), ["x5"])
        .monitor("x3")
        .build()
        .unwrap();
    // C = M Φ diag(2 ξ ω) Φᵀ M.
    let c = if proportional {
        let rates: Vec<f64> = ratios.iter().zip(&model.modes().frequencies).map(|(r, w)| 2.0 * r * w).collect();
        let left = mass.matmul(&model.modes().shapes);
        left.matmul(&Matrix::diagonal(&rates)).matmul(&left.transpose())
    } else {
        dashpots
    };
    (model, c)
}

/// (K + iωC − ω²M) x = A s by Gaussian elimination with pivoting on the equivalent real system of order 2n.
fn dense_response(model: &Model, c: &Matrix, amplitude: f64, omega: f64) -> Vec<(f64, f64)> {
    let n = model.size();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for part in 0..2 {
        for i in 0..n {
            let re = |j| model.stiffness()[(i, j)] - omega * omega * model.mass()[(i, j)];
            let im = |j| omega * c[(i, j)];
            let mut row: Vec<f64> = if part == 0 {
                (0..n).map(re).chain((0..n).map(|j| -im(j))).collect()
            } else {
                (0..n).map(im).chain((0..n).map(re)).collect()
            };
            row.push(if part == 0 { amplitude * model.forcing().shape[i] } else { 0.0 });
            rows.push(row);
        }
    }
    for k in 0..2 * n {
        let pivot = (k..2 * n).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs())).unwrap();
        rows.swap(k, pivot);
        let top = rows[k].clone();
        for (i, row) in rows.iter_mut().enumerate() {
            if i != k {
                let factor = row[k] / top[k];
                row.iter_mut().zip(&top).for_each(|(a, b)| *a -= factor * b);
            }
        }
    }
    let value = |i: usize| rows[i][2 * n] / rows[i][i];
    (0..n).map(|i| (value(i), value(n + i))).collect()
}

/// Largest difference of the displacements, and the largest displacement.
fn linear_error(model: &Model, c: &Matrix, state: &State) -> (f64, f64) {
    let exact = dense_response(model, c, state.forcing, state.omega);
    let size = exact.iter().fold(0.0f64, |m, x| m.max(x.0.hypot(x.1)));
    let error = exact.iter().enumerate().map(|(i, x)| {
        let series = displacement(model, state, i);
        let first = complex(&series, 1);
        let rest: f64 = series.iter().enumerate().filter(|&(k, _)| k != 1 && k != 2).map(|(_, x)| x.abs()).sum();
        (first.re - x.0).hypot(first.im - x.1) + rest
    });
    (error.fold(0.0, f64::max), size)
}

#[test]
fn the_linear_response_is_that_of_a_dense_solve() {
    for proportional in [true, false] {
        let (model, c) = chain(proportional);
        let unknown = Unknown::Frequency { forcing: 2.5 };
        let problem = PressureForm::new(&model, with_harmonics(3).harmonics, 0, unknown, Scales::new(&model, 0));
        let top = 1.3 * model.modes().frequencies[4];
        let grid = (1..=400).map(|i| top * f64::from(i) / 400.0);
        for omega in grid.chain(model.modes().frequencies.iter().copied()) {
            let state = forced_response(&problem, 2.5, omega).unwrap();
            let (error, size) = linear_error(&model, &c, &state);
            assert!(error < 1e-10 * size, "proportional {proportional}, {omega} rad/s: {error:e} of {size:e}");
        }
    }
}

#[test]
fn a_main_branch_that_never_touches_is_that_of_a_dense_solve() {
    for proportional in [true, false] {
        let (model, c) = chain(proportional);
        let mut settings = with_harmonics(3);
        // Residuals are measured in gaps, and a resonance amplifies them.
        settings.continuation.newton.tolerance = 1e-13;
        let frequencies = &model.modes().frequencies;
        (settings.frequency.min, settings.frequency.max) = (Some(0.5 * frequencies[0]), Some(1.2 * frequencies[4]));
        let backbone = backbone(&model, &settings);
        let mut forced = Forced::new(&model, &settings, SearchRange::new(&settings, &backbone).unwrap(), 2.5);
        let branch = forced.main_branch(Side::Below, &mut quiet).unwrap();
        let (low, high) = branch.frequency_range();
        assert!(low < 0.51 * frequencies[0] && high > 1.19 * frequencies[4], "{low} {high} {:?}", branch.outcome);
        let errors: Vec<(f64, f64)> = branch.points.iter().map(|p| linear_error(&model, &c, &p.state)).collect();
        let peak = errors.iter().fold(0.0f64, |m, e| m.max(e.1));
        for (point, (error, _)) in branch.points.iter().zip(errors) {
            assert_eq!(point.contact(), [0.0]);
            assert!(error < 1e-10 * peak, "proportional {proportional}, {} rad/s: {error:e}", point.omega());
        }
        assert!(branch.points.len() > 50);
    }
}
