//! A Jenkins element against a program of its own: the mass moved in small steps, the slider exactly from one to the next.

use super::common::{assert_close, main_branch};
use super::models::jenkins;
use solver::stability::multipliers::Verdict;
use solver::stability::polish::{Around, PolishSettings, polish};
use solver::{Model, Settings};
use std::f64::consts::TAU;

const DAMPING: f64 = 0.02;
const STIFFNESS: f64 = 0.5;
const LIMIT: f64 = 0.2;
const FORCING: f64 = 0.2;
const STEPS: usize = 8192;

/// Displacement, velocity and force of the slider.
type Motion = [f64; 3];

/// Moves ẍ + 2·0.02 ẋ + x + f = A cos ωt on by a period, f being the force of the slider (velocity Verlet); its largest |x|.
fn period(motion: &mut Motion, omega: f64) -> f64 {
    let h = TAU / omega / STEPS as f64;
    let [x, v, f] = motion;
    let mut largest = 0.0f64;
    for i in 0..STEPS {
        let force = |i: usize| FORCING * (omega * i as f64 * h).cos();
        let half = *v + 0.5 * h * (force(i) - *x - *f - 2.0 * DAMPING * *v);
        *x += h * half;
        *f = (*f + STIFFNESS * h * half).clamp(-LIMIT, LIMIT);
        *v = (half + 0.5 * h * (force(i + 1) - *x - *f)) / (1.0 + h * DAMPING);
        largest = largest.max(x.abs());
    }
    largest
}

/// Largest modulus of the multipliers of a motion, by differences: |Φ^k|^(1/k) of its derivative over a period.
fn spectral_radius(motion: Motion, omega: f64) -> f64 {
    const STEP: f64 = 1e-4;
    const SQUARED: i32 = 10;
    let moved = |i: usize, by: f64| {
        let mut motion = motion;
        motion[i] += by;
        period(&mut motion, omega);
        motion
    };
    let columns: [Motion; 3] = std::array::from_fn(|i| {
        let (up, down) = (moved(i, STEP), moved(i, -STEP));
        std::array::from_fn(|j| (up[j] - down[j]) / (2.0 * STEP))
    });
    let (mut power, mut logarithm) = (columns, 0.0);
    for k in 0..SQUARED {
        let at = |i: usize, j: usize| (0..3).map(|l| power[l][j] * power[i][l]).sum::<f64>();
        power = std::array::from_fn(|i| std::array::from_fn(|j| at(i, j)));
        let size = power.iter().flatten().fold(0.0f64, |m, x| m.max(x.abs()));
        power.iter_mut().flatten().for_each(|x| *x /= size);
        logarithm += size.ln() / 2f64.powi(k + 1);
    }
    logarithm.exp()
}

#[test]
fn a_slipping_slider_has_the_amplitude_and_the_decay_of_direct_integration() {
    let model = Model::builder("slider")
        .mass([[1.0]])
        .stiffness([[1.0]])
        .damping_ratio(DAMPING)
        .force("x1", 1.0)
        .element("slider", jenkins(STIFFNESS, LIMIT), ["x1"])
        .monitor("x1")
        .build()
        .unwrap();
    let mut settings = Settings::default();
    settings.harmonics.count = 15;
    (settings.frequency.min, settings.frequency.max) = (Some(0.7), Some(1.5));
    let branch = main_branch(&model, &settings, FORCING);
    let mut slipping = 0;
    for point in branch.points.iter().skip(2).step_by(branch.points.len() / 9) {
        let found = polish(&model, &PolishSettings::default(), &point.state, Around::default());
        let polished = found.polished.unwrap_or_else(|| panic!("{} rad/s: {:?}", point.omega(), found.reason));
        let omega = polished.orbit.omega;
        let mut motion = [0.0; 3];
        for _ in 0..400 {
            period(&mut motion, omega);
        }
        let decay = spectral_radius(motion, omega);
        let largest = period(&mut motion, omega);
        let (modulus, slips) = (polished.multipliers[0].modulus(), largest > LIMIT / STIFFNESS);
        println!("{omega} rad/s: {} and {largest} m, {modulus} and {decay}, slips {slips}", polished.amplitudes[0]);
        // Where it sticks what it was strained by at first stays.
        if slips {
            assert_close(polished.amplitudes[0], largest, 1e-3, "amplitude, m");
            assert_eq!(found.verdict, Verdict::Stable);
            assert!((modulus - decay).abs() < 0.01, "{modulus} and {decay}");
            slipping += 1;
        }
    }
    assert!(slipping > 3, "{slipping}");
}
