//! Friction, against areas of loops.

use super::common::*;
use solver::formulation::harmonics::complex;
use solver::response::branch::Side;
use solver::response::forced::{Forced, SearchRange};
use solver::structure::laws::{Jenkins, LawKind, TanhFriction};
use std::f64::consts::{PI, TAU};

#[test]
fn an_elastic_friction_element_is_a_linear_spring() {
    let model = oscillator(2.0, 0.01, LawKind::Jenkins(Jenkins { stiffness: 1.0, limit: 10.0 }));
    let mut settings = with_harmonics(5);
    // Residuals are measured in the amplitude at which friction matters, a hundred times these.
    settings.continuation.newton.tolerance = 1e-13;
    (settings.frequency.min, settings.frequency.max) = (Some(1.0), Some(2.5));
    let backbone = backbone(&model, &settings);
    let branch = Forced::new(&model, &settings, SearchRange::new(&settings, &backbone).unwrap(), 0.1)
        .main_branch(Side::Below, &mut quiet)
        .unwrap();
    let (low, high) = branch.frequency_range();
    assert!(low < 1.01 && high > 2.49, "{low} {high} {:?}", branch.outcome);
    for point in &branch.points {
        let w = point.omega();
        let first = complex(&displacement(&model, &point.state, 0), 1);
        // (k + k_J − ω² + icω) X = A, c = 2ξ√k
        let (re, im) = (3.0 - w * w, 0.02 * 2f64.sqrt() * w);
        let square = re * re + im * im;
        let error = (first.re - 0.1 * re / square).hypot(first.im + 0.1 * im / square) * square.sqrt() / 0.1;
        assert!(error < 1e-9, "{w} rad/s: {error:e}");
    }
}

#[test]
fn elastic_friction_dissipates_the_area_of_its_loop() {
    let (k, limit) = (1.0, 0.1);
    let model = oscillator(1.0, 0.001, LawKind::Jenkins(Jenkins { stiffness: k, limit }));
    // One harmonic: between a stop and the next the motion is monotone, whatever the harmonics, but here it is sinusoidal.
    let mut settings = with_harmonics(1);
    settings.harmonics.samples = 4096;
    settings.backbone.max_amplitude = Some(1.0);
    let curve = backbone(&model, &settings);
    let (mut sticking, mut sliding) = (0, 0);
    for point in &curve.points {
        let (a, loss) = (point.point.amplitude(), point.energies().nonlinear);
        if a < limit / k {
            assert!(loss.abs() < 1e-12 * limit * a, "a = {a}: {loss}");
            assert!(
                (point.point.omega() / 2f64.sqrt() - 1.0).abs() < 1e-5,
                "a = {a}: {} rad/s for k + k_J and a damping ratio of 1e-3",
                point.point.omega()
            );
            sticking += 1;
        } else {
            // Parallelogram of height 2F and width 2(a − F/k). The instants of sticking fall between two samples: an error
            // of the order of (2π/4096)² = 2.4e-6 of the loop.
            let area = 4.0 * limit * (a - limit / k);
            assert!((loss - area).abs() < 2.4e-6 * limit * a, "a = {a}: {loss} against {area}");
            sliding += 1;
        }
    }
    assert!(sticking > 1 && sliding > 10 && curve.max_amplitude() > 9.0 * limit / k);
}

#[test]
fn rubbing_dissipates_the_area_of_its_loop() {
    let (limit, velocity) = (0.02, 0.01);
    let model = oscillator(1.0, 0.001, LawKind::TanhFriction(TanhFriction { limit, velocity }));
    let mut settings = with_harmonics(1);
    settings.harmonics.samples = 4096;
    settings.backbone.max_amplitude = Some(1.0);
    let curve = backbone(&model, &settings);
    let (mut slow, mut fast) = (0, 0);
    for point in &curve.points {
        let (a, loss) = (point.point.amplitude(), point.energies().nonlinear);
        let peak = point.point.omega() * a;
        // ∮ F tanh(v/v₀) dx by the rectangle rule, which is spectrally accurate on a period.
        let count = 20_000;
        let power = |i: i32| {
            let v = peak * (TAU * f64::from(i) / f64::from(count)).cos();
            limit * (v / velocity).tanh() * v
        };
        let exact = (0..count).map(power).sum::<f64>() * TAU / point.point.omega() / f64::from(count);
        assert!((loss / exact - 1.0).abs() < 1e-9, "a = {a}: {loss} against {exact}");
        // Both ends in closed form: a viscous damper F/v₀, and Coulomb's 4 F a less what the smooth reversals save.
        if peak < 0.05 * velocity {
            assert!((loss / (PI * limit / velocity * peak * a) - 1.0).abs() < 0.5 * (peak / velocity).powi(2));
            slow += 1;
        } else if peak > 20.0 * velocity {
            let coulomb = 4.0 * limit * a * (1.0 - PI * PI / 24.0 * (velocity / peak).powi(2));
            assert!((loss / coulomb - 1.0).abs() < (velocity / peak).powi(4), "a = {a}: {loss} against {coulomb}");
            fast += 1;
        }
    }
    assert!(slow > 0 && fast > 10, "{slow} {fast}");
}

/// At rest the friction is a damper of 100 N s/m, and nothing swings; its backbone is that of larger motions.
#[test]
fn a_backbone_begins_where_friction_lets_the_mass_swing() {
    let (limit, velocity, ratio) = (1.0, 0.01, 0.001);
    let model = oscillator(1.0, ratio, LawKind::TanhFriction(TanhFriction { limit, velocity }));
    let mut settings = with_harmonics(1);
    settings.harmonics.samples = 4096;
    settings.backbone.max_amplitude = Some(100.0);
    let curve = backbone(&model, &settings);
    let large: Vec<_> = curve.points.iter().filter(|point| point.point.amplitude() > 5.0 * limit).collect();
    for point in &large {
        let (a, omega) = (point.point.amplitude(), point.point.omega());
        // What keeps it going against friction shifts it by the square of the ratio that this makes, (2F/πa)²/2.
        assert!((omega - 1.0).abs() < (2.0 * limit / (PI * a)).powi(2), "{omega} rad/s at {a}");
        // A π a = 4 F a + π c ω a², c = 2ξ: the work of the forcing is what friction and damping take.
        let expected = 4.0 * limit / PI + 2.0 * ratio * omega * a;
        assert!((point.threshold() / expected - 1.0).abs() < 1e-4, "a = {a}: {} against {expected}", point.threshold());
    }
    println!(
        "{} {:?}",
        curve.outcome,
        curve.points.iter().map(|p| (p.point.amplitude(), p.point.omega())).collect::<Vec<_>>()
    );
    assert!(large.len() > 5 && curve.max_amplitude() > 99.0, "{} {}", large.len(), curve.max_amplitude());
}
