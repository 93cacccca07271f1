//! Light damping: peaks against closed forms, over damping ratios from 1e-2 to 1e-6, and nothing but the main branch where
//! there is nothing else. Steps along a branch must never go from one flank of a resonance to the other.

use crate::support::balance::{Balance, Matrices};
use crate::support::geometry::complaints;
use crate::support::linear::{maximum, response};
use crate::support::study::{Kind, Listed, Study, assert_main_only, main_peak, shipped, with_harmonics};
use solver::laws::PenaltySpring;
use solver::linalg::Matrix;
use solver::{Model, Settings};

const RATIOS: [f64; 5] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6];

fn assert_close(value: f64, expected: f64, relative: f64, what: &str) {
    assert!((value / expected - 1.0).abs() < relative, "{what}: {value} is not {expected} to {relative:e}");
}

/// Every point fulfils the balance, to `relative` of its largest term; no curve hops or comes twice.
fn assert_sound(model: &Model, level: &[Listed], relative: f64, what: &str) {
    let balance = Balance::new(model);
    for listed in level {
        for point in &listed.branch.points {
            let residual = balance.residual(&point.state);
            let share = residual.relative();
            assert!(share < relative, "{what}, {} at {} rad/s: {share:e}", listed.name, point.omega());
        }
    }
    assert_eq!(complaints(model, level), Vec::<String>::new(), "{what}");
}

/// Forcing of x″ + 2ζ x′ + x + x³ = A cos ωt whose response with one harmonic has its largest amplitude a. Of all ω that
/// solve (κ − ω²)² a² + (2ζωa)² = A², κ = 1 + ¾a², the fold in a is at ω² = κ − 2ζ².
fn duffing_forcing(ratio: f64, a: f64) -> f64 {
    2.0 * ratio * a * (1.0 + 0.75 * a * a - ratio * ratio).sqrt()
}

fn duffing(ratio: f64, settings: Settings) -> Study {
    Study::new(shipped("duffing", &[("damping.default_ratio", &ratio.to_string())]), settings)
}

fn check_duffing(ratio: f64) {
    let study = duffing(ratio, with_harmonics(1));
    for a in [0.01, 0.1, 1.0, 10.0] {
        let forcing = duffing_forcing(ratio, a);
        let what = format!("ratio {ratio:e}, A = {forcing:e}");
        let level = study.level(forcing);
        assert_main_only(&level, &what);
        let (omega, peak) = main_peak(&level);
        assert!((peak / a - 1.0).abs() < 1e-4, "{what}: the peak is {a}: {level:#?}");
        assert_close(omega * omega, 1.0 + 0.75 * a * a - 2.0 * ratio * ratio, 1e-4, &what);
        assert_sound(&study.model, &level, 1e-7, &what);
    }
}

#[test]
fn a_duffing_oscillator_at_a_hundredth() {
    check_duffing(RATIOS[0]);
}

#[test]
fn a_duffing_oscillator_at_a_thousandth() {
    check_duffing(RATIOS[1]);
}

#[test]
fn a_duffing_oscillator_at_1e_4() {
    check_duffing(RATIOS[2]);
}

#[test]
fn a_duffing_oscillator_at_1e_5() {
    check_duffing(RATIOS[3]);
}

#[test]
fn a_duffing_oscillator_at_1e_6() {
    check_duffing(RATIOS[4]);
}

#[test]
fn a_duffing_oscillator_with_ten_harmonics() {
    // Amplitudes at which further harmonics change the peak by a²/32 at most, and the forcings of a reported fault.
    for (ratio, forcing) in [(1e-3, 2e-5), (1e-5, 2e-7), (1e-5, 1e-5), (1e-5, 4e-5)] {
        let study = duffing(ratio, Settings::default());
        let what = format!("ratio {ratio:e}, A = {forcing:e}");
        let level = study.level(forcing);
        assert_main_only(&level, &what);
        assert_sound(&study.model, &level, 1e-7, &what);
        let (omega, peak) = main_peak(&level);
        // 2ζ ω a₁ = A whatever the other harmonics are, as dissipation of the first one is all but a₃²·9/a₁² of it.
        let first = forcing / (2.0 * ratio * omega);
        assert_close(peak, first, 1e-4 + peak * peak / 24.0, &what);
    }
}

#[test]
fn a_nonlinear_damper_without_linear_damping_to_speak_of() {
    // With one harmonic a velocity of amplitude V is opposed by F(V) = 2ζV − ¾·0.01 V³ + ⅝·0.00144 V⁵, and there is a
    // response wherever |F(V)| ≤ A. At ζ = 1e-3, A = 0.0012 these are two ranges of V: from rest to where F falls below −A,
    // and round the limit cycle of the undriven damper, up to F(V) = A.
    let (ratio, forcing) = (1e-3, 0.0012);
    let force = |v: f64| 2.0 * ratio * v - 0.0075 * v.powi(3) + 0.0009 * v.powi(5);
    let root = |mut low: f64, mut high: f64, level: f64| {
        let rising = force(high) > level;
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if (force(middle) > level) == rising { high = middle } else { low = middle }
        }
        0.5 * (low + high)
    };
    let (small, large) = (root(0.3, 1.5, -forcing), root(2.0, 3.0, forcing));
    let study = Study::new(shipped("nonlinear_damper", &[("damping.default_ratio", "1e-3")]), with_harmonics(1));
    let level = study.level(forcing);
    assert_close(main_peak(&level).1, small, 1e-4, "main branch");
    let others: Vec<&Listed> = level.iter().filter(|listed| listed.kind != Kind::Main).collect();
    assert!(others.len() == 1 && others[0].kind == Kind::Isola, "{level:#?}");
    assert_close(others[0].branch.peak().amplitude(), large, 1e-4, "limit cycle");
    assert_sound(&study.model, &level, 1e-7, "nonlinear damper");
}

/// Three masses between springs, the last one before a stop far out of reach.
fn chain(ratio: f64) -> Model {
    Model::builder("chain")
        .mass([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.5]])
        .stiffness([[3.0, -1.0, 0.0], [-1.0, 2.5, -1.5], [0.0, -1.5, 2.0]])
        .damping_ratio(ratio)
        .force("x1", 1.0)
        .element("stop", PenaltySpring { stiffness: 10.0, gap: 1e6 }, ["x3"])
        .monitor("x3")
        .build()
        .unwrap()
}

/// Peaks of a linear structure at each of its first `count` modes against an exact solution; the largest of all is located,
/// the others are as exact as the curve is dense.
fn check_linear(model: Model, ratio: f64, forcing: f64, count: usize) {
    let frequencies = model.modes().frequencies.clone();
    let mut settings = with_harmonics(1);
    (settings.frequency.min, settings.frequency.max) = (Some(0.5 * frequencies[0]), Some(1.1 * frequencies[count - 1]));
    let what = format!("{}, ratio {ratio:e}", model.name());
    let matrices = Matrices::of(&model);
    let force: Vec<f64> = model.forcing().shape.iter().map(|s| forcing * s).collect();
    let monitor = model.monitors()[0];
    let peaks: Vec<(f64, f64)> = frequencies[..count]
        .iter()
        .map(|&w| maximum(w, 4.0 * ratio * w, |omega| response(&matrices, &force, omega)[monitor].norm()))
        .collect();
    let study = Study::new(model, settings);
    let level = study.level(forcing);
    assert_main_only(&level, &what);
    let (omega, peak) = main_peak(&level);
    let largest = peaks.iter().copied().fold((0.0, 0.0), |best, p| if p.1 > best.1 { p } else { best });
    assert_close(peak, largest.1, 1e-4, &what);
    // An amplitude within 1e-4 of the largest is no farther than √2e-4 half-widths away.
    assert_close(omega, largest.0, 0.015 * ratio, &what);
    let points = || level.iter().flat_map(|listed| &listed.branch.points);
    for (at, height) in peaks {
        let near = points().filter(|p| (p.omega() / at - 1.0).abs() < 4.0 * ratio);
        let reached = near.map(|p| p.amplitude()).fold(0.0, f64::max);
        assert_close(reached, height, 2e-2, &format!("{what}, {at} rad/s"));
    }
    for point in points() {
        let exact = response(&matrices, &force, point.omega())[monitor].norm();
        // A residual of 1e-12 of the elastic forces is one of 1e-12/2ζ of the forcing.
        assert_close(point.amplitude(), exact, 1e-6 + 1e-11 / ratio, &format!("{what}, {} rad/s", point.omega()));
    }
    assert_eq!(complaints(&study.model, &level), Vec::<String>::new(), "{what}");
}

#[test]
fn a_linear_chain() {
    for ratio in RATIOS {
        check_linear(chain(ratio), ratio, 1.0, 3);
    }
}

#[test]
fn a_linear_beam() {
    for ratio in RATIOS {
        let overrides = [("damping.default_ratio", &*ratio.to_string()), ("contact.gap", "1e6")];
        check_linear(shipped("cantilever_stop", &overrides), ratio, 1.0, 2);
    }
}

#[test]
fn the_chain_is_what_modes_sum_to() {
    // The elimination that the others compare with, against the sum over modes.
    let model = chain(1e-2);
    let (matrices, modes) = (Matrices::of(&model), model.modes());
    for i in 1..200 {
        let omega = 0.02 * f64::from(i);
        let exact = response(&matrices, &model.forcing().shape, omega);
        for (dof, x) in exact.iter().enumerate() {
            let terms = modes.frequencies.iter().enumerate().map(|(j, &w)| {
                let (real, imaginary) = (w * w - omega * omega, 0.02 * w * omega);
                let gain = modes.shapes[(dof, j)] * modes.shapes[(0, j)] / (real * real + imaginary * imaginary);
                (gain * real, -gain * imaginary)
            });
            let sum = terms.fold((0.0, 0.0), |s, t| (s.0 + t.0, s.1 + t.1));
            assert!((x.re - sum.0).hypot(x.im - sum.1) < 1e-12 * x.norm().max(1.0), "{omega}");
        }
    }
    assert_eq!(Matrix::diagonal(&[1.0, 2.0, 0.5]), matrices.mass);
}
