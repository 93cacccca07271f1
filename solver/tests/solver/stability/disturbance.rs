//! Pushes onto an isola, against a program of its own: a Runge–Kutta integration of the equation of motion.

use super::lasting::{level, model};
use solver::response::branch::Observer;
use solver::response::task::{BranchId, DisturbPlace};
use solver::stability::disturbance::{DisturbSettings, Disturbance, Unpushed, disturb};
use solver::stability::endings::Ending;
use solver::structure::laws::{PolynomialDamper, Term};
use solver::{Backbone, Branch, Level, Model, Settings, Stretch, verify};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

const FORCING: f64 = 0.007;

/// Frequency in the middle of what is stable of the isola, and what pushes do there.
fn pushed(model: &Model, level: &Level, settings: &DisturbSettings, omega: Option<f64>) -> Disturbance {
    let quiet: &mut Observer<'_> = &mut |_| ControlFlow::Continue(());
    let isola = level.isolas().next().unwrap();
    let found = verify(model, isola, Stretch::Whole, quiet).unwrap();
    let settled = found.settled().unwrap();
    let (low, high) = isola.frequency_range();
    assert!(low < settled && settled < high, "{settled} of {low} to {high}");
    let place = DisturbPlace { branch: BranchId::isola(0), mode: 0, omega: omega.unwrap_or(settled) };
    let mains: Vec<&Branch> = level.branches().filter(|(id, _)| id.is_main()).map(|(_, branch)| branch).collect();
    let pushed = disturb(model, settings, &mains, isola, &place, &mut |_| ControlFlow::Continue(())).unwrap();
    assert!(pushed.is_sound(&place, 1) && !pushed.is_sound(&DisturbPlace { mode: 1, ..place }, 1));
    pushed
}

/// Largest |x| in the last period of a motion of ẍ + 0.018 ẋ − 0.01 ẋ³ + 0.00144 ẋ⁵ + x = A cos ωt that was at rest 400 periods
/// before a push at a phase, and 400 periods after it.
fn amplitude_after(omega: f64, phase: f64, push: f64) -> f64 {
    const STEPS: usize = 256;
    let h = TAU / omega / STEPS as f64;
    let rate = |t: f64, [x, v]: [f64; 2]| {
        [v, FORCING * (omega * t).cos() - x - v * (0.018 + v * v * (-0.01 + 0.00144 * v * v))]
    };
    let mut z = [0.0, 0.0];
    let mut largest = 0.0f64;
    for i in 0..800 * STEPS {
        if i == 400 * STEPS + (phase * STEPS as f64).round() as usize {
            z[1] += push;
        }
        let t = i as f64 * h;
        let moved = |by: f64, r: [f64; 2]| [z[0] + by * r[0], z[1] + by * r[1]];
        let a = rate(t, z);
        let b = rate(t + 0.5 * h, moved(0.5 * h, a));
        let c = rate(t + 0.5 * h, moved(0.5 * h, b));
        let d = rate(t + h, moved(h, c));
        z = std::array::from_fn(|j| z[j] + h / 6.0 * (a[j] + 2.0 * (b[j] + c[j]) + d[j]));
        largest = if i >= 799 * STEPS { largest.max(z[0].abs()) } else { 0.0 };
    }
    largest
}

#[test]
fn the_smallest_push_onto_an_isola_is_that_of_another_integration() {
    let model = model("nonlinear_damper");
    let level = level(&model, FORCING);
    let found = pushed(&model, &level, &DisturbSettings::default(), None);
    let push = found.push.unwrap();
    assert!(push.is_confirmed && push.size - push.below <= 0.01 * push.size, "{push:?}");
    assert_eq!((found.reason, found.monitor, found.shape), (None, 0, 1.0));
    let [main, isola] = [found.amplitudes[0][0], found.amplitudes[1][0]];
    assert!(isola > 2.0 * main, "{main} {isola}");
    // 2 % beyond either side the integration ends where the scan says, to what the scheme's step leaves of the amplitude.
    let phase = push.phase as f64 / found.phases as f64;
    for (size, expected) in [(1.02 * push.size, isola), (0.98 * push.below, main)] {
        let amplitude = amplitude_after(found.omega, phase, size);
        assert!((amplitude / expected - 1.0).abs() < 0.01, "{size}: {amplitude} for {expected}");
    }
    // No smaller one that was scanned does, at whatever phase.
    let row = found.sizes.iter().position(|size| *size > push.below).unwrap();
    assert!(found.endings[..row * found.phases].iter().all(|ending| *ending != Ending::Onto));
    assert!(found.endings[row * found.phases..].contains(&Ending::Onto));
}

#[test]
fn where_rest_leads_is_where_another_integration_ends() {
    let model = model("nonlinear_damper");
    let level = level(&model, FORCING);
    let (main, isola) = (level.main(), level.isolas().next().unwrap());
    let quick = DisturbSettings { phases: 1, sizes: (1, 1.3), finer: (1, 1.3), ..DisturbSettings::default() };
    let place = DisturbPlace { branch: BranchId::isola(0), mode: 0, omega: isola.peak().omega() };
    let from = |mains: &[&Branch], branch: &Branch, omega: f64| {
        let place = DisturbPlace { omega, ..place };
        disturb(&model, &quick, mains, branch, &place, &mut |_| ControlFlow::Continue(())).unwrap()
    };
    let omega = pushed(&model, &level, &quick, None).omega;
    let onto_isola = from(&[main], isola, omega);
    let [small, large] = [onto_isola.amplitudes[0][0], onto_isola.amplitudes[1][0]];
    let amplitude = amplitude_after(omega, 0.0, 0.0);
    assert!((amplitude / small - 1.0).abs() < 0.01 && large > 2.0 * small, "{amplitude}: {small} or {large}");
    assert_eq!(onto_isola.from_rest, Some(Ending::Back));
    // The same motion with the two branches exchanged, and where no other motion is known than that which rest leads to.
    assert_eq!(from(&[isola], main, omega).from_rest, Some(Ending::Onto));
    let alone = from(&[], main, omega);
    assert_eq!((alone.reason, alone.from_rest), (Some(Unpushed::NoMain), Some(Ending::Onto)));
    // Where the branch has no motion, rest leads to the other one; where neither has, nothing is known.
    let beyond = 1.05 * isola.frequency_range().1;
    let no_target = from(&[main], isola, beyond);
    assert_eq!((no_target.reason, no_target.from_rest), (Some(Unpushed::NoTarget), Some(Ending::Back)));
}

/// Two masses that swing against each other as that of `nonlinear_damper` does: x1 = x, x2 = −x.
fn opposed(monitored: [&str; 2]) -> Model {
    let term = |power, coefficient: f64| Term { power, coefficient: coefficient / 2f64.powi(power as i32) };
    let damper = PolynomialDamper { terms: vec![term(3, -0.01), term(5, 0.00144)] };
    Model::builder("opposed")
        .mass([[1.0, 0.0], [0.0, 1.0]])
        .stiffness([[0.65, -0.35], [-0.35, 0.65]])
        .damping_ratio(0.009)
        .force("x1", 1.0)
        .force("x2", -1.0)
        .element("damper", damper, [[("x1", 1.0), ("x2", -1.0)]])
        .monitor(monitored[0])
        .monitor(monitored[1])
        .build()
        .unwrap()
}

#[test]
fn a_push_moves_the_monitored_dof_forward_whatever_the_sign_of_the_mode() {
    let quiet: &mut Observer<'_> = &mut |_| ControlFlow::Continue(());
    let mut signs = Vec::new();
    for monitored in [["x1", "x2"], ["x2", "x1"]] {
        let model = opposed(monitored);
        let modes = solver::settings::BackboneSettings { modes: solver::ModeChoice::one(2), ..Default::default() };
        let settings = Settings { backbone: modes, ..Settings::default() };
        let backbone = Backbone::compute(&model, &settings).unwrap();
        let level = Level::compute(&model, &settings, &backbone, FORCING).unwrap();
        let isola = level.isolas().next().unwrap();
        let omega = verify(&model, isola, Stretch::Whole, quiet).unwrap().settled().unwrap();
        let place = DisturbPlace { branch: BranchId::isola(0), mode: 1, omega };
        let mains = [level.main()];
        let found =
            disturb(&model, &DisturbSettings::default(), &mains, isola, &place, &mut |_| ControlFlow::Continue(()))
                .unwrap();
        let push = found.push.unwrap();
        let dof = model.monitors()[found.monitor];
        let velocity = if dof == 0 { 1.0 } else { -1.0 } * push.size * found.shape;
        let phase = push.phase as f64 / found.phases as f64;
        let [main, isola] = [found.amplitudes[0][0], found.amplitudes[1][0]];
        for (velocity, expected) in [(1.02 * velocity, isola), (0.98 * velocity * push.below / push.size, main)] {
            let amplitude = amplitude_after(omega, phase, velocity);
            assert!((amplitude / expected - 1.0).abs() < 0.01, "{monitored:?}: {amplitude} for {expected}");
        }
        // The other way it would lead nowhere: the test can fail.
        let amplitude = amplitude_after(omega, phase, -1.02 * velocity);
        assert!((amplitude / main - 1.0).abs() < 0.01, "{monitored:?}: {amplitude} for {main}");
        signs.push(model.modes().shapes[(dof, 1)].signum());
    }
    assert!(signs.contains(&-1.0), "{signs:?}");
}

#[test]
fn nothing_is_pushed_where_there_is_nothing_to_end_on() {
    let model = model("nonlinear_damper");
    let level = level(&model, FORCING);
    let beyond = 1.05 * level.isolas().next().unwrap().frequency_range().1;
    let found = pushed(&model, &level, &DisturbSettings::default(), Some(beyond));
    assert_eq!((found.reason, found.push, found.sizes.len()), (Some(Unpushed::NoTarget), None, 0));
}

#[test]
fn a_scan_that_is_broken_off_says_nothing() {
    let model = model("nonlinear_damper");
    let level = level(&model, FORCING);
    let isola = level.isolas().next().unwrap();
    let place = DisturbPlace { branch: BranchId::isola(0), mode: 0, omega: isola.peak().omega() };
    let settings = DisturbSettings::default();
    let mut left = 5;
    let found = disturb(&model, &settings, &[level.main()], isola, &place, &mut |_| {
        left -= 1;
        if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!((found, left), (None, 0));
}

#[test]
fn without_a_main_branch_the_motion_from_rest_is_pushed() {
    let model = model("nonlinear_damper");
    let level = level(&model, FORCING);
    let isola = level.isolas().next().unwrap();
    let known = pushed(&model, &level, &DisturbSettings::default(), None);
    let place = DisturbPlace { branch: BranchId::isola(0), mode: 0, omega: known.omega };
    let settings = DisturbSettings::default();
    let found = disturb(&model, &settings, &[], isola, &place, &mut |_| ControlFlow::Continue(())).unwrap();
    let [with, without] = [&known, &found].map(|found| found.push.unwrap());
    assert_eq!((with.phase, with.ends), (without.phase, without.ends));
    assert!((with.size / without.size - 1.0).abs() < 1e-6, "{with:?} {without:?}");
    assert!((known.amplitudes[0][0] / found.amplitudes[0][0] - 1.0).abs() < 1e-6);
}
