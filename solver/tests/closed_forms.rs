//! Harmonic balance against closed forms and against direct integration, neither of which shares code with it.

use solver::backbone::Backbone;
use solver::branch::{Branch, BranchPoint, SpecialKind};
use solver::forced::{Forced, Reach};
use solver::harmonics::{complex, evaluate, width};
use solver::laws::{Contact, Jenkins, LawKind, TanhFriction};
use solver::linalg::Matrix;
use solver::linear::forced_response;
use solver::model::{DampingParts, Element, ForcingShape, Model, ModelParts};
use solver::pressure::PressureForm;
use solver::problem::Problem;
use solver::scales::Scales;
use solver::settings::{BackboneEquation, HarmonicSettings, Settings};
use solver::state::State;
use solver::unknown::Unknown;
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;
use std::path::Path;

fn load(name: &str) -> Model {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name);
    Model::load(&folder).unwrap_or_else(|error| panic!("{error}"))
}

fn quiet(_: &BranchPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn element(channel: &[(usize, f64)], law: LawKind) -> Element {
    Element { name: "element".into(), channels: vec![channel.to_vec()], law }
}

fn contact(gap: f64, epsilon: f64) -> LawKind {
    LawKind::Contact(Contact { gap, epsilon, friction: None })
}

/// One mass of 1 kg with modal damping, forced by 1 N per unit of amplitude.
fn oscillator(stiffness: f64, ratio: f64, law: LawKind) -> Model {
    Model::new(ModelParts {
        name: "oscillator".into(),
        dofs: Vec::new(),
        mass: Matrix::diagonal(&[1.0]),
        stiffness: Matrix::diagonal(&[stiffness]),
        damping: DampingParts::Ratios(vec![ratio]),
        shape: ForcingShape::Vector(vec![1.0]),
        harmonic: 1,
        elements: vec![element(&[(0, 1.0)], law)],
        monitors: Vec::new(),
    })
    .unwrap()
}

fn with_harmonics(count: usize) -> Settings {
    Settings { harmonics: HarmonicSettings { count, ..Default::default() }, ..Settings::default() }
}

fn conservative(count: usize) -> Settings {
    let mut settings = with_harmonics(count);
    settings.backbone.equation = BackboneEquation::ConservativeMode;
    settings
}

fn backbone(model: &Model, settings: &Settings) -> Backbone {
    Backbone::compute(model, settings, &mut quiet).unwrap()
}

/// Displacement of a dof.
fn displacement(model: &Model, state: &State, dof: usize) -> Vec<f64> {
    state.combine(model.modes.shapes.row(dof).iter().copied())
}

/// Converged states of a branch at one frequency, in the order of the arc.
fn states_at(forced: &mut Forced<'_>, branch: &Branch, omega: f64) -> Vec<State> {
    let crossing = |pair: &&[BranchPoint]| (pair[0].omega() - omega) * (pair[1].omega() - omega) < 0.0;
    let pairs: Vec<_> = branch.points.windows(2).filter(crossing).collect();
    let between = pairs.into_iter().map(|pair| {
        let share = (omega - pair[0].omega()) / (pair[1].omega() - pair[0].omega());
        State { omega, ..pair[0].state.interpolate(&pair[1].state, share) }
    });
    between.map(|state| forced.converge(&state).unwrap()).collect()
}

/// Root of a function with a sign change between `low` and `high`.
fn bisect(mut low: f64, mut high: f64, function: impl Fn(f64) -> f64) -> f64 {
    let sign = function(low) > 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if (function(middle) > 0.0) == sign { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

// ---------------------------------------------------------------------------------------------------- linear response

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
    let damping =
        if proportional { DampingParts::Ratios(ratios.clone()) } else { DampingParts::Matrix(dashpots.clone()) };
    let mass = Matrix::diagonal(&masses);
    let model = Model::new(ModelParts {
        name: "chain".into(),
        dofs: Vec::new(),
        mass: mass.clone(),
        stiffness,
        damping,
        shape: ForcingShape::Vector(vec![0.0, 1.0, 0.0, -0.3, 0.2]),
        harmonic: 1,
        // Far out of reach: the model is linear, but its contact is part of every system solved.
        elements: vec![element(&[(4, 1.0)], contact(1.0, 1e3))],
        monitors: vec![2],
    })
    .unwrap();
    // C = M Φ diag(2 ξ ω) Φᵀ M.
    let c = if proportional {
        let rates: Vec<f64> = ratios.iter().zip(&model.modes.frequencies).map(|(r, w)| 2.0 * r * w).collect();
        let left = mass.matmul(&model.modes.shapes);
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
            let re = |j| model.stiffness[(i, j)] - omega * omega * model.mass[(i, j)];
            let im = |j| omega * c[(i, j)];
            let mut row: Vec<f64> = if part == 0 {
                (0..n).map(re).chain((0..n).map(|j| -im(j))).collect()
            } else {
                (0..n).map(im).chain((0..n).map(re)).collect()
            };
            row.push(if part == 0 { amplitude * model.forcing.shape[i] } else { 0.0 });
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
    let exact = dense_response(model, c, state.amplitude, state.omega);
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
        let problem =
            PressureForm::new(&model, with_harmonics(3).harmonics, 0, Unknown::Frequency, Scales::new(&model, 0));
        let top = 1.3 * model.modes.frequencies[4];
        let grid = (1..=400).map(|i| top * f64::from(i) / 400.0);
        for omega in grid.chain(model.modes.frequencies.iter().copied()) {
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
        let frequencies = &model.modes.frequencies;
        (settings.frequency.min, settings.frequency.max) = (Some(0.5 * frequencies[0]), Some(1.2 * frequencies[4]));
        let backbone = backbone(&model, &settings);
        let mut forced = Forced::new(&model, &settings, Reach::new(&settings, &backbone).unwrap(), 2.5);
        let branch = forced.main_branch(&mut quiet).unwrap();
        let (low, high) = branch.frequency_range();
        assert!(low < 0.51 * frequencies[0] && high > 1.19 * frequencies[4], "{low} {high} {:?}", branch.outcome);
        let errors: Vec<(f64, f64)> = branch.points.iter().map(|p| linear_error(&model, &c, &p.state)).collect();
        let peak = errors.iter().fold(0.0f64, |m, e| m.max(e.1));
        for (point, (error, _)) in branch.points.iter().zip(errors) {
            assert_eq!(point.contact, [0.0]);
            assert!(error < 1e-10 * peak, "proportional {proportional}, {} rad/s: {error:e}", point.omega());
        }
        assert!(branch.points.len() > 50);
    }
}

// ------------------------------------------------------------------------------------------------------------ Duffing

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
        let branch = Forced::new(&model, &settings, Reach::new(&settings, &backbone).unwrap(), amplitude)
            .main_branch(&mut quiet)
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
    let mut forced = Forced::new(&model, &settings, Reach::new(&settings, &backbone).unwrap(), amplitude);
    let branch = forced.main_branch(&mut quiet).unwrap();
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

// -------------------------------------------------------------------------------------------------------- rigid stops

/// Frequency of the undamped free motion before a rigid stop, a the excursion away from it: x = −a cos ω₀t from −a to the
/// gap takes (π − arccos(gap/a))/ω₀, half a period.
fn bouncing(natural: f64, gap: f64, a: f64) -> f64 {
    natural * PI / (PI - (gap / a).acos())
}

/// Frequency of a backbone at an amplitude, by cubic interpolation between four points.
fn frequency_at(backbone: &Backbone, amplitude: f64) -> f64 {
    let points: Vec<(f64, f64)> = backbone.points.iter().map(|p| (p.point.amplitude(), p.point.omega())).collect();
    let above = points.iter().position(|p| p.0 > amplitude).unwrap();
    let near = &points[above - 2..above + 2];
    let weight = |i: usize| {
        let others = (0..4).filter(|&j| j != i);
        others.map(|j| (amplitude - near[j].0) / (near[i].0 - near[j].0)).product::<f64>()
    };
    (0..4).map(|i| weight(i) * near[i].1).sum()
}

#[test]
fn a_mass_bouncing_on_a_rigid_stop() {
    // Before the stop between two masses x1 = q/√2: half of the gap between them.
    for (name, mode, gap) in [("impact_subharmonic", 1, 1.0), ("two_masses_stop", 2, 0.05)] {
        let model = load(name);
        let curves = [5, 10, 20, 40, 80].map(|count| {
            let mut settings = conservative(count);
            settings.backbone.mode = mode;
            backbone(&model, &settings)
        });
        for amplitude in [1.5 * gap, 2.0 * gap, 4.0 * gap] {
            let exact = bouncing(model.modes.frequencies[mode - 1], gap, amplitude);
            let found = curves.each_ref().map(|curve| frequency_at(curve, amplitude));
            let errors = found.map(|omega| omega / exact - 1.0);
            let extrapolated = (2.0 * found[4] - found[3]) / exact - 1.0;
            println!("{name}, a = {amplitude}: {errors:.5?}, extrapolated {extrapolated:.5}");
            // An impulse has harmonics that do not decay. What is cut off makes the stop softer: the frequency comes from
            // below, at an order in 1/H that rises from 0.7 (H = 5 to 10) to 0.9 (40 to 80), towards 1.
            for pair in errors.windows(2) {
                let order = (pair[0] / pair[1]).log2();
                assert!(pair[0] < pair[1] && pair[1] < 0.0 && order > 0.6 && order < 1.0, "{errors:?}");
            }
            assert!(errors[3].abs() < 0.0215 && errors[4].abs() < 0.0115, "{errors:?}");
            // First-order extrapolation from the last two.
            assert!(extrapolated.abs() < 2e-3, "{extrapolated}");
        }
    }
}

#[test]
fn contact_between_two_bodies_is_that_of_one_body_before_a_stop() {
    let two = load("two_masses_stop");
    // In q = (x1 − x2)/√2 the gap is 1/√2 of that between the masses, and a pressure λ there is √2 λ here: ε is doubled.
    let one = oscillator(3.0, 0.005, contact(0.1 / 2f64.sqrt(), 6.0));
    let mut settings = with_harmonics(20);
    let reference = backbone(&one, &settings);
    let branch = Forced::new(&one, &settings, Reach::new(&settings, &reference).unwrap(), 0.005)
        .main_branch(&mut quiet)
        .unwrap();
    settings.backbone.mode = 2;
    let mut forced = Forced::new(&two, &settings, Reach::new(&settings, &reference).unwrap(), 0.005);
    // The forcing shape M φ_2 follows the sign of φ_2 = ±(1, −1)/√2, and so does q.
    let sign = two.modes.shapes[(0, 1)].signum();
    let mut touching = 0;
    for point in &branch.points {
        let mut modal = vec![0.0; width(20)];
        modal.extend(point.state.modal.iter().map(|q| sign * q));
        let arguments = point.state.arguments.iter().map(|p| p / 2f64.sqrt()).collect();
        let y = forced.problem.encode(&State { arguments, modal, ..point.state.clone() });
        let mut completed = y.clone();
        let residual = forced.problem.linearise(&mut completed);
        // Where modal amplitudes follow from the forces they agree as far as the residual of one body allows, 1e-11.
        let moved = y.iter().zip(&completed).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(residual < 1e-10 && moved < 1e-10, "{} rad/s: {residual:e} {moved:e}", point.omega());
        touching += usize::from(point.contact[0] > 0.0);
    }
    assert!(touching > 100 && branch.peak().amplitude() > 0.14, "{touching} {}", branch.peak().amplitude());
}

// ----------------------------------------------------------------------------------------------------------- friction

#[test]
fn an_elastic_friction_element_is_a_linear_spring() {
    let model = oscillator(2.0, 0.01, LawKind::Jenkins(Jenkins { stiffness: 1.0, limit: 10.0 }));
    let mut settings = with_harmonics(5);
    // Residuals are measured in the amplitude at which friction matters, a hundred times these.
    settings.continuation.newton.tolerance = 1e-13;
    (settings.frequency.min, settings.frequency.max) = (Some(1.0), Some(2.5));
    let backbone = backbone(&model, &settings);
    let branch =
        Forced::new(&model, &settings, Reach::new(&settings, &backbone).unwrap(), 0.1).main_branch(&mut quiet).unwrap();
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
        let (a, loss) = (point.point.amplitude(), point.energies.nonlinear);
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
        let (a, loss) = (point.point.amplitude(), point.energies.nonlinear);
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
