//! Backbones of the four scenarios.

use super::common::{BACKWARD, FORWARD, FRICTIONLESS, Scenario, TUNED};
use crate::support::study::{shipped, with_harmonics};
use solver::response::backbone::Backbone;
use solver::response::branch::{Outcome, Stop};

/// What must hold for every backbone.
fn check(scenario: &Scenario) -> &Backbone {
    let backbone = scenario.backbone();
    let name = scenario.name;
    assert!(backbone.max_amplitude() >= 2e-3, "{name}: ends at {} m, {}", backbone.max_amplitude(), backbone.outcome);
    assert!(backbone.points.len() <= 1000, "{name}: {} points", backbone.points.len());
    let mut arc = -1.0;
    for (i, point) in backbone.points.iter().enumerate() {
        let (energies, residual) = (point.energies(), point.point.residual());
        let what = format!("{name}, point {i} at {} rad/s", point.point.omega());
        // An identity of the exact solution: it is as good as the residual is small.
        assert!(energies.certificate <= 1e-8, "{what}: energy certificate {}", energies.certificate);
        assert!(residual <= 1e-8, "{what}: residual {residual}");
        assert!(energies.linear > 0.0 && point.threshold() > 0.0, "{what}: {energies:?}");
        assert!(point.arc() > arc, "{what}: the arc goes back from {arc} to {}", point.arc());
        arc = point.arc();
        let sum: f64 = point.contributions().iter().sum();
        assert!((sum - 1.0).abs() < 1e-12, "{what}: contributions add to {sum}");
    }
    backbone
}

#[test]
fn frictionless_comes_out_of_the_torsion_tongue() {
    let points = &check(&FRICTIONLESS).points;
    // The first torsion (mode 3) at four times the frequency: ω_3/4 = 2693 rad/s, seen at 2720 rad/s.
    let torsion = |i: &usize| points[*i].contributions()[2];
    let deepest = (0..points.len()).max_by(|a, b| torsion(a).total_cmp(&torsion(b))).unwrap();
    let omega = points[deepest].point.omega();
    assert!(torsion(&deepest) > 0.3, "no torsion tongue: share {} at most", torsion(&deepest));
    assert!((omega / 2720.0 - 1.0).abs() < 0.005, "the tongue is at {omega} rad/s");
    // Inside, damping goes to that of the torsion over four: ξ_3 ω_3 / 4.
    let damping = 5e-3 * FRICTIONLESS.model().modes().frequencies[2] / 4.0;
    let decay = points[deepest].point.state.decay;
    assert!((decay / damping - 1.0).abs() < 0.02, "decay rate {decay} in the tongue, torsion {damping}");
    let beyond = points[deepest..].iter().filter(|p| p.contributions()[2] < 0.05);
    let highest = beyond.map(|p| p.point.amplitude()).fold(0.0, f64::max);
    assert!(highest >= 3e-3, "out of the tongue it only reaches {highest} m");
}

#[test]
fn friction_backward() {
    check(&BACKWARD);
}

#[test]
fn friction_forward() {
    check(&FORWARD);
}

#[test]
fn tuned() {
    check(&TUNED);
}

#[test]
fn below_the_first_touch_the_backbone_is_the_linear_mode() {
    for scenario in [&FRICTIONLESS, &BACKWARD, &FORWARD, &TUNED] {
        let first = &scenario.backbone().points[0];
        let omega = scenario.model().modes().frequencies[0];
        // ξ_1 = 1e-3: ω = ω_1 √(1 − ξ²), ζ = ξ ω_1, both closed forms of the damped oscillator.
        assert!((first.point.omega() / (omega * (1.0f64 - 1e-6).sqrt()) - 1.0).abs() < 1e-12, "{}", scenario.name);
        assert!((first.point.state.decay / (1e-3 * omega) - 1.0).abs() < 1e-9, "{}", scenario.name);
        // W = A π |b| for mass-normalised forcing of the mode: A* = 2 ξ ω_1² b.
        let amplitude = first.point.amplitude() / scenario.model().modes().shapes[(0, 0)].abs();
        let expected = 2e-3 * omega * first.point.omega() * amplitude;
        assert!((first.threshold() / expected - 1.0).abs() < 1e-9, "{}", scenario.name);
    }
}

/// With mode 4 damped a hundred times as much the backbone turns at sharp corners between 2117 and 2118 rad/s. With longer steps Newton's method met
/// a point at the edge of one by chance, from which nothing led on.
#[test]
fn a_backbone_with_corners_does_not_depend_on_steps() {
    let ratios = r#"[{ modes = "1-2", ratio = 1e-3 }, { modes = 4, ratio = 0.5 }]"#;
    let overrides = [
        ("matrices.stiffness", "rom_K_tuned.mtx"),
        ("damping.ratios", ratios),
        ("damping.default_ratio", "5e-3"),
        ("contact.friction", "0"),
    ];
    let model = shipped("rotor67", &overrides);
    let mut settings = with_harmonics(10);
    let ends = [0.1, 0.15, 0.2, 0.3].map(|max_step| {
        settings.continuation.max_step = max_step;
        let backbone = Backbone::compute(&model, &settings).unwrap();
        assert_eq!(backbone.outcome, Outcome::Open(Stop::Start, Stop::AmplitudeBound), "{max_step}");
        assert!(backbone.crossing.is_empty(), "{max_step}: {:?}", backbone.crossing);
        backbone.points.last().unwrap().point.omega()
    });
    assert!(ends.iter().all(|end| (end / ends[0] - 1.0).abs() < 1e-9), "{ends:?}");
}
