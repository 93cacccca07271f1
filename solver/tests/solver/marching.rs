//! Time marching against closed forms: nothing here is computed by harmonic balance.

use solver::linalg::{Matrix, symmetric_eigen};
use solver::marching::{Marching, MarchingError, MarchingSettings};
use solver::structure::laws::{
    Contact, Friction, Jenkins, LawKind, PenaltySpring, PolynomialDamper, PolynomialSpring, TanhFriction, Term,
};
use solver::structure::{Damping, Element, Forcing, Model, ModelData, Modes};
use std::f64::consts::{PI, TAU};

/// Model with modal damping ratio `ratio`, forced by `shape`.
fn model(mass: Matrix, stiffness: Matrix, ratio: f64, shape: &[f64]) -> Model {
    let (squares, shapes) = symmetric_eigen(&stiffness, &mass).unwrap();
    // Rigid-body modes come out at ± rounding.
    let frequencies: Vec<f64> = squares.iter().map(|square| square.max(0.0).sqrt()).collect();
    let data = ModelData {
        name: "test".into(),
        dofs: (0..mass.rows()).map(|i| format!("x{i}")).collect(),
        damping: Damping::Modal(frequencies.iter().map(|w| 2.0 * ratio * w).collect()),
        mass,
        stiffness,
        modes: Modes { frequencies, shapes },
        forcing: Forcing { shape: shape.to_vec(), harmonic: 1 },
        elements: Vec::new(),
        monitors: vec![0],
    };
    Model::try_from(data).unwrap()
}

fn changed(model: Model, change: impl FnOnce(&mut ModelData)) -> Model {
    let mut data = ModelData::from(model);
    change(&mut data);
    Model::try_from(data).unwrap()
}

/// One dof.
fn oscillator(mass: f64, stiffness: f64, ratio: f64) -> Model {
    model(Matrix::diagonal(&[mass]), Matrix::diagonal(&[stiffness]), ratio, &[1.0])
}

fn element(name: &str, channels: &[&[(usize, f64)]], law: LawKind) -> Element {
    Element { name: name.into(), channels: channels.iter().map(|channel| channel.to_vec()).collect(), law }
}

fn with_elements(model: Model, elements: Vec<Element>) -> Model {
    changed(model, |data| data.elements = elements)
}

fn with_law(model: Model, law: LawKind) -> Model {
    with_elements(model, vec![element("element", &[&[(0, 1.0)]], law)])
}

/// The same damping as a full matrix.
fn with_full_damping(model: Model) -> Model {
    changed(model, |data| {
        if let Damping::Modal(rates) = &data.damping {
            data.damping = Damping::Full(Matrix::diagonal(rates));
        }
    })
}

fn stop(gap: f64) -> LawKind {
    LawKind::Contact(Contact { gap, epsilon: 1.0, friction: None })
}

fn steps(count: usize) -> MarchingSettings {
    MarchingSettings { min_steps_per_period: Some(count), ..MarchingSettings::default() }
}

/// Runs `count` steps.
fn run(marching: &mut Marching, count: usize) {
    (0..count).for_each(|_| marching.step().unwrap());
}

/// A three-mass chain clamped at one end.
fn chain() -> Model {
    let stiffness = Matrix::from_fn(3, 3, |i, j| match i.abs_diff(j) {
        0 => 2000.0,
        1 => -1000.0,
        _ => 0.0,
    });
    model(Matrix::diagonal(&[1.0, 2.0, 0.5]), stiffness, 0.02, &[0.0, 1.0, -0.5])
}

#[test]
fn free_decay_follows_its_closed_form_at_second_order() {
    let (w, ratio) = (3.0, 0.05);
    let model = oscillator(2.0, 2.0 * w * w, ratio);
    let damped = w * (1.0 - ratio * ratio).sqrt();
    let error = |count| {
        let mut marching = Marching::new(&model, &steps(count), 0.0, w).unwrap();
        marching.set_state(&[1.0], &[0.5]).unwrap();
        run(&mut marching, 2 * count + count / 3);
        let t = marching.time();
        let b = (0.5 + ratio * w) / damped;
        let exact = (-ratio * w * t).exp() * ((damped * t).cos() + b * (damped * t).sin());
        let slope = (-ratio * w * t).exp() * ((b * damped) * (damped * t).cos() - damped * (damped * t).sin())
            - ratio * w * exact;
        assert!((marching.velocities()[0] - slope).abs() < 1e-3 * w);
        (marching.displacements()[0] - exact).abs()
    };
    // (ωh)²/24 of phase error a radian.
    assert!(error(600) < 15.0 * (TAU / 600.0f64).powi(2) / 24.0);
    let ratio = error(600) / error(1200);
    assert!((ratio - 4.0).abs() < 0.1, "{ratio}");
}

#[test]
fn the_steady_linear_response_keeps_the_amplitude_of_the_receptance() {
    for (full, harmonic) in [(false, 1), (true, 1), (false, 3)] {
        let model = changed(chain(), |data| data.forcing.harmonic = harmonic);
        let model = if full { with_full_damping(model) } else { model };
        let (amplitude, omega) = (3.0, 0.9 * model.modes().frequencies[0]);
        let (mut a, mut b) = (vec![0.0; 3], vec![0.0; 3]);
        for (j, w) in model.modes().frequencies.iter().enumerate() {
            let phi = model.modes().shapes.column(j);
            let force: f64 = phi.iter().zip(&model.forcing().shape).map(|(x, s)| amplitude * x * s).sum();
            let (re, im) = (w * w - omega * omega, 0.04 * w * omega);
            for i in 0..3 {
                a[i] += phi[i] * force * re / (re * re + im * im);
                b[i] += phi[i] * force * im / (re * re + im * im);
            }
        }
        let velocity: Vec<f64> = b.iter().map(|b| omega * b).collect();
        let mut marching = Marching::new(&model, &steps(2000 * harmonic), amplitude, omega / harmonic as f64).unwrap();
        marching.set_state(&a, &velocity).unwrap();
        let size = a[0].hypot(b[0]);
        for _ in 0..20 {
            let summary = marching.period().unwrap();
            // h² errors of the detuning: (ωh)²/24 relative to 1 − 0.9², and the maximum between samples.
            assert!((summary.max[0] - size).abs() < 2e-5 * size, "{} {size}", summary.max[0]);
            assert!((summary.rms[0] - size / 2f64.sqrt()).abs() < 2e-5 * size);
        }
        assert!((marching.displacements()[2] - a[2]).abs() < 2e-5 * size);
    }
}

#[test]
fn smooth_laws_converge_at_second_order() {
    let cubic = |coefficient| vec![Term { power: 3, coefficient }];
    let spring = LawKind::PolynomialSpring(PolynomialSpring { terms: cubic(5e4) });
    let damper = LawKind::PolynomialDamper(PolynomialDamper { terms: cubic(0.3) });
    let friction = LawKind::TanhFriction(TanhFriction { limit: 2.0, velocity: 1.0 });
    let elements = vec![
        element("spring", &[&[(0, 1.0), (1, -1.0)]], spring),
        element("damper", &[&[(2, 1.0)]], damper),
        element("friction", &[&[(1, 1.0)]], friction),
    ];
    let model = with_elements(chain(), elements);
    let last = |count| {
        let mut marching = Marching::new(&model, &steps(count), 20.0, 15.0).unwrap();
        marching.set_state(&[0.1, 0.15, 0.05], &[1.0, -0.5, 0.0]).unwrap();
        run(&mut marching, 3 * count);
        marching.displacements()[1]
    };
    let reference = last(32_000);
    let ratio = (last(1000) - reference) / (last(2000) - reference);
    assert!((ratio - 4.0).abs() < 0.2, "{ratio}");
}

#[test]
fn friction_that_turns_within_a_step_is_that_of_coulomb() {
    // From the middle on: it turns at R − F after t₁, with R = √(1 + F²), and every half cycle takes 2F.
    let limit = 0.02;
    let model = with_law(oscillator(1.0, 1.0, 0.0), LawKind::TanhFriction(TanhFriction { limit, velocity: 1e-4 }));
    let (radius, turn) = (1.0f64.hypot(limit), 1.0f64.atan2(limit));
    let off = [401, 402, 403, 404, 405].map(|count| {
        let mut marching = Marching::with_steps(&model, count, 0.0, 1.0).unwrap();
        marching.set_state(&[0.0], &[1.0]).unwrap();
        let step = TAU / count as f64;
        let steps = ((turn + TAU + 1.3) / step).round() as usize;
        run(&mut marching, steps);
        let phase = steps as f64 * step - turn - TAU;
        marching.displacements()[0] - limit - (radius - 6.0 * limit) * phase.cos()
    });
    // Steps change frequencies by (ωh)²/24, whatever part of one lies before a turn.
    let phase = (TAU / 401.0).powi(2) / 24.0 * (turn + TAU + 1.3);
    assert!(off.iter().all(|off| off.abs() < 1.5 * phase), "{off:?}, {phase}");
}

#[test]
fn a_penalty_stop_at_rest_makes_two_half_periods() {
    // k on one side of the origin, k + k_stop on the other.
    let (w, stiff) = (1.0, 3.0);
    let law = LawKind::PenaltySpring(PenaltySpring { stiffness: stiff * stiff - w * w, gap: 0.0 });
    let model = with_law(oscillator(1.0, w * w, 0.0), law);
    let period = PI / w + PI / stiff;
    let mut marching = Marching::new(&model, &steps(4000), 0.0, TAU / period).unwrap();
    marching.set_state(&[0.0], &[1.0]).unwrap();
    for _ in 0..5 {
        let summary = marching.period().unwrap();
        assert!((summary.max[0] - 1.0 / w).abs() < 1e-5);
    }
    assert!(marching.displacements()[0].abs() < 5e-5);
    assert!((marching.velocities()[0] - 1.0).abs() < 1e-5);
}

#[test]
fn a_jenkins_element_sticks_as_a_spring_and_slides_as_coulomb_friction() {
    let law = |limit| LawKind::Jenkins(Jenkins { stiffness: 3.0, limit });
    let model = with_law(oscillator(1.0, 1.0, 0.0), law(10.0));
    let mut marching = Marching::new(&model, &steps(2000), 0.0, 2.0).unwrap();
    marching.set_state(&[0.0], &[1.0]).unwrap();
    run(&mut marching, 500);
    // A quarter of the period of √(k + k_J) = 2 rad/s.
    assert!((marching.displacements()[0] - 0.5).abs() < 1e-6);

    // A stiff slider: the amplitude falls by 2F/k in each half cycle.
    let stiff = LawKind::Jenkins(Jenkins { stiffness: 1e6, limit: 0.01 });
    let model = with_law(oscillator(1.0, 1.0, 0.0), stiff);
    let mut marching = Marching::new(&model, &steps(4000), 0.0, 1.0).unwrap();
    marching.set_state(&[1.0], &[0.0]).unwrap();
    for _ in 0..5 {
        marching.period().unwrap();
    }
    assert!((marching.displacements()[0] - (1.0 - 5.0 * 0.04)).abs() < 1e-4);
}

/// A spring of 1 N/m that presses a dof against its stop, by this force at the stop.
fn pressing_spring(dof: usize, force: f64) -> Element {
    element("pressing", &[&[(dof, -1.0)]], LawKind::PenaltySpring(PenaltySpring { stiffness: 1.0, gap: -force }))
}

/// A mass of 1 kg on springs of together `stiffness`, pressed against a stop without clearance.
fn pressed(stiffness: f64, ratio: f64, force: f64) -> Model {
    let stop = element("stop", &[&[(0, 1.0)]], stop(0.0));
    with_elements(oscillator(1.0, stiffness - 1.0, ratio), vec![stop, pressing_spring(0, force)])
}

#[test]
fn a_stop_pressed_on_for_ever_carries_the_exact_force() {
    // The stop holds the mass at zero with λ = P + A cos ωt, which is above zero for A < P.
    let (pressing, amplitude, omega) = (2.0, 1.0, 1.3);
    let model = pressed(4.0, 0.01, pressing);
    let mut marching = Marching::new(&model, &MarchingSettings::default(), amplitude, omega).unwrap();
    marching.set_state(&[0.0], &[0.0]).unwrap();
    run(&mut marching, 3);
    for _ in 0..2000 {
        marching.step().unwrap();
        let exact = pressing + amplitude * (omega * marching.time()).cos();
        assert!((marching.pressures()[0] - exact).abs() < 1e-9);
        assert!(marching.displacements()[0].abs() < 1e-13);
    }
    assert!((marching.period().unwrap().contact[0] - 1.0).abs() < 1e-9);
}

#[test]
fn a_released_mass_flies_on_its_exact_orbit() {
    // λ = A cos ωt + A/2 falls to zero at cos ωt = −1/2; from there on the motion is that of the linear oscillator around
    // the place where it would rest without a stop, A/2k beyond it.
    let (w, omega, amplitude) = (2.0, 1.3, 1.0);
    let c = -0.5 * amplitude / (w * w);
    let model = pressed(w * w, 0.0, 0.5 * amplitude);
    let mut marching = Marching::new(&model, &steps(3000), amplitude, omega).unwrap();
    marching.set_state(&[0.0], &[0.0]).unwrap();
    run(&mut marching, 1500);
    let (t, release) = (marching.time(), TAU / 3.0 / omega);
    let forced = amplitude / (w * w - omega * omega);
    let (a, b) = (c + 0.5 * forced, forced * omega * (TAU / 3.0).sin() / w);
    let phase = w * (t - release);
    let exact = forced * (omega * t).cos() + a * phase.cos() + b * phase.sin() - c;
    assert!(exact < 0.0 && (marching.displacements()[0] - exact).abs() < 1e-5);
    assert_eq!(marching.pressures(), [0.0]);
}

#[test]
fn the_impact_of_a_lumped_mass_is_inelastic() {
    // A property of the contact law, not of physics: see the module's documentation.
    let model = with_law(oscillator(2.0, 0.0, 0.0), stop(0.3));
    let mut marching = Marching::new(&model, &steps(1000), 0.0, TAU).unwrap();
    marching.set_state(&[0.0], &[1.0]).unwrap();
    let mut impulse = 0.0;
    for _ in 0..500 {
        marching.step().unwrap();
        impulse += marching.pressures()[0] * marching.time_step();
        assert!(marching.displacements()[0] < 0.3 + 1e-12);
    }
    assert!((impulse - 2.0).abs() < 1e-9);
    assert!(marching.velocities()[0].abs() < 1e-9);
}

/// A free uniform bar of unit length, mass, wave speed and stiffness EA, in front of a wall.
fn bar(elements: usize, gap: f64) -> Model {
    let (n, k) = (elements + 1, elements as f64);
    let end = |i| i == 0 || i == n - 1;
    let mass: Vec<f64> = (0..n).map(|i| if end(i) { 0.5 / k } else { 1.0 / k }).collect();
    let stiffness = Matrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => k * if end(i) { 1.0 } else { 2.0 },
        1 => -k,
        _ => 0.0,
    });
    with_law(model(Matrix::diagonal(&mass), stiffness, 0.0, &vec![1.0; n]), stop(gap))
}

#[test]
fn a_bar_that_hits_a_wall_rebounds_after_two_wave_travels() {
    let losses = [60, 240].map(|elements| {
        let model = bar(elements, 0.05);
        let n = model.size();
        let mut marching = Marching::new(&model, &MarchingSettings::default(), 0.0, TAU).unwrap();
        marching.set_state(&vec![0.0; n], &vec![1.0; n]).unwrap();
        let energy = marching.energy();
        assert!((energy - 0.5).abs() < 1e-9);
        let (mut first, mut last, mut impulse, mut plateau) = (f64::INFINITY, 0.0, 0.0, (0.0, 0));
        while marching.time() < 2.5 {
            marching.step().unwrap();
            let (t, pressure) = (marching.time(), marching.pressures()[0]);
            if pressure > 0.0 {
                first = t.min(first);
                last = t;
            }
            impulse += pressure * marching.time_step();
            if t > 0.5 && t < 1.6 {
                plateau = (plateau.0 + pressure, plateau.1 + 1);
            }
        }
        // Contact from t = gap/V until the wave is back from the free end, under the pressure ρcAV; the bar leaves with
        // −V. The chain's wave fronts are spread over a few elements, (elements)^(-1/3) of its length.
        assert!((first - 0.05).abs() < 2.0 * marching.time_step());
        assert!((last - first - 2.0).abs() < 0.3 / (elements as f64).cbrt(), "{last}");
        assert!((plateau.0 / f64::from(plateau.1) - 1.0).abs() < 1e-3);
        assert!((impulse - 2.0).abs() < 0.35 * (elements as f64).powf(-2.0 / 3.0), "{impulse}");
        let momentum: f64 = (0..n).map(|i| model.mass()[(i, i)] * marching.velocities()[i]).sum();
        assert!((momentum - (1.0 - impulse)).abs() < 1e-9);
        1.0 - marching.energy() / energy
    });
    // What is lost is the kinetic energy of the touching node at the impact, 1/(2 elements) of the bar's; its release
    // costs nothing.
    assert!((120.0 * losses[0] - 1.0).abs() < 0.05, "{losses:?}");
    assert!((480.0 * losses[1] - 1.0).abs() < 0.05, "{losses:?}");
}

/// A stop without clearance that rubs.
fn rubbing(channels: &[&[(usize, f64)]; 3], friction: Friction) -> Element {
    element("node", channels, LawKind::Contact(Contact { gap: 0.0, epsilon: 1.0, friction: Some(friction) }))
}

#[test]
fn friction_drags_a_pressed_mass_along_the_sliding_direction() {
    // Held at the stop by λ, the force of the spring; friction μλ against σθ, so that the mass rests at θ = −σ μλ/k_θ.
    let (tangential, pressing, coefficient) = (2.0, 2.0, 0.3);
    for sense in [1.0, -1.0] {
        let stiffness = Matrix::diagonal(&[3.0, tangential, 3.0]);
        let model = model(Matrix::diagonal(&[1.0; 3]), stiffness, 0.2, &[1.0; 3]);
        let friction = Friction { coefficient, radius: 10.0, sense };
        let node = rubbing(&[&[(0, 1.0)], &[(1, 1.0)], &[(2, 1.0)]], friction);
        let model = with_elements(model, vec![node, pressing_spring(0, pressing)]);
        let mut marching = Marching::new(&model, &MarchingSettings::default(), 0.0, 2.0).unwrap();
        marching.set_state(&[0.0; 3], &[0.0; 3]).unwrap();
        for _ in 0..20 {
            marching.period().unwrap();
        }
        let x = marching.displacements();
        assert!((marching.pressures()[0] - pressing).abs() < 1e-9);
        assert!((x[1] + sense * coefficient * pressing / tangential).abs() < 1e-6, "{x:?}");
        assert!(x[2].abs() < 1e-12);
    }
}

#[test]
fn friction_couples_into_the_contact_force() {
    // The normal direction is inclined in the stiffness: the steady balance of three coupled dofs under λ and μλ.
    let stiffness = Matrix::from_fn(3, 3, |i, j| [[5.0, 1.5, 0.5], [1.5, 4.0, -0.5], [0.5, -0.5, 3.0]][i][j]);
    let model = model(Matrix::diagonal(&[1.0, 2.0, 1.5]), stiffness.clone(), 0.3, &[1.0; 3]);
    let (pressing, coefficient) = (2.5, 0.4);
    let friction = Friction { coefficient, radius: 10.0, sense: 1.0 };
    let node = rubbing(&[&[(0, 1.0)], &[(1, 1.0)], &[(2, 1.0)]], friction);
    let model = with_elements(model, vec![node, pressing_spring(0, pressing)]);
    let mut marching = Marching::new(&model, &MarchingSettings::default(), 0.0, 2.0).unwrap();
    marching.set_state(&[0.0; 3], &[0.0; 3]).unwrap();
    for _ in 0..30 {
        marching.period().unwrap();
    }
    let (x, pressure) = (marching.displacements(), marching.pressures()[0]);
    let balance = stiffness.mul_vec(&x);
    assert!(x[0].abs() < 1e-12);
    assert!((balance[0] + pressure - pressing).abs() < 1e-6);
    assert!((balance[1] + coefficient * pressure).abs() < 1e-6);
    assert!(balance[2].abs() < 1e-6);
}

/// The chain with a frictional stop that presses on its tip at rest, and that the tip leaves in every period.
fn rubbing_chain() -> Model {
    let friction = Friction { coefficient: 0.2, radius: 0.1, sense: -1.0 };
    let tip = rubbing(&[&[(2, 1.0)], &[(0, 1.0), (1, -1.0)], &[(1, 1.0)]], friction);
    changed(chain(), |data| {
        data.elements = vec![tip, pressing_spring(2, 15.0)];
        data.monitors = vec![2];
    })
}

#[test]
fn the_two_forms_of_damping_agree_in_contact() {
    let modal = rubbing_chain();
    let full = with_full_damping(modal.clone());
    assert!(matches!(full.damping(), Damping::Full(_)));
    let [a, b] = [&modal, &full].map(|model| {
        let mut marching = Marching::new(model, &MarchingSettings::default(), 30.0, 20.0).unwrap();
        let summary = marching.period().unwrap();
        assert!(summary.contact[0] > 0.1 && summary.contact[0] < 0.9, "{summary:?}");
        marching.displacements()
    });
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-10));
}

#[test]
fn a_motion_restarted_in_contact_goes_on() {
    let model = rubbing_chain();
    let error = |count: usize| {
        let mut first = Marching::new(&model, &steps(count), 30.0, 20.0).unwrap();
        // Whole periods, for a restart is at phase zero; the start is chosen so that the tip is pressed on there.
        first.set_state(&[0.0; 3], &[0.0, 0.5, 0.0]).unwrap();
        first.period().unwrap();
        while first.pressures()[0] == 0.0 {
            first.period().unwrap();
        }
        let mut second = Marching::new(&model, &steps(count), 30.0, 20.0).unwrap();
        second.set_state(&first.displacements(), &first.velocities()).unwrap();
        run(&mut first, count / 20);
        run(&mut second, count / 20);
        let (a, b) = (first.displacements(), second.displacements());
        a.iter().zip(&b).fold(0.0, |largest: f64, (a, b)| largest.max((a - b).abs()))
    };
    // The central velocity and the start both err by h², on motions of 1e-2 m.
    let (coarse, fine) = (error(4000), error(8000));
    assert!(coarse < 1e-8 && (coarse / fine - 4.0).abs() < 0.3, "{coarse:e} {fine:e}");
}

#[test]
fn settings_and_unbounded_motion_are_reported() {
    let model = oscillator(1.0, 1.0, 0.01);
    let settings = MarchingSettings { step_fraction: 1.5, ..MarchingSettings::default() };
    let error = Marching::new(&model, &settings, 1.0, 1.0).err().unwrap();
    assert_eq!(error.to_string(), "step_fraction = 1.5 is out of range: expected between 0 and 1");
    assert!(Marching::new(&model, &steps(512), 1.0, 0.0).is_err());

    let terms = vec![Term { power: 3, coefficient: -5.0 }];
    let model = with_law(model, LawKind::PolynomialSpring(PolynomialSpring { terms }));
    let mut marching = Marching::new(&model, &steps(512), 0.0, 1.0).unwrap();
    marching.set_state(&[1.0], &[0.0]).unwrap();
    assert!(matches!(marching.period(), Err(MarchingError::Diverged { .. })));
}
