//! Duffing oscillators, against formulas and orbits.

use super::common::*;
use solver::formulation::harmonics::evaluate;
use solver::response::branch::{BranchPoint, Side, SpecialKind};
use solver::response::forced::{Forced, SearchRange};
use std::f64::consts::TAU;

/// Damping of models/duffing, x'' + c x' + x + x³ = A cos ωt.
const C: f64 = 0.02;

#[test]
fn one_harmonic_of_a_duffing_oscillator() {
    let model = load("duffing");
    let settings = with_harmonics(1);
    let mut conservative = conservative(1);
    conservative.backbone.max_amplitude = Some(4.0);
    let backbone = backbone(&model, &conservative);
    for point in &backbone.points {
        let (w, a) = (point.point.omega(), point.point.amplitude());
        // The Newton tolerance is relative to the reference length, 50 times the smallest amplitude.
        assert!((w * w / (1.0 + 0.75 * a * a) - 1.0).abs() < 1e-9, "a = {a}: {w}");
    }
    for amplitude in [0.02, 0.1] {
        let branch = Forced::new(&model, &settings, SearchRange::new(&settings, &backbone).unwrap(), amplitude)
            .main_branch(Side::Below, &mut quiet)
            .unwrap();
        for point in &branch.points {
            let (w, a) = (point.omega(), point.amplitude());
            let spring = 1.0 + 0.75 * a * a;
            // The Newton tolerance, over the distance of a resonance from where the spring balances the inertia.
            let force = ((spring - w * w) * a).hypot(C * w * a);
            assert!((force / amplitude - 1.0).abs() < 1e-8, "{w} rad/s: {force}");
        }
        // In W = ω² the response is (W − β)² + c²W = A²/a², β = 1 + 3a²/4: at the peak both roots W coincide.
        let beta = |a: f64| 1.0 + 0.75 * a * a;
        let peak = bisect(0.01, 10.0, |a| C * C * beta(a) - 0.25 * C.powi(4) - (amplitude / a).powi(2));
        let omega = (beta(peak) - 0.5 * C * C).sqrt();
        let found: Vec<&BranchPoint> = branch.special(SpecialKind::Peak).collect();
        assert_eq!(found.len(), 1);
        println!("A = {amplitude}: peak {:e}, {:e}", found[0].amplitude() / peak - 1.0, found[0].omega() / omega - 1.0);
        assert!((found[0].amplitude() / peak - 1.0).abs() < 1e-9);
        assert!((found[0].omega() / omega - 1.0).abs() < 1e-6, "{} {omega}", found[0].omega());
        // A cubic in a² at given W; folds where its discriminant vanishes.
        let discriminant = |w: f64| {
            let (a, b) = (0.5625, 1.5 * (1.0 - w * w));
            let (c, d) = ((1.0 - w * w).powi(2) + (C * w).powi(2), -amplitude * amplitude);
            18.0 * a * b * c * d - 4.0 * b.powi(3) * d + b * b * c * c - 4.0 * a * c.powi(3) - 27.0 * a * a * d * d
        };
        let grid: Vec<f64> = (0..=20_000).map(|i| 0.9 + 3e-4 * f64::from(i)).collect();
        let brackets = grid.windows(2).filter(|pair| discriminant(pair[0]) * discriminant(pair[1]) < 0.0);
        let exact: Vec<f64> = brackets.map(|pair| bisect(pair[0], pair[1], discriminant)).collect();
        let mut folds: Vec<f64> = branch.special(SpecialKind::Fold).map(BranchPoint::omega).collect();
        folds.sort_by(f64::total_cmp);
        assert_eq!((exact.len(), folds.len()), (2, 2), "{exact:?} {folds:?}");
        for (fold, exact) in folds.iter().zip(&exact) {
            println!("A = {amplitude}: fold {:e}", fold / exact - 1.0);
            assert!((fold / exact - 1.0).abs() < 1e-9, "{fold} {exact}");
        }
    }
}

#[test]
fn a_duffing_response_with_many_harmonics_is_a_periodic_orbit() {
    let model = load("duffing");
    let settings = with_harmonics(20);
    let backbone = backbone(&model, &settings);
    let (amplitude, omega) = (0.1, 1.8);
    let mut forced = Forced::new(&model, &settings, SearchRange::new(&settings, &backbone).unwrap(), amplitude);
    let branch = forced.main_branch(Side::Below, &mut quiet).unwrap();
    let states = states_at(&mut forced, &branch, omega);
    assert_eq!(states.len(), 3, "upper, unstable, lower");
    let acceleration = |t: f64, x: f64, v: f64| amplitude * (omega * t).cos() - C * v - x - x.powi(3);
    let mut sizes = Vec::new();
    // The upper and the lower one are stable: an orbit does not leave them.
    for state in [&states[0], &states[2]] {
        let series = displacement(&model, state, 0);
        let size = series.iter().map(|x| x.abs()).sum::<f64>();
        let [mut x, slope, _] = evaluate(&series, 0.0);
        let mut v = omega * slope;
        let (count, periods) = (2000, 20);
        let h = TAU / omega / f64::from(count);
        let mut worst = 0.0f64;
        for i in 0..count * periods {
            let t = f64::from(i) * h;
            let a1 = acceleration(t, x, v);
            let (x2, v2) = (x + 0.5 * h * v, v + 0.5 * h * a1);
            let a2 = acceleration(t + 0.5 * h, x2, v2);
            let (x3, v3) = (x + 0.5 * h * v2, v + 0.5 * h * a2);
            let a3 = acceleration(t + 0.5 * h, x3, v3);
            let (x4, v4) = (x + h * v3, v + h * a3);
            let a4 = acceleration(t + h, x4, v4);
            x += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
            v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
            let exact = evaluate(&series, TAU * f64::from(i + 1) / f64::from(count));
            worst = worst.max((x - exact[0]).abs() / size);
        }
        println!("amplitude {size}: {worst:e}");
        // Truncation and Runge–Kutta at 2000 steps a period are both far below.
        assert!(worst < 1e-8, "{worst:e}");
        sizes.push(size);
    }
    assert!(sizes[0] > 10.0 * sizes[1], "{sizes:?}");
}

#[test]
fn the_conservative_backbone_of_a_cubic_spring_is_exact() {
    let model = load("duffing");
    let mut settings = conservative(20);
    (settings.backbone.max_amplitude, settings.backbone.max_frequency) = (Some(5.0), Some(6.0));
    let backbone = backbone(&model, &settings);
    assert!(backbone.max_amplitude() > 5.0);
    let mut worst = 0.0f64;
    for point in &backbone.points {
        let a = point.point.amplitude();
        // ω = π √(1 + a²) / 2K(m) = √(1 + a²) agm(1, √(1 − m)), m = a²/2(1 + a²).
        let m = 0.5 * a * a / (1.0 + a * a);
        let (mut x, mut y) = (1.0, (1.0 - m).sqrt());
        for _ in 0..8 {
            (x, y) = (0.5 * (x + y), (x * y).sqrt());
        }
        worst = worst.max((point.point.omega() / ((1.0 + a * a).sqrt() * x) - 1.0).abs());
        assert!(point.point.state.decay.abs() < 1e-10);
    }
    println!("{} points: {worst:e}", backbone.points.len());
    assert!(worst < 1e-9, "{worst:e}");
}
